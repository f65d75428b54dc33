//! What the control knows when it reads a program.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::machine::{Dialect, Machine};

/// What a program does not say, but the control knows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// How words are understood.
    pub dialect: Dialect,
    /// For 54 to 59 (G54 to G59): machine coordinates of the offset's zero, mm.
    pub work_offsets_mm: BTreeMap<u8, Vector3<f64>>,
    /// Block delete is on: blocks that begin with a slash are skipped.
    pub block_delete: bool,
    /// Optional stop is on: M01 stops.
    pub optional_stop: bool,
}

impl Reading {
    /// Reading for the control of a machine, no work offset known yet.
    pub fn of(machine: &Machine) -> Self {
        Self { dialect: machine.controller().dialect, ..Self::default() }
    }
}
