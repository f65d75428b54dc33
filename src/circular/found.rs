//! A value and what is known of it.

/// A value with what noise does to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The value as it was read, mm.
    pub value_mm: f64,
    /// Standard deviation by the noise: what repeats would scatter, mm.
    pub noise_mm: f64,
    /// By how much noise makes it larger on average, mm.
    pub widened_mm: f64,
}

/// One way over an arc, and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// The run.
    pub run: String,
    /// Name of the arc.
    pub arc: String,
    /// CCW and CW in planes.
    pub direction: &'static str,
    /// Where the data arc begins on the circle, rad.
    pub start_rad: f64,
    /// Points that the values are of.
    pub points: usize,
    /// Readings that the fit did not believe, and that are not among them.
    pub rejected: usize,
    /// The largest angle without a reading, rad.
    pub gap_rad: f64,
    /// G by minimum zone.
    pub circular: Found,
    /// The range about the least-squares circle.
    pub circular_by_squares: Found,
    /// F max and F min; `None` on a part of a circle.
    pub radial: Option<[Found; 2]>,
    /// The readings that the values are of.
    pub path: WayPath,
}

/// The readings of a way, by angle.
#[derive(Debug, Clone, PartialEq)]
pub struct WayPath {
    /// Index of the run among those that were identified together.
    pub run: usize,
    /// Which of its records they are.
    pub records: Vec<usize>,
    /// Where they lie on the circle, rad.
    pub angle_rad: Vec<f64>,
    /// What was read, mm.
    pub read_mm: Vec<f64>,
}
