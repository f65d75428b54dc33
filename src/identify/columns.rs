//! Where the parameters of the time maps stand among the columns of the fit.

use super::input::RunInput;
use crate::align::TimeMap;
use crate::solve::Matrix;

/// Where the parameters of the time maps stand among the columns.
pub(super) struct Columns {
    pub(super) coefficients: usize,
    /// For each run: its first column, and the legs that have one.
    pub(super) runs: Vec<(usize, Vec<usize>)>,
    pub(super) total: usize,
}

impl Columns {
    pub(super) fn new(coefficients: usize, runs: &[RunInput]) -> Self {
        let mut total = coefficients;
        let runs = runs
            .iter()
            .map(|run| {
                let legs = run.alignment.legs();
                let first = total;
                total += legs.len() + 1;
                (first, legs)
            })
            .collect();
        Self { coefficients, runs, total }
    }

    /// Column of the offset of a leg; `None` where the leg has no samples.
    pub(super) fn offset(&self, run: usize, leg: usize) -> Option<usize> {
        let (first, legs) = &self.runs[run];
        legs.iter().position(|l| *l == leg).map(|k| first + k)
    }

    /// Column of the clock rate.
    pub(super) fn rate(&self, run: usize) -> usize {
        self.runs[run].0 + self.runs[run].1.len()
    }

    /// Takes the uncertainty of a time map from the covariance of all columns.
    pub(super) fn state_uncertainty(&self, run: usize, map: &mut TimeMap, covariance: &Matrix) {
        let rate = self.rate(run);
        map.rate_sigma = covariance[(rate, rate)].max(0.0).sqrt();
        let (first, legs) = &self.runs[run];
        for (column, &leg) in (*first..).zip(legs) {
            map.offset_sigmas_s[leg] = covariance[(column, column)].max(0.0).sqrt();
            map.offset_rate_covariances_s[leg] = covariance[(column, rate)];
        }
    }
}
