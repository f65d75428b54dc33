//! The volumetric error over the sphere that was measured.
//!
//! At points of the sphere about the middle of a test, and in the four sets of senses that have the mean of all eight, the tool is displaced against the
//! workpiece by `v`; a rigid motion of the workpiece, which is its set-up, is taken off. The volumetric error is the
//! root mean square of the length of what is left, the machine at rest: what hangs on speed or time is not in it.

use nalgebra::{Matrix6, Vector3, Vector6};

use super::scene::{Column, Scene};
use crate::identify::displaced_mm;
use crate::machine::{Axis, Pose};
use crate::model::{Motion, Situation};

const SENSES: [[f64; 3]; 4] =
    [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
/// Points on the sphere: a cubic error over it is known to a per cent with half of them.
const POINTS: u32 = 200;

/// The error over a sphere.
pub(super) struct Volume {
    situations: Vec<[Situation; 3]>,
    beside_mm: Vec<Vector3<f64>>,
    /// Without the best rigid motion, mm.
    error_mm: Vec<Vector3<f64>>,
}

impl Volume {
    /// `None` where not all axes moved.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let frame = scene.frame;
        if frame.reach_mm.min() <= 0.0 {
            return None;
        }
        let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let point = |k: u32| {
            let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(POINTS);
            let (sin, cos) = (golden * f64::from(k)).sin_cos();
            let across = (1.0 - z * z).sqrt();
            scene.radius_mm * Vector3::new(across * cos, across * sin, z)
        };
        let inside = |beside: &Vector3<f64>| {
            (0..3).all(|k| beside[k].abs() <= frame.reach_mm[k] * (1.0 + 1e-3))
        };
        let (mut situations, mut beside_mm, mut error_mm) = (Vec::new(), Vec::new(), Vec::new());
        for beside in (0..POINTS).map(point).filter(inside) {
            for sense in SENSES {
                let pose = Pose { position_mm: frame.middle_mm + beside, sense: sense.into() };
                let along = |axis: Axis| {
                    let direction = Vector3::ith(axis.index(), 1.0);
                    scene.model.situation_along(&pose, &Motion::REST, 0, direction)
                };
                situations.push(Axis::ALL.map(along));
                beside_mm.push(beside);
                error_mm.push(displaced_mm(scene.model, scene.values, &pose));
            }
        }
        rest(&beside_mm, &mut error_mm);
        Some(Self { situations, beside_mm, error_mm }).filter(|of| !of.error_mm.is_empty())
    }

    /// Root mean square, mm.
    pub(super) fn rms_mm(&self) -> f64 {
        rms_mm(&self.error_mm)
    }

    /// By what a feature displaces each point, without the best rigid motion, mm; `None` where that is nothing.
    pub(super) fn moves_mm(&self, column: &Column) -> Option<Vec<Vector3<f64>>> {
        let of = |at: &[Situation; 3]| Vector3::from_fn(|k, _| column(&at[k], 0));
        let mut moved_mm: Vec<Vector3<f64>> = self.situations.iter().map(of).collect();
        if moved_mm.iter().all(|moved| moved.norm() < NOTHING_MM) {
            return None;
        }
        rest(&self.beside_mm, &mut moved_mm);
        Some(moved_mm)
    }

    /// The error without a feature.
    pub(super) fn without(mut self, moved_mm: &[Vector3<f64>]) -> Self {
        self.error_mm.iter_mut().zip(moved_mm).for_each(|(error, moved)| *error -= moved);
        self
    }

    /// By how much it falls without a feature, mm.
    pub(super) fn fall_mm(&self, moved_mm: &[Vector3<f64>]) -> f64 {
        let without: Vec<Vector3<f64>> =
            self.error_mm.iter().zip(moved_mm).map(|(error, moved)| error - moved).collect();
        self.rms_mm() - rms_mm(&without)
    }
}

/// Displaces nothing, mm.
const NOTHING_MM: f64 = 1e-9;

fn rms_mm(of: &[Vector3<f64>]) -> f64 {
    (of.iter().map(Vector3::norm_squared).sum::<f64>() / of.len().max(1) as f64).sqrt()
}

/// Takes off the rigid motion `t + w × p` that fits best.
fn rest(beside_mm: &[Vector3<f64>], error_mm: &mut [Vector3<f64>]) {
    let (mut normal, mut right) = (Matrix6::zeros(), Vector6::zeros());
    // Turns are counted at the radius, so that all six are of one size.
    let radius_mm = beside_mm.first().map_or(1.0, |p| p.norm().max(1.0));
    let row = |p: &Vector3<f64>, k: usize| {
        let along = Vector3::ith(k, 1.0);
        let turned = p.cross(&along) / radius_mm;
        Vector6::new(along.x, along.y, along.z, turned.x, turned.y, turned.z)
    };
    for (p, error) in beside_mm.iter().zip(error_mm.iter()) {
        for k in 0..3 {
            let row = row(p, k);
            normal += row * row.transpose();
            right += row * error[k];
        }
    }
    let Some(motion) = normal.cholesky().map(|normal| normal.solve(&right)) else { return };
    for (p, error) in beside_mm.iter().zip(error_mm.iter_mut()) {
        *error -= Vector3::from_fn(|k, _| row(p, k).dot(&motion));
    }
}
