//! What the model gets wrong, as plain numbers: the key `diagnosis` of `analysis.json`.
//!
//! Numbers are the results of the diagnosis themselves, which write their lengths in um; the sentences about them
//! stand here. The schema is documented field by field in `docs/analysis-schema.md`.

use serde::{Serialize, Serializer};

use super::owner::OwnerFacts;
use super::settings::WrongSettingFacts;
use super::verdict::VerdictFacts;
use crate::diagnose::{
    ArcShare, Feature, LeftOut, Moved, Number, OffTime, Picture, ProgramGain, Rival, RunGain,
    Verdict, View,
};
use crate::error::{Error, Kind, Result};
use crate::model::Effect;
use crate::written::um;

/// What the model gets wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosisFacts {
    /// The verdict, a list of sentences, the gravest first.
    pub verdict: VerdictFacts,
    /// Whether there are repeats to foretell each other.
    #[serde(skip)]
    pub foretold: bool,
    /// Whether nothing was found that these runs would show.
    pub nothing_found: bool,
    /// Root mean squares over all runs.
    #[serde(flatten)]
    pub of_all: Verdict,
    /// What was found, the largest first.
    pub findings: Vec<FindingFacts>,
    /// The gain on every run, from the others.
    pub runs: Vec<RunGain>,
    /// The gain on every program, from the others.
    pub programs: Vec<ProgramGain>,
    /// Coefficients that moved by more than their sigma.
    pub moved: Vec<Moved>,
    /// The residual against everything, the views that hold most structure first; those that are not drawn
    /// without their bins.
    pub views: Vec<View>,
    /// How much of what is left on each arc repeats.
    pub arcs: Vec<ArcShare>,
    /// What these runs cannot see or tell apart, in sentences.
    pub unseen: Vec<String>,
    /// What the machine file or the test file states wrong; all else is with it put right.
    pub wrong_settings: Vec<WrongSettingFacts>,
    /// Runs whose feed or clock is not as the test file states.
    pub off_times: Vec<OffTime>,
    /// Runs that took no part.
    pub left_out: Vec<LeftOut>,
}

/// A diagnosis that is no part of an analysis says itself what it is.
#[derive(Serialize)]
struct Alone<'a> {
    format: &'static str,
    #[serde(flatten)]
    facts: &'a DiagnosisFacts,
}

impl DiagnosisFacts {
    /// Whether of any run it is known what does not repeat.
    pub(super) fn floors_known(&self) -> bool {
        self.runs.iter().any(|run| run.floor_mm.is_some())
    }

    /// Which runs the other repeats do not foretell, where they foretell any.
    pub(super) fn not_foretold(&self) -> Option<String> {
        let own = self.runs.iter().filter(|run| self.foretold && !run.foretold);
        let own: Vec<&str> = own.map(|run| run.run.as_str()).collect();
        (!own.is_empty()).then(|| {
            format!(
                "Not foretold by the other repeats, which do not drive all that a curve is over, and so with the effects as fitted to the run itself: {}.",
                own.join(", ")
            )
        })
    }

    /// As JSON: keys in fixed order, numbers at full precision, a final newline.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn to_json(&self) -> Result<String> {
        let alone = Alone { format: "ballbar.diagnosis/1", facts: self };
        let mut text = serde_json::to_string_pretty(&alone).map_err(|error| {
            Error::new(Kind::Output, format!("the diagnosis cannot be written as JSON: {error}"))
        })?;
        text.push('\n');
        Ok(text)
    }
}

/// One effect that the model lacks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FindingFacts {
    /// What it is, in words.
    pub title: String,
    /// The name of its cause; `None` where no cause explains it.
    pub cause: Option<&'static str>,
    /// What it acts on, such as `EXX`, `Y` or `EZt`; empty where that is the whole.
    pub on: String,
    /// Whether a cause of the library explains it.
    pub named: bool,
    /// In which runs it is.
    pub owner: OwnerFacts,
    /// As `simulate --hide` takes it, one for each amplitude.
    #[serde(serialize_with = "as_hidden")]
    pub effects: Vec<Effect>,
    /// Its numbers.
    pub numbers: Vec<Number>,
    /// The numbers, in words.
    #[serde(rename = "told")]
    pub in_words: String,
    /// What follows from them, in sentences.
    pub remarks: Vec<String>,
    /// Root mean square of what it leaves in the residuals of the model, mm.
    #[serde(rename = "rms_um", serialize_with = "um")]
    pub rms_mm: f64,
    /// Residual with all that was found but this one, mm rms: what repairing the others would leave.
    #[serde(rename = "without_um", serialize_with = "um")]
    pub without_mm: f64,
    /// What it does, as an equation; empty where no cause explains it.
    pub equation: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// What to do about it.
    pub remedy: &'static str,
    /// What it is easily taken for.
    pub taken_for: &'static str,
    /// What else it could be, or could nearly be.
    pub rivals: Vec<Rival>,
    /// What it looks like by itself; `None` where it hangs on no single variable.
    pub picture: Option<Picture>,
    /// Where a curve without a cause is largest.
    pub feature: Option<Feature>,
}

fn as_hidden<S: Serializer>(
    effects: &[Effect],
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_seq(effects.iter().map(ToString::to_string))
}
