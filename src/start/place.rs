//! Where the balls can be so that a test fits into the machine.

use nalgebra::Vector3;

use crate::design::PlannedProgram;
use crate::error::{Error, Result};
use crate::machine::{Axis, Machine, Mounting};
use crate::plan::{Path, Test};

/// How high in their room along the tool axis the balls are tried: in the middle, then nearer to the table, where Z has
/// more way up.
const HEIGHTS: [f64; 4] = [0.5, 0.3, 0.1, 0.7];

/// Machine coordinates, whole mm, at which the balls of the first mounting may coincide: the middle of the room that the
/// path has in the travel, if its program passes its own check there.
///
/// # Errors
/// When there is no such place; what speaks against the first.
pub(super) fn place_mm(test: &Test, machine: &Machine) -> Result<Vector3<f64>> {
    let room_mm = Path::room_mm(test, machine, 0)?;
    let mut first: Option<Error> = None;
    for height in HEIGHTS {
        let at = |axis: Axis| {
            let [low, high] = room_mm[axis.index()];
            let share = if axis == Axis::Z { height } else { 0.5 };
            (low + share * (high - low)).round() + 0.0
        };
        let coincidence_mm = Vector3::from(Axis::ALL.map(at));
        let balls = Mounting { coincidence_mm, ..test.mountings()[0].mounting };
        let there = test.clone().with_balls(0, balls);
        let objection = PlannedProgram::new(&there, machine, 0)
            .and_then(|program| program.objections(&there, machine));
        match objection.map(|objections| objections.into_iter().next()) {
            Ok(None) => return Ok(coincidence_mm),
            Ok(Some(error)) | Err(error) => first.get_or_insert(error),
        };
    }
    // One height was tried.
    Err(first.unwrap_or_else(|| Error::input("the test has no place in the travel")))
}
