//! Residuals as records: what was measured, what was computed, and what became of it.

use std::ops::Range;

use super::input::RunInput;
use crate::align::{Alignment, Place, Sample};
use crate::machine::Pose;
use crate::model::Model;

/// What became of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// Deviation that the model predicts, mm.
    pub predicted_mm: f64,
    /// Measured minus predicted, mm.
    pub residual_mm: f64,
    /// Whether the fit used it.
    pub used: bool,
    /// Weight in the fit, 0 to 1.
    pub weight: f64,
}

impl Record {
    /// A sample of the fit whose residual was too large to be believed.
    pub fn rejected(&self) -> bool {
        self.used && self.weight < REJECTED
    }
}

/// With less weight than this a sample counts as rejected: Huber's weight at some 10 sigma.
const REJECTED: f64 = 0.13;

/// Whether the fit uses a sample: it is on an arc, and the sense of every slide is known there, that is,
/// no slide turns round within three standard deviations of its time.
fn takes_part(sample: &Sample, reversals_s: &[f64], guard_s: f64) -> bool {
    if !matches!(sample.place, Place::Arc(_)) || !sample.time_sigma_s.is_finite() {
        return false;
    }
    let next = reversals_s.partition_point(|t| *t < sample.program_s);
    let near = |index: usize| {
        reversals_s
            .get(index)
            .is_some_and(|t| (t - sample.program_s).abs() < guard_s.max(3.0 * sample.time_sigma_s))
    };
    !(near(next) || next.checked_sub(1).is_some_and(near))
}

/// One flag for each sample of each run; `guard_s` is kept from every reversal at the least.
pub(super) fn taking_part(runs: &[RunInput], guard_s: f64) -> Vec<Vec<bool>> {
    runs.iter()
        .map(|run| {
            let reversals_s = run.alignment.trajectory.reversals_s();
            run.alignment
                .samples
                .iter()
                .map(|sample| takes_part(sample, &reversals_s, guard_s))
                .collect()
        })
        .collect()
}

/// Records of all samples of a run.
pub(super) fn records(
    model: &Model,
    values: &[f64],
    run: &RunInput,
    used: &[bool],
    weights: Option<&[f64]>,
) -> Vec<Record> {
    run.alignment
        .samples
        .iter()
        .enumerate()
        .map(|(k, sample)| {
            let pose: &Pose = &sample.pose;
            let predicted_mm =
                model.length_mm(values, pose, &sample.motion, run.mounting) - run.nominal_mm;
            Record {
                predicted_mm,
                residual_mm: sample.deviation_mm - predicted_mm,
                used: used[k],
                weight: weights.map_or(1.0, |weights| weights[k]),
            }
        })
        .collect()
}

/// Stretches of consecutive used samples on one arc, without a gap.
pub(super) fn segments(alignment: &Alignment, records: &[Record]) -> Vec<Range<usize>> {
    let samples = &alignment.samples;
    let longest_s = crate::log::Log::GAP_PERIODS * alignment.sample_period_s;
    let mut segments: Vec<Range<usize>> = Vec::new();
    for k in 0..samples.len() {
        if !records[k].used {
            continue;
        }
        match segments.last_mut() {
            Some(last)
                if last.end == k
                    && samples[k].place == samples[k - 1].place
                    && samples[k].log_s - samples[k - 1].log_s <= longest_s =>
            {
                last.end = k + 1;
            }
            _ => segments.push(k..k + 1),
        }
    }
    segments
}

/// Residuals of one arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArcResiduals {
    /// Index of the section.
    pub section: usize,
    /// Samples that were used.
    pub samples: usize,
    /// Root mean square, mm.
    pub rms_mm: f64,
    /// Mean, mm.
    pub mean_mm: f64,
    /// Largest magnitude, mm.
    pub worst_mm: f64,
}

/// Residuals of each arc of a run, in order of the sections.
pub fn arcs(alignment: &Alignment, records: &[Record]) -> Vec<ArcResiduals> {
    (0..alignment.sections.len())
        .filter_map(|section| {
            let of_arc: Vec<f64> = alignment
                .samples
                .iter()
                .zip(records)
                .filter(|(sample, record)| record.used && sample.place == Place::Arc(section))
                .map(|(_, record)| record.residual_mm)
                .collect();
            (!of_arc.is_empty()).then(|| ArcResiduals {
                section,
                samples: of_arc.len(),
                rms_mm: rms(&of_arc),
                mean_mm: of_arc.iter().sum::<f64>() / of_arc.len() as f64,
                worst_mm: of_arc.iter().fold(0.0, |worst, r| worst.max(r.abs())),
            })
        })
        .collect()
}

/// Root mean square of the residuals of used samples, mm.
pub fn rms_mm(records: &[Record]) -> f64 {
    let used: Vec<f64> = records.iter().filter(|r| r.used).map(|r| r.residual_mm).collect();
    rms(&used)
}

pub(super) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
