//! The campaigns of a course: simulated, and their logs laid over the programs.

use std::path::Path;

use rayon::prelude::*;

use super::course::Course;
use crate::align;
use crate::error::Result;
use crate::identify::RunInput;
use crate::log;
use crate::simulate::{self, Scenario, SimulatedRun};

/// Every run of a course on its day.
pub(super) fn simulate_all(course: &Course, scenarios: &[Scenario]) -> Result<Vec<SimulatedRun>> {
    let runs = course.runs.par_iter().zip(scenarios);
    runs.map(|(run, scenario)| {
        let mounting = &course.test.mountings()[run.mounting].mounting;
        let bar = course.test.bar_of(run.mounting);
        simulate::run(&course.machine, mounting, &course.programs[run.program], &bar, scenario)
    })
    .collect()
}

/// The logs of a campaign laid over their programs, by repeat.
pub(super) fn aligned(course: &Course, simulated: &[SimulatedRun]) -> Result<Vec<Vec<RunInput>>> {
    let runs: Vec<(usize, &SimulatedRun)> = simulated.iter().enumerate().collect();
    let aligned = runs
        .into_par_iter()
        .map(|(index, simulated)| {
            let run = &course.runs[index];
            let csv = simulated.csv();
            let log =
                log::read_bytes(csv.as_bytes(), Path::new(&run.name), &log::Format::default())?;
            let bar = course.test.bar_of(run.mounting);
            let mounting = &course.test.mountings()[run.mounting].mounting;
            let program = &course.programs[run.program];
            let rig = align::Rig { machine: &course.machine, mounting, bar: &bar };
            let feed_override = run.feed_override;
            Ok(RunInput {
                name: run.name.clone(),
                mounting: run.mounting,
                nominal_mm: bar.length_mm,
                alignment: align::align(&align::Run { log: &log, program, rig, feed_override })?,
            })
        })
        .collect::<Result<Vec<_>>>()?;
    let mut aligned = aligned.into_iter();
    let repeats = course.repeats();
    Ok(repeats.iter().map(|runs| aligned.by_ref().take(runs.len()).collect()).collect())
}
