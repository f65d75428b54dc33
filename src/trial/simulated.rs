//! The campaigns of a course, simulated, as if they had been measured.

use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;

use super::course::Course;
use crate::error::Result;
use crate::identify::MeasuredRun;
use crate::log;
use crate::simulate::{self, Scenario, SimulatedRun};

/// Every run of a course on its day.
pub(super) fn simulate_all(course: &Course, scenarios: &[Scenario]) -> Result<Vec<SimulatedRun>> {
    let runs = course.runs.par_iter().zip(scenarios);
    runs.map(|(run, scenario)| {
        let mounting = &course.test.mountings()[run.mounting].mounting;
        let bar = course.test.bar_of(run.mounting);
        let program = &course.programs[run.program].program;
        simulate::run(&course.machine, mounting, program, &bar, scenario)
    })
    .collect()
}

/// What a campaign measured, by repeat.
///
/// # Errors
/// When the bar never reads.
pub(super) fn measured(
    course: &Course,
    simulated: &[SimulatedRun],
) -> Result<Vec<Vec<MeasuredRun>>> {
    let runs = course.runs.par_iter().zip(simulated);
    let measured = runs
        .map(|(run, simulated)| {
            let (csv, file) = (simulated.csv(), Path::new(&run.name));
            Ok(MeasuredRun {
                name: run.name.clone(),
                mounting: run.mounting,
                feed_override: run.feed_override,
                log: log::read_bytes(csv.as_bytes(), file, &log::Format::default())?,
                source: Arc::clone(&course.programs[run.program].source),
                motion: None,
            })
        })
        .collect::<Result<Vec<_>>>()?;
    let mut measured = measured.into_iter();
    let repeats = course.repeats();
    Ok(repeats.iter().map(|runs| measured.by_ref().take(runs.len()).collect()).collect())
}
