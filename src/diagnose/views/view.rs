//! What a residual looks like against something.

use serde::Serialize;

use crate::machine::Axis;
use crate::written::um;

/// One stretch of a view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bin {
    /// Its middle, in the unit of the view.
    pub center: f64,
    /// Residual of the model there, mm; of a spectrum the amplitude.
    #[serde(rename = "before_um", serialize_with = "um")]
    pub before_mm: f64,
    /// Residual of the extended model there, mm; of a spectrum the amplitude.
    #[serde(rename = "after_um", serialize_with = "um")]
    pub after_mm: f64,
    /// Standard deviation of either by noise alone, mm; of a spectrum the amplitude that noise has.
    #[serde(rename = "sigma_um", serialize_with = "um")]
    pub sigma_mm: f64,
    /// Samples in it.
    pub count: usize,
}

/// What a view is about: views about the same look alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// The position of a slide, whichever it is.
    Position,
    /// The velocity of a slide, whichever it is.
    Velocity,
    /// The time since this slide reversed.
    SinceReversal(Axis),
    /// The time since the program began.
    Elapsed,
    /// The azimuth of the bar.
    Azimuth,
    /// The polar angle of the bar.
    PolarAngle,
    /// The feed.
    Feed,
    /// The angle on a circle, whichever it is.
    Circle,
    /// Waves over the position of a slide, whichever it is.
    PositionSpectrum,
    /// Waves in time.
    TimeSpectrum,
}

/// What the values of a view are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ViewKind {
    /// Means over stretches.
    Means,
    /// Amplitudes over a wave number or a frequency.
    Spectrum,
}

/// The residual before and after, against something.
///
/// The model of a view is `e = w m(x)`: `x` what it is against, `m` its bins, and `w` how a sample counts: 1,
/// the sense of a slide, the component of the bar's direction along an axis, or a product of these. Its
/// share of the variance is cross-validated: with `m` of all other runs (of all other arcs, where there is
/// one run), `share = 1 - sum (e - w m)² / sum e²`, so that noise scores nothing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct View {
    /// What it is about.
    #[serde(skip)]
    pub subject: Subject,
    /// What it is against, such as `position of X`.
    pub variable: String,
    /// How samples count, such as `along X`; empty where they count as they are read.
    pub counted: String,
    /// Unit of the variable: `mm`, `s`, `deg`, `mm/s`, `mm/min`, `1/mm` or `Hz`.
    pub unit: &'static str,
    /// Means or amplitudes.
    pub kind: ViewKind,
    /// Share of the variance before that it foretells; below 0 by chance.
    pub share_before: f64,
    /// The same of the variance after.
    pub share_after: f64,
    /// The bins that have samples, ascending.
    pub bins: Vec<Bin>,
}

impl View {
    /// What it is against and how samples count.
    pub fn name(&self) -> String {
        if self.counted.is_empty() {
            self.variable.clone()
        } else {
            format!("{}, {}", self.variable, self.counted)
        }
    }
}
