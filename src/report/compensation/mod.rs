//! Tables for a control: terminal, which is also the page beside the files, and JSON.

pub(super) mod facts;
pub(super) mod terminal;
mod words;

use crate::compensate::{Compensation, Shrunk, Sigmas};

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
    /// The compensation.
    pub of: &'a Compensation,
}
