//! What is told of the features of planes, as plain numbers.
//!
//! The schema is documented field by field in `docs/analysis-schema.md`.

use serde::Serialize;

/// Features of the planes of circular tests.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RankingFacts {
    /// One entry a circular test in a coordinate plane, in the order in which they were driven.
    pub tests: Vec<RankingResult>,
    /// Why a repeat has none, a sentence each.
    pub untold: Vec<String>,
}

/// The features of the plane of a circular test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RankingResult {
    /// The repeat that it is of.
    pub repeat: u32,
    /// Such as `XY plane F1000`.
    pub test: String,
    /// What falls: `G(b)`, of one way `G`.
    pub deviation: &'static str,
    /// That, as it was read, um.
    pub deviation_um: f64,
    /// The volumetric error over the sphere that was measured, um rms; `None` where not all axes moved.
    pub volumetric_um: Option<f64>,
    /// In the order of repair, then what is not told apart from 0.
    pub features: Vec<FeatureResult>,
    /// By how much the deviation falls without all those together that are not told apart from 0, um.
    pub untold_fall_um: f64,
    /// What is left of it without any feature, um.
    pub left_um: f64,
    /// What the program's own chords and rounding make of it by themselves, um.
    pub commanded_um: f64,
    /// What noise makes of it by itself, and whatever the model does not explain, um.
    pub unexplained_um: f64,
    /// What was looked for and not found.
    pub not_found: Vec<String>,
    /// What does less than this to the readings would not have been found, um rms; `None` where nobody looked.
    pub smallest_um: Option<f64>,
}

/// A feature.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeatureResult {
    /// What it is, such as `squareness XY`.
    pub feature: String,
    /// What its sign means; empty where it has none.
    pub in_words: String,
    /// What is done about it; empty where nobody knows.
    pub what_to_do: &'static str,
    /// Unit of the numbers that follow: `um`, `um/m`, `urad`, `ms` or that of a finding.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
    /// At the positive end of its axis.
    pub positive_end: Option<f64>,
    /// At the negative end.
    pub negative_end: Option<f64>,
    /// Standard deviation by the noise.
    pub noise: Option<f64>,
    /// Standard deviation by the noise and by what these runs cannot tell from other plausible faults.
    pub all: Option<f64>,
    /// Whether the value is larger than twice that.
    pub told_apart_from_0: bool,
    /// What Ballbar 20 ranks it by, um; `None` of what it does not know.
    pub size_um: Option<f64>,
    /// That as a share of all, percent.
    pub share_percent: Option<f64>,
    /// By how much the deviation falls without it, um.
    pub fall_um: f64,
    /// Standard deviation of the fall by the noise of the value, um.
    pub fall_noise_um: Option<f64>,
    /// And by all that is not known of it, um.
    pub fall_all_um: Option<f64>,
    /// By how much the volumetric error falls without it, um rms.
    pub volumetric_fall_um: Option<f64>,
    /// What is left of the deviation once it and those before it are gone, um; `None` of what is not told apart from 0.
    pub left_um: Option<f64>,
    /// And of the volumetric error, um rms.
    pub volumetric_left_um: Option<f64>,
}
