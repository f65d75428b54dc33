//! The rows `L^T J` that turn a noise model into the covariance of a fit.
//!
//! With `e = L w`, `w` white, the covariance of the noise is `Sigma = L L^T` and the middle of the
//! sandwich is `M = J^T L L^T J`: the triangle of the rows `Y = L^T J`. `L` runs the noise forward in
//! time, so `L^T` runs backward. For a segment of `n` samples and order `p`, samples counted from 0:
//!
//! ```text
//! a_t = J_t + sum_k phi_k a_(t+k)       over k = 1 .. p with p <= t + k < n
//! y_t = sigma_i a_t                                       for t >= p
//! y_t = sum_i C_it a_i                  over i = t .. p-1  for t <  p
//! ```
//!
//! The first `p` samples have no past to be predicted from. `C C^T` is their stationary covariance, so
//! `L L^T` is exactly the covariance of a segment cut out of the noise, and not of one that started from
//! silence, which would underrate short arcs.

use super::matrix::Matrix;
use super::noise::NoiseModel;

/// Filters the rows of one segment after another, last sample first, without keeping them.
///
/// ```
/// use ballbar::solve::{BackwardFilter, NoiseModel, Tsqr};
///
/// let noise = NoiseModel::autoregressive(vec![0.9], 0.1)?;
/// let mut filter = BackwardFilter::new(&noise, 1);
/// let mut filtered = Tsqr::new(1);
/// filter.begin(100);
/// for _ in 0..100 {
///     filtered.push(filter.push(&[1.0]), 0.0);
/// }
/// // The variance of the mean is M / n^2, and so the noise of as many independent samples.
/// let m = filtered.finish()?.r()[(0, 0)].powi(2);
/// let independent = noise.sigma().powi(2) / (m / 1e4);
/// assert!((independent - noise.effective_samples(100)).abs() < 1e-9);
/// # Ok::<(), ballbar::Error>(())
/// ```
pub struct BackwardFilter {
    phi: Vec<f64>,
    innovation_sigma: f64,
    /// `C`, `p x p`.
    start: Matrix,
    /// `a_t` of the last rows: row `t mod p`.
    recent: Matrix,
    output: Vec<f64>,
    /// Samples of the segment in all, and those still to come.
    length: usize,
    left: usize,
}

impl BackwardFilter {
    /// A filter for rows of `n_columns` elements.
    pub fn new(noise: &NoiseModel, n_columns: usize) -> Self {
        let order = noise.phi().len();
        Self {
            phi: noise.phi().to_vec(),
            innovation_sigma: noise.innovation_sigma(),
            start: noise.covariance_root(order),
            recent: Matrix::zeros(order.max(1), n_columns),
            output: vec![0.0; n_columns],
            length: 0,
            left: 0,
        }
    }

    /// Begins a segment of `length` samples. What came before is forgotten.
    pub fn begin(&mut self, length: usize) {
        self.length = length;
        self.left = length;
    }

    /// Takes the next row from the end of the segment (sample `length - 1` first, sample 0 last) and
    /// returns the row of `L^T J` of the same sample, in the unit of the row times that of the noise.
    ///
    /// # Panics
    ///
    /// If more rows come than the segment has samples, or the row has another number of elements.
    pub fn push(&mut self, row: &[f64]) -> &[f64] {
        assert!(self.left > 0, "a segment has as many rows as it said");
        assert_eq!(row.len(), self.output.len(), "rows of equal length");
        self.left -= 1;
        let t = self.left;
        let order = self.phi.len();
        let slots = self.recent.rows();
        self.output.copy_from_slice(row);
        for (k, &phi) in (1..).zip(&self.phi) {
            if t + k >= order && t + k < self.length {
                add(&mut self.output, phi, self.recent.row((t + k) % slots));
            }
        }
        // The row p samples later is used up by now: its place is free.
        self.recent.row_mut(t % slots).copy_from_slice(&self.output);
        if t >= order {
            self.output.iter_mut().for_each(|y| *y *= self.innovation_sigma);
        } else {
            self.output.fill(0.0);
            for i in t..order.min(self.length) {
                add(&mut self.output, self.start[(i, t)], self.recent.row(i % slots));
            }
        }
        &self.output
    }
}

/// `sum += factor * row`.
fn add(sum: &mut [f64], factor: f64, row: &[f64]) {
    for (sum, x) in sum.iter_mut().zip(row) {
        *sum += factor * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Filtering the identity gives `L^T` itself, and `L L^T` must be the covariance of the samples.
    #[test]
    fn filtered_identity_squares_to_the_covariance() {
        for phi in [vec![], vec![0.9], vec![1.2, -0.5], vec![0.9, -0.5, 0.2, 0.1]] {
            let noise = NoiseModel::autoregressive(phi, 0.3).unwrap();
            for n in [1, 2, 3, 4, 5, 12] {
                let mut filter = BackwardFilter::new(&noise, n);
                for _ in 0..2 {
                    filter.begin(n);
                    let identity = Matrix::identity(n);
                    let mut l_t = Matrix::zeros(n, n);
                    for t in (0..n).rev() {
                        l_t.row_mut(t).copy_from_slice(filter.push(identity.row(t)));
                    }
                    let covariance = l_t.transposed().times_own_transpose();
                    let rho = noise.autocorrelation(n);
                    for i in 0..n {
                        for k in 0..n {
                            let expected = noise.sigma().powi(2) * rho[i.abs_diff(k)];
                            assert!((covariance[(i, k)] - expected).abs() < 1e-14, "{i} {k}");
                        }
                    }
                }
            }
        }
    }
}
