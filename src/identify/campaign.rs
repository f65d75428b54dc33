//! All runs of a test: read, aligned, grouped by repeat and identified.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::{Identification, Options, RunInput, explicit_terms, identify};
use crate::align;
use crate::error::Result;
use crate::log;
use crate::machine::{Machine, Mounting};
use crate::model::{self, Model};
use crate::nc;
use crate::plan::{Run, Test};

/// Reads and aligns one run of a test.
pub fn align_run(test: &Test, machine: &Machine, run: &Run) -> Result<RunInput> {
    let log = log::read(&run.log, &test.log_format_of(run.mounting))?;
    let mut reading = nc::Reading::of(machine);
    for mounting in test.mountings() {
        reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
    }
    // Two mountings may use the same offset, one after the other: the run's own counts.
    let mounting = &test.mountings()[run.mounting];
    reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
    let program = nc::read_file(&run.program, &reading)?;
    let bar = test.bar_of(run.mounting);
    let alignment =
        align::align(&log, &program, machine, &mounting.mounting, &bar, run.feed_override)?;
    Ok(RunInput {
        name: run.name.clone(),
        mounting: run.mounting,
        nominal_mm: bar.length_mm,
        alignment,
    })
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
    let options = Options::of(test);
    let repeats: Vec<Vec<&Run>> = repeats.into_values().collect();
    let aligned: Vec<Result<Vec<RunInput>>> = repeats
        .par_iter()
        .map(|runs| runs.iter().map(|run| align_run(test, machine, run)).collect())
        .collect();
    let mut aligned = aligned.into_iter().collect::<Result<Vec<_>>>()?;
    // One set of terms for all, or they would have no mean: that of the first repeat.
    let mut terms = test.estimation().terms.clone();
    if let Some(first) = aligned.first_mut() {
        let mountings: Vec<(String, Mounting)> =
            test.mountings().iter().map(|m| (m.name.clone(), m.mounting)).collect();
        let runs = std::mem::take(first);
        (terms, *first) = explicit_terms(&terms, machine, &mountings, runs, &options)?;
    }
    let results: Vec<Result<Identification>> = aligned
        .into_par_iter()
        .map(|inputs| {
            let mountings = test.mountings().iter().map(|m| m.mounting).collect();
            let model = Model::new(machine, mountings, model::terms(&terms, &names)?);
            let result = identify(&model, inputs, &options);
            finished();
            result
        })
        .collect();
    results.into_iter().collect()
}
