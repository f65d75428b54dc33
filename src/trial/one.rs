//! One trial: a campaign with something hidden, diagnosed and judged.

use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;

use super::judge::{Judgement, Verdict, judge};
use super::stage::{Stage, Trace, simulate_all};
use super::{Class, Course};
use crate::align;
use crate::diagnose::{Finding, Searched, search};
use crate::error::Result;
use crate::identify::{Campaign, Failure, RunInput};
use crate::log;
use crate::model::Effect;
use crate::simulate::{Scenario, SimulatedRun};

/// How long the parts of a trial took, s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Seconds {
    /// Simulation.
    pub simulate_s: f64,
    /// Reading, alignment, identification.
    pub identify_s: f64,
    /// Diagnosis.
    pub diagnose_s: f64,
}

/// What became of a trial.
#[derive(Debug)]
pub struct Outcome {
    /// What kind of trial.
    pub class: Class,
    /// Which of them.
    pub index: u64,
    /// Size of each hidden effect outside of the model, mm rms.
    pub size_mm: f64,
    /// What was hidden, with the share of its rms outside of the model.
    pub hidden: Vec<(Effect, f64)>,
    /// What was found and what it is worth.
    pub judgement: Judgement,
    /// Why it failed.
    pub failure: Option<String>,
    /// Runs that were left out, with the reason.
    pub left_out: Vec<(String, String)>,
    /// How long it took.
    pub seconds: Seconds,
    /// What was found, where it was asked for.
    pub findings: Option<Vec<Finding>>,
}

/// What a trial is: everything that was drawn.
pub(super) struct Drawn {
    pub(super) class: Class,
    pub(super) index: u64,
    pub(super) size_mm: f64,
    pub(super) hidden: Vec<(Effect, Trace)>,
    pub(super) days: Vec<Scenario>,
}

/// Does a trial.
pub(super) fn trial(stage: &Stage, course: &Course, drawn: Drawn, keep: bool) -> Outcome {
    let Drawn { class, index, size_mm, hidden, days } = drawn;
    let mut seconds = Seconds::default();
    let diagnosed = diagnosed(course, &hidden, days, &mut seconds);
    let (judgement, failure, left_out, findings) = match diagnosed {
        Ok((searched, left_out)) => {
            let judgement = judge(stage, course, class, &hidden, &searched);
            (judgement, None, left_out, keep.then_some(searched.findings))
        }
        Err(error) => {
            let judgement =
                Judgement { verdict: Verdict::Failed, found: Vec::new(), wrong_named: 0 };
            (judgement, Some(error.what), Vec::new(), None)
        }
    };
    let hidden = hidden.into_iter().map(|(effect, trace)| (effect, trace.share())).collect();
    Outcome { class, index, size_mm, hidden, judgement, failure, left_out, seconds, findings }
}

type LeftOut = Vec<(String, String)>;

fn diagnosed(
    course: &Course,
    hidden: &[(Effect, Trace)],
    mut days: Vec<Scenario>,
    seconds: &mut Seconds,
) -> Result<(Searched, LeftOut)> {
    let start = Instant::now();
    for day in &mut days {
        for (effect, _) in hidden {
            day.hide(effect.clone())?;
        }
    }
    let simulated = simulate_all(course, &days)?;
    seconds.simulate_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let aligned = aligned(course, &simulated)?;
    let campaign = Campaign::of_aligned(
        &course.test,
        &course.machine,
        aligned,
        Vec::new(),
        Failure::LeaveOut,
        &|| (),
    )?;
    seconds.identify_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let searched = search(&course.test, &course.machine, &campaign)?;
    seconds.diagnose_s = start.elapsed().as_secs_f64();
    let left_out = campaign.left_out.into_iter().map(|(run, error)| (run, error.what)).collect();
    Ok((searched, left_out))
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
            let (machine, knob) = (&course.machine, run.feed_override);
            Ok(RunInput {
                name: run.name.clone(),
                mounting: run.mounting,
                nominal_mm: bar.length_mm,
                alignment: align::align(&log, program, machine, mounting, &bar, knob)?,
            })
        })
        .collect::<Result<Vec<_>>>()?;
    let mut aligned = aligned.into_iter();
    let repeats = course.repeats();
    Ok(repeats.iter().map(|runs| aligned.by_ref().take(runs.len()).collect()).collect())
}
