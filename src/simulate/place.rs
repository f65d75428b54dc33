//! A plausible machine: errors about the place of a test, drawn from what its machine file takes for plausible.
//!
//! Slide `k` displaces by `T(u)` and turns by `R(u)`, `u = (h - c) / r`, each a sum of `P1, P2, P3` of Legendre and the
//! sense; its rotation displaces nothing while the other slides stand at `c`:
//!
//! ```text
//! error of the slide = (T(u) - R(u) × r(h_own, c), R(u))
//! ```
//!
//! with the lever `r` of the exact chain. A simulated machine must not agree with a wrong column: the terms of the
//! room `model` are not used.

use nalgebra::Vector3;

use super::random::{Purpose, Stream};
use crate::machine::{Axis, Machine, Mounting, Pose, SlideError};
use crate::model::{Local, LocalShape};

/// Nothing beyond so many standard deviations is drawn: beyond three a fit would tell that it is more than plausible.
pub(super) const MOST_SIGMAS: f64 = 2.0;

/// Errors of three slides about a place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceErrors {
    /// `c`: machine coordinates of X, Y, Z, mm.
    pub middle_mm: Vector3<f64>,
    /// `r`: the half range of each, mm.
    pub reach_mm: Vector3<f64>,
    /// The mounting whose lever it is.
    mounting: Mounting,
    /// `[slide][component][shape]`, mm and rad.
    values: [[[f64; 4]; 6]; 3],
}

impl PlaceErrors {
    /// Draws the errors of a machine about the middle of these mountings, `reach_mm` from the ball of each; `None`
    /// where there are none.
    pub fn drawn(
        machine: &Machine,
        mountings: &[Mounting],
        reach_mm: f64,
        seed: u64,
    ) -> Option<Self> {
        let mounting = *mountings.first()?;
        let balls = || mountings.iter().map(|m| m.coincidence_mm);
        let low = balls().fold(mounting.coincidence_mm, |low, ball| low.inf(&ball));
        let high = balls().fold(mounting.coincidence_mm, |high, ball| high.sup(&ball));
        let reach_mm = (high - low).map(|between_mm| 0.5 * between_mm + reach_mm);
        let mut stream = Stream::new(seed, Purpose::Machine);
        let mut values = [[[0.0; 4]; 6]; 3];
        for local in Local::all() {
            let sigma = local.plausible(machine.plausible(), reach_mm[local.slide.index()]);
            values[local.slide.index()][local.component as usize][local.shape as usize] =
                sigma * stream.normal_within(MOST_SIGMAS);
        }
        Some(Self { middle_mm: 0.5 * (low + high), reach_mm, mounting, values })
    }

    /// Multiplies all that turns with the sense by `1 + share · N(0, 1)`, each by its own.
    pub fn vary_reversals(&mut self, share: f64, mut normal: impl FnMut() -> f64) {
        for value in self.values.iter_mut().flatten() {
            value[LocalShape::Sense as usize] *= 1.0 + share * normal();
        }
    }

    /// What a slide errs at a pose.
    pub(super) fn slide_error(&self, slide: Axis, machine: &Machine, pose: &Pose) -> SlideError {
        let k = slide.index();
        let u = (pose.position_mm[k] - self.middle_mm[k]) / self.reach_mm[k];
        let basis = [u, (3.0 * u * u - 1.0) / 2.0, (5.0 * u * u - 3.0) * u / 2.0, pose.sense[k]];
        let error = |component: usize| -> f64 {
            self.values[k][component].iter().zip(&basis).map(|(value, of)| value * of).sum()
        };
        let rotation_rad = Vector3::new(error(3), error(4), error(5));
        let mut alone_mm = self.middle_mm;
        alone_mm[k] = pose.position_mm[k];
        let lever_mm = machine.lever_mm(slide, &self.mounting, &alone_mm);
        let translation_mm =
            Vector3::new(error(0), error(1), error(2)) - rotation_rad.cross(&lever_mm);
        SlideError { translation_mm, rotation_rad }
    }

    /// All that is not zero, by name; mm and rad.
    pub fn named_values(&self) -> impl Iterator<Item = (String, f64)> {
        let value = |local: &Local| {
            self.values[local.slide.index()][local.component as usize][local.shape as usize]
        };
        Local::all().map(move |local| (local.to_string(), value(&local))).filter(|of| of.1 != 0.0)
    }
}
