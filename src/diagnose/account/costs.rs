//! What is not known of the effects, in the numbers of the extended model.

use crate::identify::Campaign;
use crate::residual::{Fitted, Residuals};
use crate::solve::{Matrix, dot, low_rank_factor};

/// Counts what is not known of amplitudes and numbers inside in what the extended model states.
///
/// With `c` the columns of the effects the faults of a repeat change by `- F Q^T c` per unit; the covariance of the
/// numbers is `v` times the inverse of their normal matrix. Residuals are linear about the extended model. An effect without a cause
/// has moved the faults by what its amplitudes make of that.
pub(crate) fn count(
    extended: &mut Campaign,
    residuals: &Residuals,
    fitted: &Fitted,
    long_run_mm2: f64,
) {
    let independent = low_rank_factor(&fitted.inverse, 0.0);
    let sigma_mm = long_run_mm2.sqrt();
    let elements = fitted.elements.iter().enumerate();
    let unexplained: Vec<usize> =
        elements.filter(|(_, element)| element.curve().is_some()).map(|(k, _)| k).collect();
    for (index, repeat) in residuals.repeats.iter().enumerate() {
        let columns: Vec<&[f64]> = fitted.columns.iter().map(|c| c[index].as_slice()).collect();
        let along = repeat.basis.along(&columns);
        let change = |fault: usize, k: usize| -dot(repeat.factor.row(fault), &along[k]);
        let changes = Matrix::from_fn(repeat.factor.rows(), columns.len(), change);
        let moved = Matrix::from_fn(repeat.factor.rows(), unexplained.len(), |fault, k| {
            let element = unexplained[k];
            let first = fitted.first_index(element);
            let amplitudes = fitted.amplitudes[element].iter().enumerate();
            amplitudes.map(|(own, a)| changes[(fault, first + own)] * a).sum()
        });
        let sigmas = Matrix::from_fn(changes.rows(), changes.columns(), |fault, k| {
            changes[(fault, k)] * sigma_mm
        });
        let sigmas = sigmas.times(&independent.transposed());
        extended.repeats[index].count_effects(&sigmas, &moved, &repeat.deviations);
    }
}
