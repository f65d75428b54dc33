//! What a diagnosis says.

use super::arcs::ArcShare;
use super::choose::Rival;
use super::element::{Element, Owner};
use super::floor::Structure;
use super::picture::Picture;
use super::settings::WrongSetting;
use super::times::OffTime;
use super::view::View;
use crate::error::Error;
use crate::identify::Campaign;
use crate::model::Effect;

/// A number of a finding, as it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// Its name with its unit, such as `amplitude_um`.
    pub name: String,
    /// Its value in that unit.
    pub value: f64,
    /// Its standard deviation in that unit; `None` where it is not estimated.
    pub sigma: Option<f64>,
}

/// One effect that the model lacks.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What joins the model.
    pub element: Element,
    /// The effect with its numbers, of several amplitudes one each; none where no cause explains it.
    pub effects: Vec<Effect>,
    /// Its numbers with their uncertainty.
    pub numbers: Vec<Number>,
    /// Its amplitudes in mm and rad, in the order of the element's columns.
    pub amplitudes: Vec<f64>,
    /// Root mean square of what it leaves in the residuals of the model, mm.
    pub rms_mm: f64,
    /// What else it could be, or could nearly be.
    pub rivals: Vec<Rival>,
}

impl Finding {
    /// Whether a cause of the library explains it.
    pub fn named(&self) -> bool {
        self.element.shape().is_some()
    }

    /// Whether it is one run's alone, or differs from run to run.
    pub fn owner(&self) -> Owner {
        self.element.owner
    }
}

/// Root mean squares of one run that took no part in the fit of the effects.
#[derive(Debug, Clone, PartialEq)]
pub struct RunGain {
    /// Name of the run.
    pub run: String,
    /// Samples.
    pub samples: usize,
    /// Without the effects, mm.
    pub before_mm: f64,
    /// With the effects as the other repeats have them, mm.
    pub after_mm: f64,
    /// What does not repeat from run to run, mm; what all effects together leave where nothing repeats.
    pub floor_mm: f64,
    /// `(before² - after²) / (before² - floor²)`; `None` where nothing was there to explain.
    pub explained: Option<f64>,
}

/// The effects as runs of the other programs have them.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramGain {
    /// Runs that took no part: all of one program.
    pub runs: Vec<String>,
    /// The largest feed in their arcs, mm/min.
    pub feed_mm_min: f64,
    /// Without the effects, mm.
    pub before_mm: f64,
    /// With the effects as the runs of all other programs have them, mm.
    pub after_mm: f64,
}

/// A coefficient that was biased by what the model lacked.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Mean over the repeats without the effects.
    pub before: f64,
    /// And with them.
    pub after: f64,
    /// Standard deviation in one repeat without the effects.
    pub sigma_before: f64,
    /// And with them: what the amplitudes do not know counts.
    pub sigma_after: f64,
}

/// Root mean squares over all runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// Residual of the model, mm.
    pub before_mm: f64,
    /// Residual of the extended model, mm.
    pub after_mm: f64,
    /// What repeats of the one; `None` where no program ran twice.
    pub structure_before: Option<Structure>,
    /// And of the other.
    pub structure_after: Option<Structure>,
    /// What differs between neighbouring readings by chance, as noise of one reading, mm.
    pub neighbours_mm: f64,
    /// How many independent readings tell as much as all do.
    pub effective_samples: f64,
    /// Mean of [`RunGain::explained`] over what was there to explain.
    pub explained: Option<f64>,
    /// Its 95 % interval.
    pub explained_interval: Option<[f64; 2]>,
    /// Effects smaller than this would not have been named, mm rms.
    pub smallest_mm: f64,
}

/// Runs that took no part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// Name of the run, or names of the runs of one repeat.
    pub runs: String,
    /// Why, in a sentence without a full stop.
    pub reason: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl LeftOut {
    /// Of what the error says the sentence, without the picture below it.
    pub(super) fn of(runs: &str, error: &Error) -> Self {
        Self {
            runs: runs.to_owned(),
            reason: error.what.lines().next().unwrap_or_default().to_owned(),
            hint: error.hint.clone(),
        }
    }
}

/// What the model gets wrong.
#[derive(Debug)]
pub struct Diagnosis {
    /// Is anything wrong?
    pub verdict: Verdict,
    /// What it is, the largest first.
    pub findings: Vec<Finding>,
    /// The gain on every run, from the others.
    pub runs: Vec<RunGain>,
    /// The gain on every program, from the others; empty where all runs drove one.
    pub programs: Vec<ProgramGain>,
    /// Coefficients that moved by more than their sigma.
    pub moved: Vec<Moved>,
    /// What these runs cannot see, in sentences.
    pub unseen: Vec<String>,
    /// The residual against everything, what holds most structure first.
    pub views: Vec<View>,
    /// What each finding looks like by itself, in their order; `None` where it hangs on no single variable.
    pub pictures: Vec<Option<Picture>>,
    /// How much of what is left on each arc repeats.
    pub arcs: Vec<ArcShare>,
    /// What the machine file or the test file states wrong; all else is with it put right.
    pub wrong_settings: Vec<WrongSetting>,
    /// Runs whose feed or clock is not as stated.
    pub off_times: Vec<OffTime>,
    /// Runs that took no part, with the reason.
    pub left_out: Vec<LeftOut>,
    /// Samples that were looked at.
    pub samples: usize,
    /// The campaign identified anew with the effects; `None` where there are none.
    pub extended: Option<Campaign>,
}

impl Diagnosis {
    /// Whether nothing is wrong that these runs would show.
    pub fn nothing_found(&self) -> bool {
        self.findings.is_empty() && self.off_times.is_empty() && self.wrong_settings.is_empty()
    }
}
