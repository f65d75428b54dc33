//! What the model gets wrong, as plain numbers: the key `diagnosis` of `analysis.json`.
//!
//! The schema is documented field by field in `docs/analysis-schema.md`.

use serde::Serialize;

use crate::error::{Error, Kind, Result};

/// What the model gets wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosisFacts {
    /// The verdict, a sentence an entry, the gravest first.
    pub verdict: Vec<String>,
    /// Whether nothing was found that these runs would show.
    pub nothing_found: bool,
    /// Residual of the model, um rms.
    pub before_um: f64,
    /// Residual of the model with everything that was found, um rms.
    pub after_um: f64,
    /// What repeats of the one; `None` where no program ran twice.
    pub structure_before: Option<StructureFacts>,
    /// What repeats of the other.
    pub structure_after: Option<StructureFacts>,
    /// Noise of one reading by its neighbours, um.
    pub neighbours_um: f64,
    /// How many independent readings tell as much as all do.
    pub effective_samples: f64,
    /// Samples that were looked at.
    pub samples: usize,
    /// Share of what was there to explain that is explained, on runs that took no part, 0 to 1.
    pub explained: Option<f64>,
    /// Its 95 % interval.
    pub explained_interval: Option<[f64; 2]>,
    /// Effects smaller than this would not have been named, um rms.
    pub smallest_um: f64,
    /// What was found, the largest first.
    pub findings: Vec<FindingFacts>,
    /// The gain on every run, from the others.
    pub runs: Vec<RunGainFacts>,
    /// The gain on every program, from the others.
    pub programs: Vec<ProgramGainFacts>,
    /// Coefficients that moved by more than their sigma.
    pub moved: Vec<MovedFacts>,
    /// The residual against everything, the views that hold most structure first.
    pub views: Vec<ViewFacts>,
    /// How much of what is left on each arc repeats.
    pub arcs: Vec<ArcFacts>,
    /// What these runs cannot see or tell apart, in sentences.
    pub unseen: Vec<String>,
    /// What the machine file or the test file states wrong; all else is with it put right.
    pub wrong_settings: Vec<WrongSettingFacts>,
    /// Runs whose feed or clock is not as the test file states.
    pub off_times: Vec<OffTimeFacts>,
    /// Runs that took no part.
    pub left_out: Vec<LeftOutFacts>,
}

impl DiagnosisFacts {
    /// As JSON: keys in fixed order, numbers at full precision, a final newline.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn to_json(&self) -> Result<String> {
        let mut text = serde_json::to_string_pretty(self).map_err(|error| {
            Error::new(Kind::Output, format!("the diagnosis cannot be written as JSON: {error}"))
        })?;
        text.push('\n');
        Ok(text)
    }
}

/// A run whose feed or clock is not as the test file states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OffTimeFacts {
    /// Its name.
    pub run: String,
    /// Feed override as stated, percent.
    pub stated_percent: f64,
    /// And as it explains the log, percent.
    pub percent: f64,
    /// Its standard deviation, percent.
    pub sigma_percent: f64,
    /// By how much the clock would be off instead, parts per million.
    pub clock_ppm: f64,
    /// What is likelier: `feed-override` or `clock`.
    pub cause: &'static str,
}

/// Something that the machine file or the test file states wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WrongSettingFacts {
    /// `pivot` or `ball-place`.
    pub cause: &'static str,
    /// As `simulate --hide` takes it.
    pub effect: String,
    /// The slide, or the ball and its direction, such as `EZt`.
    pub on: String,
    /// How the setting is in truth, in words.
    pub told: String,
    /// Residual with the setting as it is stated, um rms.
    pub before_um: f64,
    /// And as it is in truth.
    pub after_um: f64,
}

/// What repeats of a residual.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StructureFacts {
    /// Root mean square, um; 0 where chance makes its square negative.
    pub rms_um: f64,
    /// Its square, um²; chance may make it negative.
    pub variance_um2: f64,
    /// Standard deviation of the square, um².
    pub sigma_um2: f64,
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
    pub owner: String,
    /// As `simulate --hide` takes it, one for each amplitude.
    pub effects: Vec<String>,
    /// Its numbers.
    pub numbers: Vec<NumberFacts>,
    /// The numbers, in words.
    pub told: String,
    /// What follows from them, in sentences.
    pub remarks: Vec<String>,
    /// Root mean square of what it leaves in the residuals of the model, um.
    pub rms_um: f64,
    /// Residual with all that was found but this one, um rms: what repairing the others would leave.
    pub without_um: f64,
    /// What it does, as an equation; empty where no cause explains it.
    pub equation: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// What to do about it.
    pub remedy: &'static str,
    /// What it is easily taken for.
    pub taken_for: &'static str,
    /// What else it could be, or could nearly be.
    pub rivals: Vec<RivalFacts>,
    /// What it looks like by itself; `None` where it hangs on no single variable.
    pub picture: Option<PictureFacts>,
    /// Where a curve without a cause is largest.
    pub feature: Option<FeatureFacts>,
}

/// A number of a finding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NumberFacts {
    /// Its name with its unit, such as `amplitude_um`.
    pub name: String,
    /// Its value in that unit.
    pub value: f64,
    /// Its standard deviation in that unit; `None` where it is not estimated.
    pub sigma: Option<f64>,
}

/// Another explanation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RivalFacts {
    /// What it is called, such as `cyclic EBX 10 mm`.
    pub name: String,
    /// What it explains of what the named one does, 0 to 1.
    pub share: f64,
    /// `same`: never to be told apart with these runs; `undecided`: within the noise; `apart`: it explains
    /// less.
    pub told: &'static str,
}

/// The largest part of a curve without a cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeatureFacts {
    /// What the curve hangs on, such as `position of X`.
    pub variable: String,
    /// Unit of the variable.
    pub variable_unit: &'static str,
    /// Unit of the curve: `um` or `urad`.
    pub unit: &'static str,
    /// Where it is largest, in the unit of the variable.
    pub at: f64,
    /// How large it is there, with its sign, in the unit of the curve.
    pub height: f64,
    /// Width at half the height, in the unit of the variable.
    pub width: f64,
    /// Knots of the curve, in the unit of the variable.
    pub knots: Vec<f64>,
    /// The curve at the knots, in the unit of the curve, without what the model spans anyway.
    pub values: Vec<f64>,
}

/// An effect over what it hangs on, with what is left around it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PictureFacts {
    /// What it hangs on, such as `position of X, within a period`.
    pub variable: String,
    /// Unit of that.
    pub variable_unit: &'static str,
    /// Unit of the values: `um` or `urad`.
    pub unit: &'static str,
    /// The points, ascending.
    pub points: Vec<PointFacts>,
}

/// A point of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PointFacts {
    /// In the unit of the variable.
    pub at: f64,
    /// The effect with what is left around it.
    pub measured: f64,
    /// The effect as it was fitted.
    pub fitted: f64,
    /// Standard deviation of `measured` by noise.
    pub sigma: f64,
}

/// The residual before and after, against something.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ViewFacts {
    /// What it is against, such as `position of X`.
    pub variable: String,
    /// How samples count, such as `along X`; empty where they count as they are read.
    pub counted: String,
    /// Unit of the variable.
    pub unit: &'static str,
    /// `means` or `spectrum`.
    pub kind: &'static str,
    /// Share of the variance before that it foretells, cross-validated; below 0 by chance.
    pub share_before: f64,
    /// The same of the variance after.
    pub share_after: f64,
    /// The bins of the views that the report draws; of the others none.
    pub bins: Vec<BinFacts>,
}

/// A stretch of a view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BinFacts {
    /// Its middle, in the unit of the view.
    pub center: f64,
    /// Mean residual of the model, or its amplitude, um.
    pub before_um: f64,
    /// Mean residual of the extended model, or its amplitude, um.
    pub after_um: f64,
    /// Standard deviation of a mean by noise, or the amplitude that noise has, um.
    pub sigma_um: f64,
    /// Samples.
    pub count: usize,
}

/// An arc over all runs of one program.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArcFacts {
    /// Its name in the program.
    pub name: String,
    /// Feed, mm/min.
    pub feed_mm_min: f64,
    /// How many runs drove it.
    pub run_count: usize,
    /// Samples.
    pub samples: usize,
    /// Residual of the model, um rms.
    pub before_um: f64,
    /// Residual of the extended model, um rms.
    pub after_um: f64,
    /// Share of the variance before that repeats; `None` where no other run drove it; below 0 by chance.
    pub structure_share_before: Option<f64>,
    /// The same of the variance after.
    pub structure_share_after: Option<f64>,
}

/// The gain on one run that took no part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunGainFacts {
    /// Name of the run.
    pub run: String,
    /// Samples.
    pub samples: usize,
    /// Without what was found, um rms.
    pub before_um: f64,
    /// With it, as the other repeats have it, um rms.
    pub after_um: f64,
    /// What does not repeat, um rms.
    pub floor_um: f64,
    /// Share of what was there to explain that is explained; `None` where nothing was.
    pub explained: Option<f64>,
}

/// The gain on the runs of one program, from those of the others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProgramGainFacts {
    /// Runs that took no part.
    pub runs: Vec<String>,
    /// Their feed, mm/min.
    pub feed_mm_min: f64,
    /// Without what was found, um rms.
    pub before_um: f64,
    /// With it, as the runs of all other programs have it, um rms.
    pub after_um: f64,
}

/// A coefficient that was biased by what the model lacked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MovedFacts {
    /// Its name.
    pub name: String,
    /// Unit of the four numbers that follow.
    pub unit: &'static str,
    /// Without what was found.
    pub before: f64,
    /// With it.
    pub after: f64,
    /// Standard deviation in one repeat without it.
    pub sigma_before: f64,
    /// And with it.
    pub sigma_after: f64,
}

/// A run that took no part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOutFacts {
    /// Its name, or the names of the runs that were to be identified together.
    pub run: String,
    /// Why.
    pub reason: String,
    /// What to do about it.
    pub hint: Option<String>,
}
