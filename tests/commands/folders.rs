//! Results of a test in a folder of their own, and nothing of an earlier one lost.

use std::fmt::Write as _;
use std::path::Path;

use crate::work::{Work, data, unpacked};

/// Names in `out`, sorted.
fn folders(work: &Work) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(work.path("out")) else { return Vec::new() };
    let mut names: Vec<String> =
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A run on a day, with a log of `tests/data`.
fn measured(log: &str, day: &str) -> Work {
    let work = Work::new();
    work.run_of(unpacked(&data("hu40t").join(log)));
    on(&work, day);
    work
}

fn on(work: &Work, day: &str) {
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    let test = test.split("[record]").next().unwrap();
    work.write("test.toml", format!("{test}[record]\ndate = {day}\n"));
}

#[test]
fn the_same_logs_go_to_the_same_folder_and_others_to_another() {
    let work = measured("run1.csv.gz", "2026-03-02");
    let first = work.plain(&["identify", "test.toml"]).done();
    assert!(
        first.stderr().contains("wrote out/2026-03-02-Test/analysis.json"),
        "{}",
        first.stderr()
    );
    let before = std::fs::read(work.path("out/2026-03-02-Test/analysis.json")).unwrap();
    let again = work.plain(&["identify", "test.toml"]).done();
    assert!(!again.stderr().contains("replaced"), "the same bytes: {}", again.stderr());
    assert_eq!(folders(&work), ["2026-03-02-Test"]);
    assert_eq!(std::fs::read(work.path("out/2026-03-02-Test/analysis.json")).unwrap(), before);

    // Taken otherwise, it takes the place of the one before, and says so.
    let otherwise = work.plain(&["identify", "test.toml", "--loss", "tukey"]).done();
    assert!(
        otherwise.stderr().contains("replaced the results of the same logs"),
        "{}",
        otherwise.stderr()
    );

    // Another log of the same name on the same day is another measurement.
    work.write("run.csv", unpacked(&data("hu40t").join("run2.csv.gz")));
    work.plain(&["identify", "test.toml"]).done();
    work.plain(&["align", "test.toml"]).done();
    assert_eq!(folders(&work), ["2026-03-02-Test", "2026-03-02-Test-2"]);
    assert!(work.path("out/2026-03-02-Test-2/samples-run.csv").exists());

    on(&work, "2026-04-07");
    work.plain(&["identify", "test.toml"]).done();
    assert_eq!(folders(&work), ["2026-03-02-Test", "2026-03-02-Test-2", "2026-04-07-Test"]);
}

#[test]
fn a_folder_of_somebody_else_is_left_alone() {
    let work = measured("run1.csv.gz", "2026-03-02");
    std::fs::create_dir_all(work.path("out/2026-03-02-Test")).unwrap();
    work.write("out/2026-03-02-Test/notes.txt", "mine");
    work.plain(&["identify", "test.toml"]).done();
    let inside = std::fs::read_dir(work.path("out/2026-03-02-Test")).unwrap().count();
    assert_eq!(inside, 1);
    assert!(work.path("out/2026-03-02-Test-2/analysis.json").exists());
}

/// A log that says its day is filed under it; one that does not, under the day of the analysis.
#[test]
fn the_day_is_that_of_the_log() {
    let log = unpacked(&data("hu40t").join("run1.csv.gz"));
    let work = Work::new();
    let mut rows = log.lines().filter(|line| !line.starts_with('#'));
    let mut dated = format!("{}\n", rows.next().unwrap());
    for row in rows {
        let (time_s, rest) = row.split_once(',').unwrap();
        let time_s: f64 = time_s.parse().unwrap();
        let (minutes, seconds) = ((time_s / 60.0).floor(), time_s % 60.0);
        writeln!(dated, "05.06.2026 08:{minutes:02.0}:{seconds:07.4},{rest}").unwrap();
    }
    work.run_of(&dated);
    work.plain(&["identify", "test.toml"]).done();
    assert_eq!(folders(&work), ["2026-06-05-Test"]);
    let analysis = std::fs::read_to_string(work.path("out/2026-06-05-Test/analysis.json")).unwrap();
    let analysis: serde_json::Value = serde_json::from_str(&analysis).unwrap();
    assert_eq!(analysis["test"]["date"], "2026-06-05");
    work.write("run.csv", log);
    work.plain(&["identify", "test.toml"]).done();
    let today = folders(&work).into_iter().find(|name| name != "2026-06-05-Test").unwrap();
    assert!(today.len() == "2026-06-05-Test".len() && today.ends_with("-Test"), "{today}");
}

/// The folder of a test with all that belongs to it can be moved, and mailed.
#[test]
fn files_are_named_from_the_folder_of_the_results() {
    let work = measured("run1.csv.gz", "2026-03-02");
    let test = work.path("test.toml");
    work.plain(&["identify", test.to_str().unwrap()]).done();
    let folder = work.path("out/2026-03-02-Test");
    let analysis = std::fs::read_to_string(folder.join("analysis.json")).unwrap();
    let analysis: serde_json::Value = serde_json::from_str(&analysis).unwrap();
    let run = &analysis["repeats"][0]["runs"][0];
    for file in
        [&analysis["test"]["file"], &analysis["machine"]["file"], &run["log"], &run["program"]]
    {
        let file = Path::new(file.as_str().unwrap());
        assert!(file.is_relative() && folder.join(file).exists(), "{}", file.display());
    }
}
