//! Coefficients that were biased by what the model lacked.

use serde::Serialize;

use crate::identify::{Campaign, Estimate};
use crate::residual::{Fitted, Residuals};
use crate::solve::dot;

/// A coefficient that was biased by what the model lacked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Moved {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Mean over the repeats without the effects.
    pub before: f64,
    /// And with them.
    pub after: f64,
    /// Standard deviation in one repeat without the effects.
    pub sigma_before: f64,
    /// And with them: what the amplitudes do not know counts.
    pub sigma_after: f64,
}

/// Parameters of the model whose mean over the repeats moves by more than its sigma in one repeat.
///
/// With `c` the columns of the effects and `a` their amplitudes, the parameters of a repeat change by
/// `- F Q^T c a`, and what is not known of the amplitudes goes into them the same way.
pub(crate) fn moved(
    residuals: &Residuals,
    campaign: &Campaign,
    extended: &Campaign,
    fitted: &Fitted,
    long_run_mm2: f64,
) -> Vec<Moved> {
    let Some(first) = campaign.repeats.first() else { return Vec::new() };
    let repeats = residuals.repeats.len() as f64;
    let parameters = first.estimates.len();
    // Mean over the repeats of what one of each amplitude and number inside changes.
    let mut per_number = vec![vec![0.0; fitted.columns.len()]; parameters];
    for (index, repeat) in residuals.repeats.iter().enumerate() {
        let columns: Vec<&[f64]> = fitted.columns.iter().map(|c| c[index].as_slice()).collect();
        let along = repeat.basis.along(&columns);
        for (k, changes) in per_number.iter_mut().enumerate() {
            for (change, along) in changes.iter_mut().zip(&along) {
                *change -= dot(repeat.factor.row(k), along) / repeats;
            }
        }
    }
    (0..parameters)
        .filter_map(|k| {
            let mean = |campaign: &Campaign, of: &dyn Fn(&Estimate) -> f64| {
                campaign.repeats.iter().map(|r| of(&r.estimates[k])).sum::<f64>() / repeats
            };
            let before = mean(campaign, &|estimate| estimate.value);
            let after = mean(extended, &|estimate| estimate.value);
            let sigma = |campaign| mean(campaign, &|estimate| estimate.sigma.powi(2)).sqrt();
            let (sigma_before, sigma_after) = (sigma(campaign), sigma(extended));
            let further: f64 = (0..fitted.columns.len())
                .flat_map(|i| (0..fitted.columns.len()).map(move |j| (i, j)))
                .map(|(i, j)| per_number[k][i] * per_number[k][j] * fitted.inverse[(i, j)])
                .sum();
            let estimate = &first.estimates[k];
            let moved = (after - before).abs() > sigma_after && sigma_after > 0.0;
            moved.then(|| Moved {
                name: estimate.parameter.name.clone(),
                unit: estimate.parameter.unit,
                before,
                after,
                sigma_before,
                sigma_after: sigma_after.hypot((long_run_mm2 * further.max(0.0)).sqrt()),
            })
        })
        .collect()
}
