//! Tables for a control: terminal, which is also the page beside the files, and JSON.

pub(super) mod facts;
pub(super) mod terminal;
mod words;

use crate::compensate::{Compensation, Shrunk, Sigmas};
use crate::report::text::numbers::fixed;

/// A compensation, and of what it is.
#[derive(Debug)]
pub struct Compensated<'a> {
    /// Name of the test.
    pub test: String,
    /// Name of the machine.
    pub machine: String,
    /// The analysis, or the test file.
    pub file: String,
    /// What compensation was active when it was measured, as the test file states it.
    pub active: Option<String>,
    /// What a diagnosis found, with what each leaves in the residual, mm rms.
    pub found: &'a [(String, f64)],
    /// What was shrunk because it is smaller than its uncertainty.
    pub shrunk: Shrunk,
    /// The volumetric error where something was measured near, before and after that, mm rms.
    pub shrunk_mm: [f64; 2],
    /// What is not known of it, mm rms.
    pub unknown: Sigmas,
    /// By how many times their noise the repeats differ, where the machine changed between them.
    pub changed: Option<f64>,
    /// The compensation.
    pub of: &'a Compensation,
}

/// That errors are the mean of machines that were not the same: repeats differ by so many times their noise.
pub fn changed_between_repeats(times: f64) -> String {
    format!(
        "Between the repeats the errors changed by up to {} times their noise: the machine or its set-up is not what it was, and this is for the mean. Find out what changed and measure again before you trust it.",
        fixed(times, 0)
    )
}
