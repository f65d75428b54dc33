//! The numbers that a cause has.

use super::seat::Seat;
use super::unit::Unit;

/// What a number measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// What the seat is displaced by: um, urad, or um/m of a scale.
    OfSeat,
    /// By how much more of that in every length of way.
    OfSeatPerLength,
    /// Always the same.
    Fixed(Unit),
}

/// A number of a cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// What it is called, without its unit.
    pub name: &'static str,
    /// What it measures.
    pub measure: Measure,
    /// What it is where it is not given, in the written unit; `None` where it must be.
    pub default: Option<f64>,
    /// From .. to, in the written unit.
    pub limits: [f64; 2],
}

/// The name of the key that scales an effect in the unit of its seat.
pub const AMPLITUDE: &str = "amplitude";
/// The name of the key for where a wave begins.
pub const PHASE: &str = "phase";
/// The name of the key for which harmonic of a degree it is.
pub const ORDER: &str = "order";
/// The name of the key for the run in which it is, counted from 1.
pub const RUN: &str = "run";
/// The name of the key for the mounting in which it is, counted from 1; 0 is all.
pub const MOUNTING: &str = "mounting";
/// The name of the key for a degree.
pub const DEGREE: &str = "degree";

impl Key {
    /// The unit in which it is written for a seat.
    pub fn unit(&self, seat: Seat) -> Unit {
        match self.measure {
            Measure::Fixed(unit) => unit,
            Measure::OfSeat => seat.unit(),
            Measure::OfSeatPerLength if seat.unit() == Unit::URAD => Unit::URAD_MM,
            Measure::OfSeatPerLength => Unit::UM_M,
        }
    }

    /// Its name with its unit, as files and commands have it: `amplitude_urad`, `speed_mm_min`, `percent`.
    pub fn written(&self, seat: Seat) -> String {
        match self.unit(seat).suffix {
            "" => self.name.to_owned(),
            suffix => format!("{}_{suffix}", self.name),
        }
    }

    /// The limits in mm, s, rad.
    pub fn limits_si(&self, seat: Seat) -> [f64; 2] {
        self.limits.map(|limit| limit * self.unit(seat).si)
    }

    /// Whether it counts something.
    pub fn is_whole(&self) -> bool {
        [DEGREE, ORDER, RUN, MOUNTING].contains(&self.name)
    }

    /// The whole numbers that it may be.
    pub fn whole_numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let [low, high] = self.limits;
        (low as i32..=high as i32).map(f64::from)
    }
}
