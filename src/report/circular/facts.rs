//! What is told of circular tests and tolerances, as plain numbers.
//!
//! The schema is documented field by field in `docs/analysis-schema.md`.

use serde::Serialize;

/// Circular tests, and what the tolerances of the test file say.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct CircularFacts {
    /// One entry an arc that was driven, both ways together.
    pub tests: Vec<CircularResult>,
    /// Arcs without some or all values, a sentence each.
    pub untold: Vec<String>,
    /// `None` where the test file has no tolerances.
    pub conformity: Option<ConformityResult>,
}

/// A circular test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CircularResult {
    /// The repeat that it is of.
    pub repeat: u32,
    /// Name of the mounting.
    pub mounting: String,
    /// The circle, such as `XY plane`; with its mounting where a test has several.
    pub circle: String,
    /// Nominal diameter, mm.
    pub diameter_mm: f64,
    /// Feed, mm/min.
    pub feed_mm_min: f64,
    /// Machine coordinates of its centre, mm.
    pub centre_mm: [f64; 3],
    /// Angle of the data arc, degrees.
    pub sweep_deg: f64,
    /// Whether it goes round, with readings all the way.
    pub whole: bool,
    /// Condition number of centre and radius: 1 of a whole circle.
    pub centre_condition: Option<f64>,
    /// What was done to the readings.
    pub filter: String,
    /// The ways, CCW first.
    pub ways: Vec<WayResult>,
    /// G(b) by minimum zone.
    pub bidirectional_circular_deviation: Option<CircularValue>,
    /// The range of both ways about the least-squares circle.
    pub bidirectional_circular_deviation_least_squares: Option<CircularValue>,
    /// D; of whole circles.
    pub mean_bidirectional_radial_deviation: Option<CircularValue>,
    /// H of ISO 230-4:1996.
    pub circular_hysteresis: Option<CircularValue>,
}

/// One way over an arc.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WayResult {
    /// `CCW` and `CW` in planes.
    pub direction: &'static str,
    /// Name of the run.
    pub run: String,
    /// Name of the arc.
    pub arc: String,
    /// Where the data arc begins on the circle, degrees.
    pub start_deg: f64,
    /// Points that the values are of.
    pub points: usize,
    /// Readings that the fit did not believe, and that are not among them.
    pub rejected: usize,
    /// The largest angle without a reading, degrees.
    pub largest_gap_deg: f64,
    /// G by minimum zone.
    pub circular_deviation: CircularValue,
    /// The range about the least-squares circle.
    pub circular_deviation_least_squares: CircularValue,
    /// F max; of whole circles.
    pub radial_deviation_max: Option<CircularValue>,
    /// F min; of whole circles.
    pub radial_deviation_min: Option<CircularValue>,
}

/// A value with what is known of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CircularValue {
    /// As it was read, um.
    pub value_um: f64,
    /// Standard deviation by the noise, um.
    pub noise_um: f64,
    /// By how much noise makes it larger on average, um; it is not taken off.
    pub widened_um: f64,
    /// Standard uncertainty, um: noise, the scale of the transducer, and of F and D the length of the bar; `None` where that
    /// is not stated.
    pub sigma_um: Option<f64>,
}

/// What the tolerances of the test file say.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConformityResult {
    /// The rule of decision, in words.
    pub rule: &'static str,
    /// The worst of all.
    pub verdict: Verdict,
    /// One entry for each value that has a tolerance; of repeats the worst.
    pub items: Vec<ConformityItem>,
}

/// A value and its tolerance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConformityItem {
    /// What is judged, such as `G(b) XY plane F1000`.
    pub quantity: String,
    /// Its magnitude; `None` where it was not measured.
    pub value: Option<f64>,
    /// Its expanded uncertainty; `None` where it is not known.
    pub expanded: Option<f64>,
    /// The tolerance.
    pub limit: f64,
    /// Unit of the three: `um` or `um/m`.
    pub unit: &'static str,
    /// What follows.
    pub verdict: Verdict,
    /// Why it is not decided; empty else.
    pub why: String,
}

/// Pass or fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Verdict {
    /// Value and uncertainty lie within the tolerance.
    #[serde(rename = "pass")]
    Pass,
    /// The tolerance lies within the uncertainty of the value.
    #[serde(rename = "within the uncertainty")]
    WithinUncertainty,
    /// The value or its uncertainty is not known.
    #[serde(rename = "not decided")]
    NotDecided,
    /// Value and uncertainty lie beyond the tolerance.
    #[serde(rename = "fail")]
    Fail,
}

impl Verdict {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::WithinUncertainty => "within the uncertainty",
            Self::NotDecided => "not decided",
            Self::Fail => "fail",
        }
    }
}
