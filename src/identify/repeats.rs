//! Repeats: mean and standard deviation over tests that were identified separately (paper, Eq. 8).

use super::result::{Estimate, Identification};
use crate::model::Parameter;

/// What differs between repeats by more than so many times its noise has changed: of the fifty numbers of two repeats one does so by
/// chance in 1 of 35 000 campaigns.
pub const CHANGED: f64 = 5.0;

/// A parameter over the repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeat {
    /// Name and unit.
    pub parameter: Parameter,
    /// Mean, in its unit.
    pub mean: f64,
    /// See [`deviation`]; `None` for a single test.
    pub deviation: Option<f64>,
    /// Root mean square of the sigmas stated for the single tests. A deviation well above it says that
    /// the machine, or its set-up, changed between the tests.
    pub stated_sigma: f64,
}

/// `sqrt(sum (x_j - mean)² / (n - 1))` of numbers that repeats gave; `None` for a single one.
pub fn deviation(of: &[f64]) -> Option<f64> {
    let count = of.len() as f64;
    let mean = of.iter().sum::<f64>() / count;
    let squares: f64 = of.iter().map(|one| (one - mean).powi(2)).sum();
    (of.len() > 1).then(|| (squares / (count - 1.0)).sqrt())
}

/// Whether all are of one test. What others drive tells of other numbers, and how their values differ is no scatter.
pub fn of_one_test(repeats: &[Identification]) -> bool {
    repeats.windows(2).all(|two| two[0].is_of_test_of(&two[1]))
}

/// Mean and deviation of every parameter over tests with the same model.
pub fn repeats(tests: &[&[Estimate]]) -> Vec<Repeat> {
    let Some(first) = tests.first() else { return Vec::new() };
    let count = tests.len() as f64;
    (0..first.len())
        .map(|k| {
            let values: Vec<f64> = tests.iter().map(|test| test[k].value).collect();
            let stated: f64 = tests.iter().map(|test| test[k].sigma.powi(2)).sum::<f64>() / count;
            Repeat {
                parameter: first[k].parameter.clone(),
                mean: values.iter().sum::<f64>() / count,
                deviation: deviation(&values),
                stated_sigma: stated.sqrt(),
            }
        })
        .collect()
}
