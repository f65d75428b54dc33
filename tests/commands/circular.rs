//! Circular tests of ISO 230-4 and tolerances, on machines whose path is known in closed form.

use serde_json::Value;

use crate::work::{Work, project};

const PLAN: &str = "[plan]\nstrategy = \"iso230-4\"\nfeed_mm_min = 1000.0\n";

/// A vertical machine with these errors and nothing else, tested with a bar of 150 mm; `rest` of the test file is for the analysis.
fn analysed(plan: &str, coefficients: &str, rest: &str) -> (Work, Value) {
    let work = Work::new();
    work.write("machine.toml", std::fs::read(project().join("machines/vertical.toml")).unwrap());
    work.test(plan);
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    let test = test
        .replace("[20.0, -35.0, 40.0]", "[20.0, -35.0, -300.0]")
        .replace("length_mm = 150.0", "length_mm = 150.0\nresolution_um = 0.001");
    work.write("test.toml", test);
    let scenario = format!(
        "sample_rate_hz = 100\n[noise]\nwhite_um = 0.02\ncorrelated_um = 0.0\n[coefficients]\n{coefficients}\n"
    );
    work.write("scenario.toml", scenario);
    work.ballbar(&["simulate", "test.toml", "--scenario", "scenario.toml"]).done();
    let measured = std::fs::read_to_string(work.path("results/test.toml")).unwrap();
    work.write("results/test.toml", format!("{measured}\n{rest}\n"));
    work.ballbar(&["analyse", "results/test.toml"]).done();
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let circular = serde_json::from_str::<Value>(&analysis).unwrap()["circular"].clone();
    (work, circular)
}

/// A value of a test, um.
fn um(test: &Value, name: &str) -> f64 {
    test[name]["value_um"].as_f64().unwrap_or_else(|| unreachable!("{name} in {test}"))
}

#[track_caller]
fn near(value: f64, is: f64) {
    assert!((value - is).abs() < 0.2, "{value} instead of {is} um");
}

/// alpha R sin cos in every direction: G = G(b) = alpha R, no D, no H.
#[test]
fn squareness_alone_is_an_ellipse_of_known_height() {
    let rest = "[tolerance]\ncircular_deviation_um = 16.0\nbidirectional_circular_deviation_um = 14.0\nradial_deviation_um = 10.0\nsquareness_um_m = 120.0";
    let (work, circular) = analysed(PLAN, "EXY1 = 1e-4", rest);
    let tests = circular["tests"].as_array().unwrap();
    assert_eq!(tests.len(), 3, "{circular}");
    let xy = &tests[0];
    assert_eq!((xy["circle"].as_str(), xy["whole"].as_bool()), (Some("XY plane"), Some(true)));
    near(um(xy, "bidirectional_circular_deviation"), 15.0);
    near(um(xy, "bidirectional_circular_deviation_least_squares"), 15.0);
    near(um(xy, "mean_bidirectional_radial_deviation"), 0.0);
    near(um(xy, "circular_hysteresis"), 0.0);
    for (way, direction) in xy["ways"].as_array().unwrap().iter().zip(["CCW", "CW"]) {
        assert_eq!(way["direction"].as_str(), Some(direction));
        near(um(way, "circular_deviation"), 15.0);
        near(um(way, "radial_deviation_max"), 7.5);
        near(um(way, "radial_deviation_min"), -7.5);
        // The data arc alone: one turn at 1000 mm/min in means of two readings, 50 a second, from +X on.
        let points = way["points"].as_u64().unwrap();
        assert!((2800..2860).contains(&points), "{points}");
        assert!(way["start_deg"].as_f64().unwrap().rem_euclid(360.0) < 1e-3);
    }
    // The other planes are parts of circles and have nothing.
    for (test, circle) in tests[1..].iter().zip(["YZ plane", "ZX plane"]) {
        assert_eq!((test["circle"].as_str(), test["whole"].as_bool()), (Some(circle), Some(false)));
        assert!((test["sweep_deg"].as_f64().unwrap() - 220.0).abs() < 0.1);
        near(um(test, "bidirectional_circular_deviation"), 0.0);
        assert!(test["mean_bidirectional_radial_deviation"].is_null());
        assert!(test["ways"][0]["radial_deviation_max"].is_null());
        assert!(test["centre_condition"].as_f64().unwrap() > 1.5);
    }
    let verdicts: Vec<(&str, &str)> = circular["conformity"]["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|item| (item["quantity"].as_str().unwrap(), item["verdict"].as_str().unwrap()))
        .collect();
    for judged in [
        ("G XY plane F1000 CCW", "pass"),
        ("G(b) XY plane F1000", "fail"),
        ("G(b) YZ plane 220 deg F1000", "pass"),
        ("F max XY plane F1000 CCW", "not decided"),
    ] {
        assert!(verdicts.contains(&judged), "{judged:?} in {verdicts:?}");
    }
    assert_eq!(circular["conformity"]["verdict"].as_str(), Some("fail"));
    let report = std::fs::read_to_string(work.path("results/report.html")).unwrap();
    for told in ["Tolerances: fail", "G(b) XY plane F1000", "ISO 14253-1", "mean of 2 readings"] {
        assert!(report.contains(told), "{told}");
    }
}

/// a R sin² of the angle: G = a R, D half of it, F from 0 to a R.
#[test]
fn a_scale_alone_is_an_ellipse_and_a_larger_circle() {
    let plan = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 1000.0\n";
    let rest = "[tolerance]\nradial_deviation_um = 20.0";
    let (work, circular) = analysed(plan, "EYY1 = -1e-4", rest);
    let xy = &circular["tests"][0];
    // Y carries the workpiece: the tool goes farther against it.
    near(um(xy, "mean_bidirectional_radial_deviation"), 7.5);
    near(um(xy, "bidirectional_circular_deviation"), 15.0);
    near(um(&xy["ways"][1], "radial_deviation_max"), 15.0);
    near(um(&xy["ways"][1], "radial_deviation_min"), 0.0);
    assert_eq!(circular["conformity"]["verdict"].as_str(), Some("not decided"));
    // With a length that is known to 1 um it is: 15 + 2 keeps 20.
    let test = std::fs::read_to_string(work.path("results/test.toml")).unwrap();
    let known = test.replace("length_mm = 150.0", "length_mm = 150.0\nlength_sigma_um = 1.0");
    work.write("results/test.toml", &known);
    let told = work.ballbar(&["analyse", "results/test.toml"]).done().stdout();
    assert!(told.contains("\nTolerances: pass\n"), "{told}");
    assert!(told.contains("+- 2.0"), "{told}");
    // A transducer whose scale is known to a tenth: so are all values, beside noise and length.
    let vague =
        known.replace("length_sigma_um = 1.0", "length_sigma_um = 1.0\nscale_sigma_percent = 10.0");
    work.write("results/test.toml", vague);
    let json = work.ballbar(&["identify", "results/test.toml", "--json"]).done().stdout();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let xy = &json["circular"]["tests"][0];
    for (name, expected_um) in [
        ("bidirectional_circular_deviation", 1.5),
        ("mean_bidirectional_radial_deviation", 0.75_f64.hypot(1.0)),
    ] {
        let sigma_um = xy[name]["sigma_um"].as_f64().unwrap();
        assert!((sigma_um / expected_um - 1.0).abs() < 0.05, "{name}: {sigma_um}");
    }
}

#[test]
fn one_way_alone_says_what_is_missing() {
    let plan = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 1000.0\nboth_directions = false\n";
    let rest = "[tolerance]\nbidirectional_circular_deviation_um = 10.0";
    let (work, circular) = analysed(plan, "EYY1 = 1e-5", rest);
    assert!(circular["tests"][0]["bidirectional_circular_deviation"].is_null());
    let untold = circular["untold"][0].as_str().unwrap();
    assert!(untold.contains("was not driven the other way"), "{untold}");
    assert_eq!(circular["conformity"]["verdict"].as_str(), Some("not decided"));
    let report = std::fs::read_to_string(work.path("results/report.html")).unwrap();
    assert!(report.contains("no run tells it") && report.contains("was not driven the other way"));
}

#[test]
fn a_tolerance_without_its_unit_or_without_sense_is_refused_with_its_line() {
    for (key, told) in [
        ("circular_deviation = 10", "unknown field `circular_deviation`"),
        ("circular_deviation_mm = 0.01", "unknown field `circular_deviation_mm`"),
        ("reversal_um = 0", "`reversal_um` must lie between 0.01 and 10000"),
        ("scale_um_m = nan", "`scale_um_m` must lie between 0.01 and 10000"),
        ("squareness_um_m = -5", "`squareness_um_m` must lie between 0.01 and 10000"),
    ] {
        let work = Work::new();
        work.machine("name", "name").test(&format!("{PLAN}\n[tolerance]\n{key}\n"));
        let message = work.ballbar(&["plan", "test.toml"]).refused(1);
        assert!(message.contains(told), "{message}");
        assert!(message.contains("test.toml:17:"), "{message}");
    }
}
