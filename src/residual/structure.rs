//! What repeats: the structure that runs of the same program have in common.
//!
//! Noise of one run knows nothing of that of another, so the mean product of their residuals at the same
//! place of the program is the variance of what they share, whatever the noise is like:
//!
//! `structure² = mean of e_i(t) e_k(t)` over all pairs of runs,
//!
//! and what is left of the variance, `e² - structure²`, is the repeatability floor.

use serde::ser::{Serialize, SerializeStruct, Serializer};

use super::data::Data;

/// Readings farther apart than so many periods are not interpolated between.
const GAP_PERIODS: f64 = 2.5;

/// What repeats of a residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Structure {
    /// Variance of what runs of the same program share, mm²; chance may make it negative.
    pub variance_mm2: f64,
    /// Its standard deviation over the arcs, mm².
    pub sigma_mm2: f64,
}

impl Structure {
    /// Root mean square of what repeats, mm; 0 where chance makes the variance negative.
    pub fn rms_mm(&self) -> f64 {
        self.variance_mm2.max(0.0).sqrt()
    }
}

/// In um and um².
impl Serialize for Structure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        const UM: f64 = 1e3;
        let mut fields = serializer.serialize_struct("Structure", 3)?;
        fields.serialize_field("rms_um", &(self.rms_mm() * UM))?;
        fields.serialize_field("variance_um2", &(self.variance_mm2 * UM * UM))?;
        fields.serialize_field("sigma_um2", &(self.sigma_mm2 * UM * UM))?;
        fields.end()
    }
}

/// What repeats of some residuals, one number a sample of each block, in runs that `takes_part` names
/// (block, run); `None` where no program ran twice.
pub(crate) fn structure(
    data: &Data,
    residuals_mm: &[Vec<f64>],
    takes_part: impl Fn(usize, usize) -> bool,
) -> Option<Structure> {
    let arcs = products(data, residuals_mm, takes_part);
    let (sum, count) = arcs.iter().fold((0.0, 0.0), |(s, n), arc| (s + arc.0, n + arc.1));
    if count == 0.0 {
        return None;
    }
    let mean = sum / count;
    let used = arcs.iter().filter(|arc| arc.1 > 0.0);
    let squares: f64 = used.map(|arc| (arc.0 - mean * arc.1).powi(2)).sum();
    Some(Structure { variance_mm2: mean, sigma_mm2: squares.sqrt() / count })
}

/// Sums of `e_i e_k` over all pairs of runs and their numbers, by the arc of the first of the pair.
pub(crate) fn products(
    data: &Data,
    residuals_mm: &[Vec<f64>],
    takes_part: impl Fn(usize, usize) -> bool,
) -> Vec<(f64, f64)> {
    let runs: Vec<(usize, usize)> = data
        .blocks
        .iter()
        .enumerate()
        .flat_map(|(b, block)| (0..block.runs.len()).map(move |run| (b, run)))
        .collect();
    let mut arcs: Vec<(f64, f64)> = vec![(0.0, 0.0); data.arcs];
    for (index, &(a, run_a)) in runs.iter().enumerate() {
        for &(b, run_b) in &runs[index + 1..] {
            let same = data.blocks[a].programs[run_a] == data.blocks[b].programs[run_b];
            if !same || !(takes_part(a, run_a) || takes_part(b, run_b)) {
                continue;
            }
            let first = &data.blocks[a];
            let range = data.blocks[b].runs[run_b].clone();
            let times_s = &data.blocks[b].program_s[range.clone()];
            let values = &residuals_mm[b][range.clone()];
            let arcs_b = &data.blocks[b].arcs[range];
            let length_s = times_s.last().unwrap_or(&0.0) - times_s.first().unwrap_or(&0.0);
            let longest_s = GAP_PERIODS * length_s / times_s.len().max(1) as f64;
            let mut after = 0;
            for k in first.runs[run_a].clone() {
                let time_s = first.program_s[k];
                while after < times_s.len() && times_s[after] < time_s {
                    after += 1;
                }
                if after == 0 || after == times_s.len() || arcs_b[after] != arcs_b[after - 1] {
                    continue;
                }
                let step_s = times_s[after] - times_s[after - 1];
                if step_s > longest_s {
                    continue;
                }
                let share = (time_s - times_s[after - 1]) / step_s;
                let other = (1.0 - share) * values[after - 1] + share * values[after];
                let arc = &mut arcs[first.arcs[k]];
                *arc = (arc.0 + residuals_mm[a][k] * other, arc.1 + 1.0);
            }
        }
    }
    arcs
}
