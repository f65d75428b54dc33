//! The figures of a plan.

pub(super) mod bars;
pub(super) mod sphere;
pub(super) mod volume_map;
