//! Coefficients that were biased by what the model lacked.

use super::data::Data;
use super::joint::Fitted;
use super::result::Moved;
use crate::identify::Campaign;

/// Parameters of the model whose mean over the repeats moves by more than the sigma of one repeat.
///
/// With `c` the columns of the effects and `a` their amplitudes, the parameters of a repeat change by
/// `- F Q^T c a`, and what is not known of the amplitudes goes into them the same way.
pub(super) fn moved(
    data: &Data,
    campaign: &Campaign,
    fitted: &Fitted,
    long_run_mm2: f64,
) -> Vec<Moved> {
    let Some(first) = campaign.repeats.first() else { return Vec::new() };
    let amplitudes: Vec<f64> = fitted.amplitudes.iter().flatten().copied().collect();
    let count = amplitudes.len();
    let repeats = data.blocks.len() as f64;
    let parameters = first.estimates.len();
    let mut change = vec![0.0; parameters];
    // Mean over the repeats of what one of each amplitude and number inside changes.
    let mut per_number = vec![vec![0.0; fitted.columns.len()]; parameters];
    for (index, block) in data.blocks.iter().enumerate() {
        let columns: Vec<&[f64]> = fitted.columns.iter().map(|c| c[index].as_slice()).collect();
        let along = block.along(&columns);
        for k in 0..parameters {
            for (j, along) in along.iter().enumerate() {
                let by = -super::data::dot(block.factor.row(k), along);
                per_number[k][j] += by / repeats;
                if j < count {
                    change[k] += by * amplitudes[j] / repeats;
                }
            }
        }
    }
    (0..parameters)
        .filter_map(|k| {
            let before =
                campaign.repeats.iter().map(|r| r.estimates[k].value).sum::<f64>() / repeats;
            let variance =
                campaign.repeats.iter().map(|r| r.estimates[k].sigma.powi(2)).sum::<f64>()
                    / repeats;
            let further: f64 = (0..fitted.columns.len())
                .flat_map(|i| (0..fitted.columns.len()).map(move |j| (i, j)))
                .map(|(i, j)| per_number[k][i] * per_number[k][j] * fitted.inverse[(i, j)])
                .sum();
            let estimate = &first.estimates[k];
            (change[k].abs() > variance.sqrt() && variance > 0.0).then(|| Moved {
                name: estimate.parameter.name.clone(),
                unit: estimate.parameter.unit,
                before,
                after: before + change[k],
                sigma_before: variance.sqrt(),
                sigma_after: (variance + long_run_mm2 * further.max(0.0)).sqrt(),
            })
        })
        .collect()
}
