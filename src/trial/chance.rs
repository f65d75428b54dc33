//! Random numbers of a trial.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64Mcg;

use super::class::Class;

/// What a stream is for. The numbers are part of what a seed means: never change them.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    Effects = 1,
    Days = 2,
    Grid = 3,
}

/// One stream.
#[derive(Debug, Clone)]
pub(super) struct Chance(Pcg64Mcg);

impl Chance {
    pub(super) fn new(seed: u64, class: Class, index: u64, purpose: Purpose) -> Self {
        let place = index << 8 | (class as u64) << 4 | purpose as u64;
        // `seed_from_u64` spreads neighbouring numbers over all bits; what goes in must only differ.
        Self(Pcg64Mcg::seed_from_u64(seed.rotate_left(40) ^ place))
    }

    /// Uniform from 0 to 1.
    pub(super) fn share(&mut self) -> f64 {
        StandardUniform.sample(&mut self.0)
    }

    /// Uniform between two limits.
    pub(super) fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * self.share()
    }

    /// Uniform in the logarithm between two limits.
    pub(super) fn log_between(&mut self, [low, high]: [f64; 2]) -> f64 {
        self.between([low.ln(), high.ln()]).exp()
    }

    /// A whole number below a limit.
    pub(super) fn below(&mut self, limit: usize) -> usize {
        ((self.share() * limit as f64) as usize).min(limit.saturating_sub(1))
    }

    /// One of several; there is at least one.
    pub(super) fn one_of<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// +1 or -1.
    pub(super) fn sign(&mut self) -> f64 {
        if self.share() < 0.5 { 1.0 } else { -1.0 }
    }

    /// Normal, mean 0, variance 1.
    pub(super) fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A seed for others.
    pub(super) fn seed(&mut self) -> u64 {
        (self.share() * 2f64.powi(52)) as u64
    }
}
