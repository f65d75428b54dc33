//! A program that was written, held against its plan.

use nalgebra::Vector3;

use super::program::{Action, Move, Path as Way, Program};
use crate::error::{Error, Kind, Result};
use crate::plan::{Circular, Path, Step, Test};

/// How a program that was read back compares with its plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadBack {
    /// Points compared.
    pub points: usize,
    /// Largest distance between a commanded and a planned coordinate, mm.
    pub worst_mm: f64,
    /// Largest sagitta of a chord on the sphere, mm.
    pub sag_mm: f64,
}

/// Compares every end point of a program with the plan, in order.
///
/// # Errors
/// When the program has another number of moves than the plan, with both.
pub fn read_back(program: &Program, test: &Test, path: &Path) -> Result<ReadBack> {
    let coincidence_mm = &test.mountings()[path.mounting].mounting.coincidence_mm;
    let sphere_mm = test.bar_of(path.mounting).length_mm;
    // The first rapid comes from an unknown place and is no step of the program.
    let planned: Vec<(&Vector3<f64>, Option<&Circular>)> =
        path.steps.iter().flat_map(ends).skip(1).collect();
    let mut moves = program.steps.iter().filter_map(|step| match &step.action {
        Action::Move(motion) => Some(motion),
        _ => None,
    });
    let mut result = ReadBack { points: 0, worst_mm: 0.0, sag_mm: 0.0 };
    for (point, arc) in &planned {
        let Some(motion) = moves.next() else { break };
        turns_as_planned(motion, *arc, coincidence_mm)?;
        let off = (motion.end_mm - coincidence_mm - **point).amax();
        result.worst_mm = result.worst_mm.max(off);
        result.points += 1;
        let start = motion.start_mm - coincidence_mm;
        // Chords only: both ends on the sphere.
        if arc.is_none()
            && (start.norm() - sphere_mm).abs() < 0.01
            && (point.norm() - sphere_mm).abs() < 0.01
        {
            let chord = (motion.end_mm - motion.start_mm).norm();
            result.sag_mm = result.sag_mm.max(chord * chord / (8.0 * sphere_mm));
        }
    }
    let left = moves.count();
    if result.points < planned.len() || left > 0 {
        return Err(Error::input(format!(
            "the program makes {} moves, the plan {}",
            result.points + left,
            planned.len()
        ))
        .hint("write the program anew with `ballbar program`"));
    }
    Ok(result)
}

/// Where the blocks of a step end, each with the arc that it is.
fn ends(step: &Step) -> impl Iterator<Item = (&Vector3<f64>, Option<&Circular>)> {
    let arc = match step {
        Step::Circular(arc, _) => Some(arc),
        _ => None,
    };
    step.ends().iter().map(move |end| (end, arc))
}

/// A circular arc whose ends are rounded may be longer or shorter by so much, mm: a hundredth at both ends. A turn the other
/// way, or a whole one for none, is off by more than that.
const LONGER_MM: f64 = 0.03;
/// So far is the centre of an arc of three decimals from the workpiece ball, mm: not at all.
const CENTRED_MM: f64 = 1e-6;

/// Whether a move is the arc that was planned, or no arc where none was.
fn turns_as_planned(
    motion: &Move,
    arc: Option<&Circular>,
    coincidence_mm: &Vector3<f64>,
) -> Result<()> {
    let right = match (motion.path, arc) {
        (Way::Line, None) => true,
        (Way::Arc { center_mm, axis, sweep_rad }, Some(arc)) => {
            let mut off_mm = center_mm - coincidence_mm;
            off_mm[axis] = 0.0;
            let mut radius_mm = motion.start_mm - center_mm;
            radius_mm[axis] = 0.0;
            axis == arc.plane.normal()
                && (sweep_rad - arc.sweep_rad).abs() * radius_mm.norm() < LONGER_MM
                && off_mm.amax() < CENTRED_MM
        }
        _ => false,
    };
    if right {
        return Ok(());
    }
    Err(Error::new(Kind::Output, "an arc of the program is not the one that was planned")
        .hint("this is a fault of this tool; please report the test file"))
}
