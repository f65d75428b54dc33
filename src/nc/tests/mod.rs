//! Programs that are read, and programs that are refused.

mod any_input;
mod dialects;
mod files;
mod moves;
mod refused;

use std::path::Path as FilePath;

use nalgebra::Vector3;

use super::read::read_at_most;
use super::{Action, Move, Program, Reading, read};
use crate::error::Result;

/// G54 as on the machine of the sample measurements, and a second offset to tell them apart.
fn offsets() -> Reading {
    let mut reading = Reading::default();
    reading.work_offsets_mm.insert(54, Vector3::new(20.0, -35.0, 40.0));
    reading.work_offsets_mm.insert(55, Vector3::new(100.0, 200.0, 300.0));
    reading
}

/// A program is not expected to be long in a test.
fn try_text(source: &str) -> Result<Program> {
    read_at_most(source, FilePath::new("O1.nc"), &offsets(), 10_000)
}

fn program(source: &str) -> Program {
    try_text(source).unwrap_or_else(|error| panic!("{error}\n{source}"))
}

/// The steps of a program that starts at the zero of G54 and ends by itself.
fn actions(blocks: &str) -> Vec<Action> {
    let source = format!("G90 G00 X0. Y0. Z0.\n{blocks}\nM30\n");
    let steps = program(&source).steps;
    assert_eq!(steps.last().unwrap().action, Action::End);
    steps[..steps.len() - 1].iter().map(|step| step.action).collect()
}

/// The moves of such a program.
fn moves(blocks: &str) -> Vec<Move> {
    let moves = actions(blocks).into_iter().filter_map(|action| match action {
        Action::Move(motion) => Some(motion),
        _ => None,
    });
    moves.collect()
}

/// Where such a program ends, relative to the zero of G54, mm.
fn end_mm(blocks: &str) -> Vector3<f64> {
    let last = moves(blocks).pop().expect("a move");
    last.end_mm - Vector3::new(20.0, -35.0, 40.0)
}

fn assert_near(found: Vector3<f64>, expected: [f64; 3], context: &str) {
    let expected = Vector3::from(expected);
    let apart = (found - expected).norm();
    assert!(apart < 1e-9, "{context}: {found} is not {expected}");
}
