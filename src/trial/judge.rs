//! Whether what was found is what was hidden.
//!
//! A finding names a hidden effect when cause and seat are the same, when a rival of it that these runs
//! cannot tell from it has them, or when the two are the same in these runs: a correlation of their
//! traces outside of the model beyond [`SAME`]. A finding of the same cause on another seat is compared
//! with the hidden numbers on that seat, so that the noise of the numbers found does not count.

use super::class::Class;
use super::course::Course;
use super::stage::{Stage, Trace};
use crate::diagnose::{Element, Finding, Owner, Searched, Separation};
use crate::model::{Effect, RUN, Shape};

/// Correlation of two traces beyond which two effects are the same in the runs at hand.
const SAME: f64 = 0.999;

/// What a trial came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Everything that was hidden is named, cause and seat, the only one as the first; nothing where
    /// nothing was hidden; what is outside of the library as unexplained, with its variable.
    Right,
    /// The causes are, but not every seat.
    CauseOnly,
    /// One of two.
    Partly,
    /// Unexplained, but over another variable.
    OtherVariable,
    /// A curve only.
    Unexplained,
    /// Another cause in its place.
    Wrong,
    /// Nothing was found.
    Nothing,
    /// Something was found where nothing is.
    FalseAlarm,
    /// The campaign could not be diagnosed.
    Failed,
}

impl Verdict {
    /// As it stands in lists.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::CauseOnly => "other seat",
            Self::Partly => "one of two",
            Self::OtherVariable => "other variable",
            Self::Unexplained => "unexplained",
            Self::Wrong => "WRONG",
            Self::Nothing => "nothing",
            Self::FalseAlarm => "FALSE ALARM",
            Self::Failed => "FAILED",
        }
    }
}

/// How well a finding names a hidden effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Grade {
    Not,
    Cause,
    Seat,
}

/// A finding, as far as the trial looks at it.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Its cause; `None` for a curve.
    pub cause: Option<&'static str>,
    /// In words, with its rms and what it could be as well.
    pub text: String,
    /// Whether it names something that was hidden, or a curve over the variable of what was.
    pub right: bool,
    /// The strongest correlation with a hidden effect, -1 to 1; `None` for curves and where every run has
    /// a phase of its own.
    pub correlation: Option<f64>,
}

/// What a diagnosis is worth.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// In a word.
    pub verdict: Verdict,
    /// What was found, the largest first.
    pub found: Vec<Found>,
    /// Findings with a cause that is not hidden.
    pub wrong_named: usize,
}

/// Judges a diagnosis.
pub(super) fn judge(
    stage: &Stage,
    course: &Course,
    class: Class,
    hidden: &[(Effect, Trace)],
    searched: &Searched,
) -> Judgement {
    let mut grades = Vec::new();
    let mut found = Vec::new();
    for finding in &searched.findings {
        let trace =
            traced(finding).and_then(|e| stage.trace(course, &told(course, finding, e)).ok());
        let of: Vec<Grade> = hidden
            .iter()
            .map(|(effect, of_effect)| {
                grade(stage, course, effect, of_effect, finding, trace.as_ref())
            })
            .collect();
        let correlations = trace.iter().flat_map(|t| hidden.iter().map(|h| h.1.correlation(t)));
        let correlation = correlations.max_by(|a, b| a.abs().total_cmp(&b.abs()));
        found.push(Found {
            cause: finding.element.shape().map(|shape| shape.cause.id),
            text: text(finding),
            right: of.iter().any(|grade| *grade > Grade::Not)
                || hidden.iter().any(|(effect, _)| over_its_variable(effect, finding)),
            correlation,
        });
        grades.push(of);
    }
    // Every course is driven in mountings that are as the test file has them.
    for wrong in &searched.wrong_settings {
        found.push(Found {
            cause: Some(wrong.effect.cause.id),
            text: wrong.effect.to_string(),
            right: false,
            correlation: None,
        });
        grades.push(vec![Grade::Not; hidden.len()]);
    }
    let named = |k: usize| found[k].cause.is_some();
    let wrong_named = (0..found.len())
        .filter(|&k| named(k) && grades[k].iter().all(|g| *g == Grade::Not))
        .count();
    let curves = (0..found.len()).any(|k| !named(k));
    let missed = || match (wrong_named > 0, curves) {
        (true, _) => Verdict::Wrong,
        (false, true) => Verdict::Unexplained,
        _ => Verdict::Nothing,
    };
    let verdict = match class {
        Class::None if found.is_empty() => Verdict::Right,
        Class::None => Verdict::FalseAlarm,
        Class::Outside if wrong_named > 0 => Verdict::Wrong,
        Class::Outside if found.iter().any(|f| f.right) => Verdict::Right,
        Class::Outside if found.is_empty() => Verdict::Nothing,
        Class::Outside => Verdict::OtherVariable,
        Class::Two => match paired(&grades) {
            Some(Grade::Seat) => Verdict::Right,
            Some(Grade::Cause) => Verdict::CauseOnly,
            _ if grades.iter().flatten().any(|g| *g > Grade::Not) => Verdict::Partly,
            _ => missed(),
        },
        _ => match grades.first().map(|of| of[0]) {
            Some(Grade::Seat) => Verdict::Right,
            Some(Grade::Cause) => Verdict::CauseOnly,
            _ => missed(),
        },
    };
    Judgement { verdict, found, wrong_named }
}

/// The worse grade of two effects that two findings name; `None` where they do not.
fn paired(grades: &[Vec<Grade>]) -> Option<Grade> {
    let mut best = None;
    for (i, one) in grades.iter().enumerate() {
        for (k, other) in grades.iter().enumerate() {
            let worse = one[0].min(other[1]);
            if i != k && worse > Grade::Not {
                best = best.max(Some(worse));
            }
        }
    }
    best
}

fn grade(
    stage: &Stage,
    course: &Course,
    hidden: &Effect,
    of_hidden: &Trace,
    finding: &Finding,
    trace: Option<&Trace>,
) -> Grade {
    let Some(shape) = finding.element.shape() else { return Grade::Not };
    // On another seat it is named all the same where, with the hidden numbers, that is the same in these runs.
    let names = |shape: &Shape| {
        let on_its_seat = || {
            let mut moved = hidden.clone();
            moved.seat = shape.seat;
            let same = |trace: Trace| trace.correlation(of_hidden).abs() > SAME;
            stage.trace(course, &[moved]).is_ok_and(same)
        };
        shape.cause == hidden.cause && (shape.seat == hidden.seat || on_its_seat())
    };
    let same_cause = shape.cause == hidden.cause;
    let rivals = || finding.rivals.iter().filter(|rival| rival.separation == Separation::Same);
    let rival_names = || rivals().any(|rival| rival.element.shape().is_some_and(names));
    let same_trace = || trace.is_some_and(|trace| trace.correlation(of_hidden) > SAME);
    if names(shape) || rival_names() || same_trace() {
        Grade::Seat
    } else if same_cause {
        Grade::Cause
    } else {
        Grade::Not
    }
}

/// The effects of a finding that have a trace: not those with a phase of their own in every run.
fn traced(finding: &Finding) -> Option<&[Effect]> {
    (!finding.effects.is_empty() && finding.owner() != Owner::EachRun)
        .then_some(finding.effects.as_slice())
}

/// Effects with the run in which they are.
fn told(course: &Course, finding: &Finding, effects: &[Effect]) -> Vec<Effect> {
    let Owner::One { repeat, run } = finding.owner() else { return effects.to_vec() };
    let number = course.repeats().get(repeat).map_or(0, |runs| runs[run]) + 1;
    effects.iter().map(|effect| effect.clone().with(RUN, number as f64)).collect()
}

/// Whether a finding is a curve over what a hidden effect hangs on, or one that these runs cannot tell from such
/// a curve.
fn over_its_variable(hidden: &Effect, finding: &Finding) -> bool {
    let over = hidden.cause.law(hidden.seat).over();
    let Some((over, axis)) = over.zip(hidden.seat.axis()) else { return false };
    let is_over_it = |of: &Element| of.curve().is_some_and(|c| c.variable == (over.variable)(axis));
    let same = finding.rivals.iter().filter(|rival| rival.separation == Separation::Same);
    is_over_it(&finding.element)
        || finding.element.curve().is_some() && same.map(|rival| &rival.element).any(is_over_it)
}

/// A finding in words: `cyclic EXX 10 mm 1.02 um (= cyclic EZX 10 mm) (? servo X)`.
fn text(finding: &Finding) -> String {
    let name = finding.element.form.name();
    let mut text = format!("{name} {:.3} um", 1e3 * finding.rms_mm);
    if let Owner::One { repeat, run } = finding.owner() {
        text = format!("{text} in repeat {} run {}", repeat + 1, run + 1);
    }
    for rival in &finding.rivals {
        let mark = match rival.separation {
            Separation::Same => "=",
            Separation::Undecided => "?",
            Separation::Apart => continue,
        };
        text = format!("{text} ({mark} {})", rival.name());
    }
    text
}
