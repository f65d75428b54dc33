//! The gain, measured on whole runs that took no part in the fit of the effects.
//!
//! For each repeat the effects are fitted to all others, numbers inside and amplitudes. In the repeat they
//! are held; only the model's own parameters and the times are fitted to it, as they always are. What is
//! each run's own (the phase of a vibration, a knock) nothing else can foretell: there the amplitude is
//! the repeat's own.

use rayon::prelude::*;
use serde::Serialize;

use crate::residual::data::{Column, Data, dot};
use crate::residual::element::Owner;
use crate::residual::joint::{self, Fitted};
use crate::residual::structure;
use crate::written::um;

/// Root mean squares of one run that took no part in the fit of the effects.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunGain {
    /// Name of the run.
    pub run: String,
    /// Samples.
    pub samples: usize,
    /// Without the effects, mm.
    #[serde(rename = "before_um", serialize_with = "um")]
    pub before_mm: f64,
    /// With the effects as the other repeats have them, mm.
    #[serde(rename = "after_um", serialize_with = "um")]
    pub after_mm: f64,
    /// What does not repeat from run to run, mm; what all effects together leave where nothing repeats.
    #[serde(rename = "floor_um", serialize_with = "um")]
    pub floor_mm: f64,
    /// `(before² - after²) / (before² - floor²)`; `None` where nothing was there to explain.
    pub explained: Option<f64>,
}

/// The effects as runs of the other programs have them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProgramGain {
    /// Runs that took no part: all of one program.
    pub runs: Vec<String>,
    /// The largest feed in their arcs, mm/min.
    pub feed_mm_min: f64,
    /// Without the effects, mm.
    #[serde(rename = "before_um", serialize_with = "um")]
    pub before_mm: f64,
    /// With the effects as the runs of all other programs have them, mm.
    #[serde(rename = "after_um", serialize_with = "um")]
    pub after_mm: f64,
}

/// Less than this part of the variance before is nothing to explain.
const NOTHING: f64 = 0.02;

/// What the effects leave in repeats that took no part: one number a sample, `None` where they cannot be
/// fitted to the others.
fn left_out(data: &Data, all: &Fitted, out: &[bool]) -> Option<Vec<Vec<f64>>> {
    let within: Vec<bool> = out.iter().map(|out| !out).collect();
    let fitted = joint::fit_to(data, all.elements.clone(), &within)?;
    let mut effect: Column = data.blocks.iter().map(|b| vec![0.0; b.samples.len()]).collect();
    for (index, element) in fitted.elements.iter().enumerate() {
        let foretold = element.owner == Owner::All;
        let amplitudes = if foretold { &fitted.amplitudes[index] } else { &all.amplitudes[index] };
        let element = if foretold { element } else { &all.elements[index] };
        for (amplitude, column) in amplitudes.iter().zip(element.columns(data)) {
            for (sum, own) in effect.iter_mut().zip(&column) {
                for (s, c) in sum.iter_mut().zip(own) {
                    *s += amplitude * c;
                }
            }
        }
    }
    for (block, out) in effect.iter_mut().zip(out) {
        if !out {
            block.clear();
        }
    }
    let effect = data.projected(&effect);
    let left =
        data.blocks.iter().zip(&effect).map(|(block, effect)| {
            block.residual_mm.iter().zip(effect).map(|(e, c)| e - c).collect()
        });
    Some(left.collect())
}

/// The gain on every run, and with it sums by arc: (before - after, before - floor), mm².
pub(crate) fn by_run(
    data: &Data,
    fitted_mm: &[Vec<f64>],
    all: Option<&Fitted>,
) -> (Vec<RunGain>, Vec<(f64, f64)>) {
    let many = data.blocks.len() > 1;
    let after: Vec<Vec<f64>> = (0..data.blocks.len())
        .into_par_iter()
        .map(|index| {
            let out: Vec<bool> = (0..data.blocks.len()).map(|k| k == index).collect();
            let left = all.filter(|_| many).and_then(|all| left_out(data, all, &out));
            // With one repeat there is nothing to foretell from: what the fit itself leaves.
            left.map_or_else(|| fitted_mm[index].clone(), |mut left| left.swap_remove(index))
        })
        .collect();
    let before = data.residuals_mm();
    let mut gains = Vec::new();
    let mut arcs = vec![(0.0, 0.0); data.arcs];
    for (index, block) in data.blocks.iter().enumerate() {
        for (run, range) in block.runs.iter().enumerate() {
            let samples = range.len().max(1) as f64;
            let mean =
                |values: &[f64]| dot(&values[range.clone()], &values[range.clone()]) / samples;
            let program = block.programs[run];
            let repeats =
                structure::structure(data, &before, |b, r| data.blocks[b].programs[r] == program);
            let (was, is) = (mean(&before[index]), mean(&after[index]));
            let own = all.is_some_and(|all| all.elements.iter().any(|e| e.owner != Owner::All));
            let left = mean(&fitted_mm[index]);
            let floor = match repeats {
                // What is finer than the readings repeats, but not at the same readings.
                Some(structure) if !own => left.min(was - structure.variance_mm2.max(0.0)),
                _ => left,
            };
            let there = was - floor;
            let explained = (there > NOTHING * was).then(|| (was - is) / there);
            for k in range.clone() {
                let arc = &mut arcs[block.arcs[k]];
                let (b, a) = (before[index][k].powi(2), after[index][k].powi(2));
                *arc = (arc.0 + b - a, arc.1 + b - floor);
            }
            gains.push(RunGain {
                run: block.names[run].clone(),
                samples: range.len(),
                before_mm: was.sqrt(),
                after_mm: is.sqrt(),
                floor_mm: floor.max(0.0).sqrt(),
                explained,
            });
        }
    }
    (gains, arcs)
}

/// Share of what was there that is explained, over all arcs, with its 95 % interval by leaving out one arc
/// after the other.
pub(crate) fn explained(arcs: &[(f64, f64)]) -> Option<(f64, [f64; 2])> {
    let (gain, there) = arcs.iter().fold((0.0, 0.0), |(g, t), arc| (g + arc.0, t + arc.1));
    if there <= 0.0 || gain <= 0.0 {
        return None;
    }
    let share = gain / there;
    let count = arcs.len() as f64;
    let without = arcs.iter().map(|arc| (gain - arc.0) / (there - arc.1));
    let squares: f64 = without.map(|w| (w - share).powi(2)).sum();
    let sigma = ((count - 1.0) / count * squares).sqrt();
    Some((share, [share - 1.96 * sigma, share + 1.96 * sigma]))
}

/// The gain on the runs of each program, from those of all others.
pub(crate) fn by_program(data: &Data, all: &Fitted) -> Vec<ProgramGain> {
    let of_block = |index: usize| data.blocks[index].programs.clone();
    let mut programs: Vec<Vec<usize>> = (0..data.blocks.len()).map(of_block).collect();
    programs.sort();
    programs.dedup();
    if programs.len() < 2 {
        return Vec::new();
    }
    let gains = programs.iter().map(|program| {
        let out: Vec<bool> = (0..data.blocks.len()).map(|k| of_block(k) == *program).collect();
        let left = left_out(data, all, &out)?;
        let (mut before, mut after, mut samples) = (0.0, 0.0, 0.0_f64);
        let mut runs = Vec::new();
        let mut fastest = 0.0_f64;
        for ((block, left), _) in data.blocks.iter().zip(&left).zip(&out).filter(|(_, out)| **out) {
            before += dot(&block.residual_mm, &block.residual_mm);
            after += dot(left, left);
            samples += left.len() as f64;
            runs.extend(block.names.clone());
            let speeds = block.samples.iter().map(|s| s.situation.motion.velocity_mm_s.norm());
            fastest = speeds.fold(fastest, f64::max);
        }
        Some(ProgramGain {
            runs,
            feed_mm_min: (60.0 * fastest).round(),
            before_mm: (before / samples.max(1.0)).sqrt(),
            after_mm: (after / samples.max(1.0)).sqrt(),
        })
    });
    gains.flatten().collect()
}
