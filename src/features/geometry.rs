//! Squareness, scale mismatch, straightness and positioning.

use super::feature::{Feature, Kind};
use super::scene::{Draft, Scene};
use crate::identify::{Answer, Asked, bent};
use crate::machine::Axis;
use crate::model::Situation;

/// One mm/m is so many um/m, one mm so many um.
const UM_M: f64 = 1e6;
const UM: f64 = 1e3;

/// A feature of an answer, in a unit of which one mm/mm or mm is so many.
pub(super) fn feature(kind: Kind, of: &Answer, unit: &'static str, factor: f64) -> Feature {
    let known = [Some(of.noise * factor), of.all.map(|all| all * factor)];
    Feature::of(kind, unit, of.value * factor, known)
}

/// What the geometry of the two axes does.
pub(super) fn drafts<'a>(scene: &'a Scene<'a>) -> Vec<Draft<'a>> {
    let [a, b] = scene.axes;
    let mut drafts = Vec::new();
    // Named as `at_the_place` names it, whichever axis of the plane is first.
    let [first, second] = if a < b { [a, b] } else { [b, a] };
    let [squareness, mismatch] =
        scene.ask([Asked::Squareness(first, second), Asked::ScaleMismatch(a, b)]);
    if let Some(answer) = squareness {
        let half = 0.5 * answer.value;
        let column = move |at: &Situation, _| {
            let (u, of) = (&at.direction, |axis| scene.beside_mm(at, axis));
            half * (u[a.index()] * of(b) + u[b.index()] * of(a))
        };
        let size_mm = Some(answer.value.abs() * scene.radius_mm);
        let of = feature(Kind::Squareness(first, second), &answer, "um/m", UM_M);
        drafts.push(Draft { feature: Feature { size_mm, ..of }, column: Box::new(column) });
    }
    if let Some(answer) = mismatch {
        let half = 0.5 * answer.value;
        let column = move |at: &Situation, _| {
            let (u, of) = (&at.direction, |axis| scene.beside_mm(at, axis));
            half * (u[a.index()] * of(a) - u[b.index()] * of(b))
        };
        let diameter_mm = 2.0 * scene.radius_mm;
        let size_mm = Some(answer.value.abs() * diameter_mm);
        let of = feature(Kind::ScaleMismatch(a, b), &answer, "um", UM * diameter_mm);
        drafts.push(Draft { feature: Feature { size_mm, ..of }, column: Box::new(column) });
    }
    for [axis, along] in [[a, b], [b, a], [a, a], [b, b]] {
        drafts.extend(bow(scene, axis, along));
    }
    drafts
}

/// What an axis errs by along another or along itself, about a straight line.
fn bow<'a>(scene: &'a Scene<'a>, axis: Axis, along: Axis) -> Option<Draft<'a>> {
    let straightness = axis != along;
    let (asked, kind) = if straightness {
        (Asked::Straightness(axis, along), Kind::Straightness(axis, along))
    } else {
        (Asked::Positioning(axis), Kind::Positioning(axis))
    };
    let [answer] = scene.ask([asked]);
    let answer = answer?;
    let curve = bent(scene.model, scene.frame, scene.values, [axis, along]);
    let (first, middle, last) =
        (curve.first()?[1], curve.get(curve.len() / 2)?[1], curve.last()?[1]);
    let column = move |at: &Situation, _| {
        at.direction[along.index()] * between(&curve, at.pose.position_mm[axis.index()])
    };
    let of = feature(kind, &answer, "um", UM);
    // Ballbar 20 knows straightness, and of positioning no more than the scale.
    let size_mm = straightness.then_some(answer.value.abs());
    let sag_mm = Some(middle - 0.5 * (first + last));
    Some(Draft { feature: Feature { sag_mm, size_mm, ..of }, column: Box::new(column) })
}

/// A curve between its points, level beyond its ends.
fn between(curve: &[[f64; 2]], at_mm: f64) -> f64 {
    let next = curve.partition_point(|[h, _]| *h < at_mm);
    let last = curve.len() - 1;
    let ([from, before], [to, after]) =
        (curve[next.clamp(1, last) - 1], curve[next.clamp(1, last)]);
    let share = ((at_mm - from) / (to - from)).clamp(0.0, 1.0);
    before + share * (after - before)
}
