//! The displacement of a tool against the workpiece, and how well it is known.

use nalgebra::Vector3;

use super::error_model::{ErrorModel, Held};
use crate::error::Result;
use crate::machine::{Axis, Mounting, Pose, SlideError};
use crate::model::{Model, Motion};
use crate::solve::dot;

/// What a number hangs on: `by` of one of each parameter, and of each effect beside them by its own size.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// One number a parameter, and after them one an effect.
    pub by: Vec<f64>,
}

impl Row {
    /// Of a number that hangs on nothing.
    pub fn zero(count: usize) -> Self {
        Self { by: vec![0.0; count] }
    }

    /// Adds so many times another.
    pub fn add(&mut self, of: &Self, factor: f64) {
        self.by.iter_mut().zip(&of.by).for_each(|(to, of)| *to += factor * of);
    }
}

/// A displacement in the programmed directions X, Y, Z, actual less commanded.
#[derive(Debug, Clone, PartialEq)]
pub struct Displacement {
    /// By how much, mm.
    pub error_mm: Vector3<f64>,
    /// What each component hangs on.
    pub rows: [Row; 3],
}

/// How well a number is known, in its unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sigmas {
    /// Standard deviation by the noise: what repeats would scatter.
    pub noise: f64,
    /// Standard deviation by the noise and by what the test cannot tell from other plausible faults.
    pub all: f64,
}

/// The displacement of a tool against the workpiece at any pose of a machine that stands still or creeps.
///
/// `e = actual - commanded` of the tool relative to the workpiece, along the programmed directions, through the exact
/// chain: a slide that carries the workpiece counts with its other sign there and nowhere else. What is constant is set-up,
/// so `e` means something between two poses only.
#[derive(Debug)]
pub struct Field<'a> {
    errors: &'a ErrorModel,
    model: Model<'a>,
    /// Of the tool among the mountings of the model.
    index: usize,
    tool_ball_mm: Vector3<f64>,
}

impl<'a> Field<'a> {
    /// Of a tool whose tip is there in the frame of the last slide on the tool side, mm.
    ///
    /// # Errors
    /// When a term is not known.
    pub fn new(errors: &'a ErrorModel, tool_ball_mm: Vector3<f64>) -> Result<Self> {
        let balls = Mounting { coincidence_mm: Vector3::zeros(), tool_ball_mm };
        let (model, index) = errors.model(&balls)?;
        Ok(Self { errors, model, index, tool_ball_mm })
    }

    /// The error model.
    pub fn errors(&self) -> &'a ErrorModel {
        self.errors
    }

    /// How many numbers a row has.
    pub fn width(&self) -> usize {
        self.errors.values.len() + self.errors.held.len()
    }

    /// The displacement, mm.
    pub fn error_mm(&self, pose: &Pose) -> Vector3<f64> {
        self.displaced_mm(&self.errors.values, pose)
    }

    /// The same of other values of the parameters, mm.
    pub(super) fn displaced_mm(&self, values: &[f64], pose: &Pose) -> Vector3<f64> {
        let touching =
            Mounting { coincidence_mm: pose.position_mm, tool_ball_mm: self.tool_ball_mm };
        let errors = self.model.errors(values, pose, &Motion::REST, self.index);
        self.model.machine().ball_vector_mm(&touching, &pose.position_mm, &errors)
    }

    /// The six errors of each slide at a pose.
    pub(super) fn slides(&self, pose: &Pose) -> [SlideError; 3] {
        self.model.errors(&self.errors.values, pose, &Motion::REST, self.index).slides
    }

    /// Where the tip of the tool is in the frame of the last slide on the tool side, mm.
    pub(super) fn tool_ball_mm(&self) -> Vector3<f64> {
        self.tool_ball_mm
    }

    /// The displacement and what it hangs on.
    pub fn displacement(&self, pose: &Pose) -> Displacement {
        let row = |axis: Axis| {
            let along = Vector3::ith(axis.index(), 1.0);
            let at = self.model.situation_along(pose, &Motion::REST, self.index, along);
            let mut by = vec![0.0; self.errors.values.len()];
            self.model.row(&at, &mut by);
            by.extend(self.errors.held.iter().map(|Held { effect, .. }| {
                let mut columns = vec![0.0; effect.amplitudes.len()];
                effect.form.term().columns(&at, &mut columns);
                dot(&columns, &effect.amplitudes)
            }));
            Row { by }
        };
        Displacement { error_mm: self.error_mm(pose), rows: Axis::ALL.map(row) }
    }

    /// How well a number is known that hangs on the errors so.
    pub fn sigmas(&self, row: &Row) -> Sigmas {
        let (parameters, effects) = row.by.split_at(self.errors.values.len());
        let of_effects = effects.iter().zip(&self.errors.held);
        let of_effects: f64 = of_effects.map(|(by, held)| (by * held.uncertain).powi(2)).sum();
        let by = |of: &crate::solve::Matrix| dot(parameters, &of.times_vector(parameters)).max(0.0);
        let noise = by(&self.errors.noise) + of_effects;
        Sigmas { noise: noise.sqrt(), all: (noise + by(&self.errors.open)).sqrt() }
    }
}
