//! What terms beyond position and sense depend on.

use nalgebra::Vector3;

/// The last reversal of a slide, as seen from now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reversal {
    /// How long ago, s.
    pub ago_s: f64,
    /// How far ago along the slide, mm, not negative.
    pub ago_mm: f64,
}

/// The next corner of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// How soon, s.
    pub ahead_s: f64,
    /// By how much the commanded velocity of X, Y, Z jumps there, mm/s.
    pub jump_mm_s: Vector3<f64>,
}

/// How the machine moves at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Velocity of X, Y, Z, mm/s.
    pub velocity_mm_s: Vector3<f64>,
    /// Time since the program began by the clock of the bar, the operator's pauses included, s.
    pub elapsed_s: f64,
    /// Time in the program, the operator's pauses left out, s: the same place of a program has the same in all runs.
    pub program_s: f64,
    /// The last reversal of X, Y, Z; `None` where a slide has only ever moved one way.
    pub reversals: [Option<Reversal>; 3],
    /// The end of the present block.
    pub corner: Corner,
    /// Which of the runs that are looked at together: an effect may be one run's alone.
    pub run: usize,
}

impl Motion {
    /// A machine that has always stood still.
    pub const REST: Self = Self {
        velocity_mm_s: Vector3::new(0.0, 0.0, 0.0),
        elapsed_s: 0.0,
        program_s: 0.0,
        reversals: [None; 3],
        corner: Corner { ahead_s: f64::INFINITY, jump_mm_s: Vector3::new(0.0, 0.0, 0.0) },
        run: 0,
    };
}
