//! What a control takes off: functions of one slide, numbers that hold everywhere, a grid of vectors, or a model of slides.
//!
//! All of it is kept as the error `e = actual - commanded` of the tool against the workpiece along the programmed positive
//! directions, whatever sign a control has for it: the files have theirs, and their readers take it off again.

use nalgebra::{Matrix3, Vector3};

use crate::machine::{Axis, ChainErrors, Machine, Mounting, Pose, SlideError};

/// With which motion of its slide a column counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ways {
    /// With every one.
    Both,
    /// While it moves, or has moved last, in the positive direction.
    Plus,
    /// The same of the negative one.
    Minus,
}

impl Ways {
    /// How much of the column counts; of a slide of which no motion has been seen, the mean of both senses.
    fn share(self, sense: f64) -> f64 {
        match self {
            Self::Both => 1.0,
            Self::Plus => 0.5 * (1.0 + sense),
            Self::Minus => 0.5 * (1.0 - sense),
        }
    }
}

/// The error along one axis as a function of the position of one slide: straight between its points, beyond them as at the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The slide on whose position it hangs.
    pub over: Axis,
    /// The direction of the error.
    pub along: Axis,
    /// With which motions of that slide.
    pub ways: Ways,
    /// Positions, machine coordinates, ascending, mm; at least one.
    pub at_mm: Vec<f64>,
    /// The error at each, mm.
    pub error_mm: Vec<f64>,
}

impl Column {
    /// The error at a position, mm.
    pub fn error_mm_at(&self, position_mm: f64) -> f64 {
        between(&self.at_mm, position_mm, |k| self.error_mm[k])
    }
}

/// Straight between points, beyond them as at the last.
fn between(at_mm: &[f64], position_mm: f64, value: impl Fn(usize) -> f64) -> f64 {
    let next = at_mm.partition_point(|at| *at <= position_mm);
    if next == 0 || next == at_mm.len() {
        return value(next.saturating_sub(1));
    }
    let share = (position_mm - at_mm[next - 1]) / (at_mm[next] - at_mm[next - 1]);
    (1.0 - share) * value(next - 1) + share * value(next)
}

/// Vectors of error at the nodes of a box, linear between along each axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Coordinates along X, Y, Z, ascending, mm.
    pub at_mm: [Vec<f64>; 3],
    /// The vectors, X the fastest, mm.
    pub error_mm: Vec<Vector3<f64>>,
}

impl Grid {
    fn error_mm_at(&self, position_mm: &Vector3<f64>) -> Vector3<f64> {
        let [nx, ny, _] = [0, 1, 2].map(|k| self.at_mm[k].len());
        Vector3::from_fn(|component, _| {
            between(&self.at_mm[2], position_mm.z, |z| {
                between(&self.at_mm[1], position_mm.y, |y| {
                    between(&self.at_mm[0], position_mm.x, |x| {
                        self.error_mm[x + nx * (y + ny * z)][component]
                    })
                })
            })
        })
    }
}

/// The six errors of each slide at positions of it: a control that has the model of the machine computes the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct SlideTable {
    /// Positions, machine coordinates, ascending, mm.
    pub at_mm: Vec<f64>,
    /// `EXH, EYH, EZH` in mm and `EAH, EBH, ECH` in rad at each.
    pub errors: Vec<[f64; 6]>,
}

impl SlideTable {
    pub(super) fn at(&self, position_mm: f64) -> SlideError {
        let value = |k: usize| between(&self.at_mm, position_mm, |i| self.errors[i][k]);
        SlideError {
            translation_mm: Vector3::new(value(0), value(1), value(2)),
            rotation_rad: Vector3::new(value(3), value(4), value(5)),
        }
    }
}

/// All that a control takes off.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tables {
    /// Functions of one slide.
    pub columns: Vec<Column>,
    /// Error a length of the position: scales and squarenesses.
    pub linear: Matrix3<f64>,
    /// Lost motion of each slide: how much farther in the positive direction it is when it came from above, mm.
    pub play_mm: Vector3<f64>,
    /// Vectors in a box.
    pub grid: Option<Grid>,
    /// Errors of the three slides.
    pub slides: Option<[SlideTable; 3]>,
}

impl Tables {
    /// The error that is taken off at a pose with the tip of a tool there, mm.
    pub fn error_mm(
        &self,
        machine: &Machine,
        tool_ball_mm: Vector3<f64>,
        pose: &Pose,
    ) -> Vector3<f64> {
        let mut error_mm = self.linear * pose.position_mm;
        error_mm -= 0.5 * self.play_mm.component_mul(&pose.sense);
        for column in &self.columns {
            let k = column.over.index();
            error_mm[column.along.index()] +=
                column.ways.share(pose.sense[k]) * column.error_mm_at(pose.position_mm[k]);
        }
        if let Some(grid) = &self.grid {
            error_mm += grid.error_mm_at(&pose.position_mm);
        }
        if let Some(tables) = &self.slides {
            let at = |axis: Axis| tables[axis.index()].at(pose.position_mm[axis.index()]);
            let errors = ChainErrors { slides: Axis::ALL.map(at), ..ChainErrors::zero() };
            let touching = Mounting { coincidence_mm: pose.position_mm, tool_ball_mm };
            error_mm += machine.ball_vector_mm(&touching, &pose.position_mm, &errors);
        }
        error_mm
    }

    /// The part along one axis that hangs on the position and the sense of one slide alone, mm.
    pub(super) fn of_slide_mm(&self, over: Axis, along: Axis, position_mm: f64, sense: f64) -> f64 {
        let (k, j) = (over.index(), along.index());
        let own = |column: &&Column| column.over == over && column.along == along;
        let columns = self.columns.iter().filter(own);
        let columns = columns.map(|of| of.ways.share(sense) * of.error_mm_at(position_mm));
        let play_mm = if over == along { -0.5 * self.play_mm[k] * sense } else { 0.0 };
        columns.sum::<f64>() + self.linear[(j, k)] * position_mm + play_mm
    }
}
