//! A machine file and a test file: path, programs, check, and what the test will know.

use ballbar::design::{Outlook, PlannedProgram};
use ballbar::machine::Machine;
use ballbar::plan::Test;

use super::{Target, accepted, test};
use crate::seeds::{self, joined, parts};

pub const TARGET: Target = Target {
    name: "plan",
    seeds: || {
        let both = [
            (seeds::FULL_MACHINE, seeds::SHORT_TEST),
            (seeds::OTHER_MACHINE, seeds::OTHER_TEST),
            (seeds::OTHER_MACHINE, seeds::PLANES_TEST),
        ];
        both.map(|(machine, test)| joined(&[machine.as_bytes(), test.as_bytes()])).into()
    },
    words: test::WORDS,
    made: &[],
    read,
};

/// Programs that take longer are planned and checked and not rehearsed: a rehearsal takes longer than all else.
const REHEARSED_S: f64 = 120.0;

fn read(input: &[u8]) -> bool {
    let [machine, test] = parts(input);
    let machine = Machine::parse(&seeds::as_text(machine), "machine.toml".as_ref());
    let test = Test::parse(&seeds::as_text(test), "test.toml".as_ref());
    if !(accepted(&machine) & accepted(&test)) {
        return false;
    }
    let (Ok(machine), Ok(test)) = (machine, test) else { return false };
    let mut short = true;
    for mounting in 0..test.mountings().len().min(2) {
        let planned = PlannedProgram::new(&test, &machine, mounting);
        if !accepted(&planned) {
            return false;
        }
        let Ok(planned) = planned else { return false };
        let objections = planned.objections(&test, &machine);
        accepted(&objections);
        if let Ok(objections) = &objections {
            let _ = planned.clone().warned(&machine, objections);
        }
        short &= planned.trajectory.end_s() < REHEARSED_S && test.ball_bar().sample_rate_hz < 50.0;
    }
    if short && test.mountings().len() < 3 {
        accepted(&Outlook::new(&test, &machine));
    }
    true
}
