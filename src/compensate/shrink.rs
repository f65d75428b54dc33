//! What is smaller than its uncertainty is not compensated as if it were known.
//!
//! In units of what is plausible the parameters are `x` and the covariance by all is `W`, with the eigenvectors `v_i` and eigenvalues
//! `l_i`: directions that the test knows independently of each other. Along one whose error `a_i = v_i · x` is smaller than its
//! uncertainty, `a_i² < l_i`, the best that can be said is `a_i · a_i² / (a_i² + l_i)`. A squareness is known although neither
//! of the two slopes is that make it: so it is done by directions, and not by parameters.
//!
//! How the control may have driven is no part of that uncertainty. A lag that nobody can rule out makes a common scale uncertain by
//! `(v T)² / 2 R²`, 22 um/m of 20 ms at 2000 mm/min on 100 mm; what the bar has seen is right for the machine with its control at that
//! feed all the same.

use nalgebra::{DMatrix, DVector};

use super::error_model::ErrorModel;

/// What was shrunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shrunk {
    /// Directions in which the error is smaller than its uncertainty.
    pub directions: usize,
    /// Of so many.
    pub of: usize,
}

impl ErrorModel {
    /// The same with every direction shrunk whose error is smaller than its uncertainty.
    #[must_use]
    pub fn shrunk(mut self) -> (Self, Shrunk) {
        let count = self.values.len();
        let all = |i: usize, k: usize| self.noise[(i, k)] + self.open[(i, k)] - self.driven[(i, k)];
        let scale = |k: usize| {
            let plausible = self.parameters[k].plausible.filter(|sigma| *sigma > 0.0);
            plausible.unwrap_or_else(|| all(k, k).sqrt()).max(f64::MIN_POSITIVE.sqrt())
        };
        let scales: Vec<f64> = (0..count).map(scale).collect();
        let known = DMatrix::from_fn(count, count, |i, k| all(i, k) / (scales[i] * scales[k]));
        let eigen = known.symmetric_eigen();
        let values = DVector::from_fn(count, |k, _| self.values[k] / scales[k]);
        let mut shrunk = DVector::zeros(count);
        let mut directions = 0;
        for (k, direction) in eigen.eigenvectors.column_iter().enumerate() {
            let (error, variance) = (direction.dot(&values), eigen.eigenvalues[k].max(0.0));
            let square = error * error;
            let factor = if square < variance { square / (square + variance) } else { 1.0 };
            directions += usize::from(factor < 1.0);
            shrunk += direction * (error * factor);
        }
        self.values = shrunk.iter().zip(&scales).map(|(value, scale)| value * scale).collect();
        (self, Shrunk { directions, of: count })
    }
}
