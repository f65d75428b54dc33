//! What an effect may hang on, and effects that are only described.

use std::fmt;

use super::jacobian::Situation;
use super::motion::Motion;
use super::seat::Seat;
use super::term::{Parameter, ParameterId, Term};
use crate::machine::{Axis, ChainErrors, Pose};
use nalgebra::Vector3;

/// What an effect may hang on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Variable {
    /// Machine coordinate of a slide, mm.
    Position(Axis),
    /// Velocity of a slide, mm/s.
    Velocity(Axis),
    /// Time since the program began, s.
    Elapsed,
    /// Time in the program, without the operator's pauses, s.
    Program,
    /// Time since a slide reversed, s.
    SinceReversal(Axis),
    /// Way of a slide since it reversed, mm.
    WaySinceReversal(Axis),
}

impl Variable {
    /// All that there are.
    pub fn all() -> impl Iterator<Item = Self> {
        let of_slides = Axis::ALL.into_iter().flat_map(|axis| {
            [
                Self::Position(axis),
                Self::Velocity(axis),
                Self::SinceReversal(axis),
                Self::WaySinceReversal(axis),
            ]
        });
        of_slides.chain([Self::Elapsed, Self::Program])
    }

    /// Reads what it is called, such as `position of X`.
    pub fn parse(name: &str) -> Option<Self> {
        Self::all().find(|variable| variable.to_string() == name)
    }

    /// Its value; `None` where a slide has never reversed.
    pub fn value(self, pose: &Pose, motion: &Motion) -> Option<f64> {
        match self {
            Self::Position(axis) => Some(pose.position_mm[axis.index()]),
            Self::Velocity(axis) => Some(motion.velocity_mm_s[axis.index()]),
            Self::Elapsed => Some(motion.elapsed_s),
            Self::Program => Some(motion.program_s),
            Self::SinceReversal(axis) => motion.reversals[axis.index()].map(|r| r.ago_s),
            Self::WaySinceReversal(axis) => motion.reversals[axis.index()].map(|r| r.ago_mm),
        }
    }

    /// What it changes by in a second: of what counts from a reversal nothing, as that is no wave.
    pub fn per_s(self, motion: &Motion) -> f64 {
        match self {
            Self::Position(axis) => motion.velocity_mm_s[axis.index()],
            Self::Elapsed | Self::Program => 1.0,
            Self::Velocity(_) | Self::SinceReversal(_) | Self::WaySinceReversal(_) => 0.0,
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Position(_) | Self::WaySinceReversal(_) => "mm",
            Self::Velocity(_) => "mm/s",
            Self::Elapsed | Self::Program | Self::SinceReversal(_) => "s",
        }
    }

    /// The slide, if it is one's.
    pub fn slide(self) -> Option<Axis> {
        match self {
            Self::Position(axis)
            | Self::Velocity(axis)
            | Self::SinceReversal(axis)
            | Self::WaySinceReversal(axis) => Some(axis),
            Self::Elapsed | Self::Program => None,
        }
    }
}

impl fmt::Display for Variable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Position(axis) => write!(f, "position of {axis}"),
            Self::Velocity(axis) => write!(f, "velocity of {axis}"),
            Self::Elapsed => f.write_str("time since the program began"),
            Self::Program => f.write_str("time in the program"),
            Self::SinceReversal(axis) => write!(f, "time since {axis} reversed"),
            Self::WaySinceReversal(axis) => write!(f, "way since {axis} reversed"),
        }
    }
}

/// What an effect displaces and what it hangs on: `s(sample) · f(v)`, `s` the sensitivity of the length to the
/// seat, turned with the sense of the variable's slide where the effect is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Dependence {
    /// What it displaces.
    pub seat: Seat,
    /// What it hangs on.
    pub variable: Variable,
    /// Whether it changes its sign with the sense of the variable's slide.
    pub with_sense: bool,
}

impl Dependence {
    /// The variable's value and by which sign the effect counts; `None` where a slide has never reversed.
    pub fn value(&self, pose: &Pose, motion: &Motion) -> Option<(f64, f64)> {
        Some((self.variable.value(pose, motion)?, self.sense(pose)))
    }

    /// By which sign the effect counts.
    pub fn sense(&self, pose: &Pose) -> f64 {
        match self.variable.slide() {
            Some(axis) if self.with_sense => pose.sense[axis.index()],
            _ => 1.0,
        }
    }

    /// The variable's value and what one of the effect there does to the length, mm per mm or rad.
    pub fn at(&self, at: &Situation) -> Option<(f64, f64)> {
        let (value, sense) = self.value(&at.pose, &at.motion)?;
        Some((value, self.seat.sensitivity(at) * sense))
    }
}

/// An effect that is described and not explained: a curve over a variable, straight between its knots.
///
/// It is labelled empirical wherever it is shown. Beyond the outer knots the curve goes on level.
#[derive(Debug, Clone, PartialEq)]
pub struct Empirical {
    /// What it displaces.
    pub seat: Seat,
    /// What it hangs on.
    pub variable: Variable,
    /// Whether it changes its sign with the sense of the variable's slide.
    pub with_sense: bool,
    /// Where the curve has its corners, ascending, in the unit of the variable; two at the least.
    pub knots: Vec<f64>,
}

impl Empirical {
    /// The two knots around a place and the share of the second one.
    pub fn between(&self, pose: &Pose, motion: &Motion) -> Option<(usize, f64, f64)> {
        let (value, sense) = self.dependence().value(pose, motion)?;
        let (first, share) = place(&self.knots, value);
        Some((first, share, sense))
    }

    /// What it displaces and what it hangs on.
    pub fn dependence(&self) -> Dependence {
        Dependence { seat: self.seat, variable: self.variable, with_sense: self.with_sense }
    }

    /// What it is called in a table.
    pub fn name(&self) -> String {
        let sense = if self.with_sense { ", by direction" } else { "" };
        format!("empirical {} over {}{sense}", self.seat, self.variable)
    }
}

/// The knot before a value and how far the value is towards the next, 0 to 1.
pub fn place(knots: &[f64], value: f64) -> (usize, f64) {
    let first = knots.partition_point(|knot| *knot <= value).clamp(1, knots.len() - 1) - 1;
    let share = (value - knots[first]) / (knots[first + 1] - knots[first]);
    (first, share.clamp(0.0, 1.0))
}

impl Term for Empirical {
    fn parameters(&self) -> Vec<Parameter> {
        let unit = match self.seat {
            Seat::Function(_, component) if component.is_angular() => "rad",
            Seat::Coefficient(of) => of.unit(),
            _ => "mm",
        };
        let name = self.name();
        let of = |knot: &f64| Parameter {
            id: ParameterId::Amplitude,
            name: format!("{name} at {knot:.1} {}", self.variable.unit()),
            unit,
            plausible: None,
        };
        self.knots.iter().map(of).collect()
    }

    fn parameter_count(&self) -> usize {
        self.knots.len()
    }

    fn columns(&self, at: &Situation, out: &mut [f64]) {
        out.fill(0.0);
        let Some((first, share, sense)) = self.between(&at.pose, &at.motion) else { return };
        let sensitivity = sense * self.seat.sensitivity(at);
        out[first] = (1.0 - share) * sensitivity;
        out[first + 1] = share * sensitivity;
    }

    fn bend(
        &self,
        values: &[f64],
        at: &Pose,
        motion: &Motion,
        _mounting: usize,
        errors: &mut ChainErrors,
    ) {
        let Some((first, share, sense)) = self.between(at, motion) else { return };
        let amount = sense * ((1.0 - share) * values[first] + share * values[first + 1]);
        self.seat.displace(amount, at, motion, errors);
    }

    fn lengthens(&self) -> bool {
        self.seat.lengthens()
    }

    fn lengthen(
        &self,
        values: &[f64],
        at: &Pose,
        motion: &Motion,
        _mounting: usize,
        _direction: &Vector3<f64>,
    ) -> f64 {
        if !self.lengthens() {
            return 0.0;
        }
        let Some((first, share, sense)) = self.between(at, motion) else { return 0.0 };
        sense * ((1.0 - share) * values[first] + share * values[first + 1])
    }
}
