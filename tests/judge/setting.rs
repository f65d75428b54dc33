//! What the judge is told: the machine, where the workpiece ball is, and the bar.

use ballbar::machine::{Axis, Dialect, Machine};
use ballbar::plan::Test;

use crate::bodies::Bodies;
use crate::path::Point;

/// Everything that is not in the program.
#[derive(Debug, Clone)]
pub(crate) struct Setting {
    pub(crate) dialect: Dialect,
    pub(crate) travel_mm: [[f64; 2]; 3],
    pub(crate) rapid_mm_s: [f64; 3],
    /// Machine coordinates at which the balls coincide, and the work offset that has its zero there.
    pub(crate) centre_mm: Point,
    pub(crate) offset: u8,
    pub(crate) length_mm: f64,
    pub(crate) range_mm: f64,
    pub(crate) feed_mm_s: f64,
    /// What the machine file says of what stands behind the balls.
    pub(crate) bodies: Option<Bodies>,
}

impl Setting {
    /// That of a mounting of a test.
    pub(crate) fn of(test: &Test, machine: &Machine, mounting: usize) -> Self {
        let named = &test.mountings()[mounting];
        let at = named.mounting.coincidence_mm;
        Self {
            dialect: machine.controller().dialect,
            travel_mm: Axis::ALL.map(|axis| machine.slide(axis).travel_mm),
            rapid_mm_s: Axis::ALL.map(|axis| machine.slide(axis).rapid_mm_s),
            centre_mm: [at.x, at.y, at.z],
            offset: named.work_offset,
            length_mm: named.bar_length_mm,
            range_mm: test.ball_bar().range_mm,
            feed_mm_s: test.plan().map_or(0.0, ballbar::plan::PathPlan::fastest_mm_s),
            bodies: Bodies::of(machine),
        }
    }

    /// Each axis may position at its own rapid traverse.
    pub(crate) fn bends(&self) -> bool {
        matches!(self.dialect, Dialect::Fanuc | Dialect::Siemens)
    }

    /// The bar is never shorter than this, mm. Balls, sockets and the holder behind the tool ball are all within it, or
    /// there would be no bar: with the bar off, nothing of a test feeds nearer to the workpiece ball.
    pub(crate) fn shortest_mm(&self) -> f64 {
        self.length_mm - self.range_mm
    }

    /// The bar is never longer than this, mm. At rapid nothing comes nearer than the bar is long: there the operator has
    /// his hands, and a ball may hang on the magnet.
    pub(crate) fn longest_mm(&self) -> f64 {
        self.length_mm + self.range_mm
    }

    /// Places in which somebody may have left the machine: all over the travel, the workpiece ball itself,
    /// where it was just touched, and places around and below it.
    pub(crate) fn places(&self) -> Vec<Point> {
        let mut places = Vec::new();
        let along = |axis: usize| {
            let [low, high] = self.travel_mm[axis];
            let ball_mm = self.centre_mm[axis].clamp(low, high);
            let part = |share: f64| low + (high - low) * share;
            [low, part(0.2), part(0.4), part(0.6), part(0.8), high, ball_mm]
        };
        for x in along(0) {
            for y in along(1) {
                places.extend(along(2).map(|z| [x, y, z]));
            }
        }
        let length_mm = self.length_mm;
        for aside in [
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 30.0],
            [60.0, 0.0, -40.0],
            [-40.0, -50.0, -80.0],
            [length_mm, 0.0, 0.0],
            [-0.7 * length_mm, 0.7 * length_mm, -20.0],
            [0.0, -1.3 * length_mm, 0.3 * length_mm],
        ] {
            let at = std::array::from_fn(|k| {
                let [low, high] = self.travel_mm[k];
                (self.centre_mm[k] + aside[k]).clamp(low, high)
            });
            places.push(at);
        }
        places
    }
}
