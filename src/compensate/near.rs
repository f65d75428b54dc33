//! Where something was measured near.

use nalgebra::Vector3;

use super::error_model::ErrorModel;

/// Farther from what was measured than this part of the bar, nobody has looked: the errors of a smooth way change by little
/// over it.
const NEAR: f64 = 0.1;

/// The part of the volume about which a test says something: within the spheres of its mountings, as far as the slides went.
#[derive(Debug)]
pub struct Measured<'a> {
    errors: &'a ErrorModel,
}

impl<'a> Measured<'a> {
    /// By the test of an error model.
    pub fn by(errors: &'a ErrorModel) -> Self {
        Self { errors }
    }

    /// How far machine coordinates are from there, mm; 0 within.
    pub fn beyond_mm(&self, position_mm: &Vector3<f64>) -> f64 {
        let frame = &self.errors.frame;
        let aside = (position_mm - frame.middle_mm).abs() - frame.reach_mm;
        let spheres = self.errors.mountings.iter().zip(&self.errors.bar_lengths_mm);
        let outside = spheres
            .map(|((_, balls), length)| (position_mm - balls.coincidence_mm).norm() - length)
            .fold(f64::INFINITY, f64::min);
        aside.max().max(outside).max(0.0)
    }

    /// Whether something was measured near.
    pub fn is_near(&self, position_mm: &Vector3<f64>) -> bool {
        let shortest = self.errors.bar_lengths_mm.iter().copied().fold(f64::INFINITY, f64::min);
        self.beyond_mm(position_mm) <= NEAR * shortest
    }

    /// Lowest and highest coordinates to which the slides went, mm.
    pub fn range_mm(&self) -> [Vector3<f64>; 2] {
        let frame = &self.errors.frame;
        [frame.middle_mm - frame.reach_mm, frame.middle_mm + frame.reach_mm]
    }
}
