//! `ballbar diagnose`: what it says, and what it makes of runs that are few, mixed or damaged.

use serde_json::Value;

use crate::work::{Work, data, unpacked};

/// A log of a set, as text.
fn log(set: &str, run: &str) -> String {
    unpacked(&data(set).join(format!("{run}.csv.gz")))
}

/// A test of case-a: logs by name, each with the number of its program.
fn test_of(runs: &[(&str, u32, String)]) -> Work {
    let work = Work::new();
    work.machine("name", "name");
    for program in ["O1005.nc", "O1015.nc"] {
        work.write(program, unpacked(&data("case-a").join(format!("{program}.gz"))));
    }
    let mut rest = vec!["[identify]\nterms = [\"observable35\"]\n".to_owned()];
    for (name, program, text) in runs {
        work.write(&format!("{name}.csv"), text);
        rest.push(format!("[[run]]\nprogram = \"O{program}.nc\"\nlog = \"{name}.csv\"\n"));
    }
    work.test(&rest.join("\n"));
    work
}

/// The rows of a log that are kept, by their number.
fn kept(text: &str, keep: impl Fn(usize, usize) -> bool) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let first =
        lines.iter().position(|line| line.starts_with(|c: char| c.is_ascii_digit())).unwrap();
    let rows = lines.len() - first;
    let lines = lines.iter().enumerate();
    let kept = lines.filter(|(k, _)| *k < first || keep(*k - first, rows));
    kept.map(|(_, line)| *line).collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn a_cause_is_named_with_what_to_do_and_the_gain() {
    let work = Work::new();
    let test = data("case-a").join("test.toml");
    let outcome = work.ballbar(&["diagnose", test.to_str().unwrap()]).done();
    let text = outcome.stdout();
    for told in [
        "The repeatable part of the residual is",
        "1. Cyclic error of a screw or scale, EXX (positioning of X): amplitude 1.20",
        "the pitch of the X screw, 10 mm: once per turn",
        "what to do",
        "Predicted from the runs of the other programs",
        "Coefficients that change by more than their sigma",
    ] {
        assert!(text.contains(told), "{told}: {text}");
    }
    assert!(outcome.files().contains(&"report.html".to_owned()), "{:?}", outcome.files());
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let analysis: Value = serde_json::from_str(&analysis).unwrap();
    let finding = &analysis["diagnosis"]["findings"][0];
    assert_eq!((&finding["cause"], &finding["on"]), (&"cyclic".into(), &"EXX".into()));
    let report = std::fs::read_to_string(work.path("results/report.html")).unwrap();
    assert!(report.contains("<h2>What the model gets wrong</h2>"));
}

#[test]
fn an_analysis_ends_with_the_diagnosis() {
    let work =
        test_of(&[("run4", 1015, log("case-a", "run4")), ("run5", 1015, log("case-a", "run5"))]);
    let text = work.ballbar(&["analyse", "test.toml"]).done().stdout();
    let (_, end) = text.split_once("\nWhat the model gets wrong\n").unwrap();
    assert!(end.contains("1. Cyclic error of a screw or scale, EXX"), "{end}");
}

#[test]
fn one_run_only_still_works_and_says_what_it_cannot_tell() {
    let work = test_of(&[("run1", 1005, log("case-a", "run1"))]);
    let outcome = work.ballbar(&["diagnose", "test.toml"]).done();
    let text = outcome.stdout();
    assert!(text.contains("1. Cyclic error of a screw or scale, EXX"), "{text}");
    assert!(text.contains("its repeatable part is unknown"), "{text}");
    assert!(text.contains("Only one repeat") && text.contains("No program ran twice"), "{text}");
    assert!(!text.contains("Predicted") && !text.contains("not fitted:"), "{text}");
}

#[test]
fn runs_that_do_not_belong_are_left_out_with_the_reason() {
    let work = test_of(&[
        ("run4", 1015, log("case-a", "run4")),
        ("run5", 1015, log("case-a", "run5")),
        // The program of the other feed, and another test altogether.
        ("slow", 1015, log("case-a", "run1")),
        ("planes", 1015, log("planar", "xy")),
    ]);
    let outcome = work.ballbar(&["diagnose", "test.toml"]).done();
    for run in ["slow", "planes"] {
        assert!(outcome.stderr().contains(&format!("left out: {run}: ")), "{}", outcome.stderr());
    }
    let text = outcome.stdout();
    let (_, end) = text.split_once("\nRuns that were left out\n").unwrap();
    assert!(end.contains("slow: ") && end.contains("planes: "), "{end}");
    assert!(text.contains("1. Cyclic error of a screw or scale, EXX"), "{text}");
    // What is strict refuses them.
    let strict = work.ballbar(&["identify", "test.toml"]);
    assert_eq!(strict.code(), 3, "{}", strict.stderr());
}

#[test]
fn where_no_run_belongs_the_first_reason_is_told() {
    let work =
        test_of(&[("slow", 1015, log("case-a", "run1")), ("planes", 1015, log("planar", "xy"))]);
    let message = work.ballbar(&["diagnose", "test.toml"]).refused(3);
    assert!(message.contains("hint: "), "{message}");
}

#[test]
fn a_third_of_the_samples_may_be_missing() {
    let whole = log("case-a", "run5");
    let work = test_of(&[
        ("run4", 1015, log("case-a", "run4")),
        ("sparse", 1015, kept(&whole, |row, _| row % 3 != 1)),
        // The middle third is not there at all.
        ("torn", 1015, kept(&whole, |row, rows| !(rows / 3..2 * rows / 3).contains(&row))),
    ]);
    let outcome = work.ballbar(&["diagnose", "test.toml"]).done();
    let text = outcome.stdout();
    assert!(text.contains("1. Cyclic error of a screw or scale, EXX"), "{text}");
    let (_, amplitude) = text.split_once("EXX (positioning of X): amplitude ").unwrap();
    let amplitude_um: f64 = amplitude.split_whitespace().next().unwrap().parse().unwrap();
    assert!((amplitude_um - 1.2).abs() < 0.01, "{amplitude_um} um");
    assert!(!outcome.stderr().contains("left out: sparse"), "{}", outcome.stderr());
}

#[test]
fn a_diagnosis_as_json_is_the_key_of_the_analysis() {
    let work =
        test_of(&[("run4", 1015, log("case-d", "run4")), ("run5", 1015, log("case-d", "run5"))]);
    let outcome = work.ballbar(&["diagnose", "test.toml", "--json"]).done();
    let mut told: Value = serde_json::from_str(&outcome.stdout()).unwrap();
    assert_eq!(told["nothing_found"], true);
    let format = told.as_object_mut().unwrap().remove("format");
    assert_eq!(format.unwrap(), "ballbar.diagnosis/1");
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let analysis: Value = serde_json::from_str(&analysis).unwrap();
    assert_eq!(analysis["diagnosis"], told);
    // Runs of one feed cannot tell time from place by more than shape.
    let unseen = told["unseen"].as_array().unwrap();
    assert!(unseen.iter().any(|s| s.as_str().unwrap().contains("one feed")), "{unseen:?}");
}

/// What is told of a sphere at ten readings a second with these effects in it, all of which the model with them explains.
fn found(hidden: &[&str]) -> Vec<Value> {
    let work = Work::new();
    work.machine("name", "name")
        .write("slow.toml", "sample_rate_hz = 10\nseed = 4\n")
        .test("[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 1500.0\n");
    let mut simulate = vec!["simulate", "test.toml", "--scenario", "slow.toml"];
    simulate.extend(hidden.iter().flat_map(|effect| ["--hide", effect]));
    work.ballbar(&simulate).done();
    let told = work.ballbar(&["diagnose", "results/test.toml", "--json"]).done().stdout();
    let told: Value = serde_json::from_str(&told).unwrap();
    let doubts = |said: &Value| said.as_str().unwrap().contains("explains little");
    assert!(!told["verdict"].as_array().unwrap().iter().any(doubts), "{}", told["verdict"]);
    told["findings"].as_array().unwrap().clone()
}

/// The step of a finding that is a knock in X, um, with its standard deviation.
fn knock_in_x(finding: &Value) -> [f64; 2] {
    assert_eq!((&finding["cause"], &finding["on"]), (&"knock".into(), &"EXt".into()), "{finding}");
    ["value", "sigma"].map(|key| finding["numbers"][0][key].as_f64().unwrap())
}

/// A tenth of it is seen, and however far it moves the readings, a search is right by far more than that.
#[test]
fn a_ball_that_was_knocked_by_four_tenths_of_a_millimetre_is_told() {
    let findings = found(&["knock:on=EXt,step_um=400,moment_s=200,run=1"]);
    let [finding] = findings.as_slice() else { panic!("{findings:?}") };
    let [step_um, sigma_um] = knock_in_x(finding);
    assert!((step_um - 400.0).abs() < 3.0 * sigma_um, "{finding}");
}

/// Either move by itself explains next to nothing of it: a curve over time or a scale did, and the moves were not found.
#[test]
fn a_ball_that_stood_off_for_seconds_and_came_back_is_told() {
    let findings = found(&[
        "knock:on=EXt,step_um=60,moment_s=200,run=1",
        "knock:on=EXt,step_um=-60,moment_s=240,run=1",
    ]);
    let steps = findings.iter().map(knock_in_x).collect::<Vec<_>>();
    let [[one_um, sigma_um], [other_um, _]] = steps[..] else { panic!("{findings:?}") };
    assert!((one_um.abs() - 60.0).abs() < 3.0 * sigma_um, "{one_um} +- {sigma_um}");
    assert!((one_um + other_um).abs() < 3.0 * sigma_um, "{one_um} {other_um}");
}
