//! Coefficients that were biased by what the model lacked.

use serde::Serialize;

use crate::identify::{Campaign, Estimate};

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

/// A move by less than this part of what is open is none: of what a test does not see, noise moves as little.
const UNSEEN: f64 = 1e-3;

/// Parameters of the model whose mean over the repeats moves by more than its sigma in one repeat.
pub(crate) fn moved(campaign: &Campaign, extended: &Campaign) -> Vec<Moved> {
    let Some(first) = campaign.repeats.first() else { return Vec::new() };
    let repeats = campaign.repeats.len() as f64;
    let moved = first.estimates.iter().enumerate().filter_map(|(k, estimate)| {
        let mean = |campaign: &Campaign, of: &dyn Fn(&Estimate) -> f64| {
            campaign.repeats.iter().map(|r| of(&r.estimates[k])).sum::<f64>() / repeats
        };
        let before = mean(campaign, &|estimate| estimate.value);
        let after = mean(extended, &|estimate| estimate.value);
        let sigma = |campaign| mean(campaign, &|estimate| estimate.sigma.powi(2)).sqrt();
        let (sigma_before, sigma_after) = (sigma(campaign), sigma(extended));
        let all = mean(extended, &|estimate| estimate.all.unwrap_or(estimate.sigma));
        let moved = (after - before).abs();
        (sigma_after > 0.0 && moved > sigma_after && moved > UNSEEN * all).then(|| Moved {
            name: estimate.parameter.name.clone(),
            unit: estimate.parameter.unit,
            before,
            after,
            sigma_before,
            sigma_after,
        })
    });
    moved.collect()
}
