//! A trial as files, for whoever wants to look at it with the other commands.

use std::fmt::Write as _;

use super::course::Course;
use super::simulated::simulate_all;
use super::stage::Trace;
use crate::error::Result;
use crate::model::Effect;
use crate::simulate::{Scenario, TrueRun, at_the_place, truth_toml};

/// Hides on all days what was drawn; gives it with the share of its rms outside of the model.
pub(super) fn hide(
    hidden: Vec<(Effect, Trace)>,
    days: &mut [Scenario],
) -> Result<Vec<(Effect, f64)>> {
    for day in days {
        for (effect, _) in &hidden {
            day.hide(effect.clone())?;
        }
    }
    Ok(hidden.into_iter().map(|(effect, trace)| (effect, trace.share())).collect())
}

/// Name and text of every file.
pub(super) fn files(
    course: &Course,
    test_toml: &str,
    machine_toml: &str,
    days: &[Scenario],
) -> Result<Vec<(String, String)>> {
    let mut test = test_toml.to_owned();
    let mut files = vec![("machine.toml".to_owned(), machine_toml.to_owned())];
    // Programs of two feeds have the same number.
    let program_name = |index: usize| format!("program{}.nc", index + 1);
    for (index, program) in course.programs.iter().enumerate() {
        files.push((program_name(index), program.source.text.clone()));
    }
    let simulated = simulate_all(course, days)?;
    let names: Vec<(String, String)> = (0..simulated.len())
        .map(|run| {
            let run = &course.runs[run];
            (format!("{}.csv", run.name), program_name(run.program))
        })
        .collect();
    let mut truths = Vec::new();
    for ((run, of_course), (log, program)) in simulated.iter().zip(&course.runs).zip(&names) {
        let mounting = &course.test.mountings()[of_course.mounting].name;
        let _ = write!(
            test,
            "\n[[run]]\nprogram = {program:?}\nlog = {log:?}\nmounting = {mounting:?}\nrepeat = {}\n",
            of_course.repeat
        );
        files.push((log.clone(), run.csv()));
        truths.push(TrueRun { log, program, run });
    }
    let asked = match days.first().map(|day| (day, &day.place)) {
        Some((day, Some(place))) => {
            let mounting = &course.test.mountings()[0].mounting;
            at_the_place(&course.machine, mounting, day, &place.middle_mm, &place.reach_mm)?
        }
        _ => Vec::new(),
    };
    files.push(("truth.toml".to_owned(), truth_toml(&truths, &asked)));
    files.push(("test.toml".to_owned(), test));
    Ok(files)
}
