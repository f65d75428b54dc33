//! A test before it is run.

use serde_json::Value;

use crate::work::{Work, project};

/// A feed and a chord with which a test is planned quickly.
const QUICK: &str = "feed_mm_min = 2000.0\nchord_sag_um = 4.0\n";

fn planned(rest: &str) -> Work {
    let work = Work::new();
    work.machine("name", "name").test(rest);
    work
}

/// Words without the ends of lines between them.
fn unfilled(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn complete(strategy: &str) -> String {
    format!("[plan]\nstrategy = \"{strategy}\"\n{QUICK}[identify]\nterms = [\"complete\"]\n")
}

#[test]
fn one_mounting_of_3d6() {
    let work = planned(&complete("3d6"));
    let outcome = work.ballbar(&["plan", "test.toml"]).done();
    assert_eq!(outcome.files(), ["plan.html", "plan.json"]);
    let told = outcome.stdout();
    assert!(told.lines().all(|line| line.chars().count() <= 100), "{told}");
    insta::assert_snapshot!(told);
    // The same input gives the same bytes.
    let files = || ["plan.html", "plan.json"].map(|f| std::fs::read(work.path("results").join(f)));
    let before = files().map(Result::unwrap);
    work.ballbar(&["plan", "test.toml"]).done();
    assert!(before == files().map(Result::unwrap));
}

#[test]
fn the_json_agrees_with_the_text_and_repeats_count() {
    let work = planned(&complete("2d"));
    let json = |repeats: &str| -> Value {
        let told = work.ballbar(&["plan", "test.toml", "--json", "--repeats", repeats]).done();
        serde_json::from_str(&told.stdout()).unwrap()
    };
    let (one, four) = (json("1"), json("4"));
    let written = std::fs::read_to_string(work.path("results/plan.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&written).unwrap(), four);
    let number = |plan: &Value, at: &str| plan.pointer(at).unwrap().as_f64().unwrap();
    let rms = "/tests/0/volume_noise/rms_um";
    let (of_one, of_mean) =
        (number(&four, &format!("{rms}/of_one")), number(&four, &format!("{rms}/of_mean")));
    assert!((of_one / of_mean - 2.0).abs() < 1e-12);
    assert_eq!(of_one.to_bits(), number(&one, &format!("{rms}/of_mean")).to_bits());
    // Four times the machine, the balls set up once, the bar fitted four times.
    let time = |at: &str| number(&four, &format!("/tests/0/{at}"));
    let machine_s = time("time_of_repeats/machine_s");
    assert!((machine_s - 4.0 * time("time/machine_s")).abs() < 1e-6);
    assert!((time("time_of_repeats/operator_s") - (600.0 + 4.0 * 60.0)).abs() < 1e-6);

    let told = unfilled(&work.ballbar(&["plan", "test.toml", "--repeats", "4"]).done().stdout());
    let coefficients = number(&four, "/tests/0/sight/coefficients");
    assert!(told.contains(&format!("determines {coefficients} of 90 coefficients")), "{told}");
    assert!(told.contains(&format!("uncertain by {of_one:.2} um rms")), "{told}");
    assert!(told.contains(&format!("The mean of 4: {of_mean:.2} um rms")), "{told}");
    let unseen = four.pointer("/tests/0/unseen").unwrap().as_array().unwrap().len();
    assert!(told.contains(&format!("What it cannot distinguish ({unseen} terms)")), "{told}");
    let all = work.ballbar(&["plan", "test.toml", "--all"]).done().stdout();
    assert!(all.contains("    EBXb acts as"), "{all}");
}

/// Names of all fields of a JSON value.
fn names(value: &Value, all: &mut std::collections::BTreeSet<String>) {
    match value {
        Value::Object(fields) => {
            for (name, value) in fields {
                all.insert(name.clone());
                names(value, all);
            }
        }
        Value::Array(values) => values.iter().for_each(|value| names(value, all)),
        _ => {}
    }
}

#[test]
fn every_field_of_the_json_is_documented() {
    let work = planned(&complete("2d"));
    let told = work.ballbar(&["plan", "test.toml", "--json"]).done().stdout();
    let mut all = std::collections::BTreeSet::new();
    names(&serde_json::from_str(&told).unwrap(), &mut all);
    assert!(all.len() > 80, "{all:?}");
    let schema = std::fs::read_to_string(project().join("docs/plan-schema.md")).unwrap();
    // Words between backticks, cut at dots and brackets.
    let documented: Vec<&str> =
        schema.split('`').skip(1).step_by(2).flat_map(|code| code.split(['.', '['])).collect();
    for name in all {
        assert!(documented.contains(&name.as_str()), "`{name}` is not in the schema");
    }
}

#[test]
fn tests_stand_side_by_side() {
    let work = planned(&complete("2d"));
    std::fs::rename(work.path("test.toml"), work.path("planes.toml")).unwrap();
    work.test(&complete("3d6"));
    let outcome = work.ballbar(&["plan", "planes.toml", "test.toml", "--json"]).done();
    let plan: Value = serde_json::from_str(&outcome.stdout()).unwrap();
    let strategies: Vec<&Value> =
        plan["side_by_side"].as_array().unwrap().iter().map(|t| &t["strategy"]).collect();
    assert_eq!(strategies, ["2d", "3d6"]);
    let told = work.ballbar(&["plan", "planes.toml", "test.toml"]).done().stdout();
    insta::assert_snapshot!(told);
    let page = std::fs::read_to_string(work.path("results/plan.html")).unwrap();
    assert!(page.contains("2 tests side by side") && page.trim_end().ends_with("</html>"));
    for part in ["http", "<script", "src=", "href=", "NaN", "url("] {
        assert!(!page.contains(part), "{part}");
    }
}

#[test]
fn named_terms_that_the_test_confounds_are_told() {
    let work =
        planned(&format!("[plan]\nstrategy = \"3d6\"\n{QUICK}[identify]\nterms = [\"paper37\"]\n"));
    let told = unfilled(&work.ballbar(&["plan", "test.toml"]).done().stdout());
    assert!(told.contains("rank 36 of 40 on ideal arcs"), "{told}");
    assert!(told.contains("4 of 40 directions of the named terms are not observable"), "{told}");
    assert!(told.contains("only ") && told.contains("% seen"), "{told}");
}

#[test]
fn named_terms_that_two_mountings_see_leave_nothing_untold_and_long_names_fit() {
    let work = planned(&format!(
        "[[mounting]]\nname = \"on the left, behind the second pallet\"\nbar_length_mm = 100.0\n\
         coincidence_mm = [100.0, 60.0, 60.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n\
         [plan]\nstrategy = \"3d5\"\n{QUICK}[identify]\nterms = [\"paper37\"]\n"
    ));
    let told = work.ballbar(&["plan", "test.toml", "--repeats", "12"]).done().stdout();
    assert!(told.contains("37 of 90 coefficients and 6 set-up errors"), "{told}");
    assert!(!told.contains("cannot distinguish") && !told.contains("Cautions"), "{told}");
    assert!(told.lines().all(|line| line.chars().count() <= 100), "{told}");
}

#[test]
fn bodies_that_come_near_or_touch_are_told_first() {
    // The holder meets a post that stands upright over the pole of the sphere.
    for (post_mm, word) in
        [(160.0, "COLLISION: mounting A"), (141.0, "WARNING: mounting A: only 7.2")]
    {
        let work = Work::new();
        work.machine("direction = \"-Z\"", "direction = \"+Z\"").test(&complete("2d"));
        let machine = std::fs::read_to_string(work.path("machine.toml")).unwrap();
        let post = format!("length_mm = {post_mm:.1}");
        work.write("machine.toml", machine.replacen("length_mm = 80.0", &post, 1));
        let told = work.ballbar(&["plan", "test.toml"]).done().stdout();
        assert!(told.contains(&format!("\nCautions\n  - {word}")), "{told}");
    }
}

#[test]
fn a_mounting_outside_the_travel() {
    let work = planned(&complete("2d"));
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    work.write("test.toml", test.replacen("[20.0, -35.0, 40.0]", "[20.0, -235.0, 40.0]", 1));
    insta::assert_snapshot!(work.ballbar(&["plan", "test.toml"]).refused(1));
}

#[test]
fn a_bar_longer_than_the_space() {
    let work = planned(&complete("2d"));
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    work.write("test.toml", test.replacen("length_mm = 150.0", "length_mm = 300.0", 1));
    insta::assert_snapshot!(work.ballbar(&["plan", "test.toml"]).refused(1));
}

#[test]
fn a_test_without_a_plan() {
    let work = planned("");
    insta::assert_snapshot!(work.ballbar(&["plan", "test.toml"]).refused(1));
    let outcome = work.ballbar(&["plan", "test.toml", "--repeats", "0"]);
    assert_eq!(outcome.code(), 2, "{}", outcome.stderr());
}
