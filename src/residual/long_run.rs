//! How a mean of many neighbouring samples scatters where noise is all that is left.
//!
//! With the weights `w` that are 1 up to half a window and fall to 0 at its end, and `x` along one arc,
//!
//! ```text
//! S(x) = sum_k w_k sum_t x_t x_(t+k)
//! N v = S(e) + v sum_q S(q)
//! ```
//!
//! of what is left, `e`, and of the orthonormal directions `q` that the fits and accepted effects have taken out of the noise, as
//! far as they change little over its correlation. The flat top (Politis and Romano, "Bias-corrected nonparametric spectral
//! estimation", Journal of Time Series Analysis 16, 1995) sees noise whole that hangs together over half a second, where weights
//! that fall from the beginning see three quarters of it. Where little but what was taken out is left of what noise hangs together
//! for, `S` does not tell any more, and the [likeliest] noise counts.

use std::ops::Range;

use rayon::prelude::*;

use super::beside::Beside;
use super::likeliest;
use super::noise::Noise;
use super::residuals::{Repeat, Residuals};

/// Half of the window, s: longer ones scatter more, and noise does not hang together for longer than a second.
const FLAT_S: f64 = 1.0;
/// Where what is taken out leaves less than this share of the samples, nobody knows from `S` what was in it.
const LEAST_LEFT: f64 = 0.5;

impl Beside<'_> {
    /// The noise of what is left if that is noise and nothing else, as it is where the fits [held](Residuals::held) the effects.
    pub fn noise_alone(&self) -> Noise {
        let residuals = self.residuals;
        let count = residuals.samples() as f64;
        let span = self.span.par_iter().map(|unit| along(residuals, unit));
        let by_effects: f64 = span.collect::<Vec<f64>>().iter().sum();
        let by_fits =
            residuals.taken_out.get_or_init(|| residuals.repeats.iter().map(of_followed).sum());
        let left = count - by_fits - by_effects;
        let seen_mm2 = along(residuals, &self.left_mm) / left.max(LEAST_LEFT * count);
        // About a fit without them, what effects leave is also what a linear search does not see of them.
        let tells = !residuals.held || left >= LEAST_LEFT * count;
        let likeliest = if tells { None } else { likeliest::long_run_mm2(self) };
        let long_run_mm2 = likeliest.unwrap_or(seen_mm2).max(self.noise().long_run_mm2);
        Noise { long_run_mm2, ..*self.noise() }
    }
}

/// `S` of a column.
fn along(residuals: &Residuals, column: &[Vec<f64>]) -> f64 {
    let of_repeat = |(repeat, of): (&Repeat, &Vec<f64>)| {
        let of_arc =
            |(arc, half): (Range<usize>, usize)| flat_top(of.get(arc).unwrap_or(&[]), half);
        arcs(repeat).into_iter().map(of_arc).sum::<f64>()
    };
    residuals.repeats.iter().zip(column).map(of_repeat).sum()
}

/// The sum of `S` of all that a fit follows of a repeat.
fn of_followed(repeat: &Repeat) -> f64 {
    let arcs = arcs(repeat);
    let of_direction = |direction: usize| -> f64 {
        let of_arc = |(arc, half): &(Range<usize>, usize)| {
            let values = arc.clone().map(|k| repeat.basis.at(k, direction));
            flat_top(&values.collect::<Vec<f64>>(), *half)
        };
        arcs.iter().map(of_arc).sum()
    };
    let each = (0..repeat.basis.rank()).into_par_iter().map(of_direction);
    each.collect::<Vec<f64>>().iter().sum()
}

/// The samples of each arc, and how many of them half a window has.
fn arcs(repeat: &Repeat) -> Vec<(Range<usize>, usize)> {
    let half = |(arc, each_s): (Range<usize>, f64)| {
        let half = (FLAT_S / each_s.max(f64::EPSILON)) as usize;
        let most = arc.len();
        (arc, half.clamp(1, most))
    };
    repeat.arcs().into_iter().map(half).collect()
}

/// `S` of the values of one arc.
fn flat_top(values: &[f64], half: usize) -> f64 {
    2.0 * falling(values, 2 * half) - falling(values, half)
}

/// The same with weights that fall from the beginning: the mean square of the sums over all windows that touch the arc.
fn falling(values: &[f64], window: usize) -> f64 {
    let (mut sum, mut squares) = (0.0, 0.0);
    for k in 0..values.len() + window - 1 {
        sum += values.get(k).unwrap_or(&0.0);
        if k >= window {
            sum -= values[k - window];
        }
        squares += sum * sum;
    }
    squares / window as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the sum over pairs as it is written.
    #[test]
    fn sums_over_windows_are_weights_over_distances() {
        let values: Vec<f64> = (0..40).map(|k| f64::from(k * k % 17) - 8.0).collect();
        let half = 5_usize;
        let mut expected = 0.0;
        for (i, a) in values.iter().enumerate() {
            for (k, b) in values.iter().enumerate() {
                let share = i.abs_diff(k) as f64 / half as f64;
                expected += (2.0 - share).clamp(0.0, 1.0) * a * b;
            }
        }
        assert!((flat_top(&values, half) / expected - 1.0).abs() < 1e-12);
    }
}
