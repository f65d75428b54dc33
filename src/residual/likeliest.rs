//! Which noise makes what is left likeliest, where fits and effects have taken out most of what hangs together.
//!
//! With the directions `X` that they have taken out of readings `y`, nobody knows what was along them. Of noise with the covariance
//! `s V` the likelihood of all that is across them is (Patterson and Thompson, "Recovery of inter-block information when block sizes
//! are unequal", Biometrika 58, 1971), the scale `s` at its best,
//!
//! ```text
//! -2 ln L = (n - p) ln Q + ln |V| + ln |X^T V^-1 X|,      Q = min_b (e - X b)^T V^-1 (e - X b),      s = Q / (n - p)
//! ```
//!
//! which needs no more of `y` than what is left, `e`. `V` is that of white noise with noise whose correlation falls as
//! `exp(-t / tau)`, over means of a tenth of a second; other arcs are independent. Of a grid of shares and times every noise counts
//! by its likelihood, so that one that is as likely and hangs together for longer is not forgotten.

use std::ops::Range;

use rayon::prelude::*;

use super::beside::Beside;
use super::residuals::Repeat;
use crate::solve::Matrix;

/// A mean is over so long, s, or one sample.
const MEAN_S: f64 = 0.1;
/// Times over which noise hangs together, s.
const TIMES_S: [f64; 6] = [0.05, 0.1, 0.2, 0.35, 0.6, 1.0];
/// Its share of the variance of a mean.
const SHARES: [f64; 6] = [0.2, 0.4, 0.6, 0.8, 0.95, 1.0];
/// A direction of which the samples tell less than this has its number from what is plausible: it took out as little.
const FOLLOWED: f64 = 0.5;
/// Of a direction that others span less than this is left, of its square.
const SPANNED: f64 = 1e-6;

/// One arc, in means.
struct Arc {
    means: Range<usize>,
    /// From one to the next, s.
    every_s: f64,
}

/// A repeat: rows of `X^T`, those of its own fit first and those of the effects then, and what is left, over its means.
struct Means {
    arcs: Vec<Arc>,
    rows: Matrix,
    own: usize,
}

/// White noise of variance `1 - share` on means of noise that hangs together, of variance `share`.
#[derive(Clone, Copy)]
struct Colour {
    time_s: f64,
    share: f64,
}

/// Variance of a mean of many samples times their number, mm²; `None` where what was taken out leaves nothing to know it from.
pub(super) fn long_run_mm2(beside: &Beside) -> Option<f64> {
    let each = beside.residuals.repeats.par_iter().enumerate();
    let repeats: Vec<Means> =
        each.map(|(index, repeat)| Means::of(beside, index, repeat)).collect();
    let hanging = TIMES_S
        .iter()
        .flat_map(|time_s| SHARES.iter().map(|share| Colour { time_s: *time_s, share: *share }));
    let colours: Vec<Colour> =
        std::iter::once(Colour { time_s: MEAN_S, share: 0.0 }).chain(hanging).collect();
    let told: Vec<Told> =
        colours.par_iter().filter_map(|colour| Told::of(&repeats, *colour)).collect();
    let best = told.iter().map(|told| told.minus_two_ln).min_by(f64::total_cmp)?;
    let (mut sum_mm2, mut weights) = (0.0, 0.0);
    for told in &told {
        let weight = (0.5 * (best - told.minus_two_ln)).exp();
        sum_mm2 += weight * told.long_run_mm2;
        weights += weight;
    }
    Some(sum_mm2 / weights)
}

/// What is left told by one noise.
struct Told {
    minus_two_ln: f64,
    long_run_mm2: f64,
}

impl Told {
    fn of(repeats: &[Means], colour: Colour) -> Option<Self> {
        let (mut means, mut taken, mut ln) = (0, 0, 0.0);
        let mut shared: Option<Matrix> = None;
        let mut longer = 0.0;
        for repeat in repeats {
            let mut white = repeat.rows.clone();
            for arc in &repeat.arcs {
                ln += colour.whiten(&mut white, arc);
                longer += arc.means.len() as f64 * colour.long_run(arc.every_s);
                means += arc.means.len();
            }
            let mut gram = white.times_own_transpose();
            let (count, of_own) = eliminate(&mut gram, repeat.own);
            (taken, ln) = (taken + count, ln + of_own);
            let rest = gram.rows() - repeat.own;
            let rest = Matrix::from_fn(rest, rest, |i, k| gram[(repeat.own + i, repeat.own + k)]);
            shared = Some(match shared {
                None => rest,
                Some(so_far) => {
                    Matrix::from_fn(rest.rows(), rest.rows(), |i, k| so_far[(i, k)] + rest[(i, k)])
                }
            });
        }
        let mut shared = shared?;
        let effects = shared.rows() - 1;
        let (count, of_effects) = eliminate(&mut shared, effects);
        let free = means.checked_sub(taken + count).filter(|free| *free > 0)? as f64;
        let square_mm2 = shared[(effects, effects)];
        let minus_two_ln = free * square_mm2.ln() + ln + of_effects;
        let long_run_mm2 = square_mm2 / free * longer / means as f64;
        minus_two_ln.is_finite().then_some(Self { minus_two_ln, long_run_mm2 })
    }
}

impl Means {
    fn of(beside: &Beside, index: usize, repeat: &Repeat) -> Self {
        let mut arcs = Vec::new();
        let mut cells: Vec<Range<usize>> = Vec::new();
        // One sample by itself does not tell how noise hangs together.
        for (arc, each_s) in repeat.arcs().into_iter().filter(|(_, each_s)| *each_s > 0.0) {
            let size = ((MEAN_S / each_s).round() as usize).clamp(1, arc.len());
            let (begin, count) = (cells.len(), arc.len() / size);
            cells.extend((0..count).map(|k| arc.start + k * size..arc.start + (k + 1) * size));
            arcs.push(Arc { means: begin..cells.len(), every_s: size as f64 * each_s });
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
        Self { arcs, rows, own: own.len() }
    }
}

impl Colour {
    /// Correlation of what hangs together from one mean to the next.
    fn next(self, every_s: f64) -> f64 {
        (-every_s / self.time_s).exp()
    }

    /// Long-run variance over that of a mean.
    fn long_run(self, every_s: f64) -> f64 {
        let next = self.next(every_s);
        1.0 - self.share + self.share * (1.0 + next) / (1.0 - next)
    }

    /// Makes this noise white, of variance 1, in an arc of every row (Kalman); what that adds to `ln |V|`.
    fn whiten(self, rows: &mut Matrix, arc: &Arc) -> f64 {
        let next = self.next(arc.every_s);
        // Share of a surprise that is believed, and its standard deviation, mean after mean.
        let (mut steps, mut ln) = (Vec::with_capacity(arc.means.len()), 0.0);
        let mut variance = self.share;
        for _ in arc.means.clone() {
            let whole = variance + 1.0 - self.share;
            let gain = variance / whole;
            steps.push((gain, whole.sqrt().recip()));
            ln += whole.ln();
            variance = next * next * variance * (1.0 - gain) + (1.0 - next * next) * self.share;
        }
        for row in 0..rows.rows() {
            let mut expected = 0.0;
            let values = &mut rows.row_mut(row)[arc.means.clone()];
            for (value, (gain, over_sigma)) in values.iter_mut().zip(&steps) {
                let surprise = *value - expected;
                expected = next * (expected + gain * surprise);
                *value = surprise * over_sigma;
            }
        }
        ln
    }
}

/// Takes the first so many unknowns out of a symmetric matrix, in place: how many there are that others do not span, and the
/// logarithm of the determinant of their part.
fn eliminate(a: &mut Matrix, unknowns: usize) -> (usize, f64) {
    let whole = a.diagonal();
    let (mut taken, mut ln) = (0, 0.0);
    for k in 0..unknowns {
        let row = a.row(k).to_vec();
        let pivot = row[k];
        if pivot <= SPANNED * whole[k] {
            continue;
        }
        (taken, ln) = (taken + 1, ln + pivot.ln());
        for i in k + 1..a.rows() {
            let factor = row[i] / pivot;
            a.row_mut(i)[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(x, y)| *x -= factor * y);
        }
    }
    (taken, ln)
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

    #[test]
    fn what_others_span_is_no_unknown() {
        let rows = [[1.0, 2.0, 0.5], [2.0, 4.0, 1.0], [0.0, 1.0, 3.0], [1.0, 1.0, 2.0]];
        let mut gram =
            Matrix::from_fn(4, 4, |i, k| rows[i].iter().zip(&rows[k]).map(|(a, b)| a * b).sum());
        let (taken, ln) = eliminate(&mut gram, 3);
        assert_eq!(taken, 2);
        // 5.25 * 10 - 3.5 * 3.5
        assert!((ln - 40.25_f64.ln()).abs() < 1e-12, "{ln}");
    }
}
