//! Error functions: 90 numbers that say how every slide errs at every position.

use nalgebra::Vector3;

use super::coefficient::Coefficient;
use crate::machine::{Axis, Pose, SlideError};

/// The 90 coefficients as numbers, mm and rad.
///
/// The simulator bends the exact chain with these; it does not use the terms' columns, so a wrong
/// column cannot agree with itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ErrorFunctions {
    /// `[slide][component][power]`.
    values: [[[f64; 5]; 6]; 3],
}

impl ErrorFunctions {
    /// Value of a coefficient, in its unit.
    pub fn get(&self, of: Coefficient) -> f64 {
        self.values[of.slide.index()][of.component as usize][of.power as usize]
    }

    /// Sets a coefficient, in its unit.
    pub fn set(&mut self, of: Coefficient, value: f64) {
        self.values[of.slide.index()][of.component as usize][of.power as usize] = value;
    }

    /// The six errors of a slide at a pose (paper, Eq. 3).
    pub fn slide_error(&self, slide: Axis, pose: &Pose) -> SlideError {
        let h = pose.position_mm[slide.index()];
        let b = pose.sense[slide.index()];
        let error = |component: usize| {
            let [e0, e1, e2, e3, eb] = self.values[slide.index()][component];
            e0 + h * (e1 + h * (e2 + h * e3)) + b * eb
        };
        SlideError {
            translation_mm: Vector3::new(error(0), error(1), error(2)),
            rotation_rad: Vector3::new(error(3), error(4), error(5)),
        }
    }
}
