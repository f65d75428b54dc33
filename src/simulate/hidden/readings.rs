//! Effects on the balls and on the bar.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::harmonics::harmonic;
use crate::machine::ChainErrors;
use crate::model::{AMPLITUDE, Ball, Effect, Seat};
use crate::simulate::bend::Condition;

/// Adds the displacements of the balls, in the frames of their slides, mm.
pub(crate) fn add_to_balls(hidden: &[Effect], now: &Condition, errors: &mut ChainErrors) {
    for effect in hidden {
        let Seat::Ball(of) = effect.seat else { continue };
        let ball_mm = match of.ball {
            Ball::Workpiece => &mut errors.workpiece_ball_mm,
            Ball::Tool => &mut errors.tool_ball_mm,
        };
        ball_mm[of.axis.index()] += match effect.cause.id {
            "drift" => warmed(effect, now.elapsed_s),
            "vibration" => swing(effect, now.elapsed_s),
            "knock" if now.elapsed_s > effect.get("moment") => effect.get("step"),
            "repeated-step" if now.program_s > effect.get("moment") => effect.get("step"),
            _ => 0.0,
        };
    }
}

/// What the bar reads beside the length that it spans, mm.
///
/// `ball_mm` is the vector from the workpiece ball to the tool ball in `F`. By how much the errors turn
/// the workpiece in `F`, some 0.1 mrad, is nothing beside the width of a harmonic.
pub(crate) fn reading_mm(hidden: &[Effect], now: &Condition, ball_mm: &Vector3<f64>) -> f64 {
    let reading = |effect: &Effect| match (effect.cause.id, effect.seat) {
        ("bar-length", _) => effect.get(AMPLITUDE),
        ("drift", Seat::Bar) => warmed(effect, now.elapsed_s),
        ("vibration", Seat::Bar) => swing(effect, now.elapsed_s),
        ("roundness", _) => {
            let (degree, order) = (effect.get("degree") as u32, effect.get("order") as i32);
            effect.get(AMPLITUDE) * harmonic(degree, order, &ball_mm.normalize())
        }
        _ => 0.0,
    };
    hidden.iter().map(reading).sum()
}

/// `A (1 - exp(-t / time constant))` in the unit of the amplitude.
pub(super) fn warmed(effect: &Effect, elapsed_s: f64) -> f64 {
    // exp_m1 keeps the digits of a time constant of months.
    -effect.get(AMPLITUDE) * (-elapsed_s / effect.get("time_constant")).exp_m1()
}

/// `A sin(2 pi frequency t + phase)`, mm.
fn swing(effect: &Effect, elapsed_s: f64) -> f64 {
    let turns = effect.get("frequency") * elapsed_s;
    effect.get(AMPLITUDE) * (TAU * turns + effect.get("phase")).sin()
}
