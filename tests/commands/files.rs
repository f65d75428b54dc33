//! Nothing of the user's is replaced, and results are of one command.

use crate::work::{Work, data, unpacked};

const PLAN: &str = "[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n";

fn planned() -> Work {
    let work = Work::new();
    work.machine("name", "name").test(PLAN);
    work
}

#[test]
fn a_program_edited_by_hand_stays() {
    let work = planned();
    work.ballbar(&["program", "test.toml"]).done();
    let program = std::fs::read_to_string(work.path("results/O1001.nc")).unwrap();
    // The same again is no harm, nor is a plan that has changed.
    work.ballbar(&["program", "test.toml"]).done();
    work.test(&PLAN.replace("500.0", "600.0"));
    work.ballbar(&["program", "test.toml"]).done();

    let edited = program.replace("M30", "(EDITED)\nM30");
    work.write("results/O1001.nc", &edited);
    let refused = work.ballbar(&["program", "test.toml"]);
    assert_eq!(refused.code(), 5, "{}", refused.stderr());
    for told in ["edited since", "O1001.nc", "hint: choose another directory", "`--overwrite`"] {
        assert!(refused.stderr().contains(told), "{}", refused.stderr());
    }
    assert_eq!(std::fs::read_to_string(work.path("results/O1001.nc")).unwrap(), edited);
    work.ballbar(&["program", "test.toml", "--overwrite"]).done();
    let after = std::fs::read_to_string(work.path("results/O1001.nc")).unwrap();
    assert!(after.contains("F600.") && !after.contains("EDITED"), "{after}");
}

#[test]
fn a_file_that_was_there_before_stays() {
    let work = planned();
    std::fs::create_dir(work.path("results")).unwrap();
    work.write("results/plan.json", "my own");
    let refused = work.ballbar(&["plan", "test.toml"]);
    assert_eq!(refused.code(), 5, "{}", refused.stderr());
    assert_eq!(refused.files(), ["plan.json"], "neither page nor plan");
    assert!(!work.path("results/.ballbar").exists());
}

/// Also when it was written here: a log belongs to the program that ran.
#[test]
fn a_program_that_a_run_names_stays() {
    let work = planned();
    work.ballbar(&["program", "test.toml"]).done();
    let run = "[[run]]\nprogram = \"results/O1001.nc\"\nlog = \"run.csv\"\n";
    work.write("run.csv", "time_s,deviation_um\n");
    work.test(&format!("{}{run}", PLAN.replace("500.0", "600.0")));
    let before = std::fs::read(work.path("results/O1001.nc")).unwrap();
    let refused = work.ballbar(&["program", "test.toml", "--overwrite"]);
    assert_eq!(refused.code(), 5, "{}", refused.stderr());
    assert!(refused.stderr().contains("replace a file that was read"), "{}", refused.stderr());
    assert_eq!(std::fs::read(work.path("results/O1001.nc")).unwrap(), before);
}

#[test]
fn a_log_called_like_a_file_of_samples_stays() {
    let work = Work::new();
    let log = unpacked(&data("hu40t").join("run1.csv.gz"));
    work.run_of(&log);
    std::fs::create_dir(work.path("results")).unwrap();
    work.write("results/samples-run1.csv", &log);
    work.test(
        "[[run]]\nname = \"run1\"\nprogram = \"O1005.nc\"\nlog = \"results/samples-run1.csv\"\n",
    );
    let refused = work.ballbar(&["align", "test.toml"]);
    assert_eq!(refused.code(), 5, "{}", refused.stderr());
    assert!(refused.stderr().contains("replace a file that was read"), "{}", refused.stderr());
    assert_eq!(std::fs::read_to_string(work.path("results/samples-run1.csv")).unwrap(), log);
}

/// Samples and a model of an analysis that is no more would tell of another machine.
#[test]
fn an_analysis_takes_the_place_of_the_one_before() {
    let work = Work::new();
    let log = unpacked(&data("hu40t").join("run1.csv.gz"));
    work.run_of(&log);
    work.ballbar(&["analyse", "test.toml"]).done();
    assert!(work.path("results/samples-run.csv").exists());
    work.write("other.csv", &log);
    work.test("[[run]]\nprogram = \"O1005.nc\"\nlog = \"other.csv\"\n");
    let second = work.ballbar(&["analyse", "test.toml"]).done();
    assert!(!second.files().contains(&"samples-run.csv".to_owned()), "{:?}", second.files());
    assert!(second.stderr().contains("removed results/samples-run.csv"), "{}", second.stderr());
    // One that somebody has worked on is his.
    work.write("results/samples-other.csv", "mine");
    work.run_of(&log);
    let third = work.ballbar(&["analyse", "test.toml"]).done();
    assert!(third.files().contains(&"samples-other.csv".to_owned()), "{:?}", third.files());
}

#[cfg(unix)]
#[test]
fn a_replaced_file_keeps_who_may_read_it() {
    use std::os::unix::fs::PermissionsExt;
    let work = planned();
    work.ballbar(&["program", "test.toml"]).done();
    let file = work.path("results/O1001.nc");
    std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).unwrap();
    work.test(&PLAN.replace("500.0", "600.0"));
    work.ballbar(&["program", "test.toml"]).done();
    assert_eq!(std::fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
}

/// Two programs of one name in two directories are two programs.
#[test]
fn programs_of_one_name_are_simulated_apart() {
    let work = planned();
    for (directory, feed) in [("a", "500.0"), ("b", "700.0")] {
        work.test(&PLAN.replace("500.0", feed));
        work.ballbar(&["program", "test.toml"]).done();
        std::fs::create_dir(work.path(directory)).unwrap();
        std::fs::copy(work.path("results/O1001.nc"), work.path(directory).join("P.nc")).unwrap();
    }
    work.test("[[run]]\nprogram = \"a/P.nc\"\nlog = \"a.csv\"\n[[run]]\nprogram = \"b/P.nc\"\nlog = \"b.csv\"\n");
    std::fs::remove_dir_all(work.path("results")).unwrap();
    let simulated = work.ballbar(&["simulate", "test.toml"]).done();
    let files = ["P-2.nc", "P.nc", "run1-P-2.csv", "run1-P.csv", "test.toml", "truth.toml"];
    assert_eq!(simulated.files(), files);
    for (name, original) in [("P.nc", "a/P.nc"), ("P-2.nc", "b/P.nc")] {
        let [written, original] = [format!("results/{name}"), original.to_owned()]
            .map(|f| std::fs::read(work.path(&f)).unwrap());
        assert_eq!(written, original, "{name}");
    }
    let test = std::fs::read_to_string(work.path("results/test.toml")).unwrap();
    assert!(test.contains("program = \"P-2.nc\""), "{test}");
    work.ballbar(&["align", "results/test.toml"]).done();
}

/// What a terminal would obey is shown.
#[test]
fn names_do_nothing_to_a_terminal() {
    let work = planned();
    let source = std::fs::read_to_string(work.path("test.toml")).unwrap();
    work.write(
        "test.toml",
        source.replacen("\"Test\"", "\"\\u001b[2J\\u001b]0;gone\\u0007\\u009b31m\"", 1),
    );
    let planned = work.ballbar(&["plan", "test.toml"]).done();
    for text in [planned.stdout(), planned.stderr()] {
        assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text:?}");
    }
    assert!(planned.stdout().contains("\\u001b[2J"), "{}", planned.stdout());
}
