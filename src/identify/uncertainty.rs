//! From a settled fit to its noise, its covariance and everything that is told.

use super::fit::{Fit, Outcome};
use super::residuals::Record;
use super::result::{Estimate, Identification};
use super::{cautions, residuals};
use crate::error::Result;
use crate::solve::{self, Autocovariances, BackwardFilter, Matrix, NoiseModel, Triangle, Tsqr};

/// How often the noise model is told what the fit has taken out of its own residuals.
const NOISE_PASSES: usize = 3;

impl Fit<'_> {
    /// Noise model, covariance, and everything that is told.
    pub(super) fn finish(mut self, outcome: &Outcome, steps: usize) -> Result<Identification> {
        let records = self.records();
        let used: Vec<f64> =
            records.iter().flatten().filter(|r| r.used).map(|r| r.residual_mm).collect();
        let rms_mm = residuals::rms(&used);
        // The usual bound, 10 log10(N): the higher the sample rate, the longer the noise is in samples.
        // And not so high that what the fit has taken out is half of what such an order sums up.
        let samples = used.len().max(1) as f64;
        let most = 0.25 * samples / outcome.solution.rank().max(1) as f64;
        let order = most.min(10.0 * samples.log10()) as usize;
        let mut covariances = Autocovariances::new(order);
        for (run, records) in self.runs.iter().zip(&records) {
            for segment in residuals::segments(&run.alignment, records) {
                let values: Vec<f64> = records[segment].iter().map(|r| r.residual_mm).collect();
                covariances.push_segment(&values);
            }
        }
        let mut noise = NoiseModel::fit(&covariances, order)?;
        // The order stays: on few samples a free one takes what is given back for a correlation without
        // end, asks for more, and runs away.
        let order = noise.phi().len();
        for _ in 0..NOISE_PASSES {
            let whole = covariances.with_fitted(outcome.solution.rank(), noise.long_run_variance());
            noise = NoiseModel::fit(&whole, order)?;
        }
        let filtered = self.filtered(&records, &noise)?;
        let covariance = outcome.solution.covariance_sandwich(&filtered);
        let sigmas = solve::standard_deviations(&covariance);
        self.state_times(&covariance);
        let count = self.columns.coefficients;
        let spectrum = outcome.solution.spectrum();
        let observed = outcome.solution.observed_fraction();
        let estimates = self
            .model
            .parameters()
            .iter()
            .enumerate()
            .map(|(k, parameter)| Estimate {
                parameter: parameter.clone(),
                value: self.values[k],
                sigma: sigmas[k],
                observed: observed[k],
            })
            .collect();
        let lost = self.columns.total - outcome.solution.rank();
        let correlation = solve::correlation(&covariance);
        let cautions = cautions::cautions(&self.runs, &records, rms_mm, &noise, self.options.loss);
        Ok(Identification {
            estimates,
            correlation: Matrix::from_fn(count, count, |i, k| correlation[(i, k)]),
            rank: count - lost,
            condition: spectrum.condition_of(outcome.solution.rank()),
            null_directions: spectrum.null_directions(outcome.solution.rank(), 0.02),
            noise,
            runs: self.runs,
            records,
            rms_mm,
            used: used.len(),
            steps,
            cautions,
        })
    }

    /// The rows `W J`, filtered by the noise, for the sandwich.
    pub(super) fn filtered(&self, records: &[Vec<Record>], noise: &NoiseModel) -> Result<Triangle> {
        let mut rows = Tsqr::new(self.columns.total);
        let mut row = vec![0.0; self.columns.total];
        let mut filter = BackwardFilter::new(noise, self.columns.total);
        for (index, run) in self.runs.iter().enumerate() {
            for segment in residuals::segments(&run.alignment, &records[index]) {
                filter.begin(segment.len());
                for k in segment.rev() {
                    let sample = &run.alignment.samples[k];
                    let speed = self.speed_mm_s(run, sample);
                    self.fill_row(&mut row, index, sample, speed);
                    let weight = records[index][k].weight / (self.sigma_mm * self.sigma_mm);
                    for value in &mut row {
                        *value *= weight;
                    }
                    rows.push(filter.push(&row), 0.0);
                }
            }
            self.each_time_row(&mut row, index, run, |row, _, sigma| {
                rows.push_weighted(row, 0.0, 1.0 / sigma);
            });
        }
        rows.finish()
    }
}
