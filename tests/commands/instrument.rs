//! Logs that are not what the test file says: units and signs, a bar that slipped, one that reads less than stated, two runs
//! in one log, logs at each other's run, a zero the other way. Each is told, or the result is right with a caution.

use std::fmt::Write as _;

use serde_json::Value;

use crate::work::{Work, data, unpacked};

/// Time (s) and reading (um) of a line.
type Line = (f64, Option<f64>);

/// The lines of a log of measured data.
fn lines(set: &str, log: &str) -> Vec<Line> {
    let text = unpacked(&data(set).join(log));
    let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    rows.map(|row| {
        let (time, reading) = row.split_once(',').unwrap();
        (time.parse().unwrap(), reading.parse().ok())
    })
    .collect()
}

fn text(lines: impl IntoIterator<Item = Line>) -> String {
    let mut text = "time_s,deviation_um\n".to_owned();
    for (time_s, reading_um) in lines {
        let _ = match reading_um {
            Some(um) => writeln!(text, "{time_s},{um}"),
            None => writeln!(text, "{time_s},"),
        };
    }
    text
}

/// The test of a set, with the run `run1` of a changed log and `run2` as it was measured.
fn changed(set: &str, program: &str, change: impl Fn(Line) -> Line) -> Work {
    with_log(set, program, text(lines(set, "run1.csv.gz").into_iter().map(change)))
}

fn with_log(set: &str, program: &str, log: String) -> Work {
    let work = Work::new();
    let machine = data(set).join("machine.toml");
    let machine =
        if machine.exists() { machine } else { crate::work::project().join("machines/hu40t.toml") };
    let test = std::fs::read_to_string(data(set).join("test.toml")).unwrap();
    let test = test.split("[plan]").next().unwrap();
    let test = test.replace("../../../machines/hu40t.toml", "machine.toml");
    let run = |name: &str| format!("[[run]]\nprogram = \"{program}\"\nlog = \"{name}.csv\"\n");
    work.write("machine.toml", std::fs::read_to_string(machine).unwrap())
        .write(program, unpacked(&data(set).join(format!("{program}.gz"))))
        .write("run1.csv", log)
        .write("run2.csv", unpacked(&data(set).join("run2.csv.gz")))
        .write("test.toml", format!("{test}\n{}{}", run("run1"), run("run2")));
    work
}

fn rewrite(work: &Work, file: &str, from: &str, to: &str) {
    let source = std::fs::read_to_string(work.path(file)).unwrap();
    assert!(source.contains(from), "{from}: {source}");
    work.write(file, source.replacen(from, to, 1));
}

fn analysed(work: &Work) -> Value {
    work.ballbar(&["diagnose", "test.toml"]).done();
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    serde_json::from_str(&analysis).unwrap()
}

/// The caution that says so.
#[track_caller]
fn caution(analysis: &Value, says: &str) -> String {
    let all = analysis["cautions"].as_array().unwrap();
    let found = all.iter().filter_map(Value::as_str).find(|caution| caution.contains(says));
    assert!(found.is_some(), "{says}: {all:?}");
    found.unwrap_or_default().to_owned()
}

/// Three sets: ten readings a second and zero in the middle; one plane and 250 a second; zero at the end of travel.
const SETS: [(&str, &str); 3] =
    [("hu40t", "O1005.nc"), ("planar250", "O4002.nc"), ("rate250", "O4001.nc")];

/// What is wrong is told with the line to write, and with that line it is right.
#[track_caller]
fn told_and_put_right(set: &str, program: &str, line: &str, change: impl Fn(Line) -> Line) {
    let work = changed(set, program, change);
    // The second run is as it should be.
    rewrite(
        &work,
        "test.toml",
        &format!("[[run]]\nprogram = \"{program}\"\nlog = \"run2.csv\"\n"),
        "",
    );
    let message = work.ballbar(&["analyse", "test.toml"]).refused(3);
    let hint = format!("hint: write `{line}` under `[log]` in test.toml");
    assert!(message.contains(&hint), "{set}: {message}");
    rewrite(&work, "test.toml", "[[mounting]]", &format!("[log]\n{line}\n\n[[mounting]]"));
    work.ballbar(&["identify", "test.toml"]).done();
}

#[test]
fn readings_of_the_other_sign() {
    for (set, program) in SETS {
        let turned = |(time_s, um): Line| (time_s, um.map(|um| -um));
        told_and_put_right(set, program, "reading_sign = -1", turned);
    }
}

#[test]
fn readings_in_another_unit() {
    for (set, program) in SETS {
        for (line, of_um) in
            [("reading_unit = \"mm\"", 1e-3), ("reading_unit = \"inch\"", 1e-3 / 25.4)]
        {
            let read = |(time_s, um): Line| (time_s, um.map(|um| um * of_um));
            told_and_put_right(set, program, line, read);
        }
    }
}

#[test]
fn times_in_another_unit() {
    for (set, program) in SETS {
        told_and_put_right(set, program, "time_unit = \"ms\"", |(s, um)| (1e3 * s, um));
    }
}

#[test]
fn readings_in_um_where_mm_are_stated() {
    let work = changed("hu40t", "O1005.nc", |line| line);
    rewrite(&work, "test.toml", "[[mounting]]", "[log]\nreading_unit = \"mm\"\n\n[[mounting]]");
    let message = work.ballbar(&["analyse", "test.toml"]).refused(1);
    assert!(message.contains("write `reading_unit = \"um\"`"), "{message}");
}

#[test]
fn a_sign_is_one_or_the_other_and_of_deviations() {
    let work = Work::new();
    for (log, told) in [
        ("reading_sign = 2", "`reading_sign` cannot be 2"),
        ("reading_sign = -1\nreading = \"length\"", "a length cannot have a sign"),
    ] {
        work.machine("name", "name").test(&format!("[log]\n{log}\n"));
        let message = work.ballbar(&["analyse", "test.toml"]).refused(1);
        assert!(message.contains(told) && message.contains("test.toml:"), "{message}");
    }
}

#[test]
fn a_bar_that_slipped() {
    for (set, program, at_s) in [("hu40t", "O1005.nc", 492.0), ("rate250", "O4001.nc", 188.0)] {
        for step_um in [5.0, 100.0] {
            let slipped =
                |(s, um): Line| (s, um.map(|um| if s > at_s { um + step_um } else { um }));
            let analysis = analysed(&changed(set, program, slipped));
            let told = caution(&analysis, "the readings step by");
            let (_, step) = told.split_once("step by ").unwrap();
            let step: f64 = step.split_whitespace().next().unwrap().parse().unwrap();
            assert!((step - step_um).abs() < 0.1, "{told}");
            assert!(told.contains("slipped") && told.starts_with("run1:"), "{told}");
            // No cause is named for it, and no run is left out.
            let diagnosis = &analysis["diagnosis"];
            assert_eq!(diagnosis["findings"].as_array().unwrap().len(), 0, "{set}");
            assert_eq!(diagnosis["left_out"].as_array().unwrap().len(), 0, "{set}");
            assert!(diagnosis["after_um"].as_f64().unwrap() < 0.16, "{set}");
        }
    }
}

/// There a slide that turns round steps the readings as well.
#[test]
fn a_bar_that_slipped_where_a_slide_turned_round() {
    for (at_s, step_um) in [(78.4, 33.7), (97.37, 87.9)] {
        let slipped = |(s, um): Line| (s, um.map(|um| if s > at_s { um + step_um } else { um }));
        let analysis = analysed(&changed("planar250", "O4002.nc", slipped));
        let told = caution(&analysis, "the readings step by");
        let (_, step) = told.split_once("step by ").unwrap();
        let step: f64 = step.split_whitespace().next().unwrap().parse().unwrap();
        assert!((step - step_um).abs() < 0.5, "{told}");
        // What is in the data all the same, in its order.
        let findings = analysis["diagnosis"]["findings"].as_array().unwrap();
        let named: Vec<&str> = findings.iter().filter_map(|one| one["cause"].as_str()).collect();
        assert_eq!(named[..2], ["servo", "cyclic"], "{named:?}");
    }
}

#[test]
fn a_bar_that_slipped_while_it_did_not_read() {
    let slipped = |(s, um): Line| match um {
        _ if (491.0..492.5).contains(&s) => (s, None),
        Some(um) if s > 492.0 => (s, Some(um + 20.0)),
        as_it_was => (s, as_it_was),
    };
    let analysis = analysed(&changed("hu40t", "O1005.nc", slipped));
    caution(&analysis, "the readings step by +20.0");
    assert_eq!(analysis["diagnosis"]["findings"].as_array().unwrap().len(), 0);
}

#[test]
fn a_second_run_behind_the_first() {
    for (set, program) in SETS {
        let once = lines(set, "run1.csv.gz");
        let end_s = once.last().unwrap().0 + (once[1].0 - once[0].0);
        let again = once.iter().map(|(s, um)| (s + end_s, *um));
        let work = with_log(set, program, text(once.iter().copied().chain(again)));
        let analysis = analysed(&work);
        let told = caution(&analysis, "the log holds another run as well");
        assert!(told.starts_with("run1:") && told.contains("cut the log in two"), "{told}");
        assert_eq!(analysis["diagnosis"]["left_out"].as_array().unwrap().len(), 0, "{set}");
    }
}

#[test]
fn readings_that_are_cut_off_below_the_range() {
    for ((set, program), limit_um) in [(SETS[0], 15.0), (SETS[2], 21.5)] {
        let cut = |(s, um): Line| (s, um.map(|um| um.min(limit_um)));
        let analysis = analysed(&changed(set, program, cut));
        let told = caution(&analysis, &format!("are exactly {limit_um:.1} um"));
        assert!(told.starts_with("run1:") && told.contains("cut off"), "{told}");
        assert_eq!(analysis["diagnosis"]["findings"].as_array().unwrap().len(), 0, "{set}");
    }
}

/// Where the ramps are cut off too, two engagements cannot be told from one: that is said.
#[test]
fn readings_that_are_cut_off_so_far_that_nothing_can_be_told() {
    let cut = |(s, um): Line| (s, um.map(|um: f64| um.min(20.0)));
    let work = changed("planar250", "O4002.nc", cut);
    let message = work.ballbar(&["analyse", "test.toml"]).refused(3);
    assert!(message.contains("readings are exactly 20.0 um"), "{message}");
}

#[test]
fn an_instrument_that_reads_its_limit_while_it_is_out_of_range() {
    for (set, program) in SETS {
        let limited = |(s, um): Line| (s, Some(um.unwrap_or(1000.0).clamp(-1000.0, 1000.0)));
        let analysis = analysed(&changed(set, program, limited));
        assert_eq!(analysis["diagnosis"]["left_out"].as_array().unwrap().len(), 0, "{set}");
        assert!(analysis["diagnosis"]["after_um"].as_f64().unwrap() < 0.16, "{set}");
    }
}

#[test]
fn a_zero_that_is_meant_the_other_way() {
    for (file, from, to, write) in [
        ("machine.toml", "[-510.0, 0.0]", "[0.0, 510.0]", "`travel_mm = [-510.0, 0.0]` for Z"),
        (
            "test.toml",
            "270.0, -260.0]",
            "270.0, 260.0]",
            "`coincidence_mm = [410.0, 270.0, -260.0]`",
        ),
    ] {
        let work = changed("rate250", "O4001.nc", |line| line);
        rewrite(&work, file, from, to);
        let analysis = analysed(&work);
        let told = caution(&analysis, "in machine coordinates");
        assert!(told.contains("the other way") && told.contains(write), "{told}");
        let all = analysis["cautions"].as_array().unwrap().iter().filter_map(Value::as_str);
        let of_travel = all.filter(|caution| caution.contains("in machine coordinates"));
        assert_eq!(of_travel.count(), 1, "{analysis}");
    }
    // What is commanded, wherever readings lie.
    let work = changed("hu40t", "O1005.nc", |line| line);
    rewrite(&work, "machine.toml", "travel_mm = [-280.0, 280.0]", "travel_mm = [-280.0, 100.0]");
    let told = work.ballbar(&["identify", "test.toml", "--json"]).done().stdout();
    let told = caution(&serde_json::from_str(&told).unwrap(), "in machine coordinates");
    assert!(told.contains("take X from -130.0 to 170.0 mm"), "{told}");
}

/// Two runs of a set that is listed whole, the logs of two of them exchanged.
fn exchanged(set: &str, first: &str, second: &str) -> Work {
    let work = Work::new();
    let test = std::fs::read_to_string(data(set).join("test.toml")).unwrap();
    let test = test.replace("../../../machines/hu40t.toml", "machine.toml");
    let log = |name: &str| format!("log = \"{name}.csv.gz\"");
    let test = test.replace(&log(first), "log = \"?\"").replace(&log(second), &log(first));
    work.machine("name", "name").write("test.toml", test.replace("log = \"?\"", &log(second)));
    for file in std::fs::read_dir(data(set)).unwrap().map(|file| file.unwrap().path()) {
        let name = file.file_name().unwrap().to_str().unwrap().to_owned();
        if file.extension().is_some_and(|end| end == "gz") {
            work.write(&name, std::fs::read(file).unwrap());
        }
    }
    work
}

#[test]
fn logs_that_stand_at_each_others_run() {
    for (set, first, second) in [("case-a", "run1", "run4"), ("planar", "xy", "yz")] {
        let work = exchanged(set, first, second);
        for command in ["analyse", "diagnose"] {
            let message = work.ballbar(&[command, "test.toml"]).refused(3);
            assert!(message.contains("stand at each other's run"), "{message}");
            assert!(message.contains(&format!("`{first}`")), "{message}");
            assert!(message.contains("exchange the two `log = ...` in test.toml"), "{message}");
        }
    }
}

/// Also where the feed is stated wrong, so that no log fits any program as it is listed.
#[test]
fn logs_that_stand_at_each_others_run_at_another_feed() {
    let work = exchanged("planar", "xy", "yz");
    rewrite(&work, "test.toml", "log = ", "feed_override_percent = 104.0\nlog = ");
    let message = work.ballbar(&["analyse", "test.toml"]).refused(3);
    assert!(message.contains("the logs of `yz` and `xy` stand at each other's run"), "{message}");
}

/// Far off centre readings differ so much that a wrong log beside a missing one seems to be explained.
#[test]
fn a_log_that_cannot_be_read_is_told_before_where_others_belong() {
    let work = exchanged("planar", "xy", "xy");
    rewrite(&work, "test.toml", "terms = [\"observable35\"]", "terms = [\"local\"]");
    work.write("scenario.toml", "[set_up]\nEXt = 0.4\nEYt = 0.3\nEZt = -0.2\n");
    let simulate = ["simulate", "test.toml", "--scenario", "scenario.toml", "--seed", "5"];
    work.ballbar(&simulate).done();
    std::fs::rename(work.path("results"), work.path("simulated")).unwrap();
    work.write("simulated/run1-O1001.csv", "time_s,deviation_um\n0.0,\n");
    for command in ["identify", "diagnose"] {
        let told = work.ballbar(&[command, "simulated/test.toml"]).refused(1);
        assert!(told.contains("the log is too short: it has one sample"), "{told}");
        assert!(told.contains("run1-O1001.csv") && !told.contains("exchange"), "{told}");
    }
}

#[test]
fn a_log_of_another_run_that_was_copied() {
    let work = exchanged("planar", "xy", "xy");
    work.write("xy.csv.gz", std::fs::read(data("planar").join("yz.csv.gz")).unwrap());
    let told = work.ballbar(&["identify", "test.toml"]).refused(3);
    assert!(told.contains("the logs of `xy` and `yz` hold the same readings"), "{told}");
    assert!(told.contains("one is not of its run"), "{told}");
    assert!(told.contains("hint: give each run its own log in test.toml"), "{told}");
    // Of the same program it may be of its run, and only what repeats is not what it seems.
    let work = exchanged("case-a", "run1", "run1");
    work.write("run1.csv.gz", std::fs::read(data("case-a").join("run2.csv.gz")).unwrap());
    let told = work.ballbar(&["identify", "test.toml"]).done().stdout();
    let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains("one is a copy of the other"), "{told}");
}

#[test]
fn a_log_of_another_test_is_named() {
    let work = exchanged("planar", "xy", "xy");
    work.ballbar(&["simulate", "test.toml", "--seed", "5"]).done();
    rewrite(&work, "test.toml", "zx.csv.gz", "results/run1-O1002.csv");
    let told = work.ballbar(&["identify", "test.toml"]).done().stdout();
    let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains("- run1-O1002: the model leaves "), "{told}");
    assert!(told.contains("a log may be of another program or of another test"), "{told}");
}

/// A tool ball 0.2 mm off brings a bar of 1.2 mm range to the edge of it where the program waits: it reads through a pause between
/// arcs, or flickers for milliseconds, which in days are as long as the program.
#[test]
fn a_bar_that_stands_at_the_edge_of_its_range_between_arcs() {
    let work = Work::new();
    let trial = ["blind", "--grid", "--seed", "107", "--trial", "single:6", "--write"];
    work.plain(&[&trial[..], &["-o", "campaign"]].concat()).done();
    let test = std::fs::read_to_string(work.path("campaign/test.toml")).unwrap();
    let head = test.split("[[run]]").next().unwrap();
    for log in ["run3-2", "run4-2"] {
        let run =
            format!("[[run]]\nprogram = \"program2.nc\"\nlog = \"{log}.csv\"\nmounting = \"B\"\n");
        work.write(&format!("campaign/{log}.toml"), format!("{head}{run}"));
        let file = format!("campaign/{log}.toml");
        let told = work.plain(&["align", &file, "-o", log, "--json"]).done().stdout();
        let told: Value = serde_json::from_str(&told).unwrap();
        for arc in told["runs"][0]["arcs"].as_array().unwrap() {
            let left_um = arc["rms_um"].as_f64().unwrap();
            assert!(left_um < 2.0, "{log}, {}: {left_um} um", arc["name"]);
        }
    }
}

/// A machine that is 0.3 mm off where the bar was released holds it at the edge of its range there, and the log goes on: what it reads
/// while the operator walks up to the machine is none of the program.
#[test]
fn a_bar_that_goes_on_reading_where_it_was_released() {
    let until_s = 400.0;
    let measured = lines("rate250", "run1.csv.gz");
    let read_s = measured.iter().filter(|line| line.1.is_some()).map(|line| line.0);
    let released_s = read_s.fold(0.0, f64::max);
    let stands =
        (1..).map(|k| (released_s + 0.004 * f64::from(k), Some(1150.0 + 0.1 * f64::from(k % 3))));
    let log = measured.iter().copied().filter(|line| line.0 <= released_s);
    let log = log.chain(stands.take_while(|line| line.0 < until_s));
    let arcs = |work: &Work| -> Vec<f64> {
        let told = work.ballbar(&["align", "test.toml", "--json"]).done().stdout();
        let told: Value = serde_json::from_str(&told).unwrap();
        let arcs = told["runs"][0]["arcs"].as_array().unwrap().iter();
        arcs.map(|arc| arc["rms_um"].as_f64().unwrap()).collect()
    };
    let as_measured = arcs(&with_log("rate250", "O4001.nc", text(measured.clone())));
    let work = with_log("rate250", "O4001.nc", text(log));
    let with_stand = arcs(&work);
    assert_eq!(as_measured.len(), with_stand.len());
    for (alone, with) in as_measured.iter().zip(&with_stand) {
        assert!((alone - with).abs() < 0.05, "{alone} and {with} um");
    }
    let told = work.ballbar(&["identify", "test.toml"]).done().stdout();
    let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains("the bar read where the program has it wait out of its range"), "{told}");
}

/// Readings to the nearest micrometre are off by 0.29 um rms, which is no error of a machine.
#[test]
fn steps_of_readings_are_nothing_that_the_model_does_not_explain() {
    let work = changed("hu40t", "O1005.nc", |(time_s, um)| (time_s, um.map(f64::round)));
    let told = |work: &Work| work.ballbar(&["identify", "test.toml"]).done().stdout();
    assert!(told(&work).contains("times the stated noise"), "in steps of 0.1 um");
    rewrite(&work, "test.toml", "resolution_um = 0.1", "resolution_um = 1.0");
    let told = told(&work);
    assert!(!told.contains("times the stated noise"), "{told}");
}
