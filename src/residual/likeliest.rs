//! Which noise makes what is left likeliest, where fits and effects have taken out most of what hangs together: the
//! [likely] noises of means over a tenth of a second.
//!
//! [likely]: crate::solve::likely

use std::ops::Range;

use rayon::prelude::*;

use super::beside::Beside;
use super::residuals::Repeat;
use crate::solve::{ArcOfMeans, Matrix, Means, likely};

/// A mean is over so long, s, or one sample.
const MEAN_S: f64 = 0.1;
/// Noise does not hang together for longer, s.
const LONGEST_S: f64 = 1.0;
/// A direction of which the samples tell less than this has its number from what is plausible: it took out as little.
const FOLLOWED: f64 = 0.5;

/// Variance of a mean of many samples times their number, mm²; `None` where what was taken out leaves nothing to know it from.
pub(super) fn long_run_mm2(beside: &Beside) -> Option<f64> {
    let each = beside.residuals.repeats.par_iter().enumerate();
    let repeats: Vec<Means> = each.map(|(index, repeat)| means(beside, index, repeat)).collect();
    let noises = likely(&repeats, LONGEST_S);
    let arcs: Vec<&ArcOfMeans> = repeats.iter().flat_map(|repeat| &repeat.arcs).collect();
    let count: usize = arcs.iter().map(|arc| arc.means.len()).sum();
    let long_run_mm2 = noises.iter().map(|noise| {
        let of_arc =
            |arc: &&ArcOfMeans| arc.means.len() as f64 * noise.colour.long_run(arc.every_s);
        noise.weight * noise.variance * arcs.iter().map(of_arc).sum::<f64>() / count as f64
    });
    (!noises.is_empty()).then(|| long_run_mm2.sum())
}

/// A repeat: what its own fit has taken out first and the effects then, and what is left, over its means.
fn means(beside: &Beside, index: usize, repeat: &Repeat) -> Means {
    let mut arcs = Vec::new();
    let mut cells: Vec<Range<usize>> = Vec::new();
    // One sample by itself does not tell how noise hangs together.
    for (arc, each_s) in repeat.arcs().into_iter().filter(|(_, each_s)| *each_s > 0.0) {
        let size = ((MEAN_S / each_s).round() as usize).clamp(1, arc.len());
        let (begin, count) = (cells.len(), arc.len() / size);
        cells.extend((0..count).map(|k| arc.start + k * size..arc.start + (k + 1) * size));
        arcs.push(ArcOfMeans { means: begin..cells.len(), every_s: size as f64 * each_s });
    }
    let followed = |direction: &usize| -> bool {
        let all = 0..repeat.samples.len();
        all.map(|k| repeat.basis.at(k, *direction).powi(2)).sum::<f64>() > FOLLOWED
    };
    let own: Vec<usize> = (0..repeat.basis.rank()).filter(followed).collect();
    let effects = &beside.span;
    // Times the root of their number, so that white noise is as large in them as in a sample.
    let over = |cell: &Range<usize>, of: &dyn Fn(usize) -> f64| {
        cell.clone().map(of).sum::<f64>() / (cell.len() as f64).sqrt()
    };
    let at = |column: &[f64], k: usize| column.get(k).copied().unwrap_or(0.0);
    let rows = Matrix::from_fn(own.len() + effects.len() + 1, cells.len(), |i, k| {
        if let Some(direction) = own.get(i) {
            return over(&cells[k], &|sample| repeat.basis.at(sample, *direction));
        }
        match effects.get(i - own.len()) {
            Some(effect) => over(&cells[k], &|sample| at(&effect[index], sample)),
            None => over(&cells[k], &|sample| at(&beside.left_mm[index], sample)),
        }
    });
    Means { arcs, rows, own: own.len() }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::residual::bench::{residuals, white};
    use crate::residual::{Column, Residuals};

    /// Ten readings a second.
    const PERIOD_S: f64 = 0.1;

    /// Beside waves that bend as fast as noise of a second does: the long-run variance over what was put in.
    fn known(time_s: f64, seed: u64) -> f64 {
        let next = if time_s > 0.0 { (-PERIOD_S / time_s).exp() } else { 0.0 };
        let (mut draw, mut state) = (white(seed, 1.0), 0.0);
        let mut noise = residuals(1, move || {
            state = next * state + (1.0 - next * next).sqrt() * draw();
            state
        });
        // An arc of one sample, as there is where a leg is short.
        let samples = &mut noise.repeats[0].samples;
        samples.last_mut().unwrap().arc += 1;
        let wave = |index: usize| {
            let shift = if index.is_multiple_of(2) { 0.0 } else { std::f64::consts::FRAC_PI_2 };
            let at = |elapsed_s: f64| (0.025 * (index / 2 + 1) as f64 * elapsed_s + shift).sin();
            let samples = noise.repeats[0].samples.iter();
            Column::from(vec![samples.map(|sample| at(sample.elapsed_s())).collect()])
        };
        let waves: Vec<Column> = (0..80).map(wave).collect();
        let beside = Residuals::beside(&noise, &waves);
        long_run_mm2(&beside).unwrap() * (1.0 - next) / (1.0 + next)
    }

    #[test]
    fn noise_is_known_from_what_waves_leave_of_it() {
        for (time_s, within) in [(0.0, 1.15), (0.2, 1.5), (1.0, 2.0)] {
            let mut ratios: Vec<f64> = (1..=5).map(|seed| known(time_s, seed)).collect();
            ratios.sort_by(f64::total_cmp);
            let middle = ratios[2];
            assert!(middle < within && middle > within.recip(), "{time_s} s: {ratios:?}");
            // Noise of a second, of which the waves leave a tenth, is not taken for that tenth.
            assert!(ratios[0] > 0.3, "{time_s} s: {ratios:?}");
        }
    }
}
