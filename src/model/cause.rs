//! What a cause is: one entry of the table of causes.
//!
//! The table is the one vocabulary of `simulate --hide`, of `model.toml`, of diagnosis, of the trial and of
//! `docs/reference.md`. A new cause is an entry in [`CAUSES`](super::CAUSES) and its formula in the simulator,
//! which works out by itself what a cause does to the machine.

use super::coefficient::{Ball, Coefficient, Component, Power, SetUp};
use super::key::Key;
use super::law::{Inner, Law, Over};
use super::seat::{Seat, SeatKind};
use super::unit::Unit;
use crate::machine::Axis;

/// In which runs of a campaign an effect is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Runs {
    /// The same in all.
    Alike,
    /// In each with amplitudes of its own.
    Each,
    /// In one.
    One,
}

/// One cause.
#[derive(Debug, Clone, Copy)]
pub struct Cause {
    /// Its name, such as `cyclic`.
    pub id: &'static str,
    /// In words.
    pub title: &'static str,
    /// What it acts on.
    pub seat: SeatKind,
    /// Its numbers.
    pub keys: &'static [Key],
    /// What it does.
    pub law: Law,
    /// What it does where it acts on all axes alike, if that is something else.
    pub law_of_all: Option<Law>,
    /// In which runs it is.
    pub runs: Runs,
    /// Whether, with this number inside, several of it make any curve over its variable: a curve is named then,
    /// rather than what it is made of.
    pub makes_any_curve: fn(f64) -> bool,
    /// What it does, as an equation; `A` is the amplitude, `h` the position of an axis (mm), `b` its
    /// sense, `v` its velocity, `t` the time since the program began.
    pub equation: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// What a technician does about it.
    pub remedy: &'static str,
    /// What it is easily taken for.
    pub taken_for: &'static str,
    /// What is said where nothing of it is left outside of the model, with `{}` for the seats; empty where that is
    /// not said.
    pub unseen: &'static str,
}

impl PartialEq for Cause {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Cause {
    /// What it does on a seat.
    pub fn law(&self, seat: Seat) -> &Law {
        self.law_of_all.as_ref().filter(|_| seat == Seat::Whole).unwrap_or(&self.law)
    }

    /// Its number inside on a seat, with its key.
    pub fn inner(&self, seat: Seat) -> Option<(&Inner, &Key)> {
        let inner = self.law(seat).inner()?;
        Some((inner, self.keys.iter().find(|key| key.name == inner.key)?))
    }

    /// Whether diagnosis looks for it.
    pub fn is_known(&self) -> bool {
        !matches!(self.law, Law::Unknown(_))
    }

    /// What it hangs on, where that is one variable.
    pub fn over(&self) -> Option<&Over> {
        self.law.over()
    }

    /// Everything that it is looked for on. A workpiece ball that moves is, but for the sign, a tool ball that does.
    pub fn seats(&self) -> Vec<Seat> {
        let axes = Axis::ALL.into_iter();
        let tool_balls = axes.clone().map(|axis| Seat::Ball(SetUp { ball: Ball::Tool, axis }));
        let functions = axes.clone().flat_map(|slide| {
            Component::ALL.into_iter().map(move |component| Seat::Function(slide, component))
        });
        let scales = [Component::X, Component::Y, Component::Z].into_iter().zip(axes.clone()).map(
            |(component, slide)| {
                Seat::Coefficient(Coefficient { slide, component, power: Power::P1 })
            },
        );
        match self.seat {
            SeatKind::Function => functions.collect(),
            SeatKind::Angle => functions.filter(|seat| seat.unit() == Unit::URAD).collect(),
            SeatKind::Slide => axes.map(Seat::Slide).collect(),
            SeatKind::Slides => axes.map(Seat::Slide).chain([Seat::Whole]).collect(),
            SeatKind::Body => tool_balls.chain(scales).chain([Seat::Bar]).collect(),
            SeatKind::Ball => tool_balls.collect(),
            SeatKind::Reading => tool_balls.chain([Seat::Bar]).collect(),
            SeatKind::Coefficient => Coefficient::all().map(Seat::Coefficient).collect(),
            SeatKind::None => vec![Seat::Whole],
        }
    }
}
