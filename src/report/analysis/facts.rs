//! Everything that is told, as plain numbers with their units in the names of the fields.
//!
//! The schema is documented field by field in `docs/analysis-schema.md`.

use serde::Serialize;

use super::machine_errors::MachineErrors;
use super::means::MeanResult;
use super::place::PlaceResult;
use super::run_facts::{RunResult, SampleCounts};
use crate::compensate::Stored;
use crate::error::{Error, Kind, Result};
use crate::plan::Record;
use crate::report::circular::facts::CircularFacts;
use crate::report::diagnosis::facts::DiagnosisFacts;
use crate::report::ranked::facts::RankingFacts;
use crate::solve::Loss;

/// The results of a test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// Name and version of the format: `ballbar.analysis/2`.
    pub format: &'static str,
    /// Version of the program that wrote it.
    pub program_version: &'static str,
    /// What was tested.
    pub test: TestFacts,
    /// On which machine.
    pub machine: MachineFacts,
    /// With what.
    pub ball_bar: BallBarFacts,
    /// Name of the strategy; `None` where the test file has none, or the programs are not of it.
    pub strategy: Option<String>,
    /// The circles that the programs drove, each once.
    pub driven: Vec<String>,
    /// The terms that were asked for: names of sets, of coefficients and of set-up errors.
    pub terms: Vec<String>,
    /// How far-off samples were weighted: `off`, `huber` or `tukey`.
    pub loss: Loss,
    /// Whether confounded terms were allowed and the shortest solution taken.
    pub minimum_norm: bool,
    /// One entry a repeat: runs that were identified together.
    pub repeats: Vec<RepeatResult>,
    /// Every parameter over the repeats.
    pub over_repeats: Vec<MeanResult>,
    /// What people ask of the machine, at the place of the test.
    pub at_the_place: Vec<PlaceResult>,
    /// Circular tests of ISO 230-4, and what tolerances say.
    pub circular: CircularFacts,
    /// Features of the plane of each circular test, ranked by what repairing them would gain.
    pub ranking: RankingFacts,
    /// The errors of the machine where it was measured, with their covariance; `None` where `terms` are named.
    pub error_model: Option<Stored>,
    /// Squareness, scale and reversal errors in people's units, as single coefficients of the paper say them.
    pub machine_errors: MachineErrors,
    /// What the model gets wrong; `None` where nobody looked.
    pub diagnosis: Option<DiagnosisFacts>,
    /// The numbers without what was found; `None` where nothing was, or nobody looked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<Box<Before>>,
    /// What a reader should know before he believes the numbers.
    pub cautions: Vec<String>,
}

impl Analysis {
    /// The text of `analysis.json`: keys in fixed order, numbers at full precision, a final newline.
    pub fn to_json(&self) -> Result<String> {
        let mut text = serde_json::to_string_pretty(self).map_err(|error| {
            Error::new(Kind::Output, format!("the analysis cannot be written as JSON: {error}"))
        })?;
        text.push('\n');
        Ok(text)
    }

    /// All runs of all repeats, in order.
    pub fn runs(&self) -> impl Iterator<Item = &RunResult> {
        self.repeats.iter().flat_map(|repeat| &repeat.runs)
    }

    /// Whether the machine was described where it was measured, with what is plausible for it.
    pub fn is_local(&self) -> bool {
        self.at_the_place.iter().any(|result| result.all.is_some())
    }

    /// A parameter over the repeats.
    pub fn over_repeats(&self, name: &str) -> Option<&MeanResult> {
        self.over_repeats.iter().find(|mean| mean.name == name)
    }
}

/// The numbers without what was found, of the same form as those with it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Before {
    /// One entry a repeat.
    pub repeats: Vec<RepeatResult>,
    /// Every parameter over the repeats.
    pub over_repeats: Vec<MeanResult>,
    /// What people ask of the machine, at the place of the test.
    pub at_the_place: Vec<PlaceResult>,
    /// Squareness, scale and reversal errors as single coefficients say them.
    pub machine_errors: MachineErrors,
    /// What was to be known before believing these numbers.
    pub cautions: Vec<String>,
}

/// The test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestFacts {
    /// Its name.
    pub name: String,
    /// The test file, as the command or the folder of the results names it.
    pub file: String,
    /// SHA-256 of the text of the test file, in hexadecimal.
    pub sha256: String,
    /// SHA-256 of all readings, in hexadecimal: of the same logs the same.
    pub readings_sha256: String,
    /// The day of the test, year-month-day: of the record or, where it has none, of the first log that says it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
    /// Who measured what, when and with what; `None` where the test file says nothing of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub record: Option<Record>,
    /// Where the balls were.
    pub mountings: Vec<MountingFacts>,
}

/// A mounting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MountingFacts {
    /// Its name.
    pub name: String,
    /// Machine coordinates at which both ball centres coincide, mm.
    pub coincidence_mm: [f64; 3],
    /// Tool ball in the frame of the last slide on the tool side, mm.
    pub tool_ball_mm: [f64; 3],
    /// Nominal length of the bar, mm.
    pub bar_length_mm: f64,
}

/// The machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MachineFacts {
    /// Its name.
    pub name: String,
    /// The machine file as it was found.
    pub file: String,
    /// The chain from workpiece to tool, such as `wCBXFZYSt`.
    pub topology: String,
    /// Where each slide turns.
    pub pivots: Pivots,
}

/// Where each slide turns when it has an angular error: `carriage` or `base`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Pivots {
    /// The X slide.
    pub x: &'static str,
    /// The Y slide.
    pub y: &'static str,
    /// The Z slide.
    pub z: &'static str,
}

/// The instrument, as the test file states it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BallBarFacts {
    /// Nominal length where a mounting names none of its own, mm.
    pub length_mm: f64,
    /// It reads up to this much either way, mm.
    pub range_mm: f64,
    /// Smallest step of a reading, um.
    pub resolution_um: f64,
    /// Standard deviation of one reading, um.
    pub noise_um: f64,
    /// Samples a second.
    pub sample_rate_hz: f64,
    /// How far its clock may be off, ppm.
    pub clock_tolerance_ppm: f64,
}

/// What one repeat gave.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepeatResult {
    /// The repeat's number in the test file.
    pub repeat: u32,
    /// How many directions of the parameters the data determine.
    pub rank: usize,
    /// How many parameters there are.
    pub parameter_count: usize,
    /// Condition number of the scaled columns over the observed directions.
    pub condition: Option<f64>,
    /// What cannot be told apart, one sentence a group.
    pub confounded: Vec<String>,
    /// The parameters in the order of the model.
    pub parameters: Vec<ParameterResult>,
    /// Pairs of parameters whose estimates hang together closely.
    pub correlations: Vec<Correlation>,
    /// What is left in the residuals.
    pub noise: NoiseResult,
    /// Root mean square of the residuals of the samples that were used, um.
    pub residual_rms_um: f64,
    /// Names of the runs of which the model explains little.
    #[serde(skip)]
    pub little_explained: Vec<String>,
    /// What became of the samples.
    pub samples: SampleCounts,
    /// Gauss-Newton steps.
    pub gauss_newton_steps: usize,
    /// The runs of this repeat.
    pub runs: Vec<RunResult>,
}

/// One parameter of one repeat.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterResult {
    /// Its name, such as `EXX1`.
    pub name: String,
    /// Unit of `value` and `sigma`, such as `mm/mm`.
    pub unit: &'static str,
    /// The estimate.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: Option<f64>,
    /// How much of it the data determine, 0 to 1.
    pub observed: f64,
}

/// Two parameters whose estimates hang together closely.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correlation {
    /// The first.
    pub first: String,
    /// The second.
    pub second: String,
    /// Their correlation, -1 to 1.
    pub correlation: f64,
}

/// The noise model of the residuals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseResult {
    /// Standard deviation of one sample, um.
    pub sigma_um: f64,
    /// Standard deviation of what is new in every sample, um.
    pub innovation_um: f64,
    /// Coefficients of the autoregression, the nearest sample first.
    pub autoregressive: Vec<f64>,
    /// Correlation of samples 0, 1, 2 .. apart, by the model.
    pub autocorrelation: Vec<f64>,
    /// As many independent samples would determine a constant as well as the used ones.
    pub effective_samples: Option<f64>,
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::collections::BTreeSet;

    use serde_json::Value;

    use crate::report::fixture;

    fn names(value: &Value, all: &mut BTreeSet<String>) {
        match value {
            Value::Object(fields) => {
                for (name, value) in fields {
                    all.insert(name.clone());
                    names(value, all);
                }
            }
            Value::Array(values) => values.iter().for_each(|value| names(value, all)),
            _ => {}
        }
    }

    #[test]
    fn every_field_is_documented() {
        let schema = include_str!("../../../docs/analysis-schema.md");
        // Words between backticks, cut at dots and brackets.
        let documented: BTreeSet<&str> =
            schema.split('`').skip(1).step_by(2).flat_map(|code| code.split(['.', '['])).collect();
        let plain = ["hu40t-stops", "planar"].map(fixture::identified);
        for fixture in plain.into_iter().chain([fixture::diagnosed()]) {
            let text = fixture.analysis.to_json().unwrap();
            let mut all = BTreeSet::new();
            names(&serde_json::from_str(&text).unwrap(), &mut all);
            assert!(all.len() > 80, "{all:?}");
            for name in all {
                assert!(documented.contains(name.as_str()), "`{name}` is not in the schema");
            }
        }
    }

    #[test]
    fn the_same_input_gives_the_same_bytes_and_full_precision() {
        let first = fixture::identified("planar");
        let second = fixture::work_out("planar");
        let text = first.analysis.to_json().unwrap();
        assert_eq!(text, second.analysis.to_json().unwrap());
        let value: Value = serde_json::from_str(&text).unwrap();
        let read = value["repeats"][0]["parameters"][0]["value"].as_f64().unwrap();
        let exact = first.identifications[0].estimates[0].value;
        assert_eq!(read.to_bits(), exact.to_bits());
    }

    #[test]
    fn the_verdict_on_a_known_test() {
        let fixture = fixture::identified("hu40t");
        let analysis = &fixture.analysis;
        assert_eq!(analysis.repeats.len(), 5);
        for repeat in &analysis.repeats {
            assert_eq!((repeat.rank, repeat.parameter_count), (38, 38));
            assert!(repeat.residual_rms_um < 0.16, "{}", repeat.residual_rms_um);
            let run = &repeat.runs[0];
            assert_eq!(run.arcs.iter().filter(|arc| !arc.transit).count(), 12);
            assert!(run.log.ends_with(&format!("{}.csv.gz", run.name)), "{}", run.log);
            let all = repeat.samples;
            assert_eq!(
                all.used + all.rejected + all.not_used,
                fixture.identifications[repeat.repeat as usize - 1].runs[0].records.len()
            );
        }
        assert_eq!(analysis.machine_errors.squareness.len(), 3);
        assert_eq!(analysis.machine_errors.reversal.len(), 9);
    }
}
