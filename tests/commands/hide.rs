//! `ballbar simulate --hide`: effects that a machine is given.

use ballbar::model::Effect;

use crate::work::{Work, data};

const CYCLIC: &str = "cyclic:on=EXX,period_mm=10,amplitude_um=1.2";
const PLAN: &str = "[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n";

/// The deviations of a log, um; a blank one is not a number.
fn deviations(work: &Work, log: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(work.path("results").join(log)).unwrap();
    let rows = text.lines().skip(2);
    rows.map(|row| row.split(',').nth(1).unwrap().parse().unwrap_or(f64::NAN)).collect()
}

fn truth(work: &Work) -> toml::Table {
    toml::from_str(&std::fs::read_to_string(work.path("results/truth.toml")).unwrap()).unwrap()
}

#[test]
fn the_measured_test_with_a_cyclic_error() {
    let work = Work::new();
    let test = data("hu40t").join("test.toml");
    let test = test.to_str().unwrap();
    let files = work.ballbar(&["simulate", test]).done().files();
    assert_eq!(truth(&work)["effect"].as_str(), Some("none"));
    let clean = deviations(&work, "run1.csv");
    assert_eq!(work.ballbar(&["simulate", test, "--hide", CYCLIC]).done().files(), files);
    let told = truth(&work)["effect"].as_str().unwrap().to_owned();
    assert_eq!(Effect::parse(&told).unwrap(), Effect::parse(CYCLIC).unwrap());
    let bent = deviations(&work, "run1.csv");
    assert_eq!(clean.len(), bent.len());
    let added = clean.iter().zip(&bent).map(|(clean, bent)| bent - clean);
    let added: Vec<f64> = added.filter(|um| um.is_finite()).collect();
    // The noise is the same, the steps are 0.1 um.
    let largest = added.iter().fold(0.0_f64, |largest, um| largest.max(um.abs()));
    assert!((1.1..1.35).contains(&largest), "{largest} um");
    // 1.2 um sqrt(1/6): over the sphere the mean of u_X^2 is 1/3, that of the square of a sine 1/2.
    let rms = (added.iter().map(|um| um * um).sum::<f64>() / added.len() as f64).sqrt();
    assert!((0.3..0.8).contains(&rms), "{rms} um");
}

#[test]
fn several_effects_from_the_scenario_and_the_command_line() {
    let work = Work::new();
    let places = format!(
        "[[mounting]]\nname = \"B\"\ncoincidence_mm = [60.0, -35.0, 40.0]\n\
         tool_ball_mm = [0.0, 0.0, -200.0]\n\n{PLAN}"
    );
    work.machine("name", "name").test(&places).write(
        "scenario.toml",
        "[[hide]]\ncause = \"knock\"\non = \"EXt\"\nstep_um = 40\nmoment_s = 0\nrun = 3\n",
    );
    let simulate = ["simulate", "test.toml", "--repeats", "2", "--scenario", "scenario.toml"];
    work.ballbar(&[simulate.as_slice(), &["--hide", "bar-length:amplitude_um=0"]].concat()).done();
    let told = truth(&work);
    let effects: Vec<&str> = told["effect"].as_str().unwrap().split(" + ").collect();
    assert_eq!(effects[0], "knock:on=EXt,step_um=40,moment_s=0,run=3");
    assert_eq!(effects[1], "bar-length:amplitude_um=0");
    // Runs count as they stand in truth.toml: both mountings of the first repeat, then of the second.
    let logs: Vec<String> = told["run"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| run["log"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(logs.len(), 4);
    let knocked: Vec<Vec<f64>> = logs.iter().map(|log| deviations(&work, log)).collect();
    work.write("scenario.toml", "").ballbar(&simulate).done();
    for (index, (log, knocked)) in logs.iter().zip(&knocked).enumerate() {
        let clean = deviations(&work, log);
        let same = clean.iter().zip(knocked).all(|(a, b)| a.is_nan() || (a - b).abs() < 1e-9);
        assert_eq!(!same, index == 2, "{log}");
    }
}

#[test]
fn what_cannot_be_hidden_is_refused() {
    let work = Work::new();
    work.machine("name", "name").test(PLAN);
    let refused =
        |effect: &str| work.ballbar(&["simulate", "test.toml", "--hide", effect]).refused(1);
    insta::assert_snapshot!(refused("cycle"));
    insta::assert_snapshot!(refused("cyclic:on=EXX,period_mm=10"));
    insta::assert_snapshot!(refused("roundness:amplitude_um=1,degree=2,order=3"));
    work.write("scenario.toml", "[[hide]]\ncause = \"servo\"\non = \"Y\"\ndelay_ms = 5e3\n");
    let outcome = work.ballbar(&["simulate", "test.toml", "--scenario", "scenario.toml"]);
    insta::assert_snapshot!(outcome.refused(1));
}
