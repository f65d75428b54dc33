//! What a writer is given and gives.

/// What a control takes; the defaults of each can be stated otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Points of a table at the most.
    pub most_points: usize,
    /// Tables at the most.
    pub most_tables: usize,
    /// Step of its numbers, mm.
    pub unit_mm: f64,
    /// Distance of the points; `None`: a twentieth of what was measured, or what the points allow, mm.
    pub step_mm: Option<f64>,
}

/// A file of a control, name and text.
pub type Named = (String, String);

/// What was written for a control.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Written {
    /// The files.
    pub files: Vec<Named>,
    /// How they are loaded, in the order in which it is done.
    pub load: Vec<String>,
    /// What is not certain of the format.
    pub unsure: Vec<String>,
    /// What of the functions did not fit the control's limits.
    pub lost: Vec<String>,
}

/// What is smaller over all that was measured is not written, mm.
pub(super) const SMALLEST_MM: f64 = 0.1e-3;
