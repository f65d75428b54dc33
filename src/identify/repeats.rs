//! Repeats: mean and standard deviation over tests that were identified separately (paper, Eq. 8).

use super::result::Estimate;
use crate::model::Parameter;

/// A parameter over the repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeat {
    /// Name and unit.
    pub parameter: Parameter,
    /// Mean, in its unit.
    pub mean: f64,
    /// `sqrt(sum (E_j - mean)² / (n - 1))`; `None` for a single test.
    pub deviation: Option<f64>,
    /// Root mean square of the sigmas stated for the single tests. A deviation well above it says that
    /// the machine, or its set-up, changed between the tests.
    pub stated_sigma: f64,
}

/// Mean and deviation of every parameter over tests with the same model.
pub fn repeats(tests: &[&[Estimate]]) -> Vec<Repeat> {
    let Some(first) = tests.first() else { return Vec::new() };
    let count = tests.len() as f64;
    (0..first.len())
        .map(|k| {
            let mean = tests.iter().map(|test| test[k].value).sum::<f64>() / count;
            let squares: f64 = tests.iter().map(|test| (test[k].value - mean).powi(2)).sum();
            let stated: f64 = tests.iter().map(|test| test[k].sigma.powi(2)).sum::<f64>() / count;
            Repeat {
                parameter: first[k].parameter.clone(),
                mean,
                deviation: (tests.len() > 1).then(|| (squares / (count - 1.0)).sqrt()),
                stated_sigma: stated.sqrt(),
            }
        })
        .collect()
}
