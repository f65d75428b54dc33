//! Times at even distances.

/// So many times at even distances: those of the readings of which a sample is the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// The first one, s.
    pub first_s: f64,
    /// From one to the next, s.
    pub period_s: f64,
    /// How many there are.
    pub count: usize,
}

impl Times {
    /// So many about one in their middle.
    pub fn about(middle_s: f64, period_s: f64, count: usize) -> Self {
        let first_s = middle_s - 0.5 * period_s * count.saturating_sub(1) as f64;
        Self { first_s, period_s, count }
    }

    /// The same ones, later by so much.
    #[must_use]
    pub fn later(&self, by_s: f64) -> Self {
        Self { first_s: self.first_s + by_s, ..*self }
    }

    /// Their mean, s.
    pub fn middle_s(&self) -> f64 {
        self.at_s(0.5 * self.count.saturating_sub(1) as f64)
    }

    /// Their variance, s²; that of the readings, not of the window that they fill.
    pub fn variance_s2(&self) -> f64 {
        let count = self.count.max(1) as f64;
        self.period_s.powi(2) * (count * count - 1.0) / 12.0
    }

    /// How far from its middle a curve of third degree has, with the middle, the mean over these times, s.
    pub fn node_s(&self) -> f64 {
        (1.5 * self.variance_s2()).sqrt()
    }

    /// The time of a number, also between two of them, s.
    pub fn at_s(&self, number: f64) -> f64 {
        self.first_s + self.period_s * number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_points_have_the_mean_of_a_cubic() {
        let curve = |t: f64| 3.0 - t + 2.0 * t * t + 0.5 * t * t * t;
        for count in [1, 2, 5, 20] {
            let times = Times::about(0.3, 0.7 / count as f64, count);
            let mean = (0..count).map(|k| curve(times.at_s(k as f64))).sum::<f64>() / count as f64;
            let of_three =
                [-times.node_s(), 0.0, times.node_s()].map(|s| curve(times.middle_s() + s));
            assert!((of_three.iter().sum::<f64>() / 3.0 - mean).abs() < 1e-12, "{count}");
        }
    }
}
