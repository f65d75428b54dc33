//! The path of one mounting: approach, engagement, arcs, transits, release.

use std::f64::consts::TAU;

use nalgebra::{UnitVector3, Vector3};

use super::arc::Arc;
use super::leg::{Interpolation, Leg};
use super::parts::PathPlan;
use super::plane::Plane;
use super::step::{Circular, Step};
use super::test_file::Test;
use super::ways::Ways;
use crate::error::{Error, Place, Result};
use crate::machine::{Axis, Dialect, Machine};

/// An arc of one block is looked at in steps of this angle, rad; a quarter of a turn is a whole number of them.
const LOOK_RAD: f64 = TAU / 360.0;

/// More moves than these no program is read with.
const MOST_CHORDS: usize = 1_000_000;

/// The path of one mounting.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Index of the mounting in the test.
    pub mounting: usize,
    /// Its steps in order.
    pub steps: Vec<Step>,
    /// Arcs and transits in the order in which they are driven.
    pub legs: Vec<Leg>,
}

impl Path {
    /// Plans the path of one mounting of a test and checks it against the travel of the machine.
    pub fn plan(test: &Test, machine: &Machine, mounting: usize) -> Result<Self> {
        let path = Self::anywhere(test, machine, mounting)?;
        path.check_travel(test, machine)?;
        Ok(path)
    }

    /// The same wherever the travel ends.
    fn anywhere(test: &Test, machine: &Machine, mounting: usize) -> Result<Self> {
        let plan = test.plan()?;
        let length_mm = test.bar_of(mounting).length_mm;
        let ways = Ways::of(test, machine, plan, mounting);
        let dialect = machine.controller().dialect;
        let passes = plan.passes(mounting);
        let chords = |leg: &Leg| leg.driven().chords(length_mm, plan.chord_sag_mm);
        let in_chords = |leg: &&Leg| circle(&leg.arc, plan, dialect).is_none();
        let all: usize = passes.iter().filter(in_chords).map(chords).sum();
        if all > MOST_CHORDS {
            return Err(Error::input(format!("the arcs would be {all} chords"))
                .at(Place::file(test.file()))
                .hint("a program has a million moves at the most: allow more `chord_sag_um`, or drive fewer arcs"));
        }
        let mut path = Self { mounting, steps: Vec::new(), legs: Vec::new() };
        let mut at: Option<(UnitVector3<f64>, f64)> = None;
        for leg in passes {
            let driven = leg.driven();
            match at {
                None => {
                    path.steps.extend(ways.engage(&driven.start, leg.feed_mm_s));
                    path.steps.push(Step::Dwell(plan.dwell_s));
                }
                Some((from, before_mm_s)) => {
                    path.transit(plan, &from, (&driven.start, leg.feed_mm_s), (dialect, length_mm));
                    if plan.release_between_arcs {
                        let feeds = [before_mm_s, leg.feed_mm_s];
                        path.steps.extend(ways.again(&driven.start, feeds));
                        path.steps.push(Step::Dwell(plan.dwell_s));
                    }
                }
            }
            at = Some((driven.at(1.0), leg.feed_mm_s));
            path.drive(leg, plan, (dialect, length_mm));
        }
        let Some((end, feed_mm_s)) = at else {
            let name = test.mountings().get(mounting).map_or("", |named| named.name.as_str());
            return Err(Error::input(format!("the plan has no arc for the mounting `{name}`"))
                .at(Place::file(test.file()))
                .hint(format!(
                    "give a strategy, or add \"{name}\" to the `mountings` of a `[[plan.arc]]`"
                )));
        };
        path.pause(plan);
        path.steps.extend(ways.release(&end, feed_mm_s));
        Ok(path)
    }

    /// Lowest and highest machine coordinate of each axis at which the balls may coincide so that the path near them
    /// stays within the travel, mm.
    ///
    /// # Errors
    /// When the path needs more of an axis than there is.
    pub fn room_mm(test: &Test, machine: &Machine, mounting: usize) -> Result<[[f64; 2]; 3]> {
        let path = Self::anywhere(test, machine, mounting)?;
        let mut room_mm = [[0.0; 2]; 3];
        for axis in Axis::ALL {
            let (low, high) = extent_mm(path.points_below(), axis);
            let [from, to] = machine.slide(axis).travel_mm;
            check_need(test, machine, mounting, axis, high - low)?;
            room_mm[axis.index()] = [from - low, to - high];
        }
        Ok(room_mm)
    }

    /// A dwell or an operator's stop between two arcs.
    fn pause(&mut self, plan: &PathPlan) {
        // Where the bar is released after every arc, the machine stops there.
        self.steps.push(if plan.stop_between_arcs && !plan.release_between_arcs {
            Step::Stop("PRESS START TO GO ON")
        } else {
            Step::Dwell(plan.dwell_s)
        });
    }

    /// Goes to the start of the next arc along the sphere, if it is elsewhere.
    fn transit(
        &mut self,
        plan: &PathPlan,
        from: &UnitVector3<f64>,
        (to, feed_mm_s): (&UnitVector3<f64>, f64),
        (dialect, length_mm): (Dialect, f64),
    ) {
        let arc = Arc::transit("TRANSIT", from, to);
        if arc.sweep_rad.abs() * length_mm > 1e-3 {
            self.pause(plan);
            let leg = Leg { arc, overshoot_rad: 0.0, feed_mm_s, transit: true };
            self.drive(leg, plan, (dialect, length_mm));
        }
        let dwell = self.legs.last().is_some_and(|leg| leg.transit);
        if dwell { self.steps.push(Step::Dwell(plan.dwell_s)) } else { self.pause(plan) }
    }

    /// Drives an arc with what belongs to it, without a stop.
    fn drive(&mut self, leg: Leg, plan: &PathPlan, (dialect, length_mm): (Dialect, f64)) {
        for (index, piece) in leg.pieces().into_iter().enumerate() {
            self.steps.push(Step::Comment(piece.name.clone()));
            if index == 0 {
                self.steps.push(Step::LookAhead(true));
            }
            if let Some(plane) = circle(&piece, plan, dialect) {
                self.circular(&piece, plane, leg.feed_mm_s, length_mm);
                continue;
            }
            let count = piece.chords(length_mm, plan.chord_sag_mm);
            let point = |k: usize| piece.at(k as f64 / count as f64).scale(length_mm);
            self.steps.push(Step::Chords((1..=count).map(point).collect(), leg.feed_mm_s));
        }
        self.steps.push(Step::LookAhead(false));
        self.legs.push(leg);
    }

    /// An arc of a coordinate plane, in blocks of at most a whole turn.
    fn circular(&mut self, arc: &Arc, plane: Plane, feed_mm_s: f64, length_mm: f64) {
        let turns = arc.sweep_rad.abs() / TAU;
        let blocks = (turns - 1e-9).ceil().max(1.0);
        let sweep_rad = arc.sweep_rad * arc.normal[plane.normal()].signum() / blocks;
        for block in 0..blocks as usize {
            let from = block as f64 / blocks;
            let start_rad = plane.angle_rad(&arc.at(from));
            let shares = looks(start_rad, sweep_rad).into_iter().chain([1.0]);
            let point = |share: f64| arc.at(from + share / blocks).scale(length_mm);
            let arc = Circular { plane, sweep_rad, points: shares.map(point).collect() };
            self.steps.push(Step::Circular(arc, feed_mm_s));
        }
    }

    /// Every point that the path leads through, in order; of an arc some of many.
    pub fn points(&self) -> impl Iterator<Item = &Vector3<f64>> {
        self.steps.iter().flat_map(Step::points)
    }

    /// Every point that a block of the program ends at, in order.
    pub fn ends(&self) -> impl Iterator<Item = &Vector3<f64>> {
        self.steps.iter().flat_map(Step::ends)
    }

    /// The same near the balls: without the retracted places, which Z has to reach in any test.
    pub fn points_below(&self) -> impl Iterator<Item = &Vector3<f64>> {
        let near = |step: &&Step| !matches!(step, Step::Across(_) | Step::Rapid(_));
        self.steps.iter().filter(near).flat_map(Step::points)
    }

    fn check_travel(&self, test: &Test, machine: &Machine) -> Result<()> {
        let mounting = &test.mountings()[self.mounting];
        // Then no other place helps, and the first point outside would mislead.
        for axis in Axis::ALL {
            let (low, high) = extent_mm(self.points(), axis);
            check_need(test, machine, self.mounting, axis, high - low)?;
        }
        for point in self.points() {
            machine.axis_positions_mm(&mounting.mounting, point).map_err(|mut error| {
                error.what = format!("mounting `{}`: {}", mounting.name, error.what);
                error.at(Place::file(test.file()))
            })?;
        }
        Ok(())
    }
}

/// The plane of an arc that is driven as one; none where it is divided into chords.
fn circle(arc: &Arc, plan: &PathPlan, dialect: Dialect) -> Option<Plane> {
    let plane = Plane::of(arc).filter(|plane| dialect.turns_about(plane.normal()));
    plane.filter(|_| plan.interpolation == Interpolation::Arcs)
}

/// Lowest and highest coordinate of points, mm.
fn extent_mm<'a>(points: impl Iterator<Item = &'a Vector3<f64>>, axis: Axis) -> (f64, f64) {
    points
        .map(|point| point[axis.index()])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
}

/// Whether an axis is as long as a path needs it.
fn check_need(
    test: &Test,
    machine: &Machine,
    mounting: usize,
    axis: Axis,
    need_mm: f64,
) -> Result<()> {
    let [from, to] = machine.slide(axis).travel_mm;
    if need_mm <= to - from {
        return Ok(());
    }
    let named = &test.mountings()[mounting];
    Err(Error::input(format!(
        "mounting `{}`: the path needs {need_mm:.1} mm of axis {axis}, which has {} mm",
        named.name,
        to - from
    ))
    .at(Place::file(test.file()))
    .hint(format!(
        "the bar of {} mm is too long for this machine: use a shorter one, or arcs that need less of {axis}",
        named.bar_length_mm
    )))
}

/// Shares of an arc at every whole step of [`LOOK_RAD`] inside of it: its extremes are among them.
fn looks(start_rad: f64, sweep_rad: f64) -> Vec<f64> {
    let (first, last) = (start_rad / LOOK_RAD, (start_rad + sweep_rad) / LOOK_RAD);
    let (low, high) = (first.min(last) + 1e-9, first.max(last) - 1e-9);
    let mut shares: Vec<f64> = (low.ceil() as i64..=high.floor() as i64)
        .map(|k| (k as f64 * LOOK_RAD - start_rad) / sweep_rad)
        .collect();
    shares.sort_by(f64::total_cmp);
    shares
}
