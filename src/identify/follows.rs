//! What a settled fit follows: its orthonormal directions, coefficients and times of each run apart.

use super::fit::Fit;
use crate::solve::{BorderedSolution, Matrix};

/// `F` over the directions that a fit keeps: those of the coefficients first, then those of the times of each run.
pub(super) struct Follows<'a> {
    solution: &'a BorderedSolution,
    /// Of the coefficients, `D^-1 V_r S_r^-1`.
    shared: Matrix,
    /// For each run `-H F`: what its times answer to the directions of the coefficients.
    answers: Vec<Matrix>,
    /// For each run its first direction.
    first: Vec<usize>,
}

impl<'a> Follows<'a> {
    pub(super) fn of(fit: &Fit, solution: &'a BorderedSolution) -> Self {
        let (spectrum, rank) = (solution.shared().spectrum(), solution.shared().rank());
        let (v, scales) = (spectrum.right_singular_vectors(), spectrum.scales());
        let singular = spectrum.singular_values();
        let shared = Matrix::from_fn(fit.columns.coefficients, rank, |k, i| match scales[k] {
            0.0 => 0.0,
            scale => v[(k, i)] / scale / singular[i],
        });
        let mut first = vec![rank];
        let mut answers = Vec::new();
        for index in 0..fit.runs.len() {
            let own = fit.columns.own(index);
            let (_, ratio) = solution.elimination(index);
            let answer = ratio.times(&shared);
            answers.push(Matrix::from_fn(own, rank, |i, k| -answer[(i, k)]));
            first.push(first[index] + own);
        }
        Self { solution, shared, answers, first }
    }

    pub(super) fn rank(&self) -> usize {
        self.first.last().copied().unwrap_or(0)
    }

    /// Writes the row of `Q` of a reading of a run, whose row in the fit this is.
    pub(super) fn row(&self, run: usize, row: &[f64], factor: f64, out: &mut [f64]) {
        out.fill(0.0);
        let (inverse, _) = self.solution.elimination(run);
        let (own, coefficients) = row.split_at(inverse.rows());
        let shared = &mut out[..self.first[0]];
        self.shared.add_rows(factor, coefficients, shared);
        self.answers[run].add_rows(factor, own, shared);
        inverse.add_rows(factor, own, &mut out[self.first[run]..self.first[run + 1]]);
    }

    /// What `Linearised` holds as `factor` and `deviations`.
    pub(super) fn faults(&self, fit: &Fit) -> (Matrix, Vec<f64>) {
        let sigma_mm = fit.state.counts_mm();
        let (mut rows, mut deviations) = (Vec::new(), Vec::new());
        let mut push = |parts: [(&[f64], usize); 2], sigma: f64| {
            let mut row = vec![0.0; self.rank()];
            for (values, first) in parts {
                row[first..first + values.len()].copy_from_slice(values);
            }
            rows.push(row);
            deviations.push(sigma);
        };
        for (k, plausible) in fit.state.plausible.iter().enumerate() {
            push([(self.shared.row(k), 0), (&[], 0)], plausible.unwrap_or(f64::INFINITY));
        }
        for run in 0..fit.runs.len() {
            let (inverse, _) = self.solution.elimination(run);
            for (column, _, sigma) in fit.driven(run) {
                let answers = self.answers[run].row(column);
                push([(answers, 0), (inverse.row(column), self.first[run])], sigma);
            }
        }
        let factor = Matrix::from_fn(rows.len(), self.rank(), |i, k| rows[i][k] / sigma_mm);
        (factor, deviations)
    }
}
