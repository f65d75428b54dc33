//! The numbers that decide what is named.

use crate::residual::Beside;

/// An effect of which less than this part of its square is left outside of the model is not seen.
pub(crate) const SEEN: f64 = 4e-4;
/// An effect must gain this many times what chance gives an amplitude: some seven sigma, for the search.
const BEYOND_CHANCE: f64 = 50.0;
/// And be this large against the noise of a reading, rms: of what is smaller too little shows to tell causes
/// from one another.
const WORTH_NAMING: f64 = 0.2;
/// A cause that explains less than this share of what a curve does is not named.
pub(crate) const OF_A_CURVE: f64 = 0.95;
/// A cause smaller than this part of the largest curve, rms, is a part of what the curve describes.
pub(crate) const SHADOW: f64 = 0.25;

/// The smallest score that counts, mm².
pub(crate) fn threshold_mm2(beside: &Beside) -> f64 {
    let noise = beside.noise();
    let chance = BEYOND_CHANCE * noise.long_run_mm2;
    let samples = beside.residuals.samples() as f64;
    chance.max(WORTH_NAMING * WORTH_NAMING * noise.variance_mm2 * samples)
}
