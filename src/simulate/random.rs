//! Streams of random numbers by seed and purpose.

use rand::SeedableRng;
use rand_distr::{Distribution, Exp1, StandardNormal, StandardUniform};
use rand_pcg::Pcg64Mcg;

/// What a stream is for. The numbers are part of what a seed means: never change them.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    Pauses = 1,
    White = 2,
    Correlated = 3,
    Dropouts = 4,
    Vibration = 5,
    Machine = 6,
    Standstills = 7,
    SetUp = 8,
}

/// One stream.
#[derive(Debug)]
pub(super) struct Stream(Pcg64Mcg);

impl Stream {
    pub(super) fn new(seed: u64, purpose: Purpose) -> Self {
        // `seed_from_u64` spreads neighbouring numbers over all bits; what goes in must only differ.
        Self(Pcg64Mcg::seed_from_u64(seed.rotate_left(8) ^ purpose as u64))
    }

    /// Normal, mean 0, variance 1.
    pub(super) fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// The same, drawn again until it is no farther from 0 than a limit.
    pub(super) fn normal_within(&mut self, limit: f64) -> f64 {
        loop {
            let value = self.normal();
            if value.abs() <= limit {
                return value;
            }
        }
    }

    /// Exponential, mean 1.
    pub(super) fn exponential(&mut self) -> f64 {
        Exp1.sample(&mut self.0)
    }

    /// Uniform between two limits.
    pub(super) fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        let share: f64 = StandardUniform.sample(&mut self.0);
        low + (high - low) * share
    }
}
