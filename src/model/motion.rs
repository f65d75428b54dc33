//! What terms beyond position and sense depend on.

use nalgebra::Vector3;

/// The last reversal of a slide, as seen from now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reversal {
    /// How long ago, s.
    pub ago_s: f64,
    /// How far ago along the slide, mm, not negative.
    pub ago_mm: f64,
}

/// The next corner of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// How soon, s.
    pub ahead_s: f64,
    /// By how much the commanded velocity of X, Y, Z jumps there, mm/s.
    pub jump_mm_s: Vector3<f64>,
}

/// Of a vibration of which means of readings leave less than this, nine tenths would be in the single readings: it is an alias.
const LEFT_BY_MEANS: f64 = 0.1;

/// The readings that a reading is the mean of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Averaged {
    /// How many.
    pub readings: f64,
    /// From one to the next, s.
    pub period_s: f64,
}

impl Averaged {
    /// A reading by itself.
    pub const SINGLE: Self = Self { readings: 1.0, period_s: 0.0 };

    /// How long they last together, s.
    pub fn lasts_s(&self) -> f64 {
        self.readings * self.period_s
    }

    /// By which factor the mean is smaller than the middle of a wave that makes so many turns while they last: of n readings
    /// `sin(n p) / (n sin p)`, with `p` half the angle from one to the next.
    pub fn share_of_wave(&self, turns: f64) -> f64 {
        let half_rad = std::f64::consts::PI * turns / self.readings;
        let all_rad = self.readings * half_rad;
        // Where each reading has turned all the way round, the limit of it.
        if half_rad.sin().abs() > 1e-9 {
            all_rad.sin() / (self.readings * half_rad.sin())
        } else {
            all_rad.cos() / half_rad.cos()
        }
    }

    /// Whether the mean has as much of a vibration of this frequency, Hz, that it may be what the mean shows.
    pub fn holds(&self, frequency_hz: f64) -> bool {
        self.share_of_wave(frequency_hz * self.lasts_s()).abs() > LEFT_BY_MEANS
    }
}

/// How the machine moves at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Velocity of X, Y, Z, mm/s.
    pub velocity_mm_s: Vector3<f64>,
    /// Time since the program began by the clock of the bar, the operator's pauses included, s.
    pub elapsed_s: f64,
    /// Time in the program, the operator's pauses left out, s: the same place of a program has the same in all runs.
    pub program_s: f64,
    /// The last reversal of X, Y, Z; `None` where a slide has only ever moved one way.
    pub reversals: [Option<Reversal>; 3],
    /// The end of the present block.
    pub corner: Corner,
    /// What the reading is the mean of.
    pub averaged: Averaged,
    /// Which of the runs that are looked at together: an effect may be one run's alone.
    pub run: usize,
}

impl Motion {
    /// A machine that has always stood still.
    pub const REST: Self = Self {
        velocity_mm_s: Vector3::new(0.0, 0.0, 0.0),
        elapsed_s: 0.0,
        program_s: 0.0,
        reversals: [None; 3],
        corner: Corner { ahead_s: f64::INFINITY, jump_mm_s: Vector3::new(0.0, 0.0, 0.0) },
        averaged: Averaged::SINGLE,
        run: 0,
    };

    /// The same a little later in the program, s, by when the slides have become so much faster, mm/s; none turns in between.
    #[must_use]
    pub fn later(&self, later_s: f64, faster_mm_s: &Vector3<f64>) -> Self {
        let mut later = *self;
        later.velocity_mm_s += faster_mm_s;
        for (reversal, mm_s) in later.reversals.iter_mut().zip(&self.velocity_mm_s) {
            if let Some(Reversal { ago_s, ago_mm }) = reversal {
                *ago_s = (*ago_s + later_s).max(0.0);
                *ago_mm = (*ago_mm + later_s * mm_s.abs()).max(0.0);
            }
        }
        later
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn what_is_later_is_faster_and_farther_from_where_it_turned() {
        let reversal = Reversal { ago_s: 0.5, ago_mm: 0.25 };
        let now = Motion {
            velocity_mm_s: Vector3::new(-2.0, 1.0, 0.0),
            reversals: [Some(reversal), None, None],
            ..Motion::REST
        };
        let later = now.later(0.1, &Vector3::new(-0.4, 0.2, 0.0));
        assert!((later.velocity_mm_s - Vector3::new(-2.4, 1.2, 0.0)).norm() < 1e-12);
        let [Some(of_x), None, None] = later.reversals else { panic!("{later:?}") };
        assert!((of_x.ago_s - 0.6).abs() < 1e-12 && (of_x.ago_mm - 0.45).abs() < 1e-12, "{of_x:?}");
        // No reversal is ahead.
        let [Some(of_x), ..] = now.later(-1.0, &Vector3::zeros()).reversals else { panic!() };
        assert_eq!((of_x.ago_s, of_x.ago_mm), (0.0, 0.0));
    }

    #[test]
    fn a_mean_holds_the_share_of_a_wave_that_its_readings_do() {
        for (readings, period_s) in [(1, 0.0), (2, 0.01), (5, 0.004), (20, 1e-3)] {
            let averaged = Averaged { readings: f64::from(readings), period_s };
            for hz in [0.0, 0.7, 10.0, 26.0, 50.0, 60.0, 130.0, 250.0, 1000.0] {
                let wave = |k: i32| {
                    let from_middle = f64::from(k) - 0.5 * f64::from(readings - 1);
                    (TAU * hz * from_middle * period_s).cos()
                };
                let mean = (0..readings).map(wave).sum::<f64>() / f64::from(readings);
                let share = averaged.share_of_wave(hz * averaged.lasts_s());
                assert!((share - mean).abs() < 1e-9, "{readings} {hz}: {share} {mean}");
            }
        }
    }
}
