//! The repeatable part of a residual: the structure that runs of the same program have in common.
//!
//! Noise of one run knows nothing of that of another, so the mean product of their residuals at the same
//! place of the program is the variance of what they share, whatever the noise is like:
//!
//! `structure² = mean of e_i(t) e_k(t)` over all pairs of runs,
//!
//! and what is left of the variance, `e² - structure²`, is the repeatability floor.

use std::iter::Sum;
use std::ops::Add;

use serde::ser::{Serialize, SerializeStruct, Serializer};

use super::column::Column;
use super::residuals::{Repeat, Residuals, Run};

/// Readings farther apart than so many periods are not interpolated between.
const GAP_PERIODS: f64 = 2.5;

/// What repeats of a residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Structure {
    /// Variance of what runs of the same program share, mm²; chance may make it negative.
    pub variance_mm2: f64,
    /// Its standard deviation over the arcs, mm².
    pub sigma_mm2: f64,
}

impl Structure {
    /// Root mean square of what repeats, mm; 0 where chance makes the variance negative.
    pub fn rms_mm(&self) -> f64 {
        self.variance_mm2.max(0.0).sqrt()
    }
}

/// In um and um².
impl Serialize for Structure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        const UM: f64 = 1e3;
        let mut fields = serializer.serialize_struct("Structure", 3)?;
        fields.serialize_field("rms_um", &(self.rms_mm() * UM))?;
        fields.serialize_field("variance_um2", &(self.variance_mm2 * UM * UM))?;
        fields.serialize_field("sigma_um2", &(self.sigma_mm2 * UM * UM))?;
        fields.end()
    }
}

/// Products of residuals of two runs at the same place of their program.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Products {
    /// Their sum, mm².
    pub sum_mm2: f64,
    /// How many.
    pub count: f64,
}

impl Add for Products {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { sum_mm2: self.sum_mm2 + other.sum_mm2, count: self.count + other.count }
    }
}

impl Sum for Products {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), Self::add)
    }
}

/// What repeats of some residuals (mm, one number a sample), in pairs of runs of which one drove a program
/// that `takes_part`; `None` where no program ran twice.
pub fn structure(
    residuals: &Residuals,
    left_mm: &Column,
    takes_part: impl Fn(usize) -> bool,
) -> Option<Structure> {
    let arcs = products(residuals, left_mm, takes_part);
    let all: Products = arcs.iter().copied().sum();
    if all.count == 0.0 {
        return None;
    }
    let mean = all.sum_mm2 / all.count;
    let used = arcs.iter().filter(|arc| arc.count > 0.0);
    let squares: f64 = used.map(|arc| (arc.sum_mm2 - mean * arc.count).powi(2)).sum();
    Some(Structure { variance_mm2: mean, sigma_mm2: squares.sqrt() / all.count })
}

/// Products over all pairs of runs of one program, by the arc of the first of the pair.
pub fn products(
    residuals: &Residuals,
    left_mm: &Column,
    takes_part: impl Fn(usize) -> bool,
) -> Vec<Products> {
    let runs: Vec<Driven> = residuals
        .runs()
        .map(|(repeat, run)| {
            let of = &residuals.repeats[repeat];
            Driven { repeat: of, run: &of.runs[run], left_mm: &left_mm[repeat] }
        })
        .collect();
    let mut arcs = vec![Products::default(); residuals.arcs];
    for (index, first) in runs.iter().enumerate() {
        for second in &runs[index + 1..] {
            if first.run.program == second.run.program && takes_part(first.run.program) {
                first.add_products(second, &mut arcs);
            }
        }
    }
    arcs
}

/// A run with its residuals.
struct Driven<'a> {
    repeat: &'a Repeat,
    run: &'a Run,
    left_mm: &'a [f64],
}

impl Driven<'_> {
    /// Adds the products with another run of the same program, which is interpolated, to the arcs of this one.
    fn add_products(&self, other: &Self, arcs: &mut [Products]) {
        let range = other.run.samples.clone();
        let samples = &other.repeat.samples[range.clone()];
        let values = &other.left_mm[range];
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return };
        let longest_s = GAP_PERIODS * (last.program_s() - first.program_s()) / samples.len() as f64;
        let mut after = 0;
        for k in self.run.samples.clone() {
            let sample = &self.repeat.samples[k];
            while after < samples.len() && samples[after].blocks < sample.blocks {
                after += 1;
            }
            if after == 0 || after == samples.len() || samples[after].arc != samples[after - 1].arc
            {
                continue;
            }
            let (before, next) = (&samples[after - 1], &samples[after]);
            if next.program_s() - before.program_s() > longest_s || next.blocks <= before.blocks {
                continue;
            }
            let share = (sample.blocks - before.blocks) / (next.blocks - before.blocks);
            let there = (1.0 - share) * values[after - 1] + share * values[after];
            let here = Products { sum_mm2: self.left_mm[k] * there, count: 1.0 };
            arcs[sample.arc] = arcs[sample.arc] + here;
        }
    }
}
