//! How often something was so.

use std::fmt;

/// A number of cases among others, with the 95 % interval of its rate (Wilson).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rate {
    /// How many were so.
    pub hits: usize,
    /// Of how many.
    pub of: usize,
}

/// Two-sided 95 % of a normal deviate.
const Z: f64 = 1.96;

impl Rate {
    /// How many of these are so.
    pub fn of<T>(cases: &[T], so: impl Fn(&T) -> bool) -> Self {
        Self { hits: cases.iter().filter(|case| so(case)).count(), of: cases.len() }
    }

    /// Share of 1; 0 of none.
    pub fn share(self) -> f64 {
        self.hits as f64 / self.of.max(1) as f64
    }

    /// 95 % interval of the share.
    pub fn interval(self) -> [f64; 2] {
        let n = self.of.max(1) as f64;
        let p = self.share();
        let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
        let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        [(middle - half).max(0.0), (middle + half).min(1.0)]
    }
}

impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.interval().map(|share| 100.0 * share);
        write!(
            f,
            "{:5.1} % ({low:.0} .. {high:.0}), {} of {}",
            100.0 * self.share(),
            self.hits,
            self.of
        )
    }
}
