//! What an effect acts on.

use std::fmt;

use super::coefficient::{Ball, Coefficient, Component, Power, SetUp};
use super::jacobian::Situation;
use super::motion::Motion;
use super::term::Term;
use super::unit::Unit;
use crate::machine::{Axis, ChainErrors, Pose};

/// What a cause acts on: the key `on` of an [`Effect`](super::Effect).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeatKind {
    /// An error function, such as `EXX` or `EBZ`.
    Function,
    /// An angular error function only, such as `EBZ`.
    Angle,
    /// An axis: `X`, `Y` or `Z`.
    Slide,
    /// An axis, or all alike where none is named.
    Slides,
    /// What warms: a ball (`EZt`, `EXw`), the scale of an axis (`EXX1`) or the bar (`bar`).
    Body,
    /// A ball: `EXt` .. `EZw`.
    Ball,
    /// The tool ball or the bar's own length: `EXt`, `EYt`, `EZt`, `bar`.
    Reading,
    /// A coefficient of the paper, such as `EBX3`.
    Coefficient,
    /// Nothing: it acts on the whole.
    None,
}

impl SeatKind {
    /// What it is, with examples, as `docs/reference.md` has it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Function => "an error function: `EXX`, `EBZ`",
            Self::Angle => "an angular function: `EBX`",
            Self::Slide => "an axis: `X`",
            Self::Slides => "an axis: `X`; without it all alike",
            Self::Body => "a ball `EZt`, a scale `EXX1`, or `bar`",
            Self::Ball => "a ball: `EXt` .. `EZw`",
            Self::Reading => "`EXt`, `EYt`, `EZt` or `bar`",
            Self::Coefficient => "a coefficient: `EBX3`",
            Self::None => "",
        }
    }
}

/// What an effect acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Seat {
    /// One of the 18 error functions: slide and component, such as `EXX`.
    Function(Axis, Component),
    /// A slide as a whole.
    Slide(Axis),
    /// A ball in one direction.
    Ball(SetUp),
    /// A coefficient, such as the scale `EXX1`.
    Coefficient(Coefficient),
    /// The bar's own length.
    Bar,
    /// Everything.
    Whole,
}

impl Seat {
    /// Whether what acts on it adds to the length and bends no chain.
    pub(super) fn lengthens(self) -> bool {
        matches!(self, Self::Bar | Self::Whole)
    }

    /// Reads `EXX`, `X`, `EZt`, `EXX1` or `bar`.
    pub fn parse(name: &str) -> Option<Self> {
        if name == "bar" {
            return Some(Self::Bar);
        }
        if let Some(set_up) = SetUp::parse(name) {
            return Some(Self::Ball(set_up));
        }
        if let Some(coefficient) = Coefficient::parse(name) {
            return Some(Self::Coefficient(coefficient));
        }
        if let Some(of) = Coefficient::parse(&format!("{name}0")) {
            return Some(Self::Function(of.slide, of.component));
        }
        Axis::ALL.into_iter().find(|axis| axis.to_string() == name).map(Self::Slide)
    }

    /// The unit in which an amplitude on it is written.
    pub fn unit(self) -> Unit {
        match self {
            Self::Function(_, component) if component.is_angular() => Unit::URAD,
            Self::Coefficient(coefficient) if coefficient.component.is_angular() => Unit::URAD,
            Self::Coefficient(_) => Unit::UM_M,
            _ => Unit::UM,
        }
    }

    /// The axis that it belongs to.
    pub fn axis(self) -> Option<Axis> {
        match self {
            Self::Function(axis, _) | Self::Slide(axis) => Some(axis),
            Self::Coefficient(of) => Some(of.slide),
            Self::Ball(_) | Self::Bar | Self::Whole => None,
        }
    }

    /// Whether a cause that acts on such things may act on it.
    pub fn fits(self, kind: SeatKind) -> bool {
        match (kind, self) {
            (SeatKind::Function, Self::Function(..))
            | (SeatKind::Slide | SeatKind::Slides, Self::Slide(_))
            | (SeatKind::Slides | SeatKind::None, Self::Whole)
            | (SeatKind::Ball | SeatKind::Body, Self::Ball(_))
            | (SeatKind::Body | SeatKind::Reading, Self::Bar)
            | (SeatKind::Coefficient, Self::Coefficient(_)) => true,
            (SeatKind::Angle, Self::Function(_, component)) => component.is_angular(),
            (SeatKind::Reading, Self::Ball(set_up)) => set_up.ball == Ball::Tool,
            (SeatKind::Body, Self::Coefficient(of)) => {
                of.power == Power::P1 && of.component as usize == of.slide.index()
            }
            _ => false,
        }
    }
}

impl fmt::Display for Seat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Function(slide, component) => write!(f, "E{}{slide}", component.letter()),
            Self::Slide(axis) => write!(f, "{axis}"),
            Self::Ball(set_up) => write!(f, "{set_up}"),
            Self::Coefficient(coefficient) => write!(f, "{coefficient}"),
            Self::Bar => f.write_str("bar"),
            Self::Whole => Ok(()),
        }
    }
}

impl Seat {
    /// What the length gains where this is displaced by one of its unit, mm per mm or rad.
    ///
    /// A slide as a whole is displaced in the programmed sense: the tool against the workpiece.
    pub fn sensitivity(self, at: &Situation) -> f64 {
        match self {
            Self::Function(slide, component) => {
                let gradient = &at.slides[slide.index()];
                let along = if component.is_angular() {
                    &gradient.rotation_mm
                } else {
                    &gradient.translation
                };
                along[component.direction()]
            }
            Self::Slide(axis) => at.direction[axis.index()],
            Self::Ball(set_up) => match set_up.ball {
                Ball::Tool => at.direction[set_up.axis.index()],
                Ball::Workpiece => -at.direction[set_up.axis.index()],
            },
            Self::Coefficient(of) => {
                let mut column = [0.0];
                of.columns(at, &mut column);
                column[0]
            }
            Self::Bar | Self::Whole => 1.0,
        }
    }

    /// Displaces this in the exact chain by an amount in mm or rad; the length of the bar is none of it.
    pub(super) fn displace(
        self,
        amount: f64,
        pose: &Pose,
        motion: &Motion,
        errors: &mut ChainErrors,
    ) {
        match self {
            Self::Function(slide, component) => {
                let slide = &mut errors.slides[slide.index()];
                let of = if component.is_angular() {
                    &mut slide.rotation_rad
                } else {
                    &mut slide.translation_mm
                };
                of[component.direction()] += amount;
            }
            // The tool against the workpiece: at the tool, whichever side the slide is on.
            Self::Slide(axis) => errors.tool_ball_mm[axis.index()] += amount,
            Self::Ball(set_up) => {
                let ball = match set_up.ball {
                    Ball::Tool => &mut errors.tool_ball_mm,
                    Ball::Workpiece => &mut errors.workpiece_ball_mm,
                };
                ball[set_up.axis.index()] += amount;
            }
            Self::Coefficient(of) => of.bend(&[amount], pose, motion, 0, errors),
            Self::Bar | Self::Whole => {}
        }
    }
}
