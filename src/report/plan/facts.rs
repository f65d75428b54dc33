//! What is told of tests that have not been run yet, as plain numbers with their units in the names.
//!
//! The schema is documented field by field in `docs/plan-schema.md`.

use serde::Serialize;

use crate::error::{Error, Kind, Result};
use crate::report::analysis::facts::{BallBarFacts, MachineFacts};

/// One or more tests before they are run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanReport {
    /// Name and version of the format: `ballbar.plan/1`.
    pub format: &'static str,
    /// Version of the program that wrote it.
    pub program_version: &'static str,
    /// How often each test is run.
    pub repeats: u32,
    /// The tests, in the order in which they were named.
    pub tests: Vec<TestOutlook>,
    /// What is compared between them, one entry a test.
    pub side_by_side: Vec<Comparison>,
}

impl PlanReport {
    /// The text of `plan.json`: keys in fixed order, numbers at full precision, a final newline.
    pub fn to_json(&self) -> Result<String> {
        let mut text = serde_json::to_string_pretty(self).map_err(|error| {
            Error::new(Kind::Output, format!("the plan cannot be written as JSON: {error}"))
        })?;
        text.push('\n');
        Ok(text)
    }
}

/// A standard deviation for one test, and of the mean over the repeats.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// One test.
    pub of_one: Option<f64>,
    /// The mean over the repeats: that of one by the root of their number.
    pub of_mean: Option<f64>,
}

/// One test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestOutlook {
    /// Its name.
    pub name: String,
    /// The test file as the user named it.
    pub file: String,
    /// SHA-256 of the text of the test file, in hexadecimal.
    pub sha256: String,
    /// On which machine.
    pub machine: MachineFacts,
    /// With what.
    pub ball_bar: BallBarFacts,
    /// That part of the noise which is correlated from one reading to the next, um.
    pub correlated_um: f64,
    /// Time in which its correlation falls to 1/e, s.
    pub correlation_s: f64,
    /// Name of the strategy, `free` without one.
    pub strategy: &'static str,
    /// Feed on the arcs, mm/min.
    pub feed_mm_min: f64,
    /// All feeds on the arcs, mm/min.
    pub feeds_mm_min: Vec<f64>,
    /// What is assumed of the operator.
    pub operator: OperatorFacts,
    /// The mountings.
    pub mountings: Vec<MountingOutlook>,
    /// Time of one test.
    pub time: TimeFacts,
    /// Time of all repeats, the balls set up once a mounting.
    pub time_of_repeats: TimeFacts,
    /// Samples on arcs of one test.
    pub samples: usize,
    /// What it will tell.
    pub sight: SightFacts,
    /// What it will know of what people ask, at the place of the test; empty where `terms` are named.
    pub at_the_place: Vec<ForeseenPlace>,
    /// How well it will know the parameters of the model.
    pub parameters: Vec<ParameterOutlook>,
    /// The same in people's units.
    pub machine_errors: ForeseenErrors,
    /// Standard deviation of the volumetric error that the noise makes.
    pub volume_noise: VolumeFacts,
    /// What the test leaves unknown of the volumetric error.
    pub volume_unseen: VolumeFacts,
    /// Root mean square displacement over the volume that any one coefficient is trusted with
    /// beforehand, for `volume_unseen`, um.
    pub unknown_um: f64,
    /// What the test cannot tell, and what would.
    pub unseen: Vec<UnseenTerm>,
    /// What a reader should know before he runs it.
    pub cautions: Vec<String>,
}

/// What a test will know of something that people ask.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForeseenPlace {
    /// What is asked, such as `squareness XY`.
    pub quantity: String,
    /// Unit of the numbers that follow.
    pub unit: &'static str,
    /// Standard deviation by the noise: what repeats will scatter.
    pub noise: Spread,
    /// Standard deviation by the noise and by what the test cannot tell from other plausible faults.
    pub all: Option<f64>,
    /// Where `all` is more than three times `noise`: the faults that would look the same, the gravest first.
    pub looks_like: Vec<String>,
}

/// What the test file assumes of the operator.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OperatorFacts {
    /// To place the balls and set the work offset, once a mounting, min.
    pub set_up_min: f64,
    /// To fit the bar, once an engagement, min.
    pub fit_bar_min: f64,
    /// To press start at an M00 between arcs, s.
    pub stop_s: f64,
}

/// One mounting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MountingOutlook {
    /// Its name.
    pub name: String,
    /// File name of its program.
    pub program: String,
    /// Machine coordinates at which both ball centres coincide, mm.
    pub coincidence_mm: [f64; 3],
    /// Tool ball in the frame of the last slide on the tool side, mm.
    pub tool_ball_mm: [f64; 3],
    /// Nominal length of the bar, mm.
    pub bar_length_mm: f64,
    /// Arcs that are driven, each direction for itself.
    pub arcs: usize,
    /// Ways from one arc to the next.
    pub transits: usize,
    /// Length of the arcs, mm.
    pub arcs_mm: f64,
    /// Length of the ways between them, mm.
    pub transits_mm: f64,
    /// Samples on arcs.
    pub samples: usize,
    /// Time of one test.
    pub time: TimeFacts,
    /// Travel that it needs, for X, Y and Z.
    pub travel: Vec<TravelFacts>,
    /// Where the bodies behind the balls come nearest; `None` where the machine file does not name them.
    pub clearance: Option<ClearanceFacts>,
}

/// Time by kind, s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TimeFacts {
    /// On the arcs.
    pub arcs_s: f64,
    /// On the sphere from one arc to the next.
    pub transits_s: f64,
    /// At feed elsewhere: approach, engagement, release.
    pub other_feed_s: f64,
    /// In dwells.
    pub dwell_s: f64,
    /// At rapid traverse.
    pub rapid_s: f64,
    /// All that the machine takes.
    pub machine_s: f64,
    /// Assumed for the operator.
    pub operator_s: f64,
    /// Both.
    pub total_s: f64,
    /// How often the program waits for the operator.
    pub stops: usize,
}

/// Travel of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TravelFacts {
    /// `X`, `Y` or `Z`.
    pub axis: char,
    /// Lowest and highest machine coordinate of the path, mm.
    pub used_mm: [f64; 2],
    /// Lowest and highest machine coordinate that the machine has, mm.
    pub limits_mm: [f64; 2],
    /// From the path to the nearer limit, mm.
    pub margin_mm: f64,
}

/// Where the bodies behind the balls come nearest to each other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClearanceFacts {
    /// Between the part and the support of the workpiece ball, mm; 0 where they touch.
    pub clearance_mm: f64,
    /// `tool` or `spindle nose`.
    pub part: String,
    /// The comment in the program before it.
    pub section: String,
    /// Vector from the workpiece ball to the tool ball there, mm.
    pub ball_mm: [f64; 3],
}

/// What a test will tell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SightFacts {
    /// The terms that were asked for.
    pub asked: Vec<String>,
    /// Whether the terms were chosen by what the test sees, rather than named.
    pub chosen: bool,
    /// Coefficients among the terms that the test determines, of 90.
    pub coefficients: usize,
    /// Set-up errors among the terms that the test determines.
    pub set_up_errors: usize,
    /// How many parameters the terms have.
    pub parameter_count: usize,
    /// Rank of the terms on ideal arcs.
    pub ideal_rank: usize,
    /// Rank of the terms through the noise.
    pub rank: usize,
    /// Condition number of the scaled columns over the observed directions.
    pub condition: Option<f64>,
    /// The largest standard deviation of the time of a sample, ms.
    pub worst_time_sigma_ms: f64,
}

/// How well a parameter will be known.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterOutlook {
    /// Its name.
    pub name: String,
    /// Unit of `sigma`.
    pub unit: &'static str,
    /// Its standard deviation; where `observed` is below 1 that of the observed part only.
    pub sigma: Spread,
    /// How much of it the test determines, 0 to 1.
    pub observed: f64,
}

/// How well the errors of a machine will be known; only what is estimated.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ForeseenErrors {
    /// Squareness of the axes to each other.
    pub squareness: Vec<ForeseenSquareness>,
    /// Scale errors of the axes.
    pub scale: Vec<ForeseenScale>,
    /// Backlash and lateral play.
    pub reversal: Vec<ForeseenReversal>,
    /// Hysteresis of rotations.
    pub angular_hysteresis: Vec<ForeseenHysteresis>,
}

/// Squareness of two axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForeseenSquareness {
    /// The coefficient that models it.
    pub name: String,
    /// What the paper calls it.
    pub symbol: &'static str,
    /// Which axes.
    pub axes: &'static str,
    /// Standard deviation of the angle, um/m (urad).
    pub sigma_um_m: Spread,
    /// The same, arcsec.
    pub sigma_arcsec: Spread,
    /// How much of it the test determines, 0 to 1.
    pub observed: f64,
}

/// Scale error of an axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForeseenScale {
    /// The coefficient.
    pub name: String,
    /// Standard deviation, um/m.
    pub sigma_um_m: Spread,
    /// How much of it the test determines, 0 to 1.
    pub observed: f64,
}

/// Hysteresis of a displacement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForeseenReversal {
    /// The coefficient.
    pub name: String,
    /// `backlash` or `lateral play`.
    pub kind: &'static str,
    /// Standard deviation of the step at a reversal, um: twice that of the coefficient.
    pub step_sigma_um: Spread,
    /// How much of it the test determines, 0 to 1.
    pub observed: f64,
}

/// Hysteresis of a rotation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForeseenHysteresis {
    /// The coefficient.
    pub name: String,
    /// Standard deviation of the step at a reversal, urad: twice that of the coefficient.
    pub step_sigma_urad: Spread,
    /// How much of it the test determines, 0 to 1.
    pub observed: f64,
}

/// Standard deviation of the volumetric error over the travel of the machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VolumeFacts {
    /// The coordinates of the grid along X, Y and Z, mm.
    pub grid_mm: [Vec<f64>; 3],
    /// At every point of the grid for one test, um; Z fastest, then Y, then X.
    pub sigma_um: Vec<f64>,
    /// Root mean square over the grid, um.
    pub rms_um: Spread,
    /// Machine coordinates of the point where it is largest, mm.
    pub worst_at_mm: [f64; 3],
    /// How large it is there, um.
    pub worst_um: Spread,
}

/// A term that a test cannot tell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnseenTerm {
    /// Its name.
    pub name: String,
    /// How it is confounded.
    pub reason: String,
    /// What would separate it; empty where nothing that was tried does.
    pub remedies: Vec<String>,
}

/// What is compared between tests.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Name of the test.
    pub test: String,
    /// Name of the strategy.
    pub strategy: &'static str,
    /// Number of mountings.
    pub mountings: usize,
    /// Time of all repeats, operator included, s.
    pub total_s: f64,
    /// What the machine takes of it, s.
    pub machine_s: f64,
    /// Samples on arcs of one test.
    pub samples: usize,
    /// Coefficients that the test determines, of 90.
    pub coefficients: usize,
    /// Condition number of the scaled columns over the observed directions.
    pub condition: Option<f64>,
    /// Standard deviation of each squareness, um/m.
    pub squareness: Vec<ComparedSquareness>,
    /// Largest standard deviation of a backlash, as the step at a reversal, um.
    pub worst_backlash_um: Spread,
    /// Root mean square over the travel of what the noise makes, um.
    pub volume_rms_um: Spread,
    /// The largest over the travel, um.
    pub volume_worst_um: Spread,
    /// Root mean square over the travel of what the test leaves unknown, um.
    pub unseen_rms_um: Option<f64>,
}

/// Squareness of two axes in a comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedSquareness {
    /// Which axes.
    pub axes: &'static str,
    /// Standard deviation of the angle, um/m; `None` where the test does not determine it.
    pub sigma_um_m: Spread,
}
