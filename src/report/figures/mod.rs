//! The figures of the report.

mod alignment;
mod hysteresis;
mod polar;
mod residuals;

pub(super) use alignment::{RunPicture, runs};
pub(super) use hysteresis::hysteresis;
pub(super) use polar::polar;
pub(super) use residuals::{against_angle, against_time, autocorrelation, histogram};

/// A figure and the sentence under it.
#[derive(Debug)]
pub(super) struct Figure {
    /// Inline SVG.
    pub(super) svg: String,
    /// What it shows; empty where the figures of a group share one sentence.
    pub(super) caption: String,
    /// It stands beside two of the others.
    pub(super) tall: bool,
}
