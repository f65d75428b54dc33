//! Rule of the bodies behind the balls: tool and spindle nose never touch the support of the workpiece ball.

use nalgebra::Vector3;

use super::sphere::Sphere;
use crate::machine::{Cylinder, Dialect, Machine};
use crate::nc::program::Move;

/// What overlaps by less is not seen, mm: machine files state bodies to a millimetre.
const STEP_MM: f64 = 0.1;
/// Places that are looked at along a whole program: a hundred metres of all but touching.
const MOST_PLACES: usize = 1_000_000;

/// Two bodies that touch.
pub(super) struct Touch {
    part: &'static str,
    /// From the workpiece ball to the tool ball, mm.
    ball_mm: Vector3<f64>,
}

impl Touch {
    /// In words, with the comment of the program before it.
    pub(super) fn told(&self, section: &str) -> String {
        let Self { part, ball_mm: at } = self;
        let on = if section.is_empty() { "" } else { " on " };
        format!(
            "{part} and support touch{on}{section} at the ball vector ({:.1}, {:.1}, {:.1}) mm",
            at.x, at.y, at.z
        )
    }
}

/// The bodies of the machine file, and how far the program came.
pub(super) struct Bodies {
    support: Cylinder,
    parts: Vec<(&'static str, Cylinder)>,
    /// The workpiece ball, machine coordinates in mm.
    ball_mm: Vector3<f64>,
    /// Where the last move ended, and what is still to be driven from there before anything can touch, mm.
    end_mm: Vector3<f64>,
    spare_mm: f64,
    places_left: usize,
}

impl Bodies {
    /// `None` where the file does not name the support and one of the other two.
    pub(super) fn of(machine: &Machine, ball_mm: Vector3<f64>) -> Option<Self> {
        let bodies = machine.clearance();
        let parts = [("tool", bodies.tool), ("spindle nose", bodies.spindle_nose)];
        let parts: Vec<_> =
            parts.into_iter().filter_map(|(name, body)| Some((name, body?))).collect();
        let support = bodies.support.filter(|_| !parts.is_empty())?;
        Some(Self {
            support,
            parts,
            ball_mm,
            end_mm: ball_mm,
            spare_mm: 0.0,
            places_left: MOST_PLACES,
        })
    }

    /// Where the next move of the program makes them touch first: a positioning on a straight line, and on a Fanuc with
    /// every axis at its own rapid traverse too.
    pub(super) fn follow(&mut self, motion: &Move, machine: &Machine) -> Option<Touch> {
        if (motion.start_mm - self.end_mm).norm() > self.spare_mm {
            self.spare_mm = 0.0;
        }
        self.end_mm = motion.end_mm;
        let straight = self.along(motion);
        let bends = motion.rapid && machine.controller().dialect == Dialect::Fanuc;
        if straight.is_some() || !bends {
            return straight;
        }
        let spare_mm = self.spare_mm;
        let pieces = Sphere::dog_leg(motion, machine);
        let told = pieces.iter().find_map(|piece| self.on(piece));
        self.spare_mm = spare_mm;
        told
    }

    /// The same of a straight move for itself.
    pub(super) fn on(&mut self, motion: &Move) -> Option<Touch> {
        self.spare_mm = 0.0;
        self.along(motion)
    }

    /// Whether so many places were looked at that the rest is not.
    pub(super) fn is_used_up(&self) -> bool {
        self.places_left == 0
    }

    /// From the end of the move before it: the bodies come nearer by no more than the balls move, so that what is far
    /// apart need not be looked at soon again.
    fn along(&mut self, motion: &Move) -> Option<Touch> {
        let length_mm = motion.length_mm();
        let mut along_mm = self.spare_mm;
        while along_mm <= length_mm {
            let share = if length_mm > 0.0 { along_mm / length_mm } else { 0.0 };
            let ball_mm = motion.position_mm(share) - self.ball_mm;
            let apart = self
                .parts
                .iter()
                .map(|(name, body)| (*name, self.support.distance_mm(body, &ball_mm)));
            let (name, apart_mm) = apart.min_by(|a, b| a.1.total_cmp(&b.1))?;
            self.places_left = self.places_left.checked_sub(1)?;
            if apart_mm <= 0.0 {
                self.spare_mm = 0.0;
                return Some(Touch { part: name, ball_mm });
            }
            along_mm += apart_mm.max(STEP_MM);
        }
        self.spare_mm = along_mm - length_mm;
        None
    }
}
