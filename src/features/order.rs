//! The order in which to repair.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::feature::{Feature, Left};
use super::readings::Readings;
use super::volume::Volume;
use crate::error::Result;

/// A feature, and what it does.
pub(super) struct Deed {
    pub(super) feature: Feature,
    /// What it adds to each reading, mm.
    pub(super) adds_mm: Vec<f64>,
    /// By what it displaces each point of the sphere, mm; `None` where that is nothing, or where not all axes moved.
    pub(super) moves_mm: Option<Vec<Vector3<f64>>>,
}

/// Features in the order of repair: of those that are told apart from 0 the next one is always that without which, those before
/// it gone, least is left of the deviation. After them the others, the largest fall first.
pub(super) fn of(
    readings: &Readings,
    mut volume: Option<Volume>,
    all: Vec<Deed>,
) -> Result<Vec<Feature>> {
    let (mut told, untold): (Vec<Deed>, Vec<Deed>) =
        all.into_iter().partition(|of| of.feature.is_told());
    let mut untold: Vec<Feature> = untold.into_iter().map(|of| of.feature).collect();
    untold.sort_by(|a, b| b.fall_mm.total_cmp(&a.fall_mm));
    let mut ordered = Vec::with_capacity(told.len() + untold.len());
    let mut gone_mm = vec![0.0; readings.count()];
    while !told.is_empty() {
        let left_mm = |of: &Deed| {
            let gone_mm: Vec<f64> = gone_mm.iter().zip(&of.adds_mm).map(|(a, b)| a + b).collect();
            readings.deviation_without_mm(&gone_mm, 1.0)
        };
        let left_mm: Vec<f64> = told.par_iter().map(left_mm).collect::<Result<_>>()?;
        let least = (0..told.len()).min_by(|a, b| left_mm[*a].total_cmp(&left_mm[*b]));
        let Some(next) = least else { break };
        let Deed { feature, adds_mm, moves_mm } = told.remove(next);
        gone_mm.iter_mut().zip(&adds_mm).for_each(|(gone, adds)| *gone += adds);
        if let Some(moves_mm) = moves_mm {
            volume = volume.map(|volume| volume.without(&moves_mm));
        }
        let volumetric_mm = volume.as_ref().map(Volume::rms_mm);
        let then = Some(Left { deviation_mm: left_mm[next], volumetric_mm });
        ordered.push(Feature { then, ..feature });
    }
    ordered.extend(untold);
    Ok(ordered)
}
