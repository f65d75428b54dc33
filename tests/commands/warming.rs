//! A spindle that grows while a test runs.

use std::fmt::Write as _;

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
    let told = analysed(&work);
    let finding = the_drift(&told, "EZt");
    near(finding, "amplitude_um", 100.0);
    near(finding, "time_constant_s", 250.0);
    let asked = told["at_the_place"].as_array().unwrap();
    let plays = asked.iter().filter(|of| of["quantity"].as_str().unwrap().contains("lateral"));
    for of in plays {
        let key = format!("{}_um", of["quantity"].as_str().unwrap().replace(' ', "_"));
        let off = of["value"].as_f64().unwrap() - truth["at_the_place"][&key].as_float().unwrap();
        assert!(off.abs() < 3.0 * of["all"].as_f64().unwrap(), "{off} um: {of}");
    }
}

/// Each plane by itself, after a pause that hides when its program began: by that the ball has moved some microns more in one plane
/// than in another, which was told as a knock, and bent the time constant.
#[test]
fn a_ball_that_drifts_anew_in_each_plane_is_no_knock() {
    let work = Work::new();
    let mut runs = String::new();
    for (k, [plane, a, b, c, centre]) in
        [["G17", "X", "Y", "Z", "I"], ["G19", "Y", "Z", "X", "J"], ["G18", "Z", "X", "Y", "K"]]
            .into_iter()
            .enumerate()
    {
        let arc = |code: &str| {
            format!("G04 P2000\nG01 {a}-150.\n{code} {a}-150. {b}0. {centre}150.\nG01 {a}-152.\n")
        };
        let program = format!(
            "%\nO500{k}\nG21 {plane} G90 G94\nG54\nG00 {a}-157. {b}-5. {c}-5.\n\
             G01 {a}-152. {b}0. {c}0. F1400.\nM00\n{}{}M30\n%\n",
            arc("G03"),
            arc("G02"),
        );
        work.write(&format!("O500{k}.nc"), program);
        writeln!(runs, "[[run]]\nprogram = \"O500{k}.nc\"\nlog = \"{k}.csv\"").unwrap();
    }
    work.write("machine.toml", std::fs::read(project().join("machines/hu40t.toml")).unwrap())
        .write("slow.toml", "sample_rate_hz = 10\n[noise]\nwhite_um = 0.15\ncorrelated_um = 0.0\n")
        .test(&runs);
    let drift = "drift:on=EYt,amplitude_um=176.5,time_constant_s=262";
    let simulate = ["simulate", "test.toml", "--scenario", "slow.toml", "--hide", drift];
    work.ballbar(&[&simulate[..], &["--seed", "3"]].concat()).done();
    let told = analysed(&work);
    let finding = the_drift(&told, "EYt");
    near(finding, "amplitude_um", 176.5);
    near(finding, "time_constant_s", 262.0);
}

/// The analysis of what was simulated.
fn analysed(work: &Work) -> Value {
    work.ballbar(&["analyse", "results/test.toml"]).done();
    let told = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    serde_json::from_str(&told).unwrap()
}

/// The only finding, which is a drift there.
fn the_drift<'a>(told: &'a Value, on: &str) -> &'a Value {
    let findings = told["diagnosis"]["findings"].as_array().unwrap();
    assert_eq!(findings.len(), 1, "{findings:?}");
    let finding = &findings[0];
    assert_eq!((&finding["cause"], &finding["on"]), (&"drift".into(), &on.into()), "{finding}");
    finding
}

/// A number of a finding is what was put in, to three of its deviations.
fn near(finding: &Value, name: &str, put_in: f64) {
    let numbers = finding["numbers"].as_array().unwrap();
    let of = numbers.iter().find(|number| number["name"] == name).unwrap();
    let off = of["value"].as_f64().unwrap() - put_in;
    assert!(off.abs() < 3.0 * of["sigma"].as_f64().unwrap(), "{name}: {of}");
}
