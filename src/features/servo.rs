//! Servo mismatch: what one axis of the plane follows later than the other.

use super::feature::{Feature, Kind};
use super::scene::{Draft, Scene};
use crate::machine::Axis;
use crate::model::{Form, HeldEffect, Seat, Situation};

const MS: f64 = 1e3;

/// Whether an effect makes one axis follow later.
pub(super) fn is_delay(held: &HeldEffect) -> bool {
    match &held.form {
        Form::Cause(shape) => shape.cause.id == "servo" && matches!(shape.seat, Seat::Slide(_)),
        Form::Empirical(_) => false,
    }
}

/// What the times of the runs know of it, and what was found.
pub(super) fn draft<'a>(scene: &'a Scene<'a>) -> Option<Draft<'a>> {
    let [a, b] = scene.axes;
    // Terms of the model.
    let named = |axis: Axis| {
        let estimates = scene.identification.estimates.iter();
        estimates.filter(move |estimate| estimate.parameter.id.delays() == Some(axis))
    };
    let later_s = |run: usize, axis: Axis| {
        let found = scene.held.iter().filter(|held| is_delay(held) && held.is_in(run));
        let found_s: f64 = found.filter_map(|held| held.follows_later_s(Some(axis))).sum();
        let map = &scene.identification.runs[run].alignment.time_map;
        let named_s: f64 = named(axis).map(|estimate| estimate.value).sum();
        map.delays_s[axis.index()] + found_s + named_s
    };
    let mismatch_s: Vec<f64> =
        (0..scene.identification.runs.len()).map(|run| later_s(run, a) - later_s(run, b)).collect();
    // Two that stand against each other: what the one does not know the other does not, with the other sign.
    let sigma_s = |run: usize| {
        let sigmas = &scene.identification.runs[run].alignment.time_map.delay_sigmas_s;
        sigmas[a.index()] + sigmas[b.index()]
    };
    let count = scene.runs.len().max(1) as f64;
    let value_s = scene.runs.iter().map(|run| mismatch_s.get(*run)).sum::<Option<f64>>()? / count;
    let square: f64 = scene.runs.iter().map(|run| sigma_s(*run).powi(2)).sum();
    let named_s = [a, b].into_iter().flat_map(named).map(|estimate| estimate.sigma);
    let noise_s = named_s.fold(square.sqrt() / count, f64::hypot);
    let noise = Some(noise_s * MS);
    let column = move |at: &Situation, run: usize| {
        let (u, v) = (&at.direction, &at.motion.velocity_mm_s);
        let half_s = 0.5 * mismatch_s.get(run).copied().unwrap_or(0.0);
        half_s * (u[b.index()] * v[b.index()] - u[a.index()] * v[a.index()])
    };
    let of = Feature::of(Kind::ServoMismatch(a, b), "ms", value_s * MS, [noise, noise]);
    let feature = Feature { size_mm: Some(value_s.abs() * scene.feed_mm_s), ..of };
    Some(Draft { feature, column: Box::new(column) })
}
