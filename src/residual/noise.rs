//! What chance alone does to the residuals.

use super::data::Data;
use crate::solve::Autocovariances;

/// Correlations of the noise are counted over this time, s.
const CORRELATED_S: f64 = 2.0;

/// The noise of what is left.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::struct_field_names, reason = "the unit is in every name")]
pub(crate) struct Noise {
    /// Variance of one sample, mm².
    pub(crate) variance_mm2: f64,
    /// Half the mean square of the difference of neighbouring samples, mm².
    pub(crate) neighbours_mm2: f64,
    /// Variance of a mean of many neighbouring samples times their number, mm²: what an effect of one
    /// amplitude gains by chance. Effects that are still in the residual make it too large, not too small.
    pub(crate) long_run_mm2: f64,
}

impl Noise {
    /// Of what is left in the data.
    pub(crate) fn of(data: &Data) -> Self {
        Self::of_left(data, &data.left_mm)
    }

    /// Of other residuals of the same samples, mm.
    pub(crate) fn of_left(data: &Data, left_mm: &[Vec<f64>]) -> Self {
        let (mut variance, mut long_run, mut count) = (0.0, 0.0, 0.0_f64);
        let mut neighbours = 0.0;
        for (block, left) in data.blocks.iter().zip(left_mm) {
            for run in &block.runs {
                let times = |k: usize| block.samples[k].situation.motion.elapsed_s;
                let length_s =
                    if run.is_empty() { 0.0 } else { times(run.end - 1) - times(run.start) };
                let period_s = (length_s / run.len().max(1) as f64).max(1e-6);
                let lags = ((CORRELATED_S / period_s).ceil() as usize).clamp(1, 200);
                let mut sums = Autocovariances::new(lags);
                let mut first = run.start;
                for k in run.clone() {
                    if k + 1 == run.end || block.arcs[k + 1] != block.arcs[first] {
                        sums.push_segment(&left[first..=k]);
                        first = k + 1;
                    }
                }
                let covariances = sums.unbiased();
                let Some(own) = covariances.first() else { continue };
                // Bartlett's weights keep the sum positive.
                let weigh = |(lag, c): (usize, &f64)| (1.0 - lag as f64 / (lags + 1) as f64) * c;
                let others: f64 = covariances.iter().enumerate().skip(1).map(weigh).sum();
                let samples = run.len() as f64;
                variance += samples * own;
                long_run += samples * (own + 2.0 * others).max(*own);
                neighbours += samples * (own - covariances.get(1).unwrap_or(&0.0));
                count += samples;
            }
        }
        let count = count.max(1.0);
        Self {
            variance_mm2: variance / count,
            neighbours_mm2: neighbours / count,
            long_run_mm2: long_run / count,
        }
    }
}
