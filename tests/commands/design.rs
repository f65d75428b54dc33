//! A test that the program thought out.

use std::path::Path;

use ballbar::design::Outlook;
use ballbar::plan::{Strategy, Test};
use serde_json::Value;

use crate::work::{Outcome, Work};

/// A request with the mounting of the test file; quick, because the chords of its programs are long.
fn wish(design: &str) -> Work {
    let work = Work::new();
    work.machine("name", "name")
        .test(&format!("[plan]\nfeed_mm_min = 500.0\nchord_sag_um = 4.0\n[design]\n{design}"));
    work
}

fn outlook(file: &Path) -> Outlook {
    let test = Test::read(file).unwrap();
    Outlook::new(&test, &test.machine().unwrap()).unwrap()
}

fn refused(outcome: &Outcome, code: i32, words: &[&str]) {
    let told = outcome.stderr();
    assert_eq!(outcome.code(), code, "{told}");
    for word in words {
        assert!(told.contains(word), "`{word}` is not in {told}");
    }
    assert!(told.contains("hint: "), "{told}");
    assert!(outcome.files().is_empty(), "{:?}", outcome.files());
}

/// Three mountings in the time of three 3D6: all that the volume needs, and better than 3D6 in three
/// places that a person might choose.
#[test]
fn three_mountings_see_all_53_within_the_budget() {
    let work = wish("budget_min = 78.0\nstep_deg = 30.0\n");
    let told = work.ballbar(&["design", "test.toml", "--json"]).done();
    let json: Value = serde_json::from_str(&told.stdout()).unwrap();
    assert_eq!((&json["coefficients"], &json["set_up_errors"]), (&53.into(), &9.into()));
    assert!(json["total_s"].as_f64().unwrap() <= 78.0 * 60.0);
    assert_eq!(json["set_ups"].as_array().unwrap().len(), 3);
    let designed = outlook(&work.path("results/test.toml"));
    assert_eq!(designed.term_counts(), (53, 9));
    assert_eq!(designed.prediction.rank, 62);
    assert!((designed.time().total_s() - json["total_s"].as_f64().unwrap()).abs() < 1e-6);
    // Measured with a finer step: 0.29 um; 3D6 in three places: 0.78 um.
    assert!(designed.volume_noise.rms_mm < 0.4e-3, "{}", designed.volume_noise.rms_mm);
    assert!(designed.volume_unseen.rms_mm < 0.1e-3, "{}", designed.volume_unseen.rms_mm);
}

/// One mounting, the time of 3D6, whatever the criterion: what both see is known better.
#[test]
fn one_mounting_beats_3d6_in_the_same_time() {
    let of_3d6 = Work::new();
    of_3d6.machine("name", "name").test(
        "[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 500.0\nchord_sag_um = 4.0\n[identify]\nterms = [\"complete\"]\n",
    );
    let usual = outlook(&of_3d6.path("test.toml"));
    assert_eq!(usual.strategy, Strategy::ThreeD6.name());
    let minutes = usual.time().total_s() / 60.0;
    for (criterion, better) in [("A", 0.9), ("G", 0.93)] {
        let work = wish(&format!(
            "budget_min = {minutes}\ncriterion = \"{criterion}\"\nplaces = \"mountings\"\nmost_mountings = 1\n"
        ));
        let told = work.ballbar(&["design", "test.toml"]).done();
        assert!(told.stdout().contains("35 of 90 coefficients"), "{}", told.stdout());
        let designed = outlook(&work.path("results/test.toml"));
        assert!(designed.time().total_s() <= 60.0 * minutes);
        let [rms, worst] = [&designed, &usual]
            .map(|o| [o.volume_noise.rms_mm, o.volume_noise.worst.sigma_mm])
            .into_iter()
            .reduce(|a, b| [a[0] / b[0], a[1] / b[1]])
            .unwrap();
        assert!(rms < better && worst < better, "{criterion}: {rms} and {worst} of 3D6");
    }
}

#[test]
fn the_same_wish_gives_the_same_test_on_any_number_of_threads() {
    let text = |threads: &str| {
        let work = wish("budget_min = 40.0\nmost_mountings = 2\nstep_deg = 30.0\n");
        let told = work.ballbar_on(threads, &["design", "test.toml"]).done();
        let test = std::fs::read_to_string(work.path("results/test.toml")).unwrap();
        // Every wish has a directory of its own, and the test file names its machine's.
        let lines = test.lines().filter(|line| !line.starts_with("machine = "));
        (told.stdout(), lines.map(str::to_owned).collect::<Vec<_>>())
    };
    let one = text("1");
    assert!(one == text("2"));
}

#[test]
fn what_was_measured_counts() {
    let work = wish("budget_min = 30.0\nmost_mountings = 1\nplaces = \"mountings\"\n");
    let analysed = Work::new();
    let test = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/hu40t/test.toml");
    analysed.ballbar(&["analyse", test.to_str().unwrap()]).done();
    let analysis = analysed.path("results/analysis.json");
    let given = ["design", "test.toml", "--json", "--given", analysis.to_str().unwrap()];
    let told = work.ballbar(&given).done();
    let after: Value = serde_json::from_str(&told.stdout()).unwrap();
    let told = work.ballbar(&["design", "test.toml", "--json"]).done();
    let fresh: Value = serde_json::from_str(&told.stdout()).unwrap();
    let number = |json: &Value, key: &str| json[key].as_f64().unwrap();
    // Five runs of 3D6 are behind: what is left to know is a small part.
    assert!(number(&after, "before") < 0.2 * number(&fresh, "before"));
    // And the noise counts as it was found: correlated, which the wish does not state.
    assert!(number(&after, "after") < 0.75 * number(&fresh, "after"));
    assert_eq!(after["next"].as_array().unwrap().len(), 5);
    // Changed since: another test was analysed.
    let changed = analysed.path("results/changed.json");
    let text = std::fs::read_to_string(&analysis).unwrap();
    let hash = serde_json::from_str::<Value>(&text).unwrap()["test"]["sha256"].to_string();
    std::fs::write(&changed, text.replace(&hash, "\"0\"")).unwrap();
    let given = ["design", "test.toml", "--given", changed.to_str().unwrap()];
    let outcome = work.ballbar(&given);
    assert!(outcome.stderr().contains("is not the one that was analysed"), "{}", outcome.stderr());
}

#[test]
fn wishes_that_cannot_be_have_figures() {
    let short = wish("budget_min = 11.5\n").ballbar(&["design", "test.toml"]);
    refused(&short, 4, &["a budget of 11.5 min is shorter than the shortest test of"]);
    let bar = wish("budget_min = 60.0\nbar_lengths_mm = [150.0, 300.0]\n")
        .ballbar(&["design", "test.toml"]);
    refused(&bar, 1, &["a bar of 300 mm needs 643.0 mm of X", "the travel has 560.0 mm"]);
    let unseen = wish("budget_min = 60.0\nwanted = [\"EXX1\", \"EBXb\"]\nplaces = \"mountings\"\n")
        .ballbar(&["design", "test.toml"]);
    refused(&unseen, 4, &["no arc can see `EBXb`", "EBXb acts as", "EXXb", "a second place"]);
    let never = wish("budget_min = 60.0\nwanted = [\"EXX0\"]\n").ballbar(&["design", "test.toml"]);
    refused(&never, 4, &["EXX0 acts as", "nothing that a ball-bar can do"]);
    let far = wish(
        "budget_min = 60.0\n[[mounting]]\nname = \"FAR\"\ncoincidence_mm = [900.0, 0.0, 0.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n",
    )
    .ballbar(&["design", "test.toml"]);
    refused(&far, 1, &["no arc can be driven in mounting `FAR`", "axis X", "280 mm"]);
    let hurried = wish("budget_min = 26.0\nmost_mountings = 3\n").ballbar(&["design", "test.toml"]);
    refused(&hurried, 4, &["a budget of 26.0 min", "wanted coefficients unseen", "budget_min"]);
    let work = Work::new();
    work.machine("name", "name").test("[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 500.0\n");
    refused(&work.ballbar(&["design", "test.toml"]), 1, &["the test has no `[design]`"]);
}
