//! From a settled fit to its noise, its covariance and everything that is told.

use std::ops::Range;

use super::fit::{Fit, Outcome};
use super::input::RunInput;
use super::record::Record;
use super::result::{Estimate, Identification, IdentifiedRun};
use super::state::State;
use super::{cautions, residuals};
use crate::align::Sample;
use crate::error::Result;
use crate::solve::{self, Autocovariances, BackwardFilter, Matrix, NoiseModel, Triangle, Tsqr};

/// How often the noise model is told what the fit has taken out of its own residuals.
const NOISE_PASSES: usize = 3;

impl Fit<'_> {
    /// Noise model, covariance, and everything that is told.
    pub(super) fn finish(mut self, outcome: &Outcome, steps: usize) -> Result<Identification> {
        let left_mm = self.left_mm();
        let apart = self.state.apart.iter().flatten();
        let used = left_mm.iter().flatten().zip(apart).filter(|(_, apart)| apart.is_none());
        let used: Vec<f64> = used.map(|(left_mm, _)| *left_mm).collect();
        let rms_mm = residuals::rms(&used);
        // The usual bound, 10 log10(N): the higher the sample rate, the longer the noise is in samples.
        // And not so high that what the fit has taken out is half of what such an order sums up.
        let samples = used.len().max(1) as f64;
        let most = 0.25 * samples / outcome.solution.rank().max(1) as f64;
        let order = most.min(10.0 * samples.log10()) as usize;
        let mut covariances = Autocovariances::new(order);
        for (index, of_run) in left_mm.iter().enumerate() {
            for segment in self.segments(index) {
                covariances.push_segment(&of_run[segment]);
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
        let filtered = self.filtered(&noise)?;
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
                value: self.state.values[k],
                sigma: sigmas[k],
                observed: observed[k],
            })
            .collect();
        let lost = self.columns.total - outcome.solution.rank();
        let correlation = solve::correlation(&covariance);
        let loss = self.options.loss;
        let runs = self.identified(&left_mm, &noise);
        let cautions = cautions::cautions(&runs, rms_mm, &noise, loss);
        Ok(Identification {
            estimates,
            correlation: Matrix::from_fn(count, count, |i, k| correlation[(i, k)]),
            rank: count - lost,
            condition: spectrum.condition_of(outcome.solution.rank()),
            null_directions: spectrum.null_directions(outcome.solution.rank(), 0.02),
            noise,
            runs,
            rms_mm,
            used: used.len(),
            steps,
            cautions,
        })
    }

    /// The rows `W J`, filtered by the noise, for the sandwich.
    pub(super) fn filtered(&self, noise: &NoiseModel) -> Result<Triangle> {
        let mut rows = Tsqr::new(self.columns.total);
        let mut row = vec![0.0; self.columns.total];
        let mut filter = BackwardFilter::new(noise, self.columns.total);
        for (index, run) in self.runs.iter().enumerate() {
            for segment in self.segments(index) {
                filter.begin(segment.len());
                for k in segment.rev() {
                    let sample = &run.samples()[k];
                    let speed = self.speed_mm_s(run, sample);
                    self.fill_row(&mut row, index, sample, speed);
                    let weight = self.weight(index, k) / self.state.sigma_mm.powi(2);
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

    /// Stretches of samples of a run that take part, on one arc each, without a gap.
    fn segments(&self, index: usize) -> Vec<Range<usize>> {
        let (run, apart) = (&self.runs[index], &self.state.apart[index]);
        let period_s = run.alignment.sample_period_s;
        residuals::segments(run.samples(), |k| apart[k].is_none(), period_s)
    }

    /// The runs with what became of their readings.
    fn identified(self, left_mm: &[Vec<f64>], noise: &NoiseModel) -> Vec<IdentifiedRun> {
        let whitened: Vec<Vec<Option<f64>>> = (0..self.runs.len())
            .map(|index| {
                let mut whitened = vec![None; left_mm[index].len()];
                for segment in self.segments(index) {
                    let of_segment = noise.whitened(&left_mm[index][segment.clone()]);
                    for (to, of) in whitened[segment].iter_mut().zip(of_segment) {
                        *to = Some(of);
                    }
                }
                whitened
            })
            .collect();
        let weights: Vec<Vec<f64>> = left_mm
            .iter()
            .enumerate()
            .map(|(index, left)| (0..left.len()).map(|k| self.weight(index, k)).collect())
            .collect();
        let State { apart, .. } = self.state;
        let of_run = |(index, run): (usize, RunInput)| {
            let record = |(k, sample): (usize, &Sample)| Record {
                sample: *sample,
                computed_mm: sample.deviation_mm - left_mm[index][k],
                residual_mm: left_mm[index][k],
                whitened: whitened[index][k],
                weight: weights[index][k],
                apart: apart[index][k],
            };
            IdentifiedRun {
                records: run.samples().iter().enumerate().map(record).collect(),
                name: run.name,
                mounting: run.mounting,
                nominal_mm: run.nominal_mm,
                alignment: run.alignment,
            }
        };
        self.runs.into_iter().enumerate().map(of_run).collect()
    }
}
