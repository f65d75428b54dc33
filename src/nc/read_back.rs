//! A program that was written, held against its plan.

use nalgebra::Vector3;

use super::program::{Action, Program};
use crate::error::{Error, Result};
use crate::plan::{Path, Test};

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
    let planned: Vec<&Vector3<f64>> = path.points().skip(1).collect();
    let mut moves = program.steps.iter().filter_map(|step| match &step.action {
        Action::Move(motion) => Some(motion),
        _ => None,
    });
    let mut result = ReadBack { points: 0, worst_mm: 0.0, sag_mm: 0.0 };
    for point in &planned {
        let Some(motion) = moves.next() else { break };
        let off = (motion.end_mm - coincidence_mm - *point).amax();
        result.worst_mm = result.worst_mm.max(off);
        result.points += 1;
        let start = motion.start_mm - coincidence_mm;
        // Chords only: both ends on the sphere.
        if (start.norm() - sphere_mm).abs() < 0.01 && (point.norm() - sphere_mm).abs() < 0.01 {
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
