//! Backlash and lateral play: what an axis steps by when it turns round.

use super::feature::Kind;
use super::geometry::feature;
use super::scene::{Draft, Scene};
use crate::identify::Asked;
use crate::machine::Axis;
use crate::model::{Component, Form, Seat, Situation};

const UM: f64 = 1e3;

/// What grows along the travel of an axis, where that was found.
struct Growth {
    /// Step from negative to positive motion, mm per mm of its machine coordinate.
    step: f64,
    /// Standard deviation of that.
    sigma: f64,
    /// From where on it grows, a coordinate of the axis, mm: there is none of it.
    from_mm: f64,
}

pub(super) fn drafts<'a>(scene: &'a Scene<'a>) -> Vec<Draft<'a>> {
    let [a, b] = scene.axes;
    let of = |[axis, along]: [Axis; 2]| step(scene, axis, along);
    [[a, a], [b, b], [a, b], [b, a]].into_iter().filter_map(of).collect()
}

fn step<'a>(scene: &'a Scene<'a>, axis: Axis, along: Axis) -> Option<Draft<'a>> {
    let backlash = axis == along;
    let (asked, kind) = if backlash {
        (Asked::Reversal(axis), Kind::Backlash(axis))
    } else {
        (Asked::LateralPlay(axis, along), Kind::LateralPlay(axis, along))
    };
    let [answer] = scene.ask([asked]);
    let answer = answer?;
    let k = axis.index();
    let [middle_mm, reach_mm] = [scene.frame.middle_mm[k], scene.frame.reach_mm[k]];
    let growth = growth(scene, axis, along);
    // The step is told beside what grows: here both are told where the test was.
    let [slope, at_middle] = growth.as_ref().map_or([0.0, answer.value], |growth| {
        [growth.step, answer.value + growth.step * (middle_mm - growth.from_mm)]
    });
    let outward = if backlash { -1.0 } else { 1.0 };
    let at_ends = [reach_mm, -reach_mm].map(|beside_mm| (at_middle + slope * beside_mm) * outward);
    let largest = if at_ends[0].abs() >= at_ends[1].abs() { at_ends[0] } else { at_ends[1] };
    let value = if growth.is_some() { largest } else { at_middle * outward };
    let mut of = feature(kind, &answer, "um", UM);
    of.value = value * UM + 0.0;
    of.size_mm = Some(value.abs());
    of.at_ends = (backlash || growth.is_some()).then(|| at_ends.map(|mm| mm * UM + 0.0));
    if let Some(growth) = &growth {
        // The noise of the step beside what grows is that of both where it begins to grow.
        let common: f64 = answer.in_common.iter().map(|c| c * c).sum();
        let alone = (answer.noise.powi(2) - common).max(0.0).sqrt();
        let noise = alone.hypot(growth.sigma * reach_mm);
        let open = answer.all.map(|all| (all.powi(2) - answer.noise.powi(2)).max(0.0).sqrt());
        of.noise = Some(noise * UM);
        of.all = open.map(|open| noise.hypot(open) * UM);
    }
    let column = move |at: &Situation, _| {
        let step = at_middle + slope * scene.beside_mm(at, axis);
        0.5 * step * at.pose.sense[k] * at.direction[along.index()]
    };
    Some(Draft { feature: of, column: Box::new(column) })
}

/// Whether an effect is backlash that grows along an axis, and what it displaces.
pub(super) fn grows(form: &Form) -> Option<[Axis; 2]> {
    let Form::Cause(shape) = form else { return None };
    match shape.seat {
        Seat::Function(axis, component)
            if shape.cause.id == "growing-backlash" && !component.is_angular() =>
        {
            Some([axis, Axis::ALL[component.direction()]])
        }
        _ => None,
    }
}

fn growth(scene: &Scene, axis: Axis, along: Axis) -> Option<Growth> {
    let found = scene.found();
    let (k, held) = found.iter().find(|(_, held)| grows(&held.form) == Some([axis, along]))?;
    let sign = scene.model.machine().topology().side(axis).sign();
    let number = scene.findings.get(*k)?.numbers.first()?;
    let share = number.sigma.map_or(0.0, |sigma| (sigma / number.value).abs());
    let step = 2.0 * sign * held.amplitudes.first()?;
    let Form::Cause(shape) = &held.form else { return None };
    Some(Growth { step, sigma: step.abs() * share, from_mm: shape.inner.unwrap_or(0.0) })
}

/// Whether a component of a slide lies in a plane.
pub(super) fn lies_in(component: Component, axes: [Axis; 2]) -> bool {
    !component.is_angular() && axes.contains(&Axis::ALL[component.direction()])
}
