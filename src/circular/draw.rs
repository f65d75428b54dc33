//! Noise, drawn as a fit found it.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::solve::NoiseModel;

/// After so many numbers an autoregression has forgotten that it began with silence.
const LEAD: usize = 200;

/// Noise of neighbouring readings, mm; the same number gives the same noise.
pub(super) fn noise_mm(of: &NoiseModel, count: usize, number: u64) -> Vec<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(number);
    let mut drawn: Vec<f64> = Vec::with_capacity(LEAD + count);
    for _ in 0..LEAD + count {
        let fresh: f64 = StandardNormal.sample(&mut random);
        let foretold: f64 = of.phi().iter().zip(drawn.iter().rev()).map(|(phi, e)| phi * e).sum();
        drawn.push(foretold + of.innovation_sigma() * fresh);
    }
    drawn.split_off(LEAD)
}
