//! Terms, and the model that they make together.

use std::fmt::Debug;
use std::ops::Range;

use nalgebra::Vector3;

use super::coefficient::{Ball, Coefficient, SetUp};
use super::jacobian::Situation;
use super::local::Local;
use super::motion::Motion;
use crate::machine::{Axis, ChainErrors, Machine, Mounting, Pose};

/// What a parameter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterId {
    /// A coefficient of the paper.
    Coefficient(Coefficient),
    /// A set-up error of the mounting with this index.
    SetUp(SetUp, usize),
    /// An error about the middle of a test.
    Local(Local),
    /// An amplitude of an effect.
    Amplitude,
    /// How much later a slide follows than the others.
    Delay(Axis),
}

impl ParameterId {
    /// The slide that it lets follow later than the others.
    pub fn delays(self) -> Option<Axis> {
        if let Self::Delay(slide) = self { Some(slide) } else { None }
    }

    /// The coefficient, if it is one.
    pub fn coefficient(self) -> Option<Coefficient> {
        match self {
            Self::Coefficient(of) => Some(of),
            Self::SetUp(..) | Self::Local(_) | Self::Amplitude | Self::Delay(_) => None,
        }
    }

    /// The set-up error with its mounting, if it is one.
    pub fn set_up(self) -> Option<(SetUp, usize)> {
        match self {
            Self::SetUp(of, mounting) => Some((of, mounting)),
            Self::Coefficient(_) | Self::Local(_) | Self::Amplitude | Self::Delay(_) => None,
        }
    }
}

/// A number that a term estimates.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// What it is.
    pub id: ParameterId,
    /// Its name, such as `EXX1`, `EXt` or, of one of several mountings, `EXt@A`.
    pub name: String,
    /// Its unit, such as `mm/mm`.
    pub unit: &'static str,
    /// Standard deviation of what it plausibly is, in its unit; `None` where the readings alone decide.
    pub plausible: Option<f64>,
}

impl Parameter {
    /// Its name without that of a mounting: what stands for it in all mountings.
    pub fn bare_name(&self) -> String {
        match self.id {
            ParameterId::SetUp(of, _) => of.to_string(),
            ParameterId::Coefficient(_)
            | ParameterId::Local(_)
            | ParameterId::Amplitude
            | ParameterId::Delay(_) => self.name.clone(),
        }
    }
}

/// The unit of the model.
pub trait Term: Debug + Send + Sync {
    /// What it estimates, in the order of its columns.
    fn parameters(&self) -> Vec<Parameter>;

    /// How many parameters it has.
    fn parameter_count(&self) -> usize {
        1
    }

    /// Derivatives of the length (mm) with respect to each parameter, one number a parameter.
    fn columns(&self, at: &Situation, out: &mut [f64]);

    /// Adds what the parameters' values do to the exact chain.
    fn bend(
        &self,
        values: &[f64],
        at: &Pose,
        motion: &Motion,
        mounting: usize,
        errors: &mut ChainErrors,
    );

    /// What the parameters' values add to the length without bending the chain, mm, with the bar along a
    /// unit vector: what belongs to the bar and the balls themselves.
    fn lengthen(
        &self,
        _values: &[f64],
        _at: &Pose,
        _motion: &Motion,
        _mounting: usize,
        _direction: &Vector3<f64>,
    ) -> f64 {
        0.0
    }

    /// Whether it ever [lengthens](Self::lengthen) the bar.
    fn lengthens(&self) -> bool {
        false
    }

    /// Whether it does something without any parameter's doing.
    fn holds(&self) -> bool {
        false
    }
}

impl Term for Coefficient {
    fn parameters(&self) -> Vec<Parameter> {
        let id = ParameterId::Coefficient(*self);
        vec![Parameter { id, name: self.to_string(), unit: self.unit(), plausible: None }]
    }

    fn columns(&self, at: &Situation, out: &mut [f64]) {
        let gradient = &at.slides[self.slide.index()];
        let along =
            if self.component.is_angular() { &gradient.rotation_mm } else { &gradient.translation };
        out[0] = along[self.component.direction()] * self.basis(&at.pose);
    }

    fn bend(
        &self,
        values: &[f64],
        at: &Pose,
        _motion: &Motion,
        _mounting: usize,
        errors: &mut ChainErrors,
    ) {
        let slide = &mut errors.slides[self.slide.index()];
        let of = if self.component.is_angular() {
            &mut slide.rotation_rad
        } else {
            &mut slide.translation_mm
        };
        of[self.component.direction()] += values[0] * self.basis(at);
    }
}

/// A set-up error belongs to one mounting; another mounting brings its own.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SetUpTerm {
    pub(super) set_up: SetUp,
    pub(super) mounting: usize,
    /// Name of the mounting where a test has several, empty where it has one.
    pub(super) mounting_name: String,
    /// See [`Parameter::plausible`], mm.
    pub(super) plausible_mm: Option<f64>,
}

impl Term for SetUpTerm {
    fn parameters(&self) -> Vec<Parameter> {
        let name = match self.mounting_name.as_str() {
            "" => self.set_up.to_string(),
            mounting => format!("{}@{mounting}", self.set_up),
        };
        let id = ParameterId::SetUp(self.set_up, self.mounting);
        vec![Parameter { id, name, unit: "mm", plausible: self.plausible_mm }]
    }

    fn columns(&self, at: &Situation, out: &mut [f64]) {
        let along = at.direction[self.set_up.axis.index()];
        out[0] = match self.set_up.ball {
            _ if at.mounting != self.mounting => 0.0,
            Ball::Tool => along,
            Ball::Workpiece => -along,
        };
    }

    fn bend(
        &self,
        values: &[f64],
        _at: &Pose,
        _motion: &Motion,
        mounting: usize,
        errors: &mut ChainErrors,
    ) {
        if mounting == self.mounting {
            let ball = match self.set_up.ball {
                Ball::Tool => &mut errors.tool_ball_mm,
                Ball::Workpiece => &mut errors.workpiece_ball_mm,
            };
            ball[self.set_up.axis.index()] += values[0];
        }
    }
}

/// A machine, where the balls are, and the terms that describe how it errs.
#[derive(Debug)]
pub struct Model<'a> {
    machine: &'a Machine,
    mountings: Vec<Mounting>,
    terms: Vec<Box<dyn Term>>,
    /// Index of the first parameter of each term, and behind the last one.
    first: Vec<usize>,
    parameters: Vec<Parameter>,
    /// Indices of the terms that lengthen the bar: most do not, and every reading asks.
    lengthening: Vec<usize>,
    holds: bool,
}

impl<'a> Model<'a> {
    /// A model of these terms.
    pub fn new(machine: &'a Machine, mountings: Vec<Mounting>, terms: Vec<Box<dyn Term>>) -> Self {
        let parameters = terms.iter().flat_map(|term| term.parameters()).collect();
        let holds = terms.iter().any(|term| term.holds());
        let lengthening = (0..terms.len()).filter(|k| terms[*k].lengthens()).collect();
        let mut first = vec![0];
        for term in &terms {
            first.push(first[first.len() - 1] + term.parameter_count());
        }
        Self { machine, mountings, terms, first, parameters, lengthening, holds }
    }

    /// The terms, each with where its parameters are.
    fn terms(&self) -> impl Iterator<Item = (&dyn Term, Range<usize>)> {
        let spans = self.first.windows(2).map(|two| two[0]..two[1]);
        self.terms.iter().map(AsRef::as_ref).zip(spans)
    }

    /// What the columns are, in order.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The machine.
    pub fn machine(&self) -> &'a Machine {
        self.machine
    }

    /// Whether effects are held beside the parameters.
    pub fn holds(&self) -> bool {
        self.holds
    }

    /// The mountings.
    pub fn mountings(&self) -> &[Mounting] {
        &self.mountings
    }

    /// One row of the projected Jacobian: `d rho / d parameter`, mm per unit of the parameter.
    pub fn row(&self, at: &Situation, out: &mut [f64]) {
        for (term, own) in self.terms() {
            term.columns(at, &mut out[own]);
        }
    }

    /// What the parameters' values do to the exact chain at a pose.
    pub fn errors(
        &self,
        values: &[f64],
        pose: &Pose,
        motion: &Motion,
        mounting: usize,
    ) -> ChainErrors {
        let mut errors = ChainErrors::zero();
        for (term, own) in self.terms() {
            term.bend(&values[own], pose, motion, mounting, &mut errors);
        }
        errors
    }

    /// Length between the balls through the exact chain, mm.
    pub fn length_mm(&self, values: &[f64], pose: &Pose, motion: &Motion, mounting: usize) -> f64 {
        let errors = if self.is_perfect(values) {
            ChainErrors::zero()
        } else {
            self.errors(values, pose, motion, mounting)
        };
        self.bent_length_mm(values, &errors, pose, motion, mounting)
    }

    /// Whether nothing bends the chain, nor lengthens the bar, at any pose.
    fn is_perfect(&self, values: &[f64]) -> bool {
        !self.holds && values.iter().all(|value| *value == 0.0)
    }

    /// The same of a chain that is bent so: by what [`Self::errors`] says of these values at this pose.
    pub fn bent_length_mm(
        &self,
        values: &[f64],
        errors: &ChainErrors,
        pose: &Pose,
        motion: &Motion,
        mounting: usize,
    ) -> f64 {
        // A perfect machine puts the balls where the inverse kinematics say.
        if self.is_perfect(values) {
            return (pose.position_mm - self.mountings[mounting].coincidence_mm).norm();
        }
        let ball_mm =
            self.machine.ball_vector_mm(&self.mountings[mounting], &pose.position_mm, errors);
        let length_mm = ball_mm.norm();
        let direction = ball_mm / length_mm.max(f64::MIN_POSITIVE);
        let longer = self.lengthening.iter().map(|&k| {
            let own = &values[self.first[k]..self.first[k + 1]];
            self.terms[k].lengthen(own, pose, motion, mounting, &direction)
        });
        length_mm + longer.sum::<f64>()
    }

    /// The situation at a pose; where the balls coincide the bar is taken to point along Z.
    pub fn situation(&self, pose: &Pose, motion: &Motion, mounting: usize) -> Situation {
        let balls = &self.mountings[mounting];
        let at = Situation::new(self.machine, balls, mounting, pose).unwrap_or_else(|| {
            let up = Vector3::ith(Axis::Z.index(), 1.0);
            Situation::along(self.machine, balls, mounting, pose, up)
        });
        Situation { motion: *motion, ..at }
    }

    /// The situation at a pose of the machine that is bent so by some values, as [`Self::errors`] says: its row is the
    /// derivative of [`Self::length_mm`] there.
    pub fn situation_bent(
        &self,
        errors: &ChainErrors,
        pose: &Pose,
        motion: &Motion,
        mounting: usize,
    ) -> Situation {
        let balls = &self.mountings[mounting];
        match Situation::bent(self.machine, balls, mounting, pose, errors) {
            Some(at) => Situation { motion: *motion, ..at },
            None => self.situation(pose, motion, mounting),
        }
    }

    /// The situation at a pose, seen along a unit vector: its row is what the parameters displace the tool by against
    /// the workpiece, in that direction.
    pub fn situation_along(
        &self,
        pose: &Pose,
        motion: &Motion,
        mounting: usize,
        direction: Vector3<f64>,
    ) -> Situation {
        let balls = &self.mountings[mounting];
        let at = Situation::along(self.machine, balls, mounting, pose, direction);
        Situation { motion: *motion, ..at }
    }
}
