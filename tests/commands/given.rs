//! `ballbar design --given`: what to measure next.

use crate::work::Work;

const WISH: &str =
    "[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 500.0\n\n[design]\nbudget_min = 40.0\n";

/// A test that was run, simulated in `measured`, and its analysis in `analysed`.
fn measured() -> Work {
    let work = Work::new();
    work.machine("name", "name").test(WISH);
    work.ballbar(&["simulate", "test.toml"]).done();
    std::fs::rename(work.path("results"), work.path("measured")).unwrap();
    work.ballbar(&["analyse", "measured/test.toml"]).done();
    std::fs::rename(work.path("results"), work.path("analysed")).unwrap();
    work
}

#[test]
fn a_design_goes_on_from_what_was_measured() {
    let work = measured();
    let given = ["design", "test.toml", "--given", "analysed/analysis.json"];
    // The time of a set-up that no arc falls to belongs to the others: nothing of it is left over.
    let outcome = work.ballbar(&[given.as_slice(), &["--json"]].concat()).done();
    let json: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
    let total_s = json["total_s"].as_f64().unwrap();
    assert!((2160.0..=2400.0).contains(&total_s), "{total_s} s of 2400 s");
    // D's criterion is no length.
    work.test(&format!("{WISH}criterion = \"D\"\n"));
    let told = work.ballbar(&given).done().stdout();
    let (_, next) = told.split_once("What would determine most next").unwrap();
    assert!(
        next.contains("times better") && !next.contains(" um") && !next.contains('-'),
        "{next}"
    );
}

#[test]
fn an_analysis_of_another_machine_and_a_file_in_the_way_are_refused() {
    let work = measured();
    let given = ["design", "test.toml", "--given", "analysed/analysis.json"];
    std::fs::create_dir(work.path("results")).unwrap();
    std::fs::rename(work.path("measured"), work.path("results")).unwrap();
    let before = std::fs::read(work.path("results/test.toml")).unwrap();
    let mut analysis = std::fs::read_to_string(work.path("analysed/analysis.json")).unwrap();
    analysis = analysis.replace("measured/test.toml", "results/test.toml");
    work.write("analysed/analysis.json", analysis);
    let outcome = work.ballbar(&given);
    assert_ne!(outcome.code(), 0, "{}", outcome.stdout());
    assert!(outcome.stderr().contains("hint: "), "{}", outcome.stderr());
    assert_eq!(std::fs::read(work.path("results/test.toml")).unwrap(), before);
    // The machine of the analysis has the pivot of X on its carriage.
    let machine = std::fs::read_to_string(work.path("machine.toml")).unwrap();
    work.write("other.toml", machine.replacen("carriage", "base", 1));
    let wish = std::fs::read_to_string(work.path("test.toml")).unwrap();
    work.write("test.toml", wish.replace("machine.toml", "other.toml"));
    let told = work.ballbar(&given).stderr();
    assert!(told.contains("pivots carriage carriage carriage"), "{told}");
    assert!(told.contains("pivots base carriage carriage"), "{told}");
}
