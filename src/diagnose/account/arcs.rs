//! How much of what is left on each arc repeats from run to run.

use serde::Serialize;

use crate::align::Place;
use crate::identify::Campaign;
use crate::residual::data::Data;
use crate::residual::structure;
use crate::written::um;

/// An arc over all runs of one program.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArcShare {
    /// Its name in the program.
    pub name: String,
    /// Feed, mm/min.
    pub feed_mm_min: f64,
    /// Runs that drove it.
    #[serde(rename = "run_count")]
    pub runs: usize,
    /// Samples.
    pub samples: usize,
    /// Residual of the model, mm rms.
    #[serde(rename = "before_um", serialize_with = "um")]
    pub before_mm: f64,
    /// Residual of the extended model, mm rms.
    #[serde(rename = "after_um", serialize_with = "um")]
    pub after_mm: f64,
    /// Share of the variance before that repeats; `None` where no other run drove it.
    #[serde(rename = "structure_share_before")]
    pub structure_before: Option<f64>,
    /// Share of the variance after that repeats.
    #[serde(rename = "structure_share_after")]
    pub structure_after: Option<f64>,
}

/// Sums of one arc of one program.
#[derive(Debug, Default)]
struct Sums {
    name: String,
    /// Program, and the arc's number in it.
    key: (usize, usize),
    feed_mm_min: f64,
    runs: usize,
    samples: f64,
    before: f64,
    after: f64,
    products_before: (f64, f64),
    products_after: (f64, f64),
}

/// The arcs of all programs, in the order in which they are driven. The campaign is the one that the data are
/// linear about: with another one samples and arcs would not be the same.
pub(crate) fn arcs(data: &Data, campaign: &Campaign, after_mm: &[Vec<f64>]) -> Vec<ArcShare> {
    let before_mm = data.residuals_mm();
    let before = structure::products(data, &before_mm, |_, _| true);
    let after = structure::products(data, after_mm, |_, _| true);
    let mut all: Vec<Sums> = Vec::new();
    for (index, (block, repeat)) in data.blocks.iter().zip(&campaign.repeats).enumerate() {
        for (run, range) in block.runs.iter().enumerate() {
            let alignment = &repeat.runs[run].alignment;
            let mut last = None;
            for k in range.clone() {
                let place = alignment.samples[block.samples[k].sample].place;
                let Place::Arc(section) = place else { continue };
                let key = (block.programs[run], section);
                let at = all.iter().position(|sums| sums.key == key).unwrap_or_else(|| {
                    let section = &alignment.sections[section];
                    all.push(Sums {
                        name: section.name.clone(),
                        key,
                        feed_mm_min: (60.0 * section.feed_mm_s).round(),
                        ..Sums::default()
                    });
                    all.len() - 1
                });
                let sums = &mut all[at];
                if last != Some(key) {
                    last = Some(key);
                    sums.runs += 1;
                    let arc = block.arcs[k];
                    let add =
                        |to: &mut (f64, f64), of: (f64, f64)| *to = (to.0 + of.0, to.1 + of.1);
                    add(&mut sums.products_before, before[arc]);
                    add(&mut sums.products_after, after[arc]);
                }
                sums.samples += 1.0;
                sums.before += before_mm[index][k].powi(2);
                sums.after += after_mm[index][k].powi(2);
            }
        }
    }
    let share = |products: (f64, f64), mean_square: f64| {
        (products.1 > 0.0 && mean_square > 0.0).then(|| products.0 / products.1 / mean_square)
    };
    let told = all.into_iter().map(|sums| {
        let (before, after) = (sums.before / sums.samples, sums.after / sums.samples);
        ArcShare {
            name: sums.name,
            feed_mm_min: sums.feed_mm_min,
            runs: sums.runs,
            samples: sums.samples as usize,
            before_mm: before.sqrt(),
            after_mm: after.sqrt(),
            structure_before: share(sums.products_before, before),
            structure_after: share(sums.products_after, after),
        }
    });
    told.collect()
}
