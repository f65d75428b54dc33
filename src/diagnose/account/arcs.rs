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
    before_mm2: f64,
    after_mm2: f64,
    products_before: Products,
    products_after: Products,
}

impl Sums {
    fn share(self) -> ArcShare {
        let (before_mm2, after_mm2) =
            (self.before_mm2 / self.samples, self.after_mm2 / self.samples);
        let share = |of: Products, mean_mm2: f64| {
            (of.count > 0.0 && mean_mm2 > 0.0).then(|| of.sum_mm2 / of.count / mean_mm2)
        };
        ArcShare {
            name: self.name,
            feed_mm_min: self.feed_mm_min,
            runs: self.runs,
            samples: self.samples as usize,
            before_mm: before_mm2.sqrt(),
            after_mm: after_mm2.sqrt(),
            structure_before: share(self.products_before, before_mm2),
            structure_after: share(self.products_after, after_mm2),
        }
    }
}

/// The arcs of all programs, in the order in which they are driven. The campaign is the one that the residuals
/// are of: it knows the names of the sections.
pub(crate) fn arcs(residuals: &Residuals, campaign: &Campaign, after_mm: &Column) -> Vec<ArcShare> {
    let before = products(residuals, &residuals.model_mm, |_| true);
    let after = products(residuals, after_mm, |_| true);
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
                    sums.products_before = sums.products_before + before[sample.arc];
                    sums.products_after = sums.products_after + after[sample.arc];
                }
                sums.samples += 1.0;
                sums.before_mm2 += residuals.model_mm[index][k].powi(2);
                sums.after_mm2 += after_mm[index][k].powi(2);
            }
        }
    }
    all.into_iter().map(Sums::share).collect()
}
