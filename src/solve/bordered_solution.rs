//! The solution of least squares in blocks, and its uncertainty.
//!
//! With `T_b`, `C_b` and `H_b` of [`Bordered`](super::Bordered) rows and independent unit noise in them
//!
//! ```text
//! cov(y_b) = T_b^-1 T_b^-T + H_b G H_b^T,    cov(y_b, x) = -H_b G,    G = cov(x)
//! ```

use super::least_squares::Solution;
use super::matrix::Matrix;
use super::triangle::Triangle;
use super::tsqr::Tsqr;
use crate::Result;

/// Values of all unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknowns {
    /// The shared ones.
    pub shared: Vec<f64>,
    /// The own ones of each block.
    pub own: Vec<Vec<f64>>,
}

/// The solution of [`Bordered`](super::Bordered) rows.
#[derive(Debug, Clone)]
pub struct BorderedSolution {
    pub(super) shared: Solution,
    pub(super) unknowns: Unknowns,
    pub(super) eliminations: Vec<Elimination>,
}

/// Covariances of the shared unknowns and, block by block, of the own ones, in their units.
#[derive(Debug, Clone)]
pub struct BorderedCovariance {
    /// Of the shared unknowns.
    pub shared: Matrix,
    /// Of the own unknowns of each block.
    pub own: Vec<Matrix>,
}

/// How the own unknowns of a block follow from the shared ones.
#[derive(Debug, Clone)]
pub(super) struct Elimination {
    /// `T^-1`, with zeros for an own unknown that the rows of the block say nothing of.
    pub(super) inverse: Matrix,
    /// `H = T^-1 C`.
    pub(super) ratio: Matrix,
}

impl Unknowns {
    /// All of them times a factor.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        let times = |of: &Vec<f64>| of.iter().map(|value| factor * value).collect();
        Self { shared: times(&self.shared), own: self.own.iter().map(times).collect() }
    }

    /// With others.
    #[must_use]
    pub fn plus(&self, others: &Self) -> Self {
        let plus = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Self {
            shared: plus((&self.shared, &others.shared)),
            own: self.own.iter().zip(&others.own).map(plus).collect(),
        }
    }
}

impl BorderedSolution {
    /// The solution of the shared unknowns, with the own ones free to follow; its residual and its degrees of freedom
    /// are those of all rows but for the own unknowns.
    pub fn shared(&self) -> &Solution {
        &self.shared
    }

    /// All unknowns, each in its unit.
    pub fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    /// `T^-1` and `H` of a block: its own unknowns are `T^-1 d - H x`.
    pub fn elimination(&self, block: usize) -> (&Matrix, &Matrix) {
        let Elimination { inverse, ratio } = &self.eliminations[block];
        (inverse, ratio)
    }

    /// The covariance for independent unit noise in the rows, as [`Solution::covariance_unscaled`].
    pub fn covariance_unscaled(&self) -> BorderedCovariance {
        let shared = self.shared.covariance_unscaled();
        let own = |Elimination { inverse, ratio }: &Elimination| {
            let by_shared = ratio.times(&shared).times(&ratio.transposed());
            sum(&inverse.times_own_transpose(), &by_shared, 1.0)
        };
        BorderedCovariance { own: self.eliminations.iter().map(own).collect(), shared }
    }

    /// The covariance for correlated noise, as [`Solution::covariance_sandwich`], with the filtered rows of each block,
    /// its own unknowns first.
    ///
    /// With `M_b = [ N_b  P_b ]` the filtered triangle of a block, the shared unknowns answer to `P_b - N_b H_b`, and
    /// `y_b` to its own rows through `T_b^-1 T_b^-T N_b^T` besides.
    ///
    /// # Errors
    /// When squares leave the range of numbers.
    pub fn covariance_sandwich(&self, filtered: &[Triangle]) -> Result<BorderedCovariance> {
        let count = self.unknowns.shared.len();
        let mut rows = Tsqr::new(count);
        let parts: Vec<(Matrix, Matrix)> = filtered
            .iter()
            .zip(&self.eliminations)
            .map(|(filtered, Elimination { inverse, ratio })| {
                let (own, all) = (inverse.rows(), filtered.columns());
                let left = Matrix::from_fn(all, own, |i, k| filtered.r[(i, k)]);
                let right = Matrix::from_fn(all, count, |i, k| filtered.r[(i, own + k)]);
                (sum(&right, &left.times(ratio), -1.0), left)
            })
            .collect();
        for (reduced, _) in &parts {
            for i in 0..reduced.rows() {
                rows.push(reduced.row(i), 0.0);
            }
        }
        let shared = self.shared.covariance_sandwich(&rows.finish()?);
        let inverse_shared = self.shared.covariance_unscaled();
        let own = |((reduced, left), of): (&(Matrix, Matrix), &Elimination)| {
            let Elimination { inverse, ratio } = of;
            let to_shared = ratio.times(&inverse_shared.times(&reduced.transposed()));
            let to_own = inverse.times(&inverse.transposed()).times(&left.transposed());
            let by_itself = sum(&to_own, &to_shared, -1.0).times_own_transpose();
            let by_all = ratio.times(&shared).times(&ratio.transposed());
            sum(&by_itself, &sum(&by_all, &to_shared.times_own_transpose(), -1.0), 1.0)
        };
        let own = parts.iter().zip(&self.eliminations).map(own).collect();
        Ok(BorderedCovariance { shared, own })
    }
}

/// `A + factor B`.
fn sum(a: &Matrix, b: &Matrix, factor: f64) -> Matrix {
    Matrix::from_fn(a.rows(), a.columns(), |i, k| a[(i, k)] + factor * b[(i, k)])
}
