//! The numbers that decide what is named, each with its reason.
//!
//! Two questions are asked of an effect, and they are not the same. Is it more than chance? That is a gain against
//! the long-run variance `v` of what is left, `noise.long_run_mm2`: an amplitude that is not there gains `v` on
//! average, and `k v` with the probability of a normal variable beyond `sqrt(k)` sigma. And is it large enough to
//! tell causes apart, and for anybody to act? That is a size against the noise of a reading.
//!
//! *Derived* says that the number follows from a probability, a geometry or a rounding. *By trial* says that it was
//! chosen on simulated campaigns (3D6, 10 to 30 readings a second) and is a guess about all others.

use crate::residual::{Beside, Noise, Residuals};

/// An effect must gain so many times `v` to be more than chance: seven sigma, 1.5e-12 for one amplitude. The best of
/// some thousand candidates, several amplitudes each, then reaches it in fewer than 1 of 1e7 empty campaigns.
/// Derived, for noise whose `v` is known; what is left over is for a `v` that is not.
const BEYOND_CHANCE: f64 = 50.0;
/// And in units of a `v` that counts what the fits have taken out of the noise, where so few pieces are left that their number is what
/// is not known of it: 5.5 sigma, 4e-8 for one amplitude, as the ratio of likelihoods has Student's distribution in it. Derived.
const BEYOND_FEW: f64 = 30.0;
/// An effect must be this large against the noise of a reading, rms, to be worth naming. By trial: of what is smaller
/// too little shows to tell causes from one another. In a campaign of more than
/// `50 v / (0.04 sigma²)` readings this one decides, not chance.
const WORTH_NAMING: f64 = 0.2;
/// And this large, rms, mm: a quarter of the last digit of a ball-bar's log, 0.1 um. Of less, which a fast log shows beyond any
/// chance, nobody knows whether it is the machine's or the instrument's, and what a control drives otherwise than planned
/// leaves as much at its standstills.
const WORTH_A_DIGIT_MM: f64 = 2.5e-5;

/// A search is linear: of an effect that moves readings by `d` it leaves out `d² / 2L`, with a bar of `L` = 150 mm. With the share `s` of
/// its square outside of the model `d sqrt(s)` is seen, and what is left out is less than a tenth of that for `d < L sqrt(s) / 5`: this
/// times the root of `s`, mm. What would have to be larger to explain so much is no explanation.
pub(crate) const LINEAR_MM: f64 = 30.0;

/// An effect of which less than this part of its square is left outside of the model does not show: as far as a search is
/// [linear](LINEAR_MM), 0.1 mm, it leaves 0.3 um, as large as the noise.
pub(crate) const SHOWS: f64 = 1e-5;
/// A change of a setting of which less than this part of its square is left is followed by the model. By trial:
/// one part in ten thousand of what another pivot changes, rms, still shows, because levers are long.
pub(crate) const FOLLOWED: f64 = 1e-8;

/// A cause that explains less than this share of what a curve does is not named: the curve is. By trial: knots leave some
/// per cent of what has edges.
pub(crate) const OF_A_CURVE: f64 = 0.95;
/// One cause in place of a curve explains at least this share of what the curve does, several explain more than it: they can be piled
/// up to any curve. By trial; more than [`OF_A_CURVE`], because a curve was the better beside what else had been chosen.
pub(crate) const INSTEAD_OF_A_CURVE: f64 = 0.99;
/// A cause smaller than this part of the largest curve, rms, is a part of what the curve describes. By trial: knots
/// leave some percent of what is sharp.
pub(crate) const SHADOW: f64 = 0.25;
/// An effect so many times larger, rms, than what all effects together explain is there to cancel another. By trial.
pub(crate) const FIGHTING: f64 = 2.0;

/// Two effects whose traces differ by less than this share of their squares are the same in these runs, whatever the
/// noise. By trial: 3 % of the rms.
pub(crate) const SAME: f64 = 1e-3;
/// Effects whose difference is within so many of its standard deviations are not decided between. Derived: 1 in 370.
pub(crate) const UNDECIDED_SIGMAS: f64 = 3.0;
/// Two numbers inside that differ by less than this share are one after the fit. Derived: the screen's peaks of
/// wave numbers are farther apart.
pub(crate) const ONE_NUMBER: f64 = 0.02;

/// A knot of a curve stays that gains so many times `v`: two sigma. Derived: 1 in 22; a knot too many costs little.
pub(crate) const STRAIGHT: f64 = 4.0;
/// Another frequency of a vibration in one run gains at least so many times `v`: 4.5 sigma. Derived: 1 in 130 000,
/// where some 600 frequencies are tried in each run.
pub(crate) const TUNED: f64 = 20.0;

/// Less than this part of the variance is nothing to explain in a run. By trial.
pub(crate) const NOTHING: f64 = 0.02;

/// The smallest score that is looked for beside some effects, mm². Of `S` that is left, with what is looked for in it,
/// `n = S / v` pieces are independent, and what noise is in them is known from themselves only: a gain `g` is worth
///
/// `n ln(S / (S - g)) = 50`, so `g = S (1 - exp(-50 v / S))`.
///
/// That is `50 v` where readings are many, and never all there is.
pub(crate) fn threshold_mm2(beside: &Beside) -> f64 {
    let (noise, left_mm2) = (beside.noise(), beside.left_mm2());
    let chance = -left_mm2 * (-chance(noise, left_mm2)).exp_m1();
    chance.max(worth_naming_mm2(beside.residuals, noise))
}

/// The smallest gain that stands where this is left beside it, mm²: `n ln((S + g) / S) = 50` of
/// [`threshold_mm2`].
pub(crate) fn stands_mm2(residuals: &Residuals, noise: &Noise, left_mm2: f64) -> f64 {
    let chance = left_mm2 * chance(noise, left_mm2).exp_m1();
    chance.max(worth_naming_mm2(residuals, noise))
}

/// The smallest gain of an effect beside which this is left, mm², where that alone says how noise hangs together: an effect that
/// is most of what there was hangs together for as long as a run, and `n` of [`threshold_mm2`] are then so few pieces that
/// nothing could gain enough. The best of a thousand candidates may take half of the `v` of mere noise with it, so twice as much
/// is asked: `n ln((S + g) / S) = 100`.
pub(crate) fn chosen_mm2(residuals: &Residuals, noise: &Noise, left_mm2: f64) -> f64 {
    let chance = left_mm2 * (2.0 * chance(noise, left_mm2)).exp_m1();
    chance.max(worth_naming_mm2(residuals, noise))
}

/// The smallest gain that stands beside effects next to which nothing but noise is left, mm²: fifty times its `v`, and
/// `n ln((S + g) / S) = 30`.
pub(crate) fn stands_beside_mm2(beside: &Beside) -> f64 {
    let (noise, left_mm2) = (beside.noise_alone(), beside.left_mm2());
    let few_mm2 = left_mm2 * (BEYOND_FEW * piece(&noise, left_mm2)).exp_m1();
    let chance_mm2 = few_mm2.max(BEYOND_CHANCE * noise.long_run_mm2);
    chance_mm2.max(worth_naming_mm2(beside.residuals, &noise))
}

/// `50 / n`.
fn chance(noise: &Noise, left_mm2: f64) -> f64 {
    BEYOND_CHANCE * piece(noise, left_mm2)
}

/// `1 / n`, with one piece at the least; nothing left is no noise.
fn piece(noise: &Noise, left_mm2: f64) -> f64 {
    if left_mm2 > 0.0 { (noise.long_run_mm2 / left_mm2).min(1.0) } else { 0.0 }
}

fn worth_naming_mm2(residuals: &Residuals, noise: &Noise) -> f64 {
    let worth_mm2 = (WORTH_NAMING.powi(2) * noise.variance_mm2).max(WORTH_A_DIGIT_MM.powi(2));
    worth_mm2 * residuals.samples() as f64
}
