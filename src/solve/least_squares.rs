//! The least-squares solution over the directions that the data see, and its uncertainty.
//!
//! ```text
//! x = D^-1 V_r S_r^-1 U_r^T c             minimum norm of D x over the retained directions
//! (J^T J)^+ = D^-1 V_r S_r^-2 V_r^T D^-1  covariance for independent unit noise in the rows
//! ```
//!
//! `D`, `V`, `S`, `U` and `c` as in [`Spectrum`] and [`Triangle`]; `r` is how many directions are kept.

use super::matrix::{Matrix, norm};
use super::spectrum::{Spectrum, Truncation};
use super::triangle::Triangle;
use crate::Result;

/// The solution of a least-squares problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    spectrum: Spectrum,
    rank: usize,
    x: Vec<f64>,
}

/// Solves `min |J x - e|` for the rows in the triangle.
///
/// ```
/// use ballbar::solve::{Truncation, Tsqr, solve};
///
/// // Only the sum of the two unknowns is seen: the shortest of all solutions shares it evenly.
/// let mut rows = Tsqr::new(2);
/// rows.push(&[1.0, 1.0], 3.0);
/// rows.push(&[2.0, 2.0], 6.0);
/// let solution = solve(&rows.finish()?, Truncation::Relative(1e-10))?;
/// assert_eq!(solution.rank(), 1);
/// assert!((solution.x()[0] - 1.5).abs() < 1e-14);
/// assert!((solution.observed_fraction()[0] - 0.5).abs() < 1e-14);
/// # Ok::<(), ballbar::Error>(())
/// ```
pub fn solve(triangle: &Triangle, truncation: Truncation) -> Result<Solution> {
    Ok(Spectrum::of(triangle)?.solve(truncation))
}

impl Spectrum {
    /// The least-squares solution over the retained directions.
    pub fn solve(self, truncation: Truncation) -> Solution {
        let rank = self.retained(truncation);
        let along: Vec<f64> =
            (0..rank).map(|i| self.u_t_rhs[i] / self.singular_values[i]).collect();
        let x = (0..self.columns())
            .map(|k| unscale(super::vector::dot(&self.v.row(k)[..rank], &along), self.scales[k]))
            .collect();
        Solution { spectrum: self, rank, x }
    }
}

impl Solution {
    /// The coefficients, each in its unit (unit of the right-hand side over unit of its column).
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// How many directions were kept.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// The singular value decomposition that the solution comes from.
    pub fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// `|J x - e|`, in the unit of the right-hand side; truncated directions count as not fitted.
    pub fn residual_norm(&self) -> f64 {
        let left = self.spectrum.u_t_rhs[self.rank..].iter().copied();
        norm(left.chain(std::iter::once(self.spectrum.residual_norm)))
    }

    /// Rows less rank; zero if the rows are fewer.
    pub fn degrees_of_freedom(&self) -> usize {
        self.spectrum.rows.saturating_sub(self.rank)
    }

    /// The standard deviation of one row, `|J x - e| / sqrt(rows - rank)`, if all rows are equally
    /// and independently noisy; nothing if no degree of freedom is left.
    pub fn residual_sigma(&self) -> Option<f64> {
        match self.degrees_of_freedom() {
            0 => None,
            freedom => Some(self.residual_norm() / (freedom as f64).sqrt()),
        }
    }

    /// [`Spectrum::observed_fraction`] of the retained directions.
    pub fn observed_fraction(&self) -> Vec<f64> {
        self.spectrum.observed_fraction(self.rank)
    }

    /// `(J^T J)^+`, `n x n`, restricted to the retained directions, in the units of the coefficients
    /// per unit of a row, squared.
    ///
    /// For independent noise of standard deviation `sigma` in every row the covariance is `sigma^2`
    /// times this; for rows that were divided by their own standard deviation it is this. Read the
    /// diagonal with [`observed_fraction`](Self::observed_fraction): a coefficient that is not seen has
    /// variance 0 here, because the solution never moves it.
    pub fn covariance_unscaled(&self) -> Matrix {
        let s = &self.spectrum.singular_values;
        Matrix::from_fn(self.x.len(), self.rank, |k, i| {
            unscale(self.spectrum.v[(k, i)] / s[i], self.spectrum.scales[k])
        })
        .times_own_transpose()
    }

    /// The covariance `(J^T J)^+ M (J^T J)^+` for correlated noise, `M = J^T Sigma J` given as the
    /// triangle of the rows `L^T J`, `Sigma = L L^T` (see [`BackwardFilter`](super::BackwardFilter)),
    /// in the units of the coefficients, squared.
    ///
    /// With rows weighed by the diagonal `W`, `J` here is `W^(1/2) J`, and the rows to filter are
    /// `W J`, with the full weight and not its root. Only the noise in the rows of `Sigma` is counted;
    /// a prior's own variance goes in as one more row, `e_k / sigma`, which is its `W J` filtered.
    ///
    /// # Panics
    ///
    /// If the triangle has another number of columns.
    pub fn covariance_sandwich(&self, filtered: &Triangle) -> Matrix {
        let spectrum = &self.spectrum;
        // W = (J^T J)^+ R_M^T, so that W W^T stays symmetric and non-negative whatever the rounding.
        // With B = R_M D^-1 V_r, W = D^-1 V_r S_r^-2 B^T.
        let columns = self.x.len();
        let v_scaled = Matrix::from_fn(columns, self.rank, |k, i| {
            unscale(spectrum.v[(k, i)], spectrum.scales[k])
        });
        let b = filtered.r().times(&v_scaled);
        let divided = Matrix::from_fn(self.rank, columns, |i, k| {
            b[(k, i)] / spectrum.singular_values[i] / spectrum.singular_values[i]
        });
        v_scaled.times(&divided).times_own_transpose()
    }
}

/// The standard deviations on the diagonal of a covariance.
pub fn standard_deviations(covariance: &Matrix) -> Vec<f64> {
    covariance.diagonal().into_iter().map(|variance| variance.max(0.0).sqrt()).collect()
}

/// The correlations of a covariance: ones on the diagonal, and zeros beside it where a variance is zero.
pub fn correlation(covariance: &Matrix) -> Matrix {
    let sigma = standard_deviations(covariance);
    Matrix::from_fn(covariance.rows(), covariance.columns(), |i, k| {
        if i == k {
            1.0
        } else if sigma[i] > 0.0 && sigma[k] > 0.0 {
            (covariance[(i, k)] / sigma[i] / sigma[k]).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    })
}

/// A scaled coefficient in its own unit; a vanished column has no effect, so its coefficient stays zero.
fn unscale(z: f64, scale: f64) -> f64 {
    if scale > 0.0 { z / scale } else { 0.0 }
}
