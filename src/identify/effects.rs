//! What is not known of effects that stand beside a model, in what the model states.
//!
//! With `G` what one of each number of the effects changes the parameters by (the fit follows them as `- F Q^T c`), and
//! `N` the covariance of these numbers, the parameters and the numbers estimated together have the covariance
//! `C + G N G^T`: by the noise, and as well of what is plausible.
//!
//! A curve that nobody has explained is known where readings lie and by its shape there, not by what makes it. What it has taken
//! from a parameter, `G a` with its own numbers `a`, may be the parameter's all the same: of what grows with speed from a
//! standstill on like a root, a part looks like a lost motion. So much is left open, of all parameters together.

use super::result::Identification;
use crate::solve::{self, Matrix};

impl Identification {
    /// Counts what is not known of effects that it was identified with: `changes` is what a standard deviation of
    /// each independent combination of their numbers (column) does to the faults (row), first the parameters, then how
    /// the control may have driven; `moved` is what each effect without a cause (column) has moved them by; `deviations` is what is
    /// plausible of each fault.
    pub fn count_effects(&mut self, changes: &Matrix, moved: &Matrix, deviations: &[f64]) {
        let count = self.estimates.len();
        let both = changes.times_own_transpose();
        let covariance = &self.covariance;
        self.covariance = Matrix::from_fn(count, count, |i, k| covariance[(i, k)] + both[(i, k)]);
        self.correlation = solve::correlation(&self.covariance);
        self.left_open = self.left_open.as_ref().map(|open| {
            let faults = open.columns();
            Matrix::from_fn(count, faults + moved.columns(), |i, k| match k.checked_sub(faults) {
                None => open[(i, k)] + both[(i, k)] / deviations[k],
                Some(effect) => moved[(i, effect)],
            })
        });
        self.unexplained = moved.columns();
        for (k, sigma) in solve::standard_deviations(&self.covariance).into_iter().enumerate() {
            let open = self.left_open.as_ref().map(|open| open.row(k));
            let all = open.map(|open| open.iter().fold(sigma, |all, open| all.hypot(*open)));
            let estimate = &mut self.estimates[k];
            (estimate.sigma, estimate.all) = (sigma, all);
        }
        self.effects = Some(Matrix::from_fn(count, changes.columns(), |i, k| changes[(i, k)]));
    }
}
