//! What there is to choose from, what it is worth, and what one more arc gains.
//!
//! The covariance of coefficients and set-up errors before a measurement is the inverse of the
//! information, `C = (I + sum F^T F)^-1`. One more arc with the factor `F` leaves
//! `C' = C - Z^T Z`, `Z = L^-1 F C`, `L L^T = I + F C F^T`, so what it gains costs one small factorisation:
//!
//! | criterion | value | gain |
//! | --- | --- | --- |
//! | A | `trace(W C)`, the mean square over the volume | `trace(Z W Z^T)` |
//! | D | `ln det C`, over the wanted coefficients | `-ln det(I - Z C^-1 Z^T)` |
//! | G | `(mean of v^4)^(1/4)` over points, `v = trace(J C J^T)` | by `v' = v - |J Z^T|²` |
//!
//! G's largest value has no slope where another point is nearly as bad; a high power of it has.

use rayon::prelude::*;

use super::information::{ArcInformation, SET_UPS};
use crate::plan::Criterion;
use crate::solve::{Cholesky, Matrix};

/// Power of the mean that stands for the worst point.
pub(super) const POWER: i32 = 4;

/// What is to be small.
#[derive(Debug, Clone)]
pub(super) struct Objective {
    pub(super) criterion: Criterion,
    /// Indices of the wanted coefficients, which D counts.
    pub(super) wanted: Vec<usize>,
    /// `W`, over the coefficients, mm² in their sizes.
    pub(super) mean_square: Matrix,
    /// `J` of the points, [`ROWS`](super::volume) rows each, mm.
    pub(super) points: Vec<Matrix>,
}

/// A problem: what there is to choose from, and for how long.
#[derive(Debug)]
pub(super) struct Problem {
    pub(super) coefficients: usize,
    pub(super) objective: Objective,
    /// All arcs in all set-ups.
    pub(super) arcs: Vec<ArcInformation>,
    /// What each set-up takes before its first arc, s.
    pub(super) set_up_s: Vec<f64>,
    /// What is known beforehand, over the coefficients: the prior, and what was measured.
    pub(super) known: Matrix,
    pub(super) most_set_ups: usize,
}

/// What was chosen: set-ups and indices of arcs, and the value of the criterion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chosen {
    pub(super) set_ups: Vec<usize>,
    pub(super) arcs: Vec<usize>,
    pub(super) value: f64,
    /// No plan of the same set-ups, arcs and time is below this.
    pub(super) bound: f64,
}

impl Objective {
    /// The value for a covariance whose first rows are the coefficients'.
    pub(super) fn value(&self, c: &Matrix, coefficients: usize) -> f64 {
        let corner = Matrix::from_fn(coefficients, coefficients, |i, k| c[(i, k)]);
        match self.criterion {
            Criterion::A => trace_of_product(&self.mean_square, &corner),
            Criterion::D => {
                let c = self.of_wanted(&corner);
                Cholesky::of(&c).map_or(f64::INFINITY, |f| f.log_determinant())
            }
            Criterion::G => {
                let variances: Vec<f64> =
                    self.points.iter().map(|j| variance(j, &corner)).collect();
                power_mean(&variances)
            }
        }
    }
}

impl Objective {
    /// Rows and columns of the wanted coefficients.
    fn of_wanted(&self, corner: &Matrix) -> Matrix {
        let wanted = &self.wanted;
        Matrix::from_fn(wanted.len(), wanted.len(), |i, k| corner[(wanted[i], wanted[k])])
    }

    /// `C^-1` of the wanted coefficients, in the place of theirs, zero elsewhere.
    pub(super) fn inverse_of_wanted(&self, corner: &Matrix) -> Option<Matrix> {
        let inverse = Cholesky::of(&self.of_wanted(corner))?.inverse();
        let place = |k: usize| self.wanted.iter().position(|&wanted| wanted == k);
        let places: Vec<Option<usize>> = (0..corner.rows()).map(place).collect();
        Some(Matrix::from_fn(corner.rows(), corner.rows(), |i, k| match (places[i], places[k]) {
            (Some(i), Some(k)) => inverse[(i, k)],
            _ => 0.0,
        }))
    }
}

/// `trace(A B)` of symmetric matrices.
pub(super) fn trace_of_product(a: &Matrix, b: &Matrix) -> f64 {
    (0..a.rows()).map(|i| a.row(i).iter().zip(b.row(i)).map(|(a, b)| a * b).sum::<f64>()).sum()
}

/// `trace(J C J^T)`.
pub(super) fn variance(j: &Matrix, c: &Matrix) -> f64 {
    let spread = j.times(c);
    (0..j.rows()).map(|i| j.row(i).iter().zip(spread.row(i)).map(|(a, b)| a * b).sum::<f64>()).sum()
}

pub(super) fn power_mean(values: &[f64]) -> f64 {
    let sum: f64 = values.iter().map(|v| v.max(0.0).powi(POWER)).sum();
    (sum / values.len().max(1) as f64).powf(f64::from(POWER).recip())
}

/// What holds for all candidates of one step.
pub(super) struct Step {
    /// For each chosen set-up the rows and columns of its arcs.
    of_set_up: Vec<Matrix>,
    pub(super) value: f64,
    /// `C^-1` of the coefficients, for D.
    inverse: Option<Matrix>,
    /// `v` of the points, for G.
    variances: Vec<f64>,
}

impl Problem {
    /// The shortest test, s.
    pub(super) fn shortest_s(&self) -> f64 {
        let of_arc = |arc: &ArcInformation| self.set_up_s[arc.set_up] + arc.seconds;
        self.arcs.iter().map(of_arc).fold(f64::INFINITY, f64::min)
    }

    /// The criterion before the first arc.
    pub(super) fn value_before(&self) -> f64 {
        self.step(&[], &self.known).map_or(f64::INFINITY, |step| step.value)
    }

    /// The best single arcs after what is known, by gain a second, each with the value that it leaves.
    pub(super) fn next_arcs(&self) -> Vec<(usize, f64)> {
        let set_ups: Vec<usize> = (0..self.set_up_s.len()).collect();
        let Some(step) = self.step(&set_ups, &self.start(&set_ups)) else { return Vec::new() };
        let mut gains: Vec<(usize, f64)> = (0..self.arcs.len())
            .into_par_iter()
            .map(|index| (index, self.gain(&step, &set_ups, index)))
            .collect();
        let seconds =
            |index: usize| self.set_up_s[self.arcs[index].set_up] + self.arcs[index].seconds;
        gains.sort_by(|a, b| (b.1 / seconds(b.0)).total_cmp(&(a.1 / seconds(a.0))));
        gains.into_iter().map(|(index, gain)| (index, step.value - gain)).collect()
    }

    /// Information before the first arc.
    pub(super) fn start(&self, set_ups: &[usize]) -> Matrix {
        let n = self.coefficients;
        let total = n + SET_UPS * set_ups.len();
        Matrix::from_fn(total, total, |i, k| match (i < n && k < n, i == k) {
            (true, _) => self.known[(i, k)],
            (false, true) => 1.0,
            _ => 0.0,
        })
    }

    /// Adds what an arc tells, `sign` times.
    pub(super) fn add(&self, information: &mut Matrix, set_ups: &[usize], index: usize, sign: f64) {
        let arc = &self.arcs[index];
        let columns = self.columns(set_ups, arc.set_up);
        for row in 0..arc.factor.rows() {
            let row = arc.factor.row(row);
            for (&i, &a) in columns.iter().zip(row) {
                for (&k, &b) in columns.iter().zip(row) {
                    information[(i, k)] += sign * a * b;
                }
            }
        }
    }

    /// Where the columns of a set-up's arcs stand among all.
    pub(super) fn columns(&self, set_ups: &[usize], set_up: usize) -> Vec<usize> {
        let slot = set_ups.iter().position(|&s| s == set_up).unwrap_or(0);
        let first = self.coefficients + SET_UPS * slot;
        (0..self.coefficients).chain(first..first + SET_UPS).collect()
    }

    pub(super) fn step(&self, set_ups: &[usize], information: &Matrix) -> Option<Step> {
        let n = self.coefficients;
        let c = Cholesky::of(information)?.inverse();
        let of_set_up = set_ups
            .iter()
            .map(|&set_up| {
                let columns = self.columns(set_ups, set_up);
                Matrix::from_fn(n + SET_UPS, n + SET_UPS, |i, k| c[(columns[i], columns[k])])
            })
            .collect();
        let corner = Matrix::from_fn(n, n, |i, k| c[(i, k)]);
        let inverse = match self.objective.criterion {
            Criterion::D => Some(self.objective.inverse_of_wanted(&corner)?),
            _ => None,
        };
        let variances = match self.objective.criterion {
            Criterion::G => self.objective.points.iter().map(|j| variance(j, &corner)).collect(),
            _ => Vec::new(),
        };
        Some(Step { value: self.objective.value(&c, n), of_set_up, inverse, variances })
    }

    /// By how much an arc lowers the value.
    pub(super) fn gain(&self, step: &Step, set_ups: &[usize], index: usize) -> f64 {
        let n = self.coefficients;
        let arc = &self.arcs[index];
        let Some(slot) = set_ups.iter().position(|&s| s == arc.set_up) else { return 0.0 };
        let factor = &arc.factor;
        let moved = factor.times(&step.of_set_up[slot]);
        let r = factor.rows();
        let k = Matrix::from_fn(r, r, |i, j| {
            let sum: f64 = moved.row(i).iter().zip(factor.row(j)).map(|(a, b)| a * b).sum();
            sum + if i == j { 1.0 } else { 0.0 }
        });
        let Some(root) = Cholesky::of(&k) else { return 0.0 };
        let mut z = Matrix::from_fn(r, n, |i, j| moved[(i, j)]);
        root.half_solve(&mut z);
        match (self.objective.criterion, &step.inverse) {
            (Criterion::D, Some(inverse)) => {
                let stretched = z.times(inverse);
                let rest = Matrix::from_fn(r, r, |i, j| {
                    let sum: f64 = stretched.row(i).iter().zip(z.row(j)).map(|(a, b)| a * b).sum();
                    (if i == j { 1.0 } else { 0.0 }) - sum
                });
                Cholesky::of(&rest).map_or(0.0, |f| -f.log_determinant())
            }
            (Criterion::G, _) => {
                let across = z.transposed();
                let left = |(j, v): (&Matrix, &f64)| {
                    let moved = j.times(&across);
                    let taken: f64 = (0..moved.rows())
                        .map(|i| moved.row(i).iter().map(|x| x * x).sum::<f64>())
                        .sum();
                    v - taken
                };
                let after: Vec<f64> =
                    self.objective.points.iter().zip(&step.variances).map(left).collect();
                step.value - power_mean(&after)
            }
            _ => variance(&z, &self.objective.mean_square),
        }
    }
}

/// Adds `weight · F^T F`.
pub(super) fn add_information(information: &mut Matrix, factor: &Matrix, weight: f64) {
    for row in 0..factor.rows() {
        let row = factor.row(row);
        for (i, &a) in row.iter().enumerate() {
            for (sum, &b) in information.row_mut(i).iter_mut().zip(row) {
                *sum += weight * a * b;
            }
        }
    }
}
