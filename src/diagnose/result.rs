//! What a diagnosis says.

use serde::Serialize;

use crate::diagnose::account::arcs::ArcShare;
use crate::diagnose::account::effects::EffectsAt;
use crate::diagnose::account::gain::{ProgramGain, RunGain};
use crate::diagnose::account::left_out::LeftOut;
use crate::diagnose::account::moved::Moved;
use crate::diagnose::account::numbers::Number;
use crate::diagnose::account::times::OffTime;
use crate::diagnose::choose::found::Rival;
use crate::diagnose::choose::settings::WrongSetting;
use crate::diagnose::views::picture::Picture;
use crate::diagnose::views::view::View;
use crate::identify::Campaign;
use crate::machine::Machine;
use crate::model::Effect;
use crate::plan::Test;
use crate::residual::{Element, Owner, Structure};
use crate::written::um;

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

/// Root mean squares over all runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Verdict {
    /// Residual of the model, mm.
    #[serde(rename = "before_um", serialize_with = "um")]
    pub before_mm: f64,
    /// Residual of the extended model, mm.
    #[serde(rename = "after_um", serialize_with = "um")]
    pub after_mm: f64,
    /// What repeats of the one; `None` where no program ran twice.
    pub structure_before: Option<Structure>,
    /// And of the other.
    pub structure_after: Option<Structure>,
    /// What differs between neighbouring readings by chance, as noise of one reading, mm.
    #[serde(rename = "neighbours_um", serialize_with = "um")]
    pub neighbours_mm: f64,
    /// How many independent readings tell as much as all do.
    pub effective_samples: f64,
    /// Samples that were looked at.
    pub samples: usize,
    /// Mean of [`RunGain::explained`] over what was there to explain.
    pub explained: Option<f64>,
    /// Its 95 % interval.
    pub explained_interval: Option<[f64; 2]>,
    /// Effects smaller than this would not have been named, mm rms.
    #[serde(rename = "smallest_um", serialize_with = "um")]
    pub smallest_mm: f64,
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
    /// What each finding does to each reading, repeat after repeat; empty where nothing was found.
    pub effects: Vec<Vec<EffectsAt>>,
    /// How much of what is left on each arc repeats.
    pub arcs: Vec<ArcShare>,
    /// What the machine file or the test file states wrong; all else is with it put right.
    pub wrong_settings: Vec<WrongSetting>,
    /// Runs whose feed or clock is not as stated.
    pub off_times: Vec<OffTime>,
    /// Runs that took no part, with the reason.
    pub left_out: Vec<LeftOut>,
    /// The model with the effects and with what is stated wrong put right; `None` where there is neither.
    pub extended: Option<ExtendedModel>,
}

/// The campaign identified anew with what was found: its numbers are those of the machine.
///
/// What is not known of the effects is counted in what its identifications state.
#[derive(Debug)]
pub struct ExtendedModel {
    /// The test, the places of its balls put right.
    pub test: Test,
    /// The machine, its pivots put right.
    pub machine: Machine,
    /// The repeats with the effects held beside the terms.
    pub campaign: Campaign,
}

impl Diagnosis {
    /// Whether nothing is wrong that these runs would show.
    pub fn nothing_found(&self) -> bool {
        self.findings.is_empty() && self.off_times.is_empty() && self.wrong_settings.is_empty()
    }
}
