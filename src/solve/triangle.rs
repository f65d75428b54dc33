//! What is left of all rows of a least-squares problem: a triangle.

use super::matrix::{Matrix, norm};

/// The triangle that stands for all rows of a least-squares problem `min |J x - e|`.
///
/// With `n` columns and any number of rows, `J^T J = R^T R`, `J^T e = R^T c` and
/// `|e|^2 = |c|^2 + rho^2`: everything that a solution, its residual and its covariance need.
#[derive(Debug, Clone, PartialEq)]
pub struct Triangle {
    pub(super) r: Matrix,
    pub(super) q_t_rhs: Vec<f64>,
    pub(super) residual_norm: f64,
    pub(super) rows: usize,
}

impl Triangle {
    /// `R`, `n x n`, zero below the diagonal. Element `(i, k)` has the unit of column `k`.
    ///
    /// Its diagonal may have either sign and is no test of the rank; [`Spectrum`](super::Spectrum) is.
    pub fn r(&self) -> &Matrix {
        &self.r
    }

    /// `c`, the first `n` elements of `Q^T e`, in the unit of the right-hand side.
    pub fn q_t_rhs(&self) -> &[f64] {
        &self.q_t_rhs
    }

    /// `rho`, the part of the right-hand side outside the `n` rows of `R`, in its unit.
    ///
    /// It is the norm of the residual when all columns are independent, and a lower bound of it
    /// otherwise: [`Solution::residual_norm`](super::Solution::residual_norm) is right in both cases.
    pub fn residual_norm(&self) -> f64 {
        self.residual_norm
    }

    /// `|e|`, the norm of the right-hand side, in its unit: of the residual where nothing moves.
    pub fn rhs_norm(&self) -> f64 {
        norm(self.q_t_rhs.iter().copied()).hypot(self.residual_norm)
    }

    /// How many rows were pushed, priors included.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns `n`, without the right-hand side.
    pub fn columns(&self) -> usize {
        self.r.columns()
    }
}
