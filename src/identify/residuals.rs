//! Sums over the records of runs.

use std::ops::Range;

use super::record::Record;
use super::result::IdentifiedRun;
use crate::align::{Part, Sample};

/// Stretches of consecutive used samples on one arc, without a gap.
pub(super) fn segments(
    samples: &[Sample],
    used: impl Fn(usize) -> bool,
    sample_period_s: f64,
) -> Vec<Range<usize>> {
    let longest_s = crate::log::Log::GAP_PERIODS * sample_period_s;
    let mut segments: Vec<Range<usize>> = Vec::new();
    for k in 0..samples.len() {
        if !used(k) {
            continue;
        }
        match segments.last_mut() {
            Some(last)
                if last.end == k
                    && samples[k].part == samples[k - 1].part
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
pub fn arcs(run: &IdentifiedRun) -> Vec<ArcResiduals> {
    (0..run.alignment.sections.len())
        .filter_map(|section| {
            let of_arc = |record: &&Record| record.sample.part == Part::Arc(section);
            let of_arc: Vec<f64> = run.used().filter(of_arc).map(|r| r.residual_mm).collect();
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

/// Root mean square of the residuals of the used samples of a run, mm.
pub fn rms_mm(run: &IdentifiedRun) -> f64 {
    rms(&run.used().map(|record| record.residual_mm).collect::<Vec<f64>>())
}

pub(super) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
