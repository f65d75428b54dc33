//! Effects whose amplitudes are known and not estimated.

use nalgebra::Vector3;

use super::jacobian::Situation;
use super::motion::Motion;
use super::shape::Shape;
use super::term::{Parameter, Term};
use super::variable::Empirical;
use crate::machine::{ChainErrors, Pose};

/// What an effect does to the length: by a cause or as a curve.
#[derive(Debug, Clone, PartialEq)]
pub enum Form {
    /// By a cause of the library.
    Cause(Shape),
    /// As a curve.
    Empirical(Empirical),
}

impl Form {
    /// The term that it is.
    pub fn term(&self) -> &dyn Term {
        match self {
            Self::Cause(shape) => shape,
            Self::Empirical(empirical) => empirical,
        }
    }
}

/// An effect that bends the chain by known amounts; it has no parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldEffect {
    /// What it does.
    pub form: Form,
    /// Its amplitudes in each mounting, mm and rad; none where it is not there.
    pub amplitudes: Vec<Vec<f64>>,
}

impl Term for HeldEffect {
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn parameter_count(&self) -> usize {
        0
    }

    fn holds(&self) -> bool {
        true
    }

    fn columns(&self, _at: &Situation, _out: &mut [f64]) {}

    fn bend(
        &self,
        _values: &[f64],
        at: &Pose,
        motion: &Motion,
        mounting: usize,
        errors: &mut ChainErrors,
    ) {
        let amplitudes = &self.amplitudes[mounting];
        if !amplitudes.is_empty() {
            self.form.term().bend(amplitudes, at, motion, mounting, errors);
        }
    }

    fn lengthen(
        &self,
        _values: &[f64],
        at: &Pose,
        motion: &Motion,
        mounting: usize,
        direction: &Vector3<f64>,
    ) -> f64 {
        let amplitudes = &self.amplitudes[mounting];
        if amplitudes.is_empty() {
            return 0.0;
        }
        self.form.term().lengthen(amplitudes, at, motion, mounting, direction)
    }
}
