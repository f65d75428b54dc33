//! What is to be begun with, before any file is written.

use super::measured::Measured;
use super::test_kind::TestKind;
use crate::error::Result;
use crate::machine::{Axis, Builtin, Dialect, Machine, Topology};

/// What a machine file is called that a test file beside it names.
pub(super) const MACHINE_FILE: &str = "machine.toml";

/// A machine, a bar, a tool and a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// What the machine is otherwise like.
    pub base: Machine,
    /// Its name.
    pub name: String,
    /// The order of its slides.
    pub topology: Topology,
    /// Lowest and highest machine coordinates of X, Y and Z, mm.
    pub travel_mm: [[f64; 2]; 3],
    /// Its control.
    pub dialect: Dialect,
    /// Nominal length of the bar, mm; without it the longest of the usual ones that fits.
    pub bar_mm: Option<f64>,
    /// From the spindle nose to the centre of the tool ball, mm.
    pub tool_mm: f64,
    /// What is driven.
    pub test: TestKind,
    /// At which feed, mm/min.
    pub feed_mm_min: f64,
    /// What was measured already, in one plane.
    pub measured: Option<Measured>,
}

/// From the spindle nose to the tool ball where nothing tells it, mm.
const TOOL_MM: f64 = 120.0;

impl Wish {
    /// A built-in machine as it is, and a test.
    pub fn of(machine: Builtin, test: TestKind) -> Result<Self> {
        let base = machine.machine()?;
        Ok(Self {
            name: base.name().to_owned(),
            topology: base.topology().clone(),
            travel_mm: Axis::ALL.map(|axis| base.slide(axis).travel_mm),
            dialect: base.controller().dialect,
            bar_mm: None,
            tool_mm: base.clearance().tool.map_or(TOOL_MM, |tool| tool.length_mm),
            test,
            feed_mm_min: test.usual_feed_mm_min(),
            measured: None,
            base,
        })
    }
}
