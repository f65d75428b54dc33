//! `analysis.json` as it is written: what of it a comparison needs, unchecked.
//!
//! Keys that came later have defaults; what is not known is passed over.

use serde::Deserialize;

#[derive(Deserialize)]
pub(super) struct RawHead {
    pub(super) format: Option<String>,
    pub(super) program_version: Option<String>,
}

#[derive(Deserialize)]
pub(super) struct RawAnalysis {
    pub(super) test: RawTest,
    pub(super) machine: RawMachine,
    #[serde(default)]
    pub(super) strategy: Option<String>,
    #[serde(default)]
    pub(super) terms: Vec<String>,
    #[serde(default)]
    pub(super) repeats: Vec<RawRepeat>,
    #[serde(default)]
    pub(super) at_the_place: Vec<RawPlace>,
    #[serde(default)]
    pub(super) circular: RawCircular,
    #[serde(default)]
    pub(super) diagnosis: Option<RawDiagnosis>,
}

#[derive(Deserialize)]
pub(super) struct RawTest {
    pub(super) name: String,
    #[serde(default)]
    pub(super) readings_sha256: Option<String>,
    #[serde(default)]
    pub(super) date: Option<String>,
    #[serde(default)]
    pub(super) record: Option<RawRecord>,
    #[serde(default)]
    pub(super) mountings: Vec<RawMounting>,
}

#[derive(Deserialize, Default)]
pub(super) struct RawRecord {
    #[serde(default)]
    pub(super) date: Option<String>,
    #[serde(default)]
    pub(super) machine_serial: Option<String>,
    #[serde(default)]
    pub(super) bar_serial: Option<String>,
    #[serde(default)]
    pub(super) compensation: Option<String>,
}

#[derive(Deserialize)]
pub(super) struct RawMounting {
    pub(super) name: String,
    pub(super) coincidence_mm: [f64; 3],
    pub(super) tool_ball_mm: [f64; 3],
    pub(super) bar_length_mm: f64,
}

#[derive(Deserialize)]
pub(super) struct RawMachine {
    pub(super) name: String,
    pub(super) topology: String,
    pub(super) pivots: RawPivots,
}

#[derive(Deserialize)]
pub(super) struct RawPivots {
    pub(super) x: String,
    pub(super) y: String,
    pub(super) z: String,
}

#[derive(Deserialize)]
pub(super) struct RawRepeat {
    #[serde(default)]
    pub(super) runs: Vec<RawRun>,
}

#[derive(Deserialize)]
pub(super) struct RawRun {
    #[serde(default)]
    pub(super) mounting: String,
    #[serde(default)]
    pub(super) arcs: Vec<RawArc>,
}

#[derive(Deserialize)]
pub(super) struct RawArc {
    pub(super) circle: String,
    pub(super) direction: String,
    pub(super) sweep_deg: f64,
    pub(super) feed_mm_min: f64,
}

#[derive(Deserialize)]
pub(super) struct RawPlace {
    pub(super) quantity: String,
    pub(super) unit: String,
    pub(super) value: f64,
    #[serde(default)]
    pub(super) noise: Option<f64>,
    #[serde(default)]
    pub(super) all: Option<f64>,
    #[serde(default)]
    pub(super) plausible: Option<f64>,
    #[serde(default)]
    pub(super) deviation: Option<f64>,
    #[serde(default)]
    pub(super) looks_like: Vec<String>,
}

#[derive(Deserialize, Default)]
pub(super) struct RawCircular {
    #[serde(default)]
    pub(super) tests: Vec<RawCircle>,
}

#[derive(Deserialize)]
pub(super) struct RawCircle {
    pub(super) circle: String,
    pub(super) diameter_mm: f64,
    pub(super) feed_mm_min: f64,
    pub(super) centre_mm: [f64; 3],
    pub(super) sweep_deg: f64,
    pub(super) ways: Vec<RawWay>,
    #[serde(default)]
    pub(super) bidirectional_circular_deviation: Option<RawValue>,
    #[serde(default)]
    pub(super) mean_bidirectional_radial_deviation: Option<RawValue>,
    #[serde(default)]
    pub(super) circular_hysteresis: Option<RawValue>,
}

#[derive(Deserialize)]
pub(super) struct RawWay {
    pub(super) direction: String,
    pub(super) circular_deviation: RawValue,
}

#[derive(Deserialize, Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "the names of the file")]
pub(super) struct RawValue {
    pub(super) value_um: f64,
    pub(super) noise_um: f64,
    #[serde(default)]
    pub(super) widened_um: f64,
    #[serde(default)]
    pub(super) sigma_um: Option<f64>,
}

#[derive(Deserialize)]
pub(super) struct RawDiagnosis {
    #[serde(default)]
    pub(super) findings: Vec<RawFinding>,
    #[serde(default)]
    pub(super) smallest_um: Option<f64>,
}

#[derive(Deserialize)]
pub(super) struct RawFinding {
    pub(super) title: String,
    #[serde(default)]
    pub(super) cause: Option<String>,
    #[serde(default)]
    pub(super) on: String,
    #[serde(default)]
    pub(super) numbers: Vec<RawNumber>,
    pub(super) rms_um: f64,
}

#[derive(Deserialize)]
pub(super) struct RawNumber {
    pub(super) name: String,
    pub(super) value: f64,
    #[serde(default)]
    pub(super) sigma: Option<f64>,
}
