//! Speed over one block.

/// A trapezoid in speed: accelerate, cruise, decelerate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    start_mm_s: f64,
    cruise_mm_s: f64,
    acceleration_mm_s2: f64,
    accelerate_s: f64,
    cruise_s: f64,
    decelerate_s: f64,
}

impl Profile {
    /// The fastest trapezoid over `length_mm` from one speed to another, within `cruise_mm_s`.
    ///
    /// The end speeds must be reachable from each other over the length; the two-pass planning sees to it.
    pub fn fastest(
        length_mm: f64,
        start_mm_s: f64,
        end_mm_s: f64,
        cruise_mm_s: f64,
        acceleration_mm_s2: f64,
    ) -> Self {
        let (v0, v1, a) = (start_mm_s, end_mm_s, acceleration_mm_s2);
        // Where acceleration and deceleration meet: v² = a L + (v0² + v1²) / 2.
        let peak = (a * length_mm + 0.5 * (v0 * v0 + v1 * v1)).sqrt();
        let cruise = peak.min(cruise_mm_s).max(v0).max(v1);
        let ramps_mm = (2.0 * cruise * cruise - v0 * v0 - v1 * v1) / (2.0 * a);
        Self {
            start_mm_s: v0,
            cruise_mm_s: cruise,
            acceleration_mm_s2: a,
            accelerate_s: (cruise - v0) / a,
            cruise_s: ((length_mm - ramps_mm) / cruise).max(0.0),
            decelerate_s: (cruise - v1) / a,
        }
    }

    /// How long the block takes, s.
    pub fn duration_s(&self) -> f64 {
        self.accelerate_s + self.cruise_s + self.decelerate_s
    }

    /// When a distance along the block is reached, s.
    pub fn time_of_s(&self, distance_mm: f64) -> f64 {
        // Distance grows with time: bisection is exact enough in 60 halvings.
        let (mut low, mut high) = (0.0, self.duration_s());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.at(middle).0 < distance_mm { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Distance (mm) and speed (mm/s) along the block after `t_s`.
    pub fn at(&self, t_s: f64) -> (f64, f64) {
        let (v0, vc, a) = (self.start_mm_s, self.cruise_mm_s, self.acceleration_mm_s2);
        let t = t_s.clamp(0.0, self.duration_s());
        if t < self.accelerate_s {
            return (v0 * t + 0.5 * a * t * t, v0 + a * t);
        }
        let accelerated = 0.5 * (v0 + vc) * self.accelerate_s;
        if t < self.accelerate_s + self.cruise_s {
            return (accelerated + vc * (t - self.accelerate_s), vc);
        }
        let braking = t - self.accelerate_s - self.cruise_s;
        let distance =
            accelerated + vc * self.cruise_s + vc * braking - 0.5 * a * braking * braking;
        (distance, vc - a * braking)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_from_rest_to_rest_reaches_its_feed_or_turns_at_half_way() {
        let long = Profile::fastest(10.0, 0.0, 0.0, 10.0, 500.0);
        assert!((long.duration_s() - (10.0 / 10.0 + 10.0 / 500.0)).abs() < 1e-12);
        assert!((long.at(long.duration_s()).0 - 10.0).abs() < 1e-12);
        let short = Profile::fastest(0.05, 0.0, 0.0, 10.0, 500.0);
        assert!((short.duration_s() - 2.0 * (0.05_f64 / 500.0).sqrt()).abs() < 1e-12);
        assert!((short.at(short.duration_s() / 2.0).0 - 0.025).abs() < 1e-12);
    }

    #[test]
    fn speed_is_the_derivative_of_distance() {
        let profile = Profile::fastest(3.0, 4.0, 2.0, 20.0, 100.0);
        for k in 1..100 {
            let t = profile.duration_s() * f64::from(k) / 100.0;
            let slope = (profile.at(t + 1e-6).0 - profile.at(t - 1e-6).0) / 2e-6;
            assert!((slope - profile.at(t).1).abs() < 1e-4, "at {t}");
        }
    }
}
