//! What is aligned: a log, the program that ran, and what it ran with.

use nalgebra::Vector3;

use crate::log::Log;
use crate::machine::{Machine, Mounting};
use crate::motion::Trajectory;
use crate::nc::Program;
use crate::plan::BallBar;

/// A machine with its two balls set up and a bar between them.
#[derive(Debug, Clone, Copy)]
pub struct Rig<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// Where the balls are.
    pub mounting: &'a Mounting,
    /// The bar, with the length that this mounting uses.
    pub bar: &'a BallBar,
}

impl Rig<'_> {
    /// From the workpiece ball to the tool ball as a position of the axes commands it, mm.
    pub(super) fn commanded_mm(&self, position_mm: &Vector3<f64>) -> Vector3<f64> {
        position_mm - self.mounting.coincidence_mm
    }

    /// Length that a position of the axes commands minus the nominal length, mm.
    pub(super) fn commanded_deviation_mm(&self, position_mm: &Vector3<f64>) -> f64 {
        self.commanded_mm(position_mm).norm() - self.bar.length_mm
    }
}

/// A log, and the program that ran while it was taken.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// What the instrument read.
    pub log: &'a Log,
    /// What the machine was told.
    pub program: &'a Program,
    /// What it ran with.
    pub rig: Rig<'a>,
    /// Where the override knob stood, as a share of 1.
    pub feed_override: f64,
    /// How the control has recorded that it drove the program, where it has.
    pub driven: Option<&'a Trajectory>,
}

impl Run<'_> {
    /// The program as it was recorded, or else as it is planned with all feeds multiplied by this.
    pub(super) fn trajectory(&self, feed: f64) -> Trajectory {
        let planned = || Trajectory::new(self.program, self.rig.machine, feed);
        self.driven.map_or_else(planned, Trajectory::clone)
    }
}
