//! One trial: a campaign with something hidden, diagnosed and judged.

use std::time::Instant;

use super::class::Class;
use super::course::Course;
use super::judge::{Judgement, Verdict, judge};
use super::simulated::{measured, simulate_all};
use super::stage::{Stage, Trace};
use crate::diagnose::{Finding, Searched, search};
use crate::error::{Kind, Result};
use crate::identify::{Campaign, Failure};
use crate::model::Effect;
use crate::simulate::Scenario;

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
    let measured = measured(course, &simulated)?;
    let campaign =
        Campaign::of_measured(&course.test, &course.machine, measured, Failure::LeaveOut)?;
    // A log that does not belong to its program would be taken again: such a trial is none.
    let foreign = campaign.left_out.iter().find(|(_, error)| error.kind == Kind::Mismatch);
    if let Some((_, error)) = foreign {
        return Err(error.clone());
    }
    seconds.identify_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let searched = search(&course.test, &course.machine, &campaign)?;
    seconds.diagnose_s = start.elapsed().as_secs_f64();
    let left_out = campaign.left_out.into_iter().map(|(run, error)| (run, error.what)).collect();
    Ok((searched, left_out))
}
