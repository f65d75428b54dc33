//! Effects as terms: what the causes that diagnosis knows do to the length.
//!
//! The column of an effect is `s(pose) · f(motion; shape)`: `s` is what the length is sensitive to, the
//! effect's [`Seat`], and `f`, its [`Law`], hangs on one number, such as a period or a time constant, that is
//! held while the term is part of a model. Diagnosis estimates it; see the room `diagnose`.

use std::fmt::Write as _;

use nalgebra::Vector3;

use super::cause::Cause;
use super::effect::Effect;
use super::jacobian::Situation;
use super::key::{Key, ORDER, PHASE, RUN};
use super::law::Law;
use super::motion::Motion;
use super::seat::Seat;
use super::term::{Parameter, ParameterId, Term};
use super::variable::Dependence;
use crate::error::{Error, Result};
use crate::machine::{Axis, ChainErrors, Pose};

/// An effect whose amplitudes are parameters and whose inner numbers are held.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Which cause.
    pub cause: &'static Cause,
    /// On what.
    pub seat: Seat,
    /// Its inner number, in mm, s, rad: a period, a time constant, a degree; none where it has none.
    pub inner: Option<f64>,
}

impl Shape {
    /// The shape of an effect; `None` for a cause that has no column of its own.
    pub fn of(effect: &Effect) -> Option<Self> {
        let Effect { cause, seat, .. } = *effect;
        let inner = cause.inner(seat).map(|(inner, _)| effect.get(inner.key));
        cause.law.is_term().then_some(Self { cause, seat, inner })
    }

    /// Reads `CAUSE:on=SEAT,inner=number`: an effect without its amplitude, as the name of a term.
    ///
    /// # Errors
    /// As [`Effect::parse`]; a cause that no column stands for.
    pub fn parse(text: &str) -> Result<Self> {
        let (id, rest) = text.split_once(':').unwrap_or((text, ""));
        let given = |name: &str| {
            rest.split(',').any(|pair| pair.split('=').next().is_some_and(|key| key.trim() == name))
        };
        let mut whole = text.to_owned();
        if let Some(cause) = Cause::named(id) {
            let on = rest.split(',').find_map(|pair| pair.trim().strip_prefix("on="));
            let seat = on.and_then(Seat::parse).unwrap_or(Seat::Whole);
            let inner = cause.inner(seat).map(|(inner, _)| inner.key);
            for key in cause.keys.iter().filter(|key| Some(key.name) != inner) {
                let name = key.written(seat);
                if !given(&name) {
                    let _ = write!(whole, ",{name}={}", key.default.unwrap_or(1.0));
                }
            }
        }
        let effect = Effect::parse(&whole)?;
        Self::of(&effect).ok_or_else(|| {
            Error::input(format!("`{id}` is no term: it is not one column of the model"))
                .hint("terms are causes that act on a seat, such as `cyclic:on=EXX,period_mm=10`")
        })
    }

    /// The name as a term: what [`parse`](Self::parse) reads.
    pub fn term_name(&self) -> String {
        let on = (self.seat != Seat::Whole).then(|| format!("on={}", self.seat));
        let inner = self.inner_as_written().map(|(key, inner)| {
            format!("{}={}", key.written(self.seat), (inner * 1e9).round() / 1e9)
        });
        let parts: Vec<String> = on.into_iter().chain(inner).collect();
        format!("{}:{}", self.cause.id, parts.join(","))
    }

    /// The key of its inner number, and the number as it is written.
    fn inner_as_written(&self) -> Option<(&'static Key, f64)> {
        let (_, key) = self.cause.inner(self.seat)?;
        Some((key, self.inner? / key.unit(self.seat).si))
    }

    /// What it does.
    pub fn law(&self) -> &'static Law {
        self.cause.law(self.seat)
    }

    /// What it displaces and what it hangs on, where that is one variable.
    pub fn dependence(&self) -> Option<Dependence> {
        let over = self.law().over()?;
        // Time is no axis's.
        let variable = (over.variable)(self.seat.axis().unwrap_or(Axis::X));
        Some(Dependence { seat: self.seat, variable, with_sense: over.with_sense })
    }

    /// How many amplitudes it has.
    pub fn amplitudes(&self) -> usize {
        self.law().amplitudes(self.inner)
    }

    /// What one of each amplitude does to the seat at a pose, with the bar along a unit vector.
    pub fn factors(&self, pose: &Pose, motion: &Motion, direction: &Vector3<f64>, out: &mut [f64]) {
        let axis = self.seat.axis().unwrap_or(Axis::X);
        self.law().at(axis, self.inner.unwrap_or(0.0), pose, motion, direction, out);
    }

    /// The effects that these amplitudes are.
    pub fn effects(&self, amplitudes: &[f64]) -> Vec<Effect> {
        let inner_key = self.cause.inner(self.seat).map(|(inner, _)| inner.key);
        let numbers = |amplitude: f64, phase_rad: f64, order: f64| {
            let number = |name: &str| match name {
                PHASE => phase_rad,
                ORDER => order,
                RUN => 1.0,
                name if Some(name) == inner_key => self.inner.unwrap_or(0.0),
                _ => amplitude,
            };
            Effect::new(
                self.cause,
                self.seat,
                self.cause.keys.iter().map(|k| number(k.name)).collect(),
            )
        };
        match self.law() {
            Law::Wave(..) => {
                let (sine, cosine) = (amplitudes[0], amplitudes[1]);
                vec![numbers(sine.hypot(cosine), cosine.atan2(sine), 0.0)]
            }
            Law::Harmonics(_) => {
                let degree = amplitudes.len() as f64 / 2.0 - 0.5;
                let each = amplitudes.iter().enumerate();
                each.map(|(k, amplitude)| numbers(*amplitude, 0.0, k as f64 - degree)).collect()
            }
            _ => vec![numbers(amplitudes[0], 0.0, 0.0)],
        }
    }

    /// What it is called in a table: `cyclic EXX 10.00 mm`.
    pub fn name(&self) -> String {
        let mut name = self.cause.id.to_owned();
        if self.seat != Seat::Whole {
            name = format!("{name} {}", self.seat);
        }
        match self.inner_as_written() {
            Some((key, inner)) => {
                format!("{name} {} {}", rounded(inner), key.unit(self.seat).symbol)
                    .trim_end()
                    .to_owned()
            }
            None => name,
        }
    }

    /// The slide that it lets follow later than the others, as much as its amplitude says.
    pub fn delays(&self) -> Option<Axis> {
        match (self.law(), self.seat) {
            (Law::Curve(..), Seat::Slide(slide)) if self.cause.id == "servo" => Some(slide),
            _ => None,
        }
    }

    /// Unit of the amplitudes.
    fn unit(&self) -> &'static str {
        match (self.law(), self.seat) {
            (Law::Corner(_), _) => "1",
            (_, Seat::Coefficient(of)) => of.unit(),
            _ => self.cause.keys.first().map_or("1", |key| key.unit(self.seat).base),
        }
    }
}

/// Four digits.
fn rounded(value: f64) -> f64 {
    let digits = 10f64.powi(3 - value.abs().max(1e-30).log10().floor() as i32);
    (value * digits).round() / digits
}

impl Term for Shape {
    fn parameters(&self) -> Vec<Parameter> {
        let name = self.name();
        let of = |part: String| Parameter {
            id: self.delays().map_or(ParameterId::Amplitude, ParameterId::Delay),
            name: format!("{name}{part}"),
            unit: self.unit(),
            plausible: None,
        };
        match (self.law(), self.amplitudes()) {
            (Law::Wave(..), _) => vec![of(" sin".into()), of(" cos".into())],
            (_, 1) => vec![of(String::new())],
            (_, count) => (0..count)
                .map(|k| of(format!(" order {}", k as i64 - (count as i64 - 1) / 2)))
                .collect(),
        }
    }

    fn parameter_count(&self) -> usize {
        self.amplitudes()
    }

    fn columns(&self, at: &Situation, out: &mut [f64]) {
        self.factors(&at.pose, &at.motion, &at.direction, out);
        let sensitivity = self.seat.sensitivity(at);
        for value in out {
            *value *= sensitivity;
        }
    }

    fn bend(
        &self,
        values: &[f64],
        at: &Pose,
        motion: &Motion,
        _mounting: usize,
        errors: &mut ChainErrors,
    ) {
        if self.lengthens() {
            return;
        }
        let mut factors = [0.0; 2];
        let factors = &mut factors[..values.len()];
        // The direction matters to what lengthens only.
        self.factors(at, motion, &Vector3::z(), factors);
        let amount = values.iter().zip(factors).map(|(value, factor)| value * *factor).sum();
        self.seat.displace(amount, at, motion, errors);
    }

    fn lengthens(&self) -> bool {
        self.seat.lengthens()
    }

    fn lengthen(
        &self,
        values: &[f64],
        at: &Pose,
        motion: &Motion,
        _mounting: usize,
        direction: &Vector3<f64>,
    ) -> f64 {
        if !self.lengthens() {
            return 0.0;
        }
        let mut factors = vec![0.0; values.len()];
        self.factors(at, motion, direction, &mut factors);
        values.iter().zip(factors).map(|(value, factor)| value * factor).sum()
    }
}
