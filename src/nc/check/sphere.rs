//! The sphere that the bar spans, and how near a move comes to its middle.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use crate::machine::{Axis, Machine};
use crate::nc::program::{Move, Path};
use crate::plan::Test;

/// The ball-bar that a program is held against.
#[derive(Debug, Clone, PartialEq)]
pub struct Sphere {
    /// The workpiece ball: machine coordinates at which both ball centres coincide, mm.
    pub centre_mm: Vector3<f64>,
    /// Nominal length of the bar, mm.
    pub length_mm: f64,
    /// The bar reads this much either way, mm.
    pub range_mm: f64,
    /// Largest sagitta of a chord that was planned, mm.
    pub chord_sag_mm: Option<f64>,
    /// Feeds on the arcs that were planned, mm/s; none without a plan.
    pub feeds_mm_s: Vec<f64>,
}

impl Sphere {
    /// The bar of a test in one of its mountings.
    pub fn of(test: &Test, mounting: usize) -> Option<Self> {
        let plan = test.plan().ok();
        let bar = test.bar_of(mounting);
        Some(Self {
            centre_mm: test.mountings().get(mounting)?.mounting.coincidence_mm,
            length_mm: bar.length_mm,
            range_mm: bar.range_mm,
            chord_sag_mm: plan.map(|plan| plan.chord_sag_mm),
            feeds_mm_s: plan.map_or_else(Vec::new, |plan| plan.feeds_mm_s.clone()),
        })
    }

    pub(super) fn distance_mm(&self, point_mm: &Vector3<f64>) -> f64 {
        (point_mm - self.centre_mm).norm()
    }

    pub(super) fn reads(&self, distance_mm: f64) -> bool {
        (distance_mm - self.length_mm).abs() <= self.range_mm
    }

    /// Whether the tool ball would touch the bar.
    pub(super) fn in_reach(&self, distance_mm: f64) -> bool {
        distance_mm <= self.length_mm + self.range_mm
    }

    /// Whether a bar that is fitted would be pressed shorter than it can be, or a ball hit.
    pub(super) fn too_near(&self, distance_mm: f64) -> bool {
        distance_mm < self.length_mm - self.range_mm
    }

    /// Least and largest distance of a move from the workpiece ball, mm.
    pub(super) fn distances_mm(&self, motion: &Move) -> [f64; 2] {
        let ends = [self.distance_mm(&motion.start_mm), self.distance_mm(&motion.end_mm)];
        let between = match motion.path {
            Path::Line => {
                let chord = motion.end_mm - motion.start_mm;
                let share = (self.centre_mm - motion.start_mm).dot(&chord) / chord.norm_squared();
                vec![self.distance_mm(&(motion.start_mm + chord * share.clamp(0.0, 1.0)))]
            }
            Path::Arc { sweep_rad, .. } => {
                let pieces = sweep_rad.to_degrees().abs().ceil().max(1.0);
                let shares = (1..pieces as usize).map(|k| k as f64 / pieces);
                let shares = shares.chain(self.abreast(motion));
                shares.map(|share| self.distance_mm(&motion.at(share).0)).collect()
            }
        };
        let all = ends.into_iter().chain(between);
        all.fold([f64::INFINITY, 0.0], |[low, high], d| [low.min(d), high.max(d)])
    }

    /// Shares of an arc at which it is abreast of the workpiece ball: the nearest and the farthest points of a flat arc. One
    /// of a large radius is far from its ends before it has turned by a degree.
    fn abreast(&self, motion: &Move) -> Vec<f64> {
        let Path::Arc { center_mm, axis, sweep_rad } = motion.path else { return Vec::new() };
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let angle_rad =
            |point: &Vector3<f64>| (point[v] - center_mm[v]).atan2(point[u] - center_mm[u]);
        let ahead_rad = angle_rad(&self.centre_mm) - angle_rad(&motion.start_mm);
        let turned = |turn_rad: f64| {
            ((ahead_rad + turn_rad) * sweep_rad.signum()).rem_euclid(TAU) / sweep_rad.abs()
        };
        [turned(0.0), turned(PI)].into_iter().filter(|share| *share < 1.0).collect()
    }

    /// Least distance when every axis goes at its own rapid traverse and stops when it is there, mm.
    pub(super) fn dog_leg_mm(&self, motion: &Move, machine: &Machine) -> Option<f64> {
        let pieces = Self::dog_leg(motion, machine);
        pieces.iter().map(|piece| self.distances_mm(piece)[0]).min_by(f64::total_cmp)
    }

    /// The straight pieces on which every axis goes at its own rapid traverse and stops when it is there.
    pub(super) fn dog_leg(motion: &Move, machine: &Machine) -> Vec<Move> {
        let chord = motion.end_mm - motion.start_mm;
        let speeds = Axis::ALL.map(|axis| machine.slide(axis).rapid_mm_s);
        let needs = |k: usize| chord[k].abs() / speeds[k];
        let mut times = [needs(0), needs(1), needs(2)];
        times.sort_by(f64::total_cmp);
        let at = |time_s: f64| {
            Vector3::from_fn(|k, _| {
                let share = if needs(k) > 0.0 { (time_s / needs(k)).min(1.0) } else { 1.0 };
                motion.start_mm[k] + chord[k] * share
            })
        };
        let mut from = motion.start_mm;
        let mut pieces = Vec::with_capacity(3);
        for time_s in times {
            let to = at(time_s);
            if (to - from).norm() > 1e-9 {
                pieces.push(Move { start_mm: from, end_mm: to, path: Path::Line, ..*motion });
            }
            from = to;
        }
        pieces
    }
}
