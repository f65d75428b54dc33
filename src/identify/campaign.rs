//! All runs of a test: read, aligned, grouped by repeat and identified.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::{Identification, Options, RunInput, identify};
use crate::align;
use crate::error::Result;
use crate::log;
use crate::machine::Machine;
use crate::model::{self, Model};
use crate::nc;
use crate::plan::{Run, Test};

/// Reads and aligns one run of a test.
pub fn align_run(test: &Test, machine: &Machine, run: &Run) -> Result<RunInput> {
    let log = log::read(&run.log, test.log_format())?;
    let mut reading = nc::Reading::of(machine);
    for mounting in test.mountings() {
        reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
    }
    // Two mountings may use the same offset, one after the other: the run's own counts.
    let mounting = &test.mountings()[run.mounting];
    reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
    let program = nc::read_file(&run.program, &reading)?;
    let alignment = align::align(
        &log,
        &program,
        machine,
        &mounting.mounting,
        test.ball_bar(),
        run.feed_override,
    )?;
    Ok(RunInput { name: run.name.clone(), mounting: run.mounting, alignment })
}

/// Identifies every repeat of a test: runs with the same repeat number together, repeats apart.
///
/// Repeats are worked on side by side; `finished` is called after each. The result does not depend on
/// the number of threads. Of several errors the one of the first repeat is returned.
pub fn campaign(
    test: &Test,
    machine: &Machine,
    finished: &(dyn Fn() + Sync),
) -> Result<Vec<Identification>> {
    let names: Vec<String> = test.mountings().iter().map(|m| m.name.clone()).collect();
    let mut repeats: BTreeMap<u32, Vec<&Run>> = BTreeMap::new();
    for run in test.runs()? {
        repeats.entry(run.repeat).or_default().push(run);
    }
    let (bar, estimation) = (test.ball_bar(), test.estimation());
    let options = Options {
        nominal_mm: bar.length_mm,
        noise_mm: bar.noise_mm,
        clock_tolerance: bar.clock_tolerance,
        loss: estimation.loss,
        minimum_norm: estimation.minimum_norm,
    };
    let repeats: Vec<Vec<&Run>> = repeats.into_values().collect();
    let results: Vec<Result<Identification>> = repeats
        .par_iter()
        .map(|runs| {
            let inputs =
                runs.iter().map(|run| align_run(test, machine, run)).collect::<Result<Vec<_>>>()?;
            let mountings = test.mountings().iter().map(|m| m.mounting).collect();
            let model = Model::new(machine, mountings, model::terms(&estimation.terms, &names)?);
            let result = identify(&model, inputs, &options);
            finished();
            result
        })
        .collect();
    results.into_iter().collect()
}
