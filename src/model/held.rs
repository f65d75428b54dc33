//! Effects whose amplitudes are known and not estimated.

use nalgebra::Vector3;

use super::jacobian::Situation;
use super::law::Law;
use super::motion::Motion;
use super::shape::Shape;
use super::term::{Parameter, Term};
use super::variable::Empirical;
use crate::machine::{Axis, ChainErrors, Pose};

/// What an effect does to the length: by a cause or as a curve.
#[derive(Debug, Clone, PartialEq)]
pub enum Form {
    /// By a cause of the library.
    Cause(Shape),
    /// As a curve.
    Empirical(Empirical),
}

impl Form {
    /// What it is called in a table: `cyclic EXX 10.00 mm`.
    pub fn name(&self) -> String {
        match self {
            Self::Cause(shape) => shape.name(),
            Self::Empirical(curve) => curve.name(),
        }
    }

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
    /// Its amplitudes, mm and rad.
    pub amplitudes: Vec<f64>,
    /// The run, of those that are looked at together, that alone has it; `None` where all do.
    pub run: Option<usize>,
    /// By how much earlier the program began, for it, than the log tells, s.
    pub earlier_s: f64,
}

impl HeldEffect {
    /// Whether a run of those that are looked at together has it.
    pub fn is_in(&self, run: usize) -> bool {
        self.run.is_none_or(|one| one == run)
    }

    /// The motion as it has it.
    pub fn its(&self, motion: &Motion) -> Motion {
        Motion { elapsed_s: motion.elapsed_s + self.earlier_s, ..*motion }
    }

    /// How much later a slide follows with it, s, or all slides with one in common; `None` of another effect.
    pub fn follows_later_s(&self, slide: Option<Axis>) -> Option<f64> {
        let Form::Cause(shape) = &self.form else { return None };
        match (shape.law(), shape.seat) {
            (Law::Corner(_), _) if slide.is_none() => shape.inner,
            _ if slide.is_some() && shape.delays() == slide => self.amplitudes.first().copied(),
            _ => None,
        }
    }
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

    fn lengthens(&self) -> bool {
        self.form.term().lengthens()
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
        if self.is_in(motion.run) {
            self.form.term().bend(&self.amplitudes, at, &self.its(motion), mounting, errors);
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
        if !self.is_in(motion.run) {
            return 0.0;
        }
        self.form.term().lengthen(&self.amplitudes, at, &self.its(motion), mounting, direction)
    }
}
