//! What is told of a run, as plain numbers with their units in the names of the fields.

use serde::Serialize;

use super::control::ControlResult;

/// What became of the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SampleCounts {
    /// Took part in the fit.
    pub used: usize,
    /// Took part, but their residual was too large to be believed.
    pub rejected: usize,
    /// Did not take part: ramps, dwells, pauses, and reversals within the uncertainty of time.
    pub not_used: usize,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunResult {
    /// Its name.
    pub name: String,
    /// The program that ran; empty where the test file does not name the run.
    pub program: String,
    /// The log; empty where the test file does not name the run.
    pub log: String,
    /// Name of the mounting.
    pub mounting: String,
    /// By how much the machine's clock runs faster than the instrument's, ppm.
    pub clock_rate_ppm: f64,
    /// Its standard deviation, ppm.
    pub clock_rate_sigma_ppm: Option<f64>,
    /// The override knob.
    pub feed_override: FeedOverride,
    /// Log time at which the program engages the bar, s.
    pub engagement_log_s: f64,
    /// Log time minus program time on the first leg that has samples, s.
    pub start_offset_s: f64,
    /// Its standard deviation, ms.
    pub start_offset_sigma_ms: Option<f64>,
    /// Largest standard deviation of the program time of a used sample, ms.
    pub worst_time_sigma_ms: Option<f64>,
    /// Period of the samples, s.
    pub sample_period_s: f64,
    /// How many readings of the log a sample is the mean of.
    pub averaged: usize,
    /// Moments known on both clocks.
    pub marks: Vec<MarkResult>,
    /// Operator's pauses.
    pub pauses: Vec<PauseResult>,
    /// How the control drove.
    pub control: ControlResult,
    /// Root mean square of the residuals of the samples that were used, um.
    pub residual_rms_um: f64,
    /// What became of the samples.
    pub samples: SampleCounts,
    /// The arcs that have used samples, in the order in which they were driven.
    pub arcs: Vec<ArcResult>,
    /// The first of the rejected samples; `samples.rejected` counts them all.
    pub rejected_samples: Vec<RejectedSample>,
}

/// The override knob.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FeedOverride {
    /// Where it stood, by the test file, percent.
    pub stated_percent: f64,
    /// By how much the real feed exceeds that, by the log, percent; 0 where nothing told otherwise.
    pub excess_percent: f64,
    /// Standard deviation of the excess, percent; `None` where it was not estimated.
    pub excess_sigma_percent: Option<f64>,
}

/// A moment known on both clocks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MarkResult {
    /// `engagement`, `release` or `standstill`.
    pub kind: &'static str,
    /// On the instrument's clock, s.
    pub log_s: f64,
    /// In program time, s.
    pub program_s: f64,
    /// Standard deviation of their difference, ms.
    pub sigma_ms: f64,
    /// Samples of the ramp that made it.
    pub samples: usize,
    /// What the final time map leaves of it: its program time minus that of the map, ms.
    pub left_ms: Option<f64>,
}

/// An M00.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PauseResult {
    /// Its program time, s.
    pub program_s: f64,
    /// How long the operator let the machine stand, s; `None` where the log cannot tell.
    pub length_s: Option<f64>,
    /// Standard deviation of the length, ms.
    pub sigma_ms: Option<f64>,
}

/// Residuals of one arc.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArcResult {
    /// Its name in the program.
    pub name: String,
    /// The circle.
    pub circle: String,
    /// `forward` or `backward`; in a coordinate plane `CCW` or `CW`.
    pub direction: &'static str,
    /// A way to the next arc rather than an arc.
    pub transit: bool,
    /// Beginning in program time, s.
    pub start_s: f64,
    /// End in program time, s.
    pub end_s: f64,
    /// Angle that it covers, degrees.
    pub sweep_deg: f64,
    /// Beginning of its data arc in program time, s; before it and after its end is overshoot.
    pub data_start_s: f64,
    /// End of its data arc in program time, s.
    pub data_end_s: f64,
    /// Feed, mm/min.
    pub feed_mm_min: f64,
    /// Samples that were used.
    pub samples: usize,
    /// Root mean square of the residuals, um.
    pub rms_um: f64,
    /// Mean of the residuals, um.
    pub mean_um: f64,
    /// Largest magnitude of a residual, um.
    pub worst_um: f64,
}

/// A sample that was too far off to be believed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RejectedSample {
    /// Line of the log.
    pub log_line: usize,
    /// Time on the instrument's clock, s.
    pub log_s: f64,
    /// Residual, um.
    pub residual_um: f64,
}
