//! A scenario and a model: the log of a virtual machine, read again.

use ballbar::log::{Format, read_bytes};
use ballbar::model::ModelFile;
use ballbar::simulate::{Scenario, TrueRun, run, truth_toml};

use super::{Target, accepted, scenario};
use crate::seeds::{self, RIGS, joined, parts};

pub const TARGET: Target = Target {
    name: "simulate",
    seeds: || {
        let plain = b"sample_rate_hz = 5\n[noise]\nwhite_um = 0.1\n";
        vec![
            joined(&[plain, seeds::MODEL.as_bytes()]),
            joined(&[seeds::SCENARIO.as_bytes(), b""]),
            plain.to_vec(),
        ]
    },
    words: scenario::WORDS,
    made: &[],
    read,
};

fn read(input: &[u8]) -> bool {
    let rig = &RIGS[0];
    let [scenario, model] = parts(input);
    let scenario = Scenario::parse(&seeds::as_text(scenario), "scenario.toml".as_ref());
    if !accepted(&scenario) {
        return false;
    }
    let Ok(mut scenario) = scenario else { return false };
    if !model.is_empty() {
        let model = ModelFile::parse(&seeds::as_text(model), "model.toml".as_ref());
        let taken = model.and_then(|model| scenario.take(&model));
        if !accepted(&taken) {
            return false;
        }
    }
    let balls = rig.test.mountings()[0].mounting;
    let bar = rig.test.bar_of(0);
    scenario.draw_machine(&rig.machine, &[balls], bar.length_mm);
    let simulated = run(&rig.machine, &balls, &rig.programs[0].program, &bar, &scenario);
    let taken = accepted(&simulated);
    let Ok(simulated) = simulated else { return taken };
    let csv = simulated.csv();
    assert!(!csv.contains("NaN") && !csv.contains("inf"), "a log has numbers");
    if !simulated.readings.is_empty() {
        accepted(&read_bytes(csv.as_bytes(), "run.csv".as_ref(), &Format::default()));
    }
    let truth =
        truth_toml(&[TrueRun { log: "run.csv", program: "O1001.nc", run: &simulated }], &[]);
    assert!(!truth.contains("NaN"), "the truth has numbers");
    taken
}
