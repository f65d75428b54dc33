//! Whatever degree can be hidden can be found: the search looks over the whole range of the table of causes.

use serde_json::Value;

use crate::work::{Work, data};

/// What is found first of an effect that is hidden in the programs of case-d.
fn found(hide: &str) -> Value {
    let work = Work::new();
    let test = data("case-d").join("test.toml");
    work.ballbar(&["simulate", "--paper", test.to_str().unwrap(), "--hide", hide, "--seed", "4"])
        .done();
    work.ballbar(&["diagnose", "results/test.toml"]).done();
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let analysis: Value = serde_json::from_str(&analysis).unwrap();
    analysis["diagnosis"]["findings"][0].clone()
}

#[test]
fn the_sixth_degree_of_an_error_function() {
    let finding = found("degree:on=EYY,amplitude_um=0.6,degree=6");
    assert_eq!((&finding["cause"], &finding["on"]), (&"degree".into(), &"EYY".into()), "{finding}");
    assert_eq!(finding["numbers"][1]["value"], 6.0, "{finding}");
    let (value, sigma) = (&finding["numbers"][0]["value"], &finding["numbers"][0]["sigma"]);
    let error = value.as_f64().unwrap() - 0.6;
    assert!(error.abs() < 4.0 * sigma.as_f64().unwrap(), "{finding}");
}

#[test]
fn a_ball_with_seven_waves() {
    let finding = found("roundness:amplitude_um=1,degree=7,order=3");
    assert_eq!(finding["cause"], "roundness", "{finding}");
    let effects = finding["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 15, "one for each order");
    assert!(effects[0].as_str().unwrap().contains("degree=7,order=-7"), "{finding}");
    // Orders count from -7: the tenth above the first is 3.
    let third = finding["numbers"][10]["value"].as_f64().unwrap();
    assert!((third - 1.0).abs() < 0.02, "{finding}");
}
