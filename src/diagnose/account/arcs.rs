//! How much of what is left on each arc repeats from run to run.

use serde::Serialize;

use crate::identify::Campaign;
use crate::residual::{Column, Products, Residuals, products};
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

/// Which arc: the program, and the section of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Key {
    program: usize,
    section: usize,
}

/// Sums of one arc of one program.
#[derive(Debug, Default)]
struct Sums {
    name: String,
    key: Key,
    feed_mm_min: f64,
    runs: usize,
    samples: f64,
    sum_mm2: f64,
    products: Products,
}

impl Sums {
    fn mean_mm2(&self) -> f64 {
        self.sum_mm2 / self.samples
    }

    /// Of the variance, what repeats.
    fn structure(&self) -> Option<f64> {
        let mean_mm2 = self.mean_mm2();
        let of = self.products;
        (of.count > 0.0 && mean_mm2 > 0.0).then(|| of.sum_mm2 / of.count / mean_mm2)
    }
}

/// The arcs of all programs, in the order in which they are driven: what the model leaves, and what the extended one does,
/// each with the campaign that knows the names of its sections.
pub(crate) fn arcs(
    before: (&Residuals, &Campaign),
    after: (&Residuals, &Campaign),
    after_mm: &Column,
) -> Vec<ArcShare> {
    let before = sums(before.0, before.1, &before.0.model_mm);
    let share = |after: Sums| {
        let before = before.iter().find(|sums| sums.key == after.key)?;
        Some(ArcShare {
            feed_mm_min: after.feed_mm_min,
            runs: after.runs,
            samples: after.samples as usize,
            before_mm: before.mean_mm2().sqrt(),
            after_mm: after.mean_mm2().sqrt(),
            structure_before: before.structure(),
            structure_after: after.structure(),
            name: after.name,
        })
    };
    sums(after.0, after.1, after_mm).into_iter().filter_map(share).collect()
}

fn sums(residuals: &Residuals, campaign: &Campaign, left_mm: &Column) -> Vec<Sums> {
    let products = products(residuals, left_mm, |_| true);
    let mut all: Vec<Sums> = Vec::new();
    for (index, repeat) in residuals.repeats.iter().enumerate() {
        for (number, run) in repeat.runs.iter().enumerate() {
            let sections = &campaign.repeats[index].runs[number].alignment.sections;
            let mut last = None;
            for k in run.samples.clone() {
                let sample = &repeat.samples[k];
                let key = Key { program: run.program, section: sample.section };
                let at = all.iter().position(|sums| sums.key == key).unwrap_or_else(|| {
                    let section = &sections[key.section];
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
                    sums.products = sums.products + products[sample.arc];
                }
                sums.samples += 1.0;
                sums.sum_mm2 += left_mm[index][k].powi(2);
            }
        }
    }
    all
}
