//! Findings of the diagnosis, each with what it does to this test.

use super::backlash::{grows, lies_in};
use super::feature::{Feature, Kind};
use super::scene::{Draft, Scene, added_mm};
use super::servo::is_delay;
use crate::diagnose::Finding;
use crate::model::{HeldEffect, Seat, Situation};

const MM: f64 = 1e-3;

/// One a finding; what is a part of backlash or servo mismatch stands there.
pub(super) fn drafts<'a>(scene: &'a Scene<'a>) -> Vec<Draft<'a>> {
    let found = scene.found();
    let part = |held: &HeldEffect| {
        let in_plane = |axes: [_; 2]| axes.iter().all(|axis| scene.axes.contains(axis));
        let delays = scene.axes.iter().any(|axis| held.follows_later_s(Some(*axis)).is_some());
        grows(&held.form).is_some_and(in_plane) || (is_delay(held) && delays)
    };
    let of = |(k, finding): (usize, &Finding)| {
        let held: Vec<&HeldEffect> =
            found.iter().filter(|(of, _)| *of == k).map(|(_, held)| *held).collect();
        if held.is_empty() || held.iter().any(|held| part(held)) {
            return None;
        }
        let feature = feature(scene, k, finding);
        let column =
            move |at: &Situation, run: usize| held.iter().map(|held| added_mm(held, at, run)).sum();
        Some(Draft { feature, column: Box::new(column) })
    };
    scene.findings.iter().enumerate().filter_map(of).collect()
}

fn feature(scene: &Scene, k: usize, of: &Finding) -> Feature {
    let number = of.numbers.first();
    let value = number.map_or(of.rms_mm / MM, |number| number.value);
    let sigma = number.and_then(|number| number.sigma);
    let shape = of.element.shape();
    let size_mm = shape.and_then(|shape| match (shape.cause.id, shape.seat) {
        ("reversal-spike", Seat::Slide(axis)) if scene.axes.contains(&axis) => {
            Some(value.abs() * MM)
        }
        // From peak to peak.
        ("cyclic", Seat::Function(axis, component))
            if scene.axes.contains(&axis) && lies_in(component, scene.axes) =>
        {
            Some(2.0 * value.abs() * MM)
        }
        _ => None,
    });
    let spike = shape.is_some_and(|shape| shape.cause.id == "reversal-spike");
    // Outward on the circle, as backlash is.
    let at_ends = spike.then_some([-value, -value]);
    let unit = number.map_or("um", |number| number.unit);
    let outward = if spike { -value } else { value };
    Feature { at_ends, size_mm, ..Feature::of(Kind::Found(k), unit, outward, [sigma, sigma]) }
}
