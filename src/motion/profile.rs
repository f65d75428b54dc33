//! Speed over one block.

/// A stretch of time with a constant jerk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Phase {
    pub(super) duration_s: f64,
    /// At its beginning.
    pub(super) speed_mm_s: f64,
    /// At its beginning.
    pub(super) acceleration_mm_s2: f64,
    pub(super) jerk_mm_s3: f64,
}

impl Phase {
    /// Distance (mm) and speed (mm/s) after a time.
    pub(super) fn at(&self, t: f64) -> (f64, f64) {
        let (v, a, j) = (self.speed_mm_s, self.acceleration_mm_s2, self.jerk_mm_s3);
        (t * (v + t * (0.5 * a + t * j / 6.0)), v + t * (a + 0.5 * j * t))
    }

    /// When a distance is reached, s; the speed is nowhere negative.
    pub(super) fn time_of_s(&self, distance_mm: f64) -> f64 {
        bisect(self.duration_s, |t| self.at(t).0 < distance_mm)
    }

    /// Its parts before and after a time.
    pub(super) fn split(self, time_s: f64) -> (Self, Self) {
        let second = Self {
            duration_s: self.duration_s - time_s,
            speed_mm_s: self.at(time_s).1,
            acceleration_mm_s2: self.acceleration_mm_s2 + self.jerk_mm_s3 * time_s,
            jerk_mm_s3: self.jerk_mm_s3,
        };
        (Self { duration_s: time_s, ..self }, second)
    }
}

/// The time until which something holds: distance grows with time, and 60 halvings are exact enough.
fn bisect(duration_s: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, duration_s);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Speed over time within one block.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile(Shape);

/// Every sample of an alignment asks a trapezoid for its place some ten times, so it is kept small.
#[derive(Debug, Clone, PartialEq)]
enum Shape {
    /// Accelerate, cruise, decelerate.
    Trapezoid {
        start_mm_s: f64,
        cruise_mm_s: f64,
        acceleration_mm_s2: f64,
        accelerate_s: f64,
        cruise_s: f64,
        decelerate_s: f64,
    },
    /// Whatever filtering has made of it.
    Filtered(Box<[Phase]>),
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
        Self(Shape::Trapezoid {
            start_mm_s: v0,
            cruise_mm_s: cruise,
            acceleration_mm_s2: a,
            accelerate_s: (cruise - v0) / a,
            cruise_s: ((length_mm - ramps_mm) / cruise).max(0.0),
            decelerate_s: (cruise - v1) / a,
        })
    }

    pub(super) fn of_phases(phases: Vec<Phase>) -> Self {
        Self(Shape::Filtered(phases.into_boxed_slice()))
    }

    /// The stretches of constant jerk that it is made of.
    pub(super) fn phases(&self) -> Vec<Phase> {
        match &self.0 {
            Shape::Filtered(phases) => phases.to_vec(),
            Shape::Trapezoid { .. } => self.trapezoid().into_iter().flatten().collect(),
        }
    }

    /// The three of a trapezoid.
    fn trapezoid(&self) -> Option<[Phase; 3]> {
        let Shape::Trapezoid {
            start_mm_s,
            cruise_mm_s,
            acceleration_mm_s2,
            accelerate_s,
            cruise_s,
            decelerate_s,
        } = self.0
        else {
            return None;
        };
        let phases = [
            (accelerate_s, start_mm_s, acceleration_mm_s2),
            (cruise_s, cruise_mm_s, 0.0),
            (decelerate_s, cruise_mm_s, -acceleration_mm_s2),
        ];
        Some(phases.map(|(duration_s, speed_mm_s, acceleration_mm_s2)| Phase {
            duration_s,
            speed_mm_s,
            acceleration_mm_s2,
            jerk_mm_s3: 0.0,
        }))
    }

    /// How many stretches of constant jerk it is made of.
    pub(super) fn phase_count(&self) -> usize {
        match &self.0 {
            Shape::Filtered(phases) => phases.len(),
            Shape::Trapezoid { .. } => 3,
        }
    }

    /// One of them, with when it begins (s) and how far along the block (mm).
    pub(super) fn phase(&self, number: usize) -> Option<(f64, f64, Phase)> {
        let three;
        let phases: &[Phase] = match &self.0 {
            Shape::Filtered(phases) => phases,
            Shape::Trapezoid { .. } => {
                three = self.trapezoid()?;
                &three
            }
        };
        let (mut into_s, mut into_mm) = (0.0, 0.0);
        for phase in phases.get(..number)? {
            into_s += phase.duration_s;
            into_mm += phase.at(phase.duration_s).0;
        }
        let phase = *phases.get(number)?;
        Some((into_s, into_mm, phase))
    }

    /// How long the block takes, s.
    pub fn duration_s(&self) -> f64 {
        match &self.0 {
            Shape::Trapezoid { accelerate_s, cruise_s, decelerate_s, .. } => {
                accelerate_s + cruise_s + decelerate_s
            }
            Shape::Filtered(phases) => phases.iter().map(|phase| phase.duration_s).sum(),
        }
    }

    /// When a distance along the block is reached, s.
    pub fn time_of_s(&self, distance_mm: f64) -> f64 {
        bisect(self.duration_s(), |t| self.at(t).0 < distance_mm)
    }

    /// Distance (mm) and speed (mm/s) along the block after `t_s`.
    pub fn at(&self, t_s: f64) -> (f64, f64) {
        let t = t_s.clamp(0.0, self.duration_s());
        match &self.0 {
            Shape::Trapezoid {
                start_mm_s: v0,
                cruise_mm_s: vc,
                acceleration_mm_s2: a,
                accelerate_s,
                cruise_s,
                ..
            } => {
                if t < *accelerate_s {
                    return (v0 * t + 0.5 * a * t * t, v0 + a * t);
                }
                let accelerated = 0.5 * (v0 + vc) * accelerate_s;
                if t < accelerate_s + cruise_s {
                    return (accelerated + vc * (t - accelerate_s), *vc);
                }
                let braking = t - accelerate_s - cruise_s;
                let distance =
                    accelerated + vc * cruise_s + vc * braking - 0.5 * a * braking * braking;
                (distance, vc - a * braking)
            }
            Shape::Filtered(phases) => {
                let (mut left, mut distance, mut speed) = (t, 0.0, 0.0);
                for phase in phases {
                    let (travelled, now) = phase.at(left.min(phase.duration_s));
                    distance += travelled;
                    speed = now;
                    if left < phase.duration_s {
                        break;
                    }
                    left -= phase.duration_s;
                }
                (distance, speed)
            }
        }
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

    /// The mean of a trapezoid over the change time: the same way, that much later, with the jerk a/T.
    #[test]
    fn filtered_blocks_take_the_change_time_longer_and_join_smoothly() {
        let (a, change_s) = (500.0, 0.03);
        let lengths = [0.4, 2.0, 0.1, 3.0];
        let speeds = [0.0, 12.0, 20.0, 18.0, 0.0];
        let planned: Vec<Profile> = (0..4)
            .map(|k| Profile::fastest(lengths[k], speeds[k], speeds[k + 1], 20.0, a))
            .collect();
        let filtered = super::super::bell::filtered(&planned, &lengths, change_s);
        let total = |profiles: &[Profile]| profiles.iter().map(Profile::duration_s).sum::<f64>();
        assert!((total(&filtered) - total(&planned) - change_s).abs() < 1e-9);
        let mut before = 0.0;
        for (profile, length) in filtered.iter().zip(&lengths) {
            let (distance, speed) = profile.at(profile.duration_s());
            assert!((distance - length).abs() < 1e-9, "{distance} of {length}");
            assert!((profile.at(0.0).1 - before).abs() < 1e-6, "speeds join");
            before = speed;
            for phase in profile.phases() {
                assert!(phase.jerk_mm_s3.abs() <= 2.0 * a / change_s * (1.0 + 1e-9));
                assert!(phase.acceleration_mm_s2.abs() <= a * (1.0 + 1e-9));
            }
        }
        assert!(before.abs() < 1e-6, "at rest");
    }
}
