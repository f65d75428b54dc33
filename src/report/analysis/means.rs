//! Every parameter over the repeats.

use serde::Serialize;

use crate::identify::{self, Estimate, Identification};
use crate::report::text::numbers::{finite, without_dust};

/// One parameter over the repeats.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeanResult {
    /// Its name.
    pub name: String,
    /// Unit of the three numbers that follow.
    pub unit: &'static str,
    /// Mean over the repeats.
    pub mean: f64,
    /// Standard deviation over the repeats (paper, Eq. 8); `None` for a single repeat.
    pub deviation: Option<f64>,
    /// Root mean square of the standard deviations stated for the single repeats.
    pub sigma: Option<f64>,
    /// The least that the data of any repeat determine of it, 0 to 1.
    pub observed: f64,
}

/// The parameters over the repeats, in the order of the model.
pub(super) fn of(identifications: &[Identification]) -> Vec<MeanResult> {
    let tests: Vec<&[Estimate]> =
        identifications.iter().map(|identification| identification.estimates.as_slice()).collect();
    identify::repeats(&tests)
        .into_iter()
        .enumerate()
        .map(|(k, repeat)| MeanResult {
            name: repeat.parameter.name,
            unit: repeat.parameter.unit,
            mean: repeat.mean + 0.0,
            deviation: repeat.deviation.and_then(finite),
            sigma: finite(repeat.stated_sigma),
            observed: tests
                .iter()
                .filter_map(|estimates| estimates.get(k))
                .fold(1.0, |least, estimate| without_dust(estimate.observed).min(least)),
        })
        .collect()
}
