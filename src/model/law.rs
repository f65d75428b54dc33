//! What a cause does: the one formula that search, fit and pictures read.

use nalgebra::Vector3;

use super::harmonics::harmonics;
use super::motion::{Corner, Motion};
use super::variable::Variable;
use crate::machine::{Axis, Pose};

/// What an effect on an axis hangs on.
#[derive(Debug, Clone, Copy)]
pub struct Over {
    /// The variable, of the axis that the effect acts on.
    pub variable: fn(Axis) -> Variable,
    /// Whether the effect changes its sign with the sense of that axis.
    pub with_sense: bool,
}

/// What one of each amplitude displaces the seat by, of a variable `v` and an inner number `n`, in mm, s, rad.
///
/// A variable that counts from a reversal is infinite where there has been none.
#[derive(Debug, Clone, Copy)]
pub enum Law {
    /// `f(v, n)`: one amplitude.
    Curve(Over, fn(f64, f64) -> f64, Option<Inner>),
    /// The sine and the cosine of so many turns `f(v, n)`: an amplitude and a phase.
    Wave(Over, fn(f64, f64) -> f64, Inner),
    /// All harmonics of degree `n` in the direction of the bar.
    Harmonics(Inner),
    /// What commanded position and velocity differ by at the corners of chords, `n` long before them. A delay `n`
    /// that all axes have is a delay of the log but for that.
    Corner(Inner),
    /// 1.
    Constant,
    /// Nothing: the machine file or the test file says how it is, and another value is tried by identifying again.
    Setting,
    /// Something over this that diagnosis does not know; it is there to be hidden from it.
    Unknown(Over),
}

/// The number inside of a law.
#[derive(Debug, Clone, Copy)]
pub struct Inner {
    /// The name of its key.
    pub key: &'static str,
    /// On what scale it is estimated beside the amplitudes; `None` where it is held as it was found.
    pub scale: Option<Scale>,
    /// Where it is looked for.
    pub start: Start,
    /// It is less than this part of the way of its axis in the test: what is longer the test cannot show.
    pub part_of_way: f64,
    /// It is less than this part of the highest speed of its axis in the test, if it is a speed.
    pub part_of_fastest: f64,
}

/// The scale on which a number is estimated: the one on which equal steps change the effect equally.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// As it is.
    Plain,
    /// Its inverse: wave numbers, not periods.
    Inverse,
    /// Its logarithm.
    Logarithm,
}

/// Where an inner number is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// From .. to, so many, evenly in the logarithm.
    Grid([f64; 2], usize),
    /// The same as parts of the longest time since a program began: time constants.
    TimeConstants([f64; 2], usize),
    /// Not looked for: the middle of the test, about which its machine is told.
    Middle,
    /// Each whole number within the limits of its key.
    Whole,
    /// Every wave that the way holds.
    Waves,
    /// The lines in the spectra of the runs.
    Lines,
    /// Every moment between two readings.
    Moments,
}

impl Law {
    /// The number inside, where there is one.
    pub fn inner(&self) -> Option<&Inner> {
        match self {
            Self::Curve(_, _, inner) => inner.as_ref(),
            Self::Wave(_, _, inner) | Self::Harmonics(inner) | Self::Corner(inner) => Some(inner),
            Self::Constant | Self::Setting | Self::Unknown(_) => None,
        }
    }

    /// What it hangs on, where that is one variable.
    pub fn over(&self) -> Option<&Over> {
        match self {
            Self::Curve(over, ..) | Self::Wave(over, ..) | Self::Unknown(over) => Some(over),
            Self::Harmonics(_) | Self::Corner(_) | Self::Constant | Self::Setting => None,
        }
    }

    /// Whether it is a term of the model: something that amplitudes can be fitted to.
    pub fn is_term(&self) -> bool {
        !matches!(self, Self::Setting | Self::Unknown(_))
    }

    /// How many amplitudes it has.
    pub fn amplitudes(&self, inner: Option<f64>) -> usize {
        match self {
            Self::Wave(..) => 2,
            Self::Harmonics(_) => 2 * inner.unwrap_or(0.0) as usize + 1,
            _ => 1,
        }
    }

    /// What one of each amplitude displaces the seat of an axis by at a pose, with the bar along a unit vector.
    pub(super) fn at(
        &self,
        axis: Axis,
        inner: f64,
        pose: &Pose,
        motion: &Motion,
        direction: &Vector3<f64>,
        out: &mut [f64],
    ) {
        let place = |over: &Over| {
            let value = (over.variable)(axis).value(pose, motion).unwrap_or(f64::INFINITY);
            (value, if over.with_sense { pose.sense[axis.index()] } else { 1.0 })
        };
        match self {
            Self::Curve(over, f, _) => {
                let (value, sense) = place(over);
                out[0] = sense * f(value, inner);
            }
            Self::Wave(over, turns, _) => {
                let (value, sense) = place(over);
                let (sine, cosine) = (turns(value, inner) * std::f64::consts::TAU).sin_cos();
                let averaged = &motion.averaged;
                let aside = 0.5 * averaged.lasts_s() * (over.variable)(axis).per_s(motion);
                let went = turns(value + aside, inner) - turns(value - aside, inner);
                let share =
                    if went.is_finite() { sense * averaged.share_of_wave(went) } else { sense };
                (out[0], out[1]) = (share * sine, share * cosine);
            }
            Self::Harmonics(_) => harmonics(inner as usize, direction, out),
            Self::Corner(_) => {
                let Corner { ahead_s, jump_mm_s } = motion.corner;
                out[0] = if ahead_s < inner { -ahead_s * jump_mm_s.dot(direction) } else { 0.0 };
            }
            Self::Constant => out[0] = 1.0,
            Self::Setting | Self::Unknown(_) => out.fill(0.0),
        }
    }
}
