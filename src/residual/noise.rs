//! What chance alone does to the residuals.

use super::column::Column;
use super::residuals::Residuals;
use crate::solve::Autocovariances;

/// Correlations of the noise are counted over this time, s.
const CORRELATED_S: f64 = 2.0;
/// And over so many readings at most.
const MOST_LAGS: usize = 200;

/// The noise of what is left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Variance of one sample, mm².
    pub variance_mm2: f64,
    /// Half the mean square of the difference of neighbouring samples, mm².
    pub neighbours_mm2: f64,
    /// Variance of a mean of many neighbouring samples times their number, mm²: what an effect of one
    /// amplitude gains by chance. Effects that are still in the residual make it too large, not too small.
    pub long_run_mm2: f64,
}

impl Noise {
    /// Of what is left at the samples, mm.
    pub fn of(residuals: &Residuals, left_mm: &Column) -> Self {
        let (mut variance, mut long_run, mut count) = (0.0, 0.0, 0.0_f64);
        let mut neighbours = 0.0;
        for (repeat, left) in residuals.repeats.iter().zip(left_mm.iter()) {
            for run in repeat.runs.iter().map(|run| &run.samples) {
                let times = |k: usize| repeat.samples[k].elapsed_s();
                let length_s =
                    if run.is_empty() { 0.0 } else { times(run.end - 1) - times(run.start) };
                let period_s = (length_s / run.len().max(1) as f64).max(1e-6);
                let lags = ((CORRELATED_S / period_s).ceil() as usize).clamp(1, MOST_LAGS);
                let mut sums = Autocovariances::new(lags);
                let mut first = run.start;
                for k in run.clone() {
                    let arc = repeat.samples[first].arc;
                    if k + 1 == run.end || repeat.samples[k + 1].arc != arc {
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

    /// What numbers may gain that are not there, mm²: twice what chance gives each on average, as Akaike's
    /// criterion has it. Of two explanations the one that gains more beyond this foretells better.
    pub fn by_chance_mm2(&self, numbers: usize) -> f64 {
        2.0 * numbers as f64 * self.long_run_mm2
    }
}
