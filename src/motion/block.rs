//! A block of a program with its time, and where the machine is in it.

use nalgebra::Vector3;

use super::profile::{Phase, Profile};
use crate::nc::Move;

/// What a block of the trajectory is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockKind {
    /// Positioning.
    Rapid,
    /// Motion at feed.
    Feed,
    /// Standstill of known length.
    Dwell,
    /// Standstill until the operator presses start; length zero here.
    Stop,
}

/// A block with its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// What it is.
    pub kind: BlockKind,
    /// When it begins, s of program time, operator's pauses counted as zero.
    pub start_s: f64,
    /// How long it takes, s.
    pub duration_s: f64,
    /// Line of the program.
    pub line: usize,
    /// Index of its label in the program.
    pub label: usize,
    /// Time spent at feed before this block, s: what a feed override stretches.
    pub feed_before_s: f64,
    /// Where it begins, machine coordinates, mm.
    pub start_mm: Vector3<f64>,
    /// How it moves; `None` where it stands.
    pub(super) motion: Option<(Move, Profile)>,
    /// Length of its path, mm.
    pub(super) length_mm: f64,
    /// Sense of the last motion of each slide before it.
    pub(super) sense: Vector3<f64>,
    /// Whether the machine stands still at its end.
    pub(super) ends_at_rest: bool,
}

/// Where the machine is at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Machine coordinates, mm.
    pub position_mm: Vector3<f64>,
    /// Velocity, mm/s.
    pub velocity_mm_s: Vector3<f64>,
    /// Sense of the last motion of each slide.
    pub sense: Vector3<f64>,
    /// Index of the block.
    pub block: usize,
}

impl Block {
    /// The move, if the block moves.
    pub fn motion(&self) -> Option<&Move> {
        self.motion.as_ref().map(|(motion, _)| motion)
    }

    /// Whether the machine stands still at its end.
    pub fn ends_at_rest(&self) -> bool {
        self.ends_at_rest
    }

    /// One of the phases of its profile, with when it begins, s from the start of the block, and how far along it, mm.
    pub(super) fn phase(&self, number: usize) -> Option<(f64, f64, Phase)> {
        self.motion.as_ref()?.1.phase(number)
    }

    pub(super) fn position_mm(&self, time_s: f64) -> Vector3<f64> {
        let Some((motion, profile)) = &self.motion else { return self.start_mm };
        motion.position_mm(profile.at(time_s - self.start_s).0 / self.length_mm)
    }

    pub(super) fn at(&self, time_s: f64, index: usize) -> State {
        let still = State {
            position_mm: self.start_mm,
            velocity_mm_s: Vector3::zeros(),
            sense: self.sense,
            block: index,
        };
        let Some((motion, profile)) = &self.motion else { return still };
        let (distance_mm, speed_mm_s) = profile.at(time_s - self.start_s);
        let (position_mm, tangent) = motion.at(distance_mm / self.length_mm);
        State {
            position_mm,
            velocity_mm_s: tangent * speed_mm_s,
            sense: turned(self.sense, &tangent),
            block: index,
        }
    }
}

/// Where an arc begins or ends at the very extreme of a slide, its tangent there says nothing of that slide: which way it leaves or
/// comes is told by the tangent this share of the arc away, which is far more than rounding and far less than a reading.
pub(super) const HAIR: f64 = 1e-6;

/// Senses after moving along a direction: slides that stand still keep theirs.
pub(super) fn turned(sense: Vector3<f64>, along: &Vector3<f64>) -> Vector3<f64> {
    // Of an arc's tangent, what is left of a component by rounding is not motion.
    sense.zip_map(along, |before, v| if v.abs() > 1e-12 { v.signum() } else { before })
}
