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

impl Move {
    /// Length along the path, mm.
    pub fn length_mm(&self) -> f64 {
        let chord = self.end_mm - self.start_mm;
        match self.path {
            Path::Line => chord.norm(),
            Path::Arc { center_mm, axis, sweep_rad } => {
                let mut radius = self.start_mm - center_mm;
                radius[axis] = 0.0;
                (radius.norm() * sweep_rad).hypot(chord[axis])
            }
        }
    }

    /// Position (mm) and unit tangent after a share of the path, 0 to 1.
    pub fn at(&self, share: f64) -> (Vector3<f64>, Vector3<f64>) {
        let chord = self.end_mm - self.start_mm;
        match self.path {
            Path::Line => (
                self.start_mm + chord * share,
                chord.try_normalize(0.0).unwrap_or_else(Vector3::zeros),
            ),
            Path::Arc { center_mm, axis, sweep_rad } => {
                let turned = self.turned_mm(&center_mm, axis, sweep_rad * share, share);
                let mut position = center_mm + turned;
                position[axis] = self.start_mm[axis] + chord[axis] * share;
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut tangent = Vector3::zeros();
                (tangent[a], tangent[b]) = (-turned[b] * sweep_rad, turned[a] * sweep_rad);
                tangent[axis] = chord[axis];
                (position, tangent.try_normalize(0.0).unwrap_or_else(Vector3::zeros))
            }
        }
    }

    /// From the centre of an arc to where it is after a share of it, in its plane, mm.
    fn turned_mm(
        &self,
        center_mm: &Vector3<f64>,
        axis: usize,
        angle_rad: f64,
        share: f64,
    ) -> Vector3<f64> {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let from =
            |point_mm: &Vector3<f64>| [point_mm[a] - center_mm[a], point_mm[b] - center_mm[b]];
        let (arm, closing) = (from(&self.start_mm), from(&self.end_mm));
        let square = |of: [f64; 2]| of[0] * of[0] + of[1] * of[1];
        // Ends that differ from a true circle by rounding are reached by letting the radius glide.
        let glide = 1.0 + ((square(closing) / square(arm)).sqrt() - 1.0) * share;
        let (sine, cosine) = angle_rad.sin_cos();
        let mut turned = Vector3::zeros();
        turned[a] = (arm[0] * cosine - arm[1] * sine) * glide;
        turned[b] = (arm[0] * sine + arm[1] * cosine) * glide;
        turned
    }

    /// Position after a share of the path, 0 to 1, mm.
    pub fn position_mm(&self, share: f64) -> Vector3<f64> {
        match self.path {
            Path::Line => self.start_mm + (self.end_mm - self.start_mm) * share,
            Path::Arc { center_mm, axis, sweep_rad } => {
                let turned = self.turned_mm(&center_mm, axis, sweep_rad * share, share);
                let mut position = center_mm + turned;
                position[axis] =
                    self.start_mm[axis] + (self.end_mm[axis] - self.start_mm[axis]) * share;
                position
            }
        }
    }

    /// Shares of an arc at which its tangent is normal to an axis of its plane; none on a line.
    pub fn extreme_shares(&self) -> Vec<f64> {
        let Path::Arc { center_mm, axis, sweep_rad } = self.path else { return Vec::new() };
        let arm = self.start_mm - center_mm;
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let start_rad = arm[b].atan2(arm[a]);
        let quarter = std::f64::consts::FRAC_PI_2;
        let (first, last) = (start_rad / quarter, (start_rad + sweep_rad) / quarter);
        let (low, high) = (first.min(last), first.max(last));
        let mut shares: Vec<f64> = Vec::new();
        let mut k = (low + 1e-9).ceil();
        while k < high - 1e-9 {
            shares.push((k * quarter - start_rad) / sweep_rad);
            k += 1.0;
        }
        shares
    }
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
    /// Index of its first step that moves the machine from a place that is known; the number of steps without one.
    pub fn first_move(&self) -> usize {
        let moves = |step: &Step| matches!(step.action, Action::Move(_));
        self.steps.iter().position(moves).unwrap_or(self.steps.len())
    }

    /// How many operator's stops the program makes from its first move on.
    pub fn stops(&self) -> usize {
        let steps = &self.steps[self.first_move()..];
        steps.iter().filter(|step| step.action == Action::Stop).count()
    }
}
