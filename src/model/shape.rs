//! Effects as terms: what the causes that diagnosis knows do to the length.
//!
//! The column of an effect is `s(pose) · f(motion; shape)`: `s` is what the length is sensitive to, the
//! effect's [`Seat`], and `f` hangs on few numbers, such as a period or a time constant, that are held
//! while the term is part of a model. Diagnosis estimates them; see the room `diagnose`.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use nalgebra::Vector3;

use super::cause::{Cause, Kind};
use super::coefficient::Ball;
use super::effect::{Effect, Seat};
use super::harmonics::harmonics;
use super::jacobian::Situation;
use super::motion::{Corner, Motion};
use super::term::{Parameter, Term};
use crate::error::{Error, Result};
use crate::machine::{ChainErrors, Pose};

impl Seat {
    /// What the length gains where this is displaced by one of its unit, mm per mm or rad.
    ///
    /// A slide as a whole is displaced in the programmed sense: the tool against the workpiece.
    pub fn sensitivity(self, at: &Situation) -> f64 {
        match self {
            Self::Function(slide, component) => {
                let gradient = &at.slides[slide.index()];
                let along = if component.is_angular() {
                    &gradient.rotation_mm
                } else {
                    &gradient.translation
                };
                along[component.direction()]
            }
            Self::Slide(axis) => at.direction[axis.index()],
            Self::Ball(set_up) => match set_up.ball {
                Ball::Tool => at.direction[set_up.axis.index()],
                Ball::Workpiece => -at.direction[set_up.axis.index()],
            },
            Self::Coefficient(of) => {
                let mut column = [0.0];
                of.columns(at, &mut column);
                column[0]
            }
            Self::Bar | Self::Whole => 1.0,
        }
    }

    /// Displaces this in the exact chain by an amount in mm or rad; the length of the bar is none of it.
    pub(super) fn displace(
        self,
        amount: f64,
        pose: &Pose,
        motion: &Motion,
        errors: &mut ChainErrors,
    ) {
        match self {
            Self::Function(slide, component) => {
                let slide = &mut errors.slides[slide.index()];
                let of = if component.is_angular() {
                    &mut slide.rotation_rad
                } else {
                    &mut slide.translation_mm
                };
                of[component.direction()] += amount;
            }
            // The tool against the workpiece: at the tool, whichever side the slide is on.
            Self::Slide(axis) => errors.tool_ball_mm[axis.index()] += amount,
            Self::Ball(set_up) => {
                let ball = match set_up.ball {
                    Ball::Tool => &mut errors.tool_ball_mm,
                    Ball::Workpiece => &mut errors.workpiece_ball_mm,
                };
                ball[set_up.axis.index()] += amount;
            }
            Self::Coefficient(of) => of.bend(&[amount], pose, motion, 0, errors),
            Self::Bar | Self::Whole => {}
        }
    }
}

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
    /// The name of the inner number among the keys of its cause.
    pub fn inner_key(cause: &Cause, seat: Seat) -> Option<&'static str> {
        Some(match cause.kind {
            Kind::Servo if seat == Seat::Whole => "delay_ms",
            Kind::Cyclic => "period_mm",
            Kind::ReversalSpike => "decay_ms",
            Kind::PreSliding => "distance_mm",
            Kind::Drift => "time_constant_s",
            Kind::Knock => "moment_s",
            Kind::Roundness | Kind::Degree => "degree",
            Kind::Vibration => "frequency_hz",
            Kind::StickSlip => "speed_mm_min",
            _ => return None,
        })
    }

    /// The shape of an effect; `None` for a cause that has no column of its own.
    pub fn of(effect: &Effect) -> Option<Self> {
        let bends = !matches!(
            effect.cause.kind,
            Kind::FeedOverride | Kind::Clock | Kind::BallPlace | Kind::Pivot
        );
        (effect.cause.known && bends).then(|| Self {
            cause: effect.cause,
            seat: effect.seat,
            inner: Self::inner_key(effect.cause, effect.seat).map(|key| effect.get(key)),
        })
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
            let inner = Self::inner_key(cause, seat);
            for key in cause.keys.iter().filter(|key| Some(key.name) != inner) {
                let name = key.written(seat).0;
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
        let inner = Self::inner_key(self.cause, self.seat).zip(self.inner).map(|(key, inner)| {
            let si = self.cause.keys.iter().find(|k| k.name == key).map_or(1.0, |k| k.si);
            format!("{key}={}", (inner / si * 1e9).round() / 1e9)
        });
        let parts: Vec<String> = on.into_iter().chain(inner).collect();
        format!("{}:{}", self.cause.id, parts.join(","))
    }

    /// How many amplitudes it has.
    pub fn amplitudes(&self) -> usize {
        match self.cause.kind {
            // Sine and cosine.
            Kind::Cyclic | Kind::Vibration => 2,
            Kind::Roundness => 2 * self.inner.unwrap_or(0.0) as usize + 1,
            _ => 1,
        }
    }

    /// `f`: what one of each amplitude does to the seat at a pose, with the bar along a unit vector.
    pub fn factors(&self, pose: &Pose, motion: &Motion, direction: &Vector3<f64>, out: &mut [f64]) {
        let inner = self.inner.unwrap_or(0.0);
        let slide = match self.seat {
            Seat::Function(slide, _) | Seat::Slide(slide) => slide.index(),
            _ => 0,
        };
        let (h_mm, b) = (pose.position_mm[slide], pose.sense[slide]);
        let wave = |turns: f64, out: &mut [f64]| (out[0], out[1]) = (turns * TAU).sin_cos();
        match self.cause.kind {
            Kind::Cyclic => wave(h_mm / inner, out),
            Kind::Vibration => wave(motion.elapsed_s * inner, out),
            // A delay that all slides have in common is one of the log. What is not is that commanded
            // position and velocity do not turn the corner at the same time.
            Kind::Servo if self.seat == Seat::Whole => {
                let Corner { ahead_s, jump_mm_s } = motion.corner;
                out[0] = if ahead_s < inner { -ahead_s * jump_mm_s.dot(direction) } else { 0.0 };
            }
            Kind::Servo => out[0] = -motion.velocity_mm_s[slide],
            Kind::ReversalSpike => {
                out[0] = motion.reversals[slide].map_or(0.0, |r| b * (-r.ago_s / inner).exp());
            }
            Kind::GrowingBacklash => out[0] = b * h_mm,
            Kind::PreSliding => {
                let left = motion.reversals[slide].map_or(0.0, |r| (-r.ago_mm / inner).exp());
                out[0] = b * (1.0 - 2.0 * left);
            }
            Kind::Drift => out[0] = -(-motion.elapsed_s.max(0.0) / inner).exp_m1(),
            Kind::Knock => out[0] = if motion.elapsed_s > inner { 1.0 } else { 0.0 },
            Kind::Roundness => harmonics(inner as usize, direction, out),
            Kind::Degree => out[0] = (h_mm / 100.0).powi(inner as i32),
            Kind::StickSlip => out[0] = -b * (-motion.velocity_mm_s[slide].abs() / inner).exp(),
            _ => out[0] = 1.0,
        }
    }

    /// The effects that these amplitudes are.
    pub fn effects(&self, amplitudes: &[f64]) -> Vec<Effect> {
        let numbers = |amplitude: f64, phase_rad: f64, order: f64| {
            let number = |name: &str| match name {
                "phase_rad" => phase_rad,
                "order" => order,
                "run" => 1.0,
                name if Some(name) == Self::inner_key(self.cause, self.seat) => {
                    self.inner.unwrap_or(0.0)
                }
                _ => amplitude,
            };
            Effect::new(
                self.cause,
                self.seat,
                self.cause.keys.iter().map(|k| number(k.name)).collect(),
            )
        };
        match self.cause.kind {
            Kind::Cyclic | Kind::Vibration => {
                let (sine, cosine) = (amplitudes[0], amplitudes[1]);
                vec![numbers(sine.hypot(cosine), cosine.atan2(sine), 0.0)]
            }
            Kind::Roundness => {
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
        match (Self::inner_key(self.cause, self.seat), self.inner) {
            (Some(key), Some(inner)) => {
                let si = self.cause.keys.iter().find(|k| k.name == key).map_or(1.0, |k| k.si);
                let unit = match key.rsplit_once('_') {
                    Some((_, "min")) => " mm/min".to_owned(),
                    Some((_, unit)) => format!(" {}", unit.replace("hz", "Hz")),
                    None => String::new(),
                };
                format!("{name} {}{unit}", rounded(inner / si))
            }
            _ => name,
        }
    }

    /// Unit of the amplitudes.
    fn unit(&self) -> &'static str {
        match (self.cause.kind, self.seat) {
            (Kind::Servo, Seat::Whole) => "1",
            (Kind::Servo, _) => "s",
            (Kind::GrowingBacklash, Seat::Function(_, component)) if component.is_angular() => {
                "rad/mm"
            }
            (Kind::GrowingBacklash, _) => "mm/mm",
            (_, Seat::Coefficient(of)) => of.unit(),
            (_, Seat::Function(_, component)) if component.is_angular() => "rad",
            _ => "mm",
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
        let of = |part: String| Parameter { name: format!("{name}{part}"), unit: self.unit() };
        match (self.cause.kind, self.amplitudes()) {
            (Kind::Cyclic | Kind::Vibration, _) => vec![of(" sin".into()), of(" cos".into())],
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
        if matches!(self.seat, Seat::Bar | Seat::Whole) {
            return;
        }
        let mut factors = [0.0; 2];
        let factors = &mut factors[..values.len()];
        // The direction matters to what lengthens only.
        self.factors(at, motion, &Vector3::z(), factors);
        let amount = values.iter().zip(factors).map(|(value, factor)| value * *factor).sum();
        self.seat.displace(amount, at, motion, errors);
    }

    fn lengthen(
        &self,
        values: &[f64],
        at: &Pose,
        motion: &Motion,
        _mounting: usize,
        direction: &Vector3<f64>,
    ) -> f64 {
        if !matches!(self.seat, Seat::Bar | Seat::Whole) {
            return 0.0;
        }
        let mut factors = vec![0.0; values.len()];
        self.factors(at, motion, direction, &mut factors);
        values.iter().zip(factors).map(|(value, factor)| value * factor).sum()
    }
}
