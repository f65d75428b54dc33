//! The path of one mounting: approach, engagement, arcs, transits, release.

use nalgebra::{UnitVector3, Vector3};

use super::arc::Arc;
use super::parts::PathPlan;
use super::step::Step;
use super::test_file::Test;
use super::ways::Ways;
use crate::error::{Error, Place, Result};
use crate::machine::{Axis, Machine};

/// The path of one mounting.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Index of the mounting in the test.
    pub mounting: usize,
    /// Its steps in order.
    pub steps: Vec<Step>,
    /// Arcs and transits in the order in which they are driven, each with whether it is a transit.
    pub arcs: Vec<(Arc, bool)>,
}

impl Path {
    /// Plans the path of one mounting of a test and checks it against the travel of the machine.
    pub fn plan(test: &Test, machine: &Machine, mounting: usize) -> Result<Self> {
        let plan = test.plan()?;
        let length_mm = test.bar_of(mounting).length_mm;
        let ways = Ways::of(test, machine, plan, mounting);
        let mut path = Self { mounting, steps: Vec::new(), arcs: Vec::new() };
        let mut at: Option<UnitVector3<f64>> = None;
        for arc in plan.arcs(mounting) {
            let (forward, backward) = directions_of_travel(&arc);
            for (index, leg) in [arc.reversed(&backward), Arc { name: forward, ..arc.clone() }]
                .iter()
                .rev()
                .enumerate()
            {
                if index == 1 && !plan.both_directions {
                    continue;
                }
                match at {
                    None => path.steps.extend(ways.engage(&leg.start)),
                    Some(from) => path.transit(plan, &from, &leg.start, length_mm),
                }
                path.drive(leg, false, plan, length_mm);
                at = Some(leg.at(1.0));
            }
        }
        let Some(end) = at else {
            let name = test.mountings().get(mounting).map_or("", |named| named.name.as_str());
            return Err(Error::input(format!("the plan has no arc for the mounting `{name}`"))
                .at(Place::file(test.file()))
                .hint(format!(
                    "give a strategy, or add \"{name}\" to the `mountings` of a `[[plan.arc]]`"
                )));
        };
        path.pause(plan);
        path.steps.extend(ways.release(&end));
        path.check_travel(test, machine)?;
        Ok(path)
    }

    /// A dwell or an operator's stop between two arcs.
    fn pause(&mut self, plan: &PathPlan) {
        self.steps.push(if plan.stop_between_arcs {
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
        to: &UnitVector3<f64>,
        length_mm: f64,
    ) {
        let arc = Arc::shortest("TRANSIT", from, to);
        if arc.sweep_rad * length_mm > 1e-3 {
            self.pause(plan);
            self.drive(&arc, true, plan, length_mm);
        }
        let dwell = self.arcs.last().is_some_and(|(_, transit)| *transit);
        if dwell { self.steps.push(Step::Dwell(plan.dwell_s)) } else { self.pause(plan) }
    }

    /// Drives an arc in chords.
    fn drive(&mut self, arc: &Arc, transit: bool, plan: &PathPlan, length_mm: f64) {
        if self.arcs.is_empty() {
            self.steps.push(Step::Dwell(plan.dwell_s));
        }
        let count = arc.chords(length_mm, plan.chord_sag_mm);
        let point = |k: usize| arc.at(k as f64 / count as f64).into_inner() * length_mm;
        self.steps.push(Step::Comment(arc.name.clone()));
        self.steps.push(Step::LookAhead(true));
        self.steps.push(Step::Chords((1..=count).map(point).collect()));
        self.steps.push(Step::LookAhead(false));
        self.arcs.push((arc.clone(), transit));
    }

    /// Every point that the path names, in order.
    pub fn points(&self) -> impl Iterator<Item = &Vector3<f64>> {
        self.steps.iter().flat_map(Step::points)
    }

    /// The same near the balls: without the retracted places, which Z has to reach in any test.
    pub fn points_below(&self) -> impl Iterator<Item = &Vector3<f64>> {
        let near = |step: &&Step| !matches!(step, Step::Across(_) | Step::Rapid(_));
        self.steps.iter().filter(near).flat_map(Step::points)
    }

    fn check_travel(&self, test: &Test, machine: &Machine) -> Result<()> {
        let mounting = &test.mountings()[self.mounting];
        for axis in Axis::ALL {
            let along = || self.points().map(|point| point[axis.index()]);
            let (low, high) =
                (along().fold(f64::INFINITY, f64::min), along().fold(-f64::INFINITY, f64::max));
            let [from, to] = machine.slide(axis).travel_mm;
            // Then no other place helps, and the first point outside would mislead.
            if high - low > to - from {
                return Err(Error::input(format!(
                    "mounting `{}`: the path needs {:.1} mm of axis {axis}, which has {} mm",
                    mounting.name,
                    high - low,
                    to - from
                ))
                .at(Place::file(test.file()))
                .hint(format!(
                    "the bar of {} mm is too long for this machine: use a shorter one, or arcs that need less of {axis}",
                    mounting.bar_length_mm
                )));
            }
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

/// Names of the two directions of an arc: a closed circle is driven CCW and CW, others forward and backward.
fn directions_of_travel(arc: &Arc) -> (String, String) {
    let (forward, backward) = if arc.is_closed() { ("CCW", "CW") } else { ("FORWARD", "BACKWARD") };
    (format!("{} {forward}", arc.name), format!("{} {backward}", arc.name))
}
