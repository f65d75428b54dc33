//! The map of the volumetric error: terminal, JSON, CSV and page.

pub(super) mod facts;
mod figures;
pub(super) mod html;
pub(super) mod terminal;
mod words;

use nalgebra::Vector3;

use crate::compensate::{ErrorModel, VolumeMap};

/// A map, and of what it is.
#[derive(Debug)]
pub struct Mapped<'a> {
    /// Name of the test.
    pub test: String,
    /// The analysis, or the test file.
    pub file: String,
    /// What compensation was active when it was measured, as the test file states it.
    pub compensation: Option<String>,
    /// The errors of the machine.
    pub errors: &'a ErrorModel,
    /// Tip of the tool in the frame of the last slide on the tool side, mm.
    pub tool_ball_mm: Vector3<f64>,
    /// The map.
    pub map: VolumeMap,
}
