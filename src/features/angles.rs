//! Rotations of the axes about the normal of the plane, as far as they act beside the middle lines.

use super::feature::Kind;
use super::geometry::feature;
use super::scene::{Draft, Scene};
use crate::identify::Asked;
use crate::model::{Local, ParameterId, Situation};

const URAD: f64 = 1e6;

/// Only where the machine was described at the place of the test: elsewhere a rotation displaces the middle lines too.
pub(super) fn drafts<'a>(scene: &'a Scene<'a>) -> Vec<Draft<'a>> {
    let parameters = scene.model.parameters();
    let of = |axis| {
        let turns: Vec<usize> = (0..parameters.len())
            .filter(|k| {
                matches!(parameters[*k].id, ParameterId::Local(Local { slide, component, .. })
                    if slide == axis && component.is_angular())
            })
            .collect();
        let [answer] = scene.ask([Asked::Angle(axis, scene.normal)]);
        let answer = answer.filter(|_| !turns.is_empty())?;
        let column = move |at: &Situation, _| {
            let mut row = vec![0.0; parameters.len()];
            scene.model.row(at, &mut row);
            turns.iter().map(|k| row[*k] * scene.values[*k]).sum()
        };
        let feature = feature(Kind::Angle(axis, scene.normal), &answer, "urad", URAD);
        Some(Draft { feature, column: Box::new(column) })
    };
    scene.axes.into_iter().filter_map(of).collect()
}
