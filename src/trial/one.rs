//! One trial: a campaign with something hidden, diagnosed and judged.

use std::time::Instant;

use super::class::Class;
use super::course::Course;
use super::judge::{Judgement, Verdict, judge};
use super::request::Request;
use super::simulated::{measured, simulate_all};
use super::stage::{Stage, Trace};
use crate::diagnose::{Finding, Searched, search};
use crate::error::{Kind, Result};
use crate::identify::{Campaign, Failure, answers};
use crate::model::Effect;
use crate::simulate::{Scenario, at_the_place};

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
    /// How far what people ask is from what is true of the first repeat, hidden effects apart.
    pub off_by: Vec<OffBy>,
    /// In a grid: the value of every factor.
    pub strata: Vec<(&'static str, String)>,
}

impl Outcome {
    /// A trial that could not be done, and why.
    pub(super) fn failed(request: Request, why: String) -> Self {
        let judgement = Judgement { verdict: Verdict::Failed, found: Vec::new(), wrong_named: 0 };
        Self {
            class: request.class,
            index: request.index,
            size_mm: 0.0,
            hidden: Vec::new(),
            judgement,
            failure: Some(why),
            left_out: Vec::new(),
            seconds: Seconds::default(),
            findings: None,
            off_by: Vec::new(),
            strata: Vec::new(),
        }
    }
}

/// How far a number that people ask is from the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct OffBy {
    /// Which, such as `squareness XY`.
    pub name: String,
    /// In units of its stated deviation by the noise.
    pub noises: f64,
    /// In units of its stated deviation by all.
    pub alls: f64,
}

/// What a trial is: everything that was drawn.
pub(super) struct Drawn {
    pub(super) class: Class,
    pub(super) index: u64,
    pub(super) size_mm: f64,
    pub(super) hidden: Vec<(Effect, Trace)>,
    pub(super) days: Vec<Scenario>,
    /// Causes that are true though they were not hidden.
    pub(super) true_too: Vec<&'static str>,
}

/// Does a trial.
pub(super) fn trial(stage: &Stage, course: &Course, drawn: Drawn, keep: bool) -> Outcome {
    let Drawn { class, index, size_mm, hidden, days, true_too } = drawn;
    let mut seconds = Seconds::default();
    let diagnosed = diagnosed(course, &hidden, days, &mut seconds);
    let (judgement, failure, left_out, findings, off_by) = match diagnosed {
        Ok(Diagnosed { mut searched, left_out, off_by }) => {
            let said =
                |finding: &Finding| finding.element.shape().map_or("", |shape| shape.cause.id);
            searched.findings.retain(|finding| !true_too.contains(&said(finding)));
            searched.wrong_settings.retain(|wrong| !true_too.contains(&wrong.effect.cause.id));
            let judgement = judge(stage, course, class, &hidden, &searched);
            (judgement, None, left_out, keep.then_some(searched.findings), off_by)
        }
        Err(error) => {
            let judgement =
                Judgement { verdict: Verdict::Failed, found: Vec::new(), wrong_named: 0 };
            (judgement, Some(error.what), Vec::new(), None, Vec::new())
        }
    };
    let hidden = hidden.into_iter().map(|(effect, trace)| (effect, trace.share())).collect();
    Outcome {
        class,
        index,
        size_mm,
        hidden,
        judgement,
        failure,
        left_out,
        seconds,
        findings,
        off_by,
        strata: Vec::new(),
    }
}

/// What came of a campaign.
struct Diagnosed {
    searched: Searched,
    left_out: Vec<(String, String)>,
    off_by: Vec<OffBy>,
}

fn diagnosed(
    course: &Course,
    hidden: &[(Effect, Trace)],
    mut days: Vec<Scenario>,
    seconds: &mut Seconds,
) -> Result<Diagnosed> {
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
    let numbers = searched.extended.as_ref().map_or(&campaign, |extended| &extended.campaign);
    let off_by = off_by(course, numbers, &days)?;
    let left_out = campaign.left_out.into_iter().map(|(run, error)| (run, error.what)).collect();
    Ok(Diagnosed { searched, left_out, off_by })
}

/// How far the answers of the first repeat, the effects that were found beside them, are from the truth, where its place is known.
fn off_by(course: &Course, campaign: &Campaign, days: &[Scenario]) -> Result<Vec<OffBy>> {
    let (Some(frame), Some(repeat)) = (&campaign.frame, campaign.repeats.first()) else {
        return Ok(Vec::new());
    };
    let Some(day) = course.runs.iter().position(|run| run.name == repeat.runs[0].name) else {
        return Ok(Vec::new());
    };
    let mounting = &course.test.mountings()[0].mounting;
    let (middle_mm, reach_mm) = (&frame.middle_mm, &frame.reach_mm);
    let truth = at_the_place(&course.machine, mounting, &days[day], middle_mm, reach_mm)?;
    let model = campaign.model(&course.test, &course.machine, 0)?;
    let answers = answers(&model, frame, &repeat.known(&repeat.values()));
    let off = |(name, truth): (String, f64)| {
        let answer = answers.iter().find(|answer| answer.asked.name() == name)?;
        let off = answer.value - truth;
        let (noises, alls) = (off / answer.noise, off / answer.all?);
        Some(OffBy { name, noises, alls })
    };
    Ok(truth.into_iter().filter_map(off).collect())
}
