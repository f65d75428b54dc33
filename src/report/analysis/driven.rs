//! What the programs of a test drove: its strategy where they are of it, else the circles.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::align::{Circle, Section};
use crate::identify::{Identification, IdentifiedRun};
use crate::plan::{Arc, Test};

/// Axes of circles this near to each other, by their cosine, are one: chords and rounding leave less.
const SAME_AXIS: f64 = 0.9998;
/// Angles of arcs this near to each other are one, rad.
const SAME_SWEEP_RAD: f64 = 0.02 * TAU;

/// The circles that were driven, each once, in order.
pub(super) fn circles(identifications: &[Identification]) -> Vec<Circle> {
    let mut circles: Vec<Circle> = Vec::new();
    for section in identifications.iter().flat_map(|of| &of.runs).flat_map(sections) {
        if !circles.iter().any(|circle| circle.is_same(&section.circle)) {
            circles.push(section.circle);
        }
    }
    circles
}

/// The strategy of the test file, where every program drove its arcs and no others.
pub(super) fn strategy(test: &Test, identifications: &[Identification]) -> Option<&'static str> {
    let plan = test.plan().ok()?;
    let is_of_it = |run: &IdentifiedRun| {
        let planned = plan.arcs(run.mounting);
        planned.iter().all(|arc| sections(run).any(|section| is_same(arc, section)))
            && sections(run).all(|section| planned.iter().any(|arc| is_same(arc, section)))
    };
    identifications.iter().flat_map(|of| &of.runs).all(is_of_it).then(|| plan.strategy_name())
}

/// The arcs of a run, without the ways between them.
fn sections(run: &IdentifiedRun) -> impl Iterator<Item = &Section> {
    run.alignment.sections.iter().filter(|section| !section.transit)
}

fn is_same(arc: &Arc, section: &Section) -> bool {
    let [zero, quarter]: [Vector3<f64>; 2] = section.circle.directions();
    zero.cross(&quarter).dot(&arc.normal).abs() > SAME_AXIS
        && (arc.sweep_rad.abs() - section.sweep_rad).abs() < SAME_SWEEP_RAD
}

/// The circles in words: `XY plane`, or how many where they are too many for a line.
pub(super) fn told(circles: &[String]) -> String {
    const LISTED: usize = 6;
    if circles.len() > LISTED {
        return format!("{} circles", circles.len());
    }
    circles.join(", ")
}
