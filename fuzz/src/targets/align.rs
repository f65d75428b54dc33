//! A log and the program that ran: laid over each other, and identified.

use std::sync::Arc;

use ballbar::identify::{Campaign, Failure, MeasuredRun};
use ballbar::log::read_bytes;
use ballbar::nc::Source;

use super::{Target, accepted, program};
use crate::seeds::{self, RIGS, joined, parts};

pub const TARGET: Target = Target {
    name: "align",
    seeds: || {
        let rig = &RIGS[0];
        vec![joined(&[rig.log.as_bytes(), rig.programs[0].text.as_bytes()])]
    },
    words: program::WORDS,
    made: &[],
    read,
};

fn read(input: &[u8]) -> bool {
    let rig = &RIGS[0];
    let [log, program] = parts(input);
    let log = read_bytes(log, "run.csv".as_ref(), &rig.test.log_format_of(0));
    if !accepted(&log) {
        return false;
    }
    let Ok(log) = log else { return false };
    let source = Source { file: "O1001.nc".into(), text: seeds::as_text(program) };
    let run = MeasuredRun {
        name: "run".into(),
        mounting: 0,
        feed_override: 1.0,
        log,
        source: Arc::new(source),
        motion: None,
    };
    let aligned = run.aligned(&rig.test, &rig.machine);
    if !accepted(&aligned) {
        return false;
    }
    accepted(&Campaign::of_measured(&rig.test, &rig.machine, vec![vec![run]], Failure::Refuse))
}
