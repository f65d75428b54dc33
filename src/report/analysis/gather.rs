//! From identifications to an [`Analysis`].

use super::control::ControlResult;
use super::facts::{
    Analysis, BallBarFacts, Correlation, MachineFacts, MountingFacts, NoiseResult, ParameterResult,
    Pivots, RepeatResult, TestFacts,
};
use super::machine_errors::MachineErrors;
use super::run_facts::{
    ArcResult, FeedOverride, MarkResult, PauseResult, RejectedSample, RunResult, SampleCounts,
};
use super::{cautions, driven, means, place};
use crate::align::{Circle, Mark, MarkKind, TimeMap};
use crate::compensate::{ErrorModel, Stored};
use crate::identify::{self, Campaign, Estimate, Identification, IdentifiedRun, Record};
use crate::machine::{Axis, Machine, Pivot};
use crate::model::{HeldEffect, Parameter};
use crate::plan::{self, BallBar, Run, Test};
use crate::report::circular::facts::CircularFacts;
use crate::report::ranked::facts::RankingFacts;
use crate::report::text::numbers::{finite, without_dust};
use crate::solve::Matrix;

/// Name and version of the format.
const FORMAT: &str = "ballbar.analysis/2";
/// Lags of the residuals' autocorrelation that are told.
const LAGS: usize = 9;
/// Estimates that hang together more closely than this are told as a pair.
const CLOSE: f64 = 0.95;
/// So many rejected samples of a run are listed.
const MOST_REJECTED: usize = 300;

impl Analysis {
    /// Gathers what is told of a campaign.
    pub fn new(test: &Test, machine: &Machine, campaign: &Campaign) -> Self {
        let error_model = ErrorModel::of(test, machine, campaign, None);
        let gathered =
            Self::gathered(test, machine, campaign).with_circles((test, machine, campaign), &[]);
        Self { error_model: error_model.as_ref().map(Stored::of), ..gathered }
    }

    /// The same without circular tests and features of planes.
    pub(super) fn gathered(test: &Test, machine: &Machine, campaign: &Campaign) -> Self {
        let identifications = &campaign.repeats;
        let mut runs = StatedRuns::new(test);
        let repeats: Vec<RepeatResult> = identifications
            .iter()
            .enumerate()
            .map(|(index, identification)| {
                let held = campaign.held.get(index).map_or(&[][..], Vec::as_slice);
                repeat(index, identification, held, &mut runs)
            })
            .collect();
        let over_repeats = means::of(identifications);
        let at_the_place = place::of(test, machine, campaign);
        let mut analysis = Self {
            format: FORMAT,
            program_version: env!("CARGO_PKG_VERSION"),
            test: test_facts(test, campaign),
            machine: machine_facts(machine),
            ball_bar: ball_bar_facts(test.ball_bar()),
            strategy: driven::strategy(test, identifications).map(str::to_owned),
            driven: driven::circles(identifications).iter().map(Circle::name).collect(),
            terms: test.estimation().terms.clone(),
            loss: test.estimation().loss,
            minimum_norm: test.estimation().minimum_norm,
            circular: CircularFacts::default(),
            ranking: RankingFacts::default(),
            at_the_place,
            error_model: None,
            machine_errors: MachineErrors::new(machine, &over_repeats),
            repeats,
            over_repeats,
            diagnosis: None,
            before: None,
            cautions: Vec::new(),
        };
        // What speaks against the fit itself comes before what speaks for caution in reading it.
        let of_fits = campaign.cautions(test, machine);
        let implausible = identifications.first().and_then(place::implausible);
        analysis.cautions =
            of_fits.into_iter().chain(implausible).chain(cautions::of(&analysis)).collect();
        analysis
    }
}

fn test_facts(test: &Test, campaign: &Campaign) -> TestFacts {
    let stated = test.record().date.clone();
    // What the test file says counts more than what a .b5r does.
    let said = campaign.said();
    let record = plan::Record {
        operator: test.record().operator.clone().or(said.operator),
        bar_serial: test.record().bar_serial.clone().or(said.bar_serial),
        bar_calibrated: test
            .record()
            .bar_calibrated
            .clone()
            .or_else(|| Some(said.bar_calibrated?.to_string())),
        ..test.record().clone()
    };
    let mountings = test.mountings().iter().map(|named| MountingFacts {
        name: named.name.clone(),
        coincidence_mm: named.mounting.coincidence_mm.into(),
        tool_ball_mm: named.mounting.tool_ball_mm.into(),
        bar_length_mm: named.bar_length_mm,
    });
    TestFacts {
        name: test.name().to_owned(),
        file: test.file().display().to_string(),
        sha256: test.hash().to_owned(),
        readings_sha256: campaign.readings_sha256(),
        date: stated.or_else(|| campaign.began().map(|day| day.to_string())),
        record: Some(record).filter(|record| *record != plan::Record::default()),
        mountings: mountings.collect(),
    }
}

/// The instrument as a test file states it.
pub(in crate::report) fn ball_bar_facts(bar: &BallBar) -> BallBarFacts {
    BallBarFacts {
        length_mm: bar.length_mm,
        range_mm: bar.range_mm,
        resolution_um: bar.resolution_mm * 1e3,
        noise_um: bar.noise_mm * 1e3,
        sample_rate_hz: bar.sample_rate_hz,
        clock_tolerance_ppm: bar.clock_tolerance * 1e6,
    }
}

/// The machine as its file says it.
pub(in crate::report) fn machine_facts(machine: &Machine) -> MachineFacts {
    let pivot = |axis| match machine.slide(axis).pivot {
        Pivot::Carriage => "carriage",
        Pivot::Base => "base",
    };
    MachineFacts {
        name: machine.name().to_owned(),
        file: machine.file().display().to_string(),
        topology: machine.topology().as_str().to_owned(),
        pivots: Pivots { x: pivot(Axis::X), y: pivot(Axis::Y), z: pivot(Axis::Z) },
    }
}

/// The runs of the test file, each given away once: two logs in two folders may have the same name.
struct StatedRuns<'a> {
    test: &'a Test,
    left: Vec<&'a Run>,
}

impl<'a> StatedRuns<'a> {
    fn new(test: &'a Test) -> Self {
        let mut left: Vec<&Run> = test.runs().map_or_else(|_| Vec::new(), |r| r.iter().collect());
        left.sort_by_key(|run| run.repeat);
        Self { test, left }
    }

    fn take(&mut self, name: &str) -> Option<&'a Run> {
        let index = self.left.iter().position(|run| run.name == name)?;
        Some(self.left.remove(index))
    }

    fn mounting(&self, index: usize) -> String {
        self.test.mountings().get(index).map_or_else(String::new, |named| named.name.clone())
    }
}

fn repeat(
    index: usize,
    from: &Identification,
    held: &[HeldEffect],
    stated: &mut StatedRuns<'_>,
) -> RepeatResult {
    let parameters: Vec<Parameter> = from.estimates.iter().map(|e| e.parameter.clone()).collect();
    let mut number = None;
    let runs: Vec<RunResult> = from
        .runs
        .iter()
        .enumerate()
        .map(|(place, run)| {
            let of_file = stated.take(&run.name);
            number = number.or(of_file.map(|run| run.repeat));
            let control = ControlResult::of(&run.alignment, &from.estimates, held, place);
            run_result(run, control, of_file, stated.mounting(run.mounting))
        })
        .collect();
    RepeatResult {
        repeat: number.unwrap_or(index as u32 + 1),
        rank: from.rank,
        parameter_count: parameters.len(),
        condition: finite(from.condition),
        confounded: from
            .null_directions
            .iter()
            .map(|direction| identify::sentence(direction, &parameters))
            .collect(),
        parameters: from.estimates.iter().map(parameter).collect(),
        correlations: correlations(&parameters, &from.correlation),
        noise: NoiseResult {
            sigma_um: from.noise.sigma() * 1e3,
            innovation_um: from.noise.innovation_sigma() * 1e3,
            autoregressive: from.noise.phi().to_vec(),
            autocorrelation: from.noise.autocorrelation(LAGS),
            effective_samples: finite(from.noise.effective_samples(from.used)),
        },
        residual_rms_um: from.rms_mm * 1e3,
        little_explained: from.little_explained.iter().map(|of| of.run.clone()).collect(),
        samples: from.runs.iter().fold(counts(&[]), |sum, run| {
            let of_run = counts(&run.records);
            SampleCounts {
                used: sum.used + of_run.used,
                rejected: sum.rejected + of_run.rejected,
                not_used: sum.not_used + of_run.not_used,
            }
        }),
        gauss_newton_steps: from.steps,
        runs,
    }
}

fn parameter(estimate: &Estimate) -> ParameterResult {
    ParameterResult {
        name: estimate.parameter.name.clone(),
        unit: estimate.parameter.unit,
        value: estimate.value + 0.0,
        sigma: finite(estimate.sigma),
        observed: without_dust(estimate.observed),
    }
}

/// The closest pairs first.
fn correlations(parameters: &[Parameter], matrix: &Matrix) -> Vec<Correlation> {
    let mut pairs = Vec::new();
    for i in 0..parameters.len() {
        for k in i + 1..parameters.len() {
            let correlation = matrix[(i, k)];
            if correlation.is_finite() && correlation.abs() >= CLOSE {
                pairs.push(Correlation {
                    first: parameters[i].name.clone(),
                    second: parameters[k].name.clone(),
                    correlation,
                });
            }
        }
    }
    pairs.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
    pairs
}

/// What became of samples.
fn counts(records: &[Record]) -> SampleCounts {
    let rejected = records.iter().filter(|r| r.rejected()).count();
    let taking_part = records.iter().filter(|r| r.used()).count();
    SampleCounts { used: taking_part - rejected, rejected, not_used: records.len() - taking_part }
}

fn run_result(
    run: &IdentifiedRun,
    control: ControlResult,
    stated: Option<&Run>,
    mounting: String,
) -> RunResult {
    let alignment = &run.alignment;
    let map = &alignment.time_map;
    let first_s = alignment.engagements.first().map_or(0.0, |engagement| engagement.start_s);
    let leg = map.leg_of(first_s);
    let rejected = run.records.iter().filter(|record| record.rejected());
    RunResult {
        name: run.name.clone(),
        program: stated.map_or_else(String::new, |run| run.program.display().to_string()),
        log: stated.map_or_else(String::new, |run| run.log.display().to_string()),
        mounting,
        clock_rate_ppm: map.rate * 1e6,
        clock_rate_sigma_ppm: finite(map.rate_sigma * 1e6),
        feed_override: FeedOverride {
            stated_percent: stated.map_or(1.0, |run| run.feed_override) * 100.0,
            excess_percent: map.feed_excess().map_or(0.0, |[excess, _]| excess * 100.0),
            excess_sigma_percent: map.feed_excess().map(|[_, sigma]| sigma * 100.0),
        },
        engagement_log_s: map.log_time_s(first_s, leg),
        start_offset_s: map.offsets_s.get(leg).copied().unwrap_or(0.0),
        start_offset_sigma_ms: map.offset_sigmas_s.get(leg).and_then(|s| finite(s * 1e3)),
        worst_time_sigma_ms: finite(
            run.used().map(|record| record.sample.time_sigma_s).fold(0.0, f64::max) * 1e3,
        ),
        sample_period_s: alignment.sample_period_s,
        averaged: alignment.averaged,
        marks: alignment.marks.iter().map(|mark| mark_result(mark, map)).collect(),
        pauses: pauses(map),
        control,
        residual_rms_um: identify::rms_mm(run) * 1e3,
        samples: counts(&run.records),
        arcs: arcs(run),
        rejected_samples: rejected
            .take(MOST_REJECTED)
            .map(|record| RejectedSample {
                log_line: record.sample.line,
                log_s: record.sample.log_s,
                residual_um: record.residual_mm * 1e3,
            })
            .collect(),
    }
}

fn mark_result(mark: &Mark, map: &TimeMap) -> MarkResult {
    let leg = map.leg_of(mark.program_s);
    let known = map.offset_sigmas_s.get(leg).is_some_and(|sigma| sigma.is_finite());
    MarkResult {
        kind: match mark.kind {
            MarkKind::Engagement => "engagement",
            MarkKind::Release => "release",
            MarkKind::Standstill => "standstill",
            MarkKind::Angle => "angle",
        },
        log_s: mark.log_s,
        program_s: mark.program_s,
        sigma_ms: mark.sigma_s * 1e3,
        samples: mark.samples,
        left_ms: known
            .then(|| (mark.program_s - map.on_leg_s(mark.log_s, leg)) * 1e3)
            .and_then(finite),
    }
}

/// Lengths of the operator's pauses. Two offsets hang together through the clock rate, which is taken
/// off; given the rate they are taken for independent.
fn pauses(map: &TimeMap) -> Vec<PauseResult> {
    let rate_variance = map.rate_sigma.powi(2);
    map.breaks()
        .iter()
        .zip(map.stood_s())
        .enumerate()
        .filter(|(_, (at, _))| at.operator)
        .map(|(before, (at, length_s))| {
            let (program_s, after) = (at.program_s, before + 1);
            let shared = if rate_variance > 0.0 {
                map.offset_rate_covariances_s[before] * map.offset_rate_covariances_s[after]
                    / rate_variance
            } else {
                0.0
            };
            let sigma = |leg: usize| map.offset_sigmas_s[leg].hypot(map.chords[leg].ambiguity_s);
            let variance = sigma(before).powi(2) + sigma(after).powi(2) - 2.0 * shared;
            PauseResult {
                program_s,
                length_s: length_s.and_then(finite),
                sigma_ms: length_s.and_then(|_| finite(variance.max(0.0).sqrt() * 1e3)),
            }
        })
        .collect()
}

fn arcs(run: &IdentifiedRun) -> Vec<ArcResult> {
    identify::arcs(run)
        .into_iter()
        .map(|residuals| {
            let section = &run.alignment.sections[residuals.section];
            ArcResult {
                name: section.name.clone(),
                circle: section.circle.name(),
                direction: section.direction(),
                transit: section.transit,
                start_s: section.start_s,
                end_s: section.end_s,
                sweep_deg: section.sweep_rad.to_degrees(),
                data_start_s: section.data_s[0],
                data_end_s: section.data_s[1],
                feed_mm_min: section.feed_mm_s * 60.0,
                samples: residuals.samples,
                rms_um: residuals.rms_mm * 1e3,
                mean_um: residuals.mean_mm * 1e3,
                worst_um: residuals.worst_mm * 1e3,
            }
        })
        .collect()
}
