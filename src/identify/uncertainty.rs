//! From a settled fit to its noise, its covariance and everything that is told.

use std::ops::Range;

use rayon::prelude::*;

use super::across::Across;
use super::fit::{Fit, Outcome};
use super::input::RunInput;
use super::record::Record;
use super::result::{Estimate, Identification, IdentifiedRun};
use super::state::State;
use super::unexplained::Unexplained;
use super::{residuals, timing};
use crate::align::{FOLLOWING_S, Sample};
use crate::error::Result;
use crate::solve::{self, Autocovariances, BorderedSolution, Matrix, NoiseModel};

/// What the readings decided.
pub(super) struct Decided {
    /// Of each parameter how much, 0 to 1.
    observed: Vec<f64>,
    /// Of how many parameters.
    rank: usize,
    /// See [`Identification::left_open`].
    pub(super) left_open: Option<Matrix>,
}

/// A lag whose deviation is more than this part of what is plausible is not told by the readings: what it does to a radius is its
/// square, then more than a sixteenth of what is plausible, which no slope tells.
const UNTOLD: f64 = 0.25;
/// How often the noise model is told what the fit has taken out of its own residuals while readings are weighed by it: to the end,
/// and what a fit leaves far from the truth would count for noise.
const NOISE_PASSES: usize = 3;
/// And at the most of a fit that has come to rest, until it changes by less than [`SETTLED`].
const MOST_PASSES: usize = 100;
/// Of the long-run variance.
const SETTLED: f64 = 1e-3;
/// Noise hangs together for no longer than that whose correlation falls to a third within half of this time, s: so many
/// readings count for one. What lasts longer than that is no noise of readings.
const NOISE_S: f64 = 2.0;

impl Fit<'_> {
    /// Noise model, covariance, and everything that is told.
    pub(super) fn finish(mut self, outcome: &Outcome, steps: usize) -> Result<Identification> {
        let left_mm = self.left_mm();
        let used = self.used_mm(&left_mm);
        let rms_mm = residuals::rms(&used);
        let noise = self.noise(&left_mm, outcome, MOST_PASSES)?;
        let solution = self.consider_lags()?;
        let outcome = &Outcome { solution, ..*outcome };
        let covariance = self.covariance(&outcome.solution, &left_mm, &noise)?;
        self.state_times(&covariance);
        let covariance = covariance.shared;
        let sigmas = solve::standard_deviations(&covariance);
        let with_plausible = outcome.solution.covariance_unscaled();
        for (index, run) in self.runs.iter_mut().enumerate() {
            let considered_s = run.considered_s();
            let map = &mut run.alignment.time_map;
            self.columns.state_driving(index, map, &with_plausible.own[index]);
            if self.state.at_once[index] {
                map.following_sigma_s = considered_s;
            }
        }
        let shared = outcome.solution.shared();
        let known = self.known(&outcome.solution);
        let left_open = known.left_open;
        let all = |k: usize| {
            let open = left_open.as_ref()?.row(k);
            Some(open.iter().fold(sigmas[k], |all, open| all.hypot(*open)))
        };
        let estimates = self
            .model
            .parameters()
            .iter()
            .enumerate()
            .map(|(k, parameter)| Estimate {
                parameter: parameter.clone(),
                value: self.state.values[k],
                sigma: sigmas[k],
                all: all(k),
                plausible: self.state.plausible[k],
                observed: known.observed[k],
            })
            .collect();
        let correlation = solve::correlation(&covariance);
        let options = self.options;
        let counts_mm = self.state.counts_mm();
        let settled = self.state.settled;
        let across = Across::of(self.model, &self.runs);
        let runs = self.identified(&left_mm, &noise);
        let left = Unexplained::of(&runs, rms_mm, &noise, options);
        Ok(Identification {
            estimates,
            across,
            correlation,
            covariance,
            left_open,
            unexplained: 0,
            effects: None,
            rank: known.rank,
            counts_mm,
            condition: shared.spectrum().condition_of(shared.rank()),
            null_directions: shared.spectrum().null_directions(shared.rank(), 0.02),
            beyond_chance: left.beyond_chance,
            little_explained: left.little,
            noise,
            runs,
            rms_mm,
            used: used.len(),
            steps,
            settled,
        })
    }

    /// A lag that the readings do not tell takes no part in the fit from now on, but stands beside it: all that it plausibly is, not
    /// what its first millisecond does, is [considered](Self::considered). The solution is that with such lags held.
    pub(super) fn consider_lags(&mut self) -> Result<BorderedSolution> {
        // Slides that seem to follow at once may lag all the same.
        self.state.at_once.fill(false);
        let solution = self.solve(&self.rows()?)?;
        self.state_lags(&solution);
        self.hold_lags();
        // With all of them free it is the same.
        if !self.state.at_once.contains(&true) {
            return Ok(solution);
        }
        if self.state.at_once.contains(&false) {
            // The first millisecond of those that are held does nothing, and beside slides that follow at once the lag of
            // others is told that is not beside slides that may lag as well: by all that they plausibly do.
            let held = std::mem::replace(&mut self.state.at_once, vec![false; self.runs.len()]);
            let solution = self.solve(&self.rows()?)?;
            self.state.at_once = held;
            self.state_lags(&solution);
            self.hold_lags();
        }
        self.solve(&self.rows()?)
    }

    /// States how well the lags of runs that are not held are known.
    fn state_lags(&mut self, solution: &BorderedSolution) {
        let covariance = solution.covariance_unscaled();
        for (index, run) in self.runs.iter_mut().enumerate() {
            if self.state.at_once[index] {
                continue;
            }
            let map = &mut run.alignment.time_map;
            self.columns.state_driving(index, map, &covariance.own[index]);
            map.following_sigma_s = map.following_sigma_s.hypot(map.corners_s());
        }
    }

    /// Holds the lags of runs whose deviations are said to be more than the readings tell of one. It is the lag of one machine: that
    /// of which least is told stands for all of them, and what one run has beyond another is no less considered.
    pub(super) fn hold_lags(&mut self) {
        let knows = self.state.knows();
        let mut most_s = 0.0_f64;
        for (run, at_once) in self.runs.iter().zip(&mut self.state.at_once) {
            let map = &run.alignment.time_map;
            let sigma_s = map.following_sigma_s;
            *at_once = knows && (sigma_s > UNTOLD * FOLLOWING_S || map.corners_s() > 0.0);
            if *at_once {
                most_s = most_s.max(sigma_s);
            }
        }
        let held = self.runs.iter_mut().zip(&self.state.at_once).filter(|(_, at_once)| **at_once);
        held.for_each(|(run, _)| run.consider_lag(most_s));
        self.runs.par_iter_mut().for_each(RunInput::follow);
    }

    /// How the coefficients err where the slides of all runs whose lag the readings do not tell follow later by what is plausible:
    /// `dx/dT T`, summed over the runs.
    ///
    /// It is the lag of one machine, and of all its runs the same: what runs at two places differ by, it does not explain. With
    /// the variance `s²` of a lag that is all but held its covariance with the coefficients is `s² dx/dT`.
    fn considered(&self, solution: &BorderedSolution, inverse: &Matrix) -> Vec<f64> {
        let held = (0..self.runs.len()).filter(|index| self.state.at_once[*index]);
        held.fold(vec![0.0; self.columns.coefficients], |all, index| {
            let (_, ratio) = solution.elimination(index);
            let with = inverse.times_vector(ratio.row(self.columns.following(index)));
            let times = self.runs[index].considered_s() / timing::AT_ONCE_S.powi(2);
            all.iter().zip(with).map(|(all, with)| all - times * with).collect()
        })
    }

    /// What is left of the readings that take part, mm.
    fn used_mm(&self, left_mm: &[Vec<f64>]) -> Vec<f64> {
        let apart = self.state.apart.iter().flatten();
        let used = left_mm.iter().flatten().zip(apart).filter(|(_, apart)| apart.is_none());
        used.map(|(left_mm, _)| *left_mm).collect()
    }

    /// The noise of what is left; what the fit has taken out is given back so often.
    fn noise(&self, left_mm: &[Vec<f64>], outcome: &Outcome, passes: usize) -> Result<NoiseModel> {
        self.refuse_none()?;
        let fitted = self.known(&outcome.solution).rank;
        // The usual bound, 10 log10(N): the higher the sample rate, the longer the noise is in samples.
        // And not so high that what the fit has taken out is half of what such an order sums up.
        let samples = self.used_mm(left_mm).len().max(1) as f64;
        let most = 0.25 * samples / fitted.max(1) as f64;
        let order = most.min(10.0 * samples.log10()) as usize;
        let mut covariances = Autocovariances::new(order);
        for (index, of_run) in left_mm.iter().enumerate() {
            for segment in self.segments(index) {
                covariances.push_segment(&of_run[segment]);
            }
        }
        let period_s = self.runs.iter().map(|run| run.alignment.sample_period_s);
        let most = 1.0 + NOISE_S / period_s.fold(f64::INFINITY, f64::min);
        let mut noise = NoiseModel::fit(&covariances, order)?.within(most);
        // The order stays: on few samples a free one takes what is given back for a correlation without
        // end, asks for more, and runs away.
        let order = noise.phi().len();
        for _ in 0..passes {
            let before = noise.long_run_variance();
            noise = NoiseModel::fit(&covariances.with_fitted(fitted, before), order)?.within(most);
            if (noise.long_run_variance() / before - 1.0).abs() < SETTLED {
                break;
            }
        }
        Ok(noise)
    }

    /// For how much more than one reading alone the noise of readings counts whose neighbours err alike.
    pub(super) fn correlated(&self, left_mm: &[Vec<f64>], outcome: &Outcome) -> Result<f64> {
        let noise = self.noise(left_mm, outcome, NOISE_PASSES)?;
        Ok((noise.long_run_variance().sqrt() / noise.sigma()).max(1.0))
    }

    /// What the readings decided, and what they left to what is plausible.
    pub(super) fn known(&self, solution: &BorderedSolution) -> Decided {
        let count = self.columns.coefficients;
        let shared = solution.shared();
        if !self.state.knows() {
            let observed = shared.observed_fraction();
            return Decided { observed, rank: shared.rank(), left_open: None };
        }
        let inverse = shared.covariance_unscaled();
        let plausible = &self.state.plausible;
        let sigma = |k: usize| plausible[k].unwrap_or(f64::INFINITY);
        let observed: Vec<f64> = (0..count)
            .map(|k| (1.0 - inverse[(k, k)] / sigma(k).powi(2)).clamp(0.0, 1.0))
            .collect();
        // The covariance of the coefficients with every fault, in units of what is plausible of the fault.
        let mut open: Vec<Vec<f64>> = (0..count)
            .map(|k| inverse.row(k).iter().map(|covariance| covariance / sigma(k)).collect())
            .collect();
        let mut considered = Some(self.considered(solution, &inverse));
        for index in 0..self.runs.len() {
            let (_, ratio) = solution.elimination(index);
            for (column, _, sigma) in self.driven(index) {
                if self.state.at_once[index] && column == self.columns.following(index) {
                    // Of all that are held, beside the first.
                    open.push(considered.take().unwrap_or_else(|| vec![0.0; count]));
                    continue;
                }
                let with = inverse.times_vector(ratio.row(column));
                open.push(with.into_iter().map(|covariance| -covariance / sigma).collect());
            }
        }
        let left_open = Matrix::from_fn(count, open.len(), |i, k| open[k][i]);
        let rank = observed.iter().sum::<f64>().round() as usize;
        Decided { observed, rank, left_open: Some(left_open) }
    }

    /// Stretches of samples of a run that take part, on one arc each, without a gap.
    pub(super) fn segments(&self, index: usize) -> Vec<Range<usize>> {
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
        let legs = self.columns.legs;
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
                aligned: run.aligned,
                legs: legs[index].clone(),
            }
        };
        self.runs.into_iter().enumerate().map(of_run).collect()
    }
}
