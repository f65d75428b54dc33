//! What a designed test can be made of: arcs on the sphere, and set-ups of the balls.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Unit, Vector3};

use crate::error::{Error, Place, Result};
use crate::machine::{Axis, Machine, Mounting};
use crate::plan::{Arc, DesignRequest, Places, Test};

/// The approach of a program stands off by this much beyond the feed-in, and a little aside, mm.
const APPROACH_MM: f64 = 20.0;
/// A slide moves by so much at the least on its way to the bar, mm.
const ASIDE_MM: f64 = 5.0;
/// The bodies behind the balls keep this from each other, mm.
const CLEARANCE_MM: f64 = 5.0;
/// Points of an arc that are looked at for travel and clearance, an angle apart, rad.
const LOOK_RAD: f64 = 0.05;

/// Balls in one place with one tool and one bar.
#[derive(Debug, Clone, PartialEq)]
pub struct SetUpCandidate {
    /// Its name, which a mounting of the test has, too.
    pub name: String,
    /// Where the balls are.
    pub mounting: Mounting,
    /// The bar, mm.
    pub bar_mm: f64,
    /// The mounting of the test that this is, by its index.
    pub given: Option<usize>,
}

/// Candidate arcs, each driven both ways: parallels, meridians over the pole and up to it, and tilted
/// half circles, a step apart. With a step of 15 degrees they are 189.
pub fn candidate_arcs(step_rad: f64) -> Vec<Arc> {
    let steps = |from: f64, to: f64, step: f64| {
        let count = ((to - from) / step + 1e-9).floor().max(0.0) as usize;
        (0..=count).map(move |k| from + k as f64 * step)
    };
    let degrees = |angle: f64| format!("{:.0}", angle.to_degrees());
    let mut arcs = vec![Arc::equator("EQUATOR", 0.0, TAU)];
    for polar in steps(2.0 * step_rad, FRAC_PI_2 - 0.5 * step_rad, 0.5 * step_rad) {
        let name = format!("PARALLEL {}", degrees(polar));
        arcs.push(Arc::parallel(&name, polar, 0.0, TAU));
    }
    for azimuth in steps(0.0, PI - 0.1 * step_rad, step_rad / 3.0) {
        arcs.push(Arc::meridian(&format!("MERIDIAN {}", degrees(azimuth)), azimuth, 0.0, PI));
    }
    for azimuth in steps(0.0, TAU - 0.1 * step_rad, step_rad) {
        let name = format!("QUARTER {}", degrees(azimuth));
        arcs.push(Arc::meridian(&name, azimuth, 0.0, FRAC_PI_2));
    }
    for azimuth in steps(0.0, TAU - 0.1 * step_rad, step_rad) {
        for tilt in steps(step_rad, FRAC_PI_2 - 0.5 * step_rad, step_rad) {
            // From a point of the equator over a highest point of this polar angle to the opposite.
            let start = Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
            let highest =
                Vector3::new(-azimuth.sin() * tilt.sin(), azimuth.cos() * tilt.sin(), tilt.cos());
            arcs.push(Arc {
                name: format!("TILTED {} {}", degrees(azimuth), degrees(tilt)),
                normal: Unit::new_normalize(start.cross(&highest)),
                start: Unit::new_normalize(start),
                sweep_rad: PI,
            });
        }
    }
    arcs
}

/// How far the tool ball goes beyond the workpiece ball in a sphere's plane and along the tool axis,
/// mm, with its approach.
fn reach_mm(bar_mm: f64, feed_in_mm: f64) -> f64 {
    bar_mm + feed_in_mm + APPROACH_MM
}

/// Every place with every tool and every bar.
///
/// # Errors
/// A bar that has no room in the travel; a mounting of the test from which no arc can be driven.
pub fn set_up_candidates(
    test: &Test,
    request: &DesignRequest,
    machine: &Machine,
) -> Result<Vec<SetUpCandidate>> {
    let feed_in_mm = test.plan()?.feed_in_mm;
    let mut candidates: Vec<SetUpCandidate> = Vec::new();
    let bars = |own_mm: f64| match request.bar_lengths_mm.as_slice() {
        [] => vec![own_mm],
        given => given.to_vec(),
    };
    for (index, named) in test.mountings().iter().enumerate() {
        let tools = std::iter::once(named.mounting.tool_ball_mm).chain(
            request.tool_balls_mm.iter().copied().filter(|t| *t != named.mounting.tool_ball_mm),
        );
        for tool_ball_mm in tools {
            for bar_mm in bars(named.bar_length_mm) {
                // Another tool meets the same workpiece ball at another place of the axes.
                let longer_mm = tool_ball_mm - named.mounting.tool_ball_mm;
                let coincidence_mm = named.mounting.coincidence_mm - longer_mm;
                let own = tool_ball_mm == named.mounting.tool_ball_mm
                    && (bar_mm - named.bar_length_mm).abs() < 1e-9;
                candidates.push(SetUpCandidate {
                    name: named.name.clone(),
                    mounting: Mounting { coincidence_mm, tool_ball_mm },
                    bar_mm,
                    given: own.then_some(index),
                });
            }
        }
    }
    for bar_mm in bars(test.ball_bar().length_mm) {
        let room_mm = room(test, machine, bar_mm, feed_in_mm)?;
        if request.places == Places::Corners {
            let first = test.mountings()[0].mounting.tool_ball_mm;
            let tools = std::iter::once(first)
                .chain(request.tool_balls_mm.iter().copied().filter(|tool| *tool != first));
            for tool_ball_mm in tools {
                candidates.extend(corners(&room_mm).into_iter().map(|coincidence_mm| {
                    let mounting = Mounting { coincidence_mm, tool_ball_mm };
                    SetUpCandidate { name: String::new(), mounting, bar_mm, given: None }
                }));
            }
        }
    }
    give_names(&mut candidates);
    Ok(candidates)
}

/// Lowest and highest coincidence of each axis so that the sphere fits into the travel, mm.
fn room(test: &Test, machine: &Machine, bar_mm: f64, feed_in_mm: f64) -> Result<[[f64; 2]; 3]> {
    let reach_mm = reach_mm(bar_mm, feed_in_mm);
    let mut room_mm = [[0.0; 2]; 3];
    for axis in Axis::ALL {
        let [low, high] = machine.slide(axis).travel_mm;
        // The arcs stay above the workpiece ball along the tool's axis.
        let below_mm = if axis == Axis::Z { ASIDE_MM } else { reach_mm };
        room_mm[axis.index()] = [low + below_mm, high - reach_mm];
        if low + below_mm > high - reach_mm {
            return Err(Error::input(format!(
                "a bar of {bar_mm} mm needs {:.1} mm of {axis} for its sphere and the approach, the travel has {:.1} mm",
                below_mm + reach_mm,
                high - low
            ))
            .at(Place::file(test.file()))
            .hint("use a shorter bar"));
        }
    }
    Ok(room_mm)
}

/// The middle of a box and its eight corners, whole millimetres.
fn corners(room_mm: &[[f64; 2]; 3]) -> Vec<Vector3<f64>> {
    let middle = room_mm.map(|[low, high]| (0.5 * (low + high)).round());
    let mut places = vec![Vector3::from(middle)];
    for k in 0..8_usize {
        let end = |axis: usize| match k >> axis & 1 {
            0 => room_mm[axis][0].ceil(),
            _ => room_mm[axis][1].floor(),
        };
        places.push(Vector3::new(end(0), end(1), end(2)));
    }
    places
}

/// Names that tell the candidates apart: those of mountings stay, others are numbered.
fn give_names(candidates: &mut [SetUpCandidate]) {
    let mut taken: Vec<String> = Vec::new();
    for candidate in candidates.iter().filter(|candidate| candidate.given.is_some()) {
        taken.push(candidate.name.clone());
    }
    for candidate in candidates.iter_mut().filter(|candidate| candidate.given.is_none()) {
        let base = if candidate.name.is_empty() { "P".to_owned() } else { candidate.name.clone() };
        let mut numbered = (1..).map(|number| format!("{base}{number}"));
        let name = numbered.find(|name| !taken.contains(name)).unwrap_or_default();
        taken.push(name.clone());
        candidate.name = name;
    }
}

/// Whether an arc can be driven in a set-up: it stays in the travel, its approach too, and the bodies
/// behind the balls keep clear of each other.
pub fn can_drive(
    machine: &Machine,
    candidate: &SetUpCandidate,
    arc: &Arc,
    feed_in_mm: f64,
) -> Result<()> {
    let count = (arc.sweep_rad.abs() / LOOK_RAD).ceil().max(1.0) as usize;
    let directions = (0..=count).map(|k| arc.at(k as f64 / count as f64).into_inner());
    let bodies = machine.clearance();
    for direction in directions {
        machine.axis_positions_mm(&candidate.mounting, &(direction * candidate.bar_mm))?;
        for part in [bodies.tool, bodies.spindle_nose].into_iter().flatten() {
            let Some(support) = bodies.support else { continue };
            let clearance_mm = support.distance_mm(&part, &(direction * candidate.bar_mm));
            if clearance_mm < CLEARANCE_MM {
                return Err(Error::input(format!(
                    "the bodies behind the balls come within {clearance_mm:.1} mm of each other"
                ))
                .hint("check `[clearance]` in the machine file, or use a longer bar"));
            }
        }
    }
    // The approach stands off along the radius, and aside where that would not move a slide.
    let start = arc.start.into_inner();
    let aside = start.map(|s| if s.abs() * APPROACH_MM < ASIDE_MM { ASIDE_MM } else { 0.0 });
    for sign in [-1.0, 1.0] {
        let ball_mm = start * reach_mm(candidate.bar_mm, feed_in_mm) + aside * sign;
        machine.axis_positions_mm(&candidate.mounting, &ball_mm)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidate_arcs_stay_on_the_upper_half_and_have_names_of_their_own() {
        let arcs = candidate_arcs(15.0_f64.to_radians());
        assert_eq!(arcs.len(), 1 + 8 + 36 + 24 + 120);
        let mut names: Vec<&str> = arcs.iter().map(|arc| arc.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), arcs.len());
        for arc in &arcs {
            for k in 0..=20 {
                assert!(arc.at(f64::from(k) / 20.0).z > -1e-9, "{}", arc.name);
            }
        }
    }
}
