//! What the effects leave in repeats that took no part in their fit.

use crate::diagnose::thresholds::UNDECIDED_SIGMAS;
use crate::residual::{self, Beside, Column, Fitted, Noise, Owner, Residuals};
use crate::solve::dot;

/// A knot of which others see less than this part is not foretold by them: a tenth as certain as it is there, and where a curve ends
/// they see nothing.
const COVERED: f64 = 0.01;

/// What the effects leave in the repeats that took no part in their fit.
pub(super) struct LeftOut {
    /// What is left, mm; nothing of the others.
    pub(super) left_mm: Column,
    /// By how much each effect lowers the sum of squares there beside the others, mm².
    pub(super) gained_mm2: Vec<f64>,
    /// Whether the others foretell all of every curve.
    pub(super) curves: bool,
}

/// What the effects leave in the repeats that are `out`: they took no part. `None` where the effects cannot be
/// fitted to the others.
pub(super) fn left_out(alone: &Beside, all: &Fitted, out: &[bool]) -> Option<LeftOut> {
    let residuals = alone.residuals;
    let within: Vec<bool> = out.iter().map(|out| !out).collect();
    let fitted = residual::fit_to(alone, all.elements.clone(), &within)?;
    let noise = Noise::of(residuals, &all.left_mm(alone));
    let mut left_mm = residuals.model_mm.clone();
    let mut parts = Vec::new();
    let mut curves = true;
    for (index, element) in fitted.elements.iter().enumerate() {
        let part = all.part(index);
        let covered = element.curve().is_none() || cover(&within, residuals, &part);
        curves &= covered;
        let foretold =
            covered && element.owner == Owner::All && see(&within, residuals, &part, &noise);
        let amplitudes = if foretold { &fitted.amplitudes[index] } else { &all.amplitudes[index] };
        let element = if foretold { element } else { &all.elements[index] };
        let mut effect = residuals.zeros();
        for (amplitude, column) in amplitudes.iter().zip(element.columns(residuals)) {
            effect.add(*amplitude, &column);
        }
        let effect = residuals.outside(&effect);
        left_mm.add(-1.0, &effect);
        parts.push(effect);
    }
    let only_out = |column: &mut Column| {
        let within = column.iter_mut().zip(out).filter(|(_, out)| !**out);
        within.for_each(|(of_repeat, _)| of_repeat.clear());
    };
    only_out(&mut left_mm);
    let gained = |mut part: Column| {
        only_out(&mut part);
        part.square() + 2.0 * part.product(&left_mm)
    };
    let gained_mm2 = parts.into_iter().map(gained).collect();
    Some(LeftOut { left_mm, gained_mm2, curves })
}

/// Whether some repeats see more of an effect than noise would make of it.
fn see(within: &[bool], residuals: &Residuals, effect: &Fitted, noise: &Noise) -> bool {
    let sum = effect.sum(residuals);
    let outside = residuals.outside(&sum);
    let each = sum.iter().zip(outside.iter()).zip(within).filter(|(_, within)| **within);
    let seen_mm2: f64 = each.map(|((sum, outside), _)| dot(sum, outside)).sum();
    let by_noise_mm2 = effect.columns.len() as f64 * noise.long_run_mm2;
    seen_mm2 > UNDECIDED_SIGMAS.powi(2) * by_noise_mm2
}

/// Whether some repeats see of each knot of a curve at least [`COVERED`] of what the others do.
fn cover(within: &[bool], residuals: &Residuals, curve: &Fitted) -> bool {
    curve.columns.iter().all(|column| {
        let outside = residuals.outside(column);
        let mut seen = [0.0; 2];
        for ((column, outside), within) in column.iter().zip(outside.iter()).zip(within) {
            seen[usize::from(*within)] += dot(column, outside);
        }
        seen[1] >= COVERED * seen[0]
    })
}
