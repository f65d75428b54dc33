//! Noise of the readings.

use super::random::{Purpose, Stream};

/// Stationary noise: a white part and a first-order autoregressive part.
///
/// ```text
/// n(t) = white · w(t) + c(t),    cov(c(t), c(t + dt)) = correlated² · exp(-|dt| / correlation_s)
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation of the white part, mm.
    pub white_mm: f64,
    /// Standard deviation of the correlated part, mm.
    pub correlated_mm: f64,
    /// Time in which its correlation falls to 1/e, s.
    pub correlation_s: f64,
}

impl Noise {
    /// None.
    pub const OFF: Self = Self { white_mm: 0.0, correlated_mm: 0.0, correlation_s: 1.0 };

    /// Standard deviation of one reading, mm.
    pub fn sigma_mm(&self) -> f64 {
        self.white_mm.hypot(self.correlated_mm)
    }
}

/// Draws the noise of evenly spaced samples.
#[derive(Debug)]
pub(super) struct NoiseSource {
    noise: Noise,
    /// Correlation of neighbouring samples of the correlated part.
    keep: f64,
    /// The correlated part in units of its standard deviation.
    level: f64,
    white: Stream,
    correlated: Stream,
}

impl NoiseSource {
    pub(super) fn new(noise: Noise, period_s: f64, seed: u64) -> Self {
        let mut correlated = Stream::new(seed, Purpose::Correlated);
        Self {
            noise,
            keep: (-period_s / noise.correlation_s).exp(),
            // Drawn, not zero: the noise did not begin with the log.
            level: correlated.normal(),
            white: Stream::new(seed, Purpose::White),
            correlated,
        }
    }

    /// The noise of the next sample, mm.
    pub(super) fn next_mm(&mut self) -> f64 {
        let now = self.noise.white_mm * self.white.normal() + self.noise.correlated_mm * self.level;
        let fresh = (1.0 - self.keep * self.keep).sqrt();
        self.level = self.keep * self.level + fresh * self.correlated.normal();
        now
    }
}
