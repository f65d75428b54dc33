//! Rotations of the slides about the normal of the plane, as far as they act beside the middle lines.

use nalgebra::Vector3;

use super::feature::Kind::{Angle, AngularReversal};
use super::geometry::feature;
use super::scene::{Draft, Scene};
use crate::identify::Asked;
use crate::machine::{Axis, Pose};
use crate::model::{Motion, ParameterId, Situation};

const URAD: f64 = 1e6;

/// What a slide turns by displaces its own middle line and, at the middle, those of the other slides: squareness, scale and
/// straightness have that. Here is the rest.
pub(super) fn drafts<'a>(scene: &'a Scene<'a>) -> Vec<Draft<'a>> {
    let normal = scene.normal;
    // A slide that stands still where it came to turns by its reversal, and else as a set-up error does.
    let stands =
        (scene.frame.reach_mm[normal.index()] > 0.0).then_some(AngularReversal(normal, normal));
    let moves = scene.axes.map(|axis| Angle(axis, normal));
    let of = |kind| {
        let (axis, asked) = match kind {
            Angle(axis, about) => (axis, Asked::Angle(axis, about)),
            AngularReversal(axis, about) => (axis, Asked::AngularReversal(axis, about)),
            _ => return None,
        };
        let turns = turns(scene, axis)?;
        let [answer] = scene.ask([asked]);
        let column = move |at: &Situation, _| {
            let here = at.pose;
            let alone = Pose { position_mm: scene.at_middle(&here, |slide| slide == axis), ..here };
            let others = Pose {
                position_mm: scene.at_middle(&here, |slide| slide != axis),
                sense: Vector3::zeros(),
            };
            let middle = Pose { position_mm: scene.frame.middle_mm, sense: Vector3::zeros() };
            let does = |pose: &Pose| {
                let of =
                    scene.model.situation_along(pose, &Motion::REST, at.mounting, at.direction);
                let mut row = vec![0.0; scene.values.len()];
                scene.model.row(&of, &mut row);
                turns.iter().map(|k| row[*k] * scene.values[*k]).sum::<f64>()
            };
            does(&here) - does(&alone) - (does(&others) - does(&middle))
        };
        let feature = feature(kind, &answer?, "urad", URAD);
        Some(Draft { feature, column: Box::new(column) })
    };
    moves.into_iter().chain(stands).filter_map(of).collect()
}

/// The parameters that turn a slide about the normal of the plane; `None` where the model has none.
fn turns(scene: &Scene, slide: Axis) -> Option<Vec<usize>> {
    let of = |id: ParameterId| match id {
        ParameterId::Local(of) => Some((of.slide, of.component)),
        ParameterId::Coefficient(of) => Some((of.slide, of.component)),
        ParameterId::SetUp(..) | ParameterId::Amplitude | ParameterId::Delay(_) => None,
    };
    let about_normal = |id: ParameterId| {
        of(id).is_some_and(|(of, component)| {
            of == slide && component.is_angular() && component.direction() == scene.normal.index()
        })
    };
    let parameters = scene.model.parameters();
    let turns: Vec<usize> =
        (0..parameters.len()).filter(|k| about_normal(parameters[*k].id)).collect();
    (!turns.is_empty()).then_some(turns)
}
