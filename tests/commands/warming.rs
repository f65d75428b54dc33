//! A spindle that grows while a test runs.

use serde_json::Value;

use crate::work::{Work, project};

/// In three planes of one program the set-ups follow all but a seventieth of it, and what is left says which it was; beside a knock in its
/// place the lateral plays, which move with it, were off by up to forty of what is stated.
#[test]
fn a_spindle_that_grows_by_a_tenth_of_a_millimetre_is_no_knock() {
    let work = Work::new();
    work.write("machine.toml", std::fs::read(project().join("machines/hu40t.toml")).unwrap())
        .write("slow.toml", "sample_rate_hz = 10\n[noise]\nwhite_um = 0.2\ncorrelated_um = 0.0\n")
        .test("[plan]\nstrategy = \"iso230-4\"\nfeed_mm_min = 650.0\n");
    let drift = "drift:on=EZt,amplitude_um=100,time_constant_s=250";
    let simulate = ["simulate", "test.toml", "--scenario", "slow.toml", "--hide", drift];
    work.ballbar(&[&simulate[..], &["--seed", "3"]].concat()).done();
    let truth = std::fs::read_to_string(work.path("results/truth.toml")).unwrap();
    let truth: toml::Table = toml::from_str(&truth).unwrap();
    work.ballbar(&["analyse", "results/test.toml"]).done();
    let told = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let told: Value = serde_json::from_str(&told).unwrap();

    let [finding] = told["diagnosis"]["findings"].as_array().unwrap().as_slice() else {
        panic!("{}", told["diagnosis"]["findings"])
    };
    assert_eq!((&finding["cause"], &finding["on"]), (&"drift".into(), &"EZt".into()), "{finding}");
    for (name, put_in) in [("amplitude_um", 100.0), ("time_constant_s", 250.0)] {
        let numbers = finding["numbers"].as_array().unwrap();
        let of = numbers.iter().find(|number| number["name"] == name).unwrap();
        let off = of["value"].as_f64().unwrap() - put_in;
        assert!(off.abs() < 3.0 * of["sigma"].as_f64().unwrap(), "{name}: {of}");
    }
    let asked = told["at_the_place"].as_array().unwrap();
    let plays = asked.iter().filter(|of| of["quantity"].as_str().unwrap().contains("lateral"));
    for of in plays {
        let key = format!("{}_um", of["quantity"].as_str().unwrap().replace(' ', "_"));
        let off = of["value"].as_f64().unwrap() - truth["at_the_place"][&key].as_float().unwrap();
        assert!(off.abs() < 3.0 * of["all"].as_f64().unwrap(), "{off} um: {of}");
    }
}
