//! What was measured before there was a test file.

use super::test_kind::TestKind;
use crate::plan::Planes;
use crate::plan::log_format::LengthUnit;

/// A log by angle of one plane, and what the test file must say of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Where it is, as the test file names it.
    pub log: String,
    /// How much of each arc its readings stand on, degrees.
    pub arc_deg: f64,
    /// Whether the log itself does not say that.
    pub states_arc: bool,
    /// The unit of its readings, where its user says it.
    pub unit: Option<LengthUnit>,
    /// Whether the log does not say its plane.
    pub states_plane: bool,
}

impl Measured {
    /// Whether nothing says where its arc began: a whole circle begins at its first axis, a part of one in a plane of the
    /// tool axis lies to both sides of that.
    pub fn begins_anywhere(&self, test: TestKind) -> bool {
        test == TestKind::Planes(Planes::Xy) && self.arc_deg < 360.0
    }
}
