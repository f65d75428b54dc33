//! A program as the control understands it: moves, dwells and stops, in machine coordinates.

use std::path::PathBuf;

use nalgebra::Vector3;

/// The path of a move between its two ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Path {
    /// A straight line.
    Line,
    /// A circular arc, or a helix when the ends differ along `axis`.
    Arc {
        /// Centre in machine coordinates, mm; its component along `axis` is the start's.
        center_mm: Vector3<f64>,
        /// The axis normal to the plane of the arc: 0, 1, 2 for X (G19), Y (G18), Z (G17).
        axis: usize,
        /// Angle from start to end about `+axis` by the right hand, rad: G03 positive, G02 negative.
        sweep_rad: f64,
    },
}

/// One move of the tool relative to the workpiece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Positioning (G00) rather than feed (G01, G02, G03).
    pub rapid: bool,
    /// The path.
    pub path: Path,
    /// Start, machine coordinates of X, Y, Z in mm.
    pub start_mm: Vector3<f64>,
    /// End, machine coordinates of X, Y, Z in mm.
    pub end_mm: Vector3<f64>,
    /// Programmed feed in mm/s; 0 for a rapid.
    pub feed_mm_s: f64,
    /// Exact stop at the end (G61 or G09).
    pub exact_stop: bool,
}

/// What a block makes the machine do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Move.
    Move(Move),
    /// Stand still for a known time (G04), s.
    Dwell {
        /// How long, s.
        seconds: f64,
    },
    /// Stand still until the operator presses start (M00, or M01 with the optional stop on).
    Stop,
    /// The end of the program (M02, M30).
    End,
}

/// One action with the place it came from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// Index into [`Program::labels`]: the last comment read before or in this block.
    pub label: usize,
    /// What happens.
    pub action: Action,
}

/// A program that was read back: the truth about the path, because it is what the machine ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// The file it was read from.
    pub file: PathBuf,
    /// Program number (`O` word), if any.
    pub number: Option<u32>,
    /// Comments in the order of the file; entry 0 is empty.
    pub labels: Vec<String>,
    /// What the machine does, in order.
    pub steps: Vec<Step>,
}

impl Program {
    /// How many operator's stops the program makes.
    pub fn stops(&self) -> usize {
        self.steps.iter().filter(|step| step.action == Action::Stop).count()
    }
}
