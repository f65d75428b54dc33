//! The machine where it was measured: errors of each slide about the middle of a test.
//!
//! With `c` the middle of a test in machine coordinates, `r` the half of its range and `u = (h - c) / r`, a slide
//! has three functions `T` (mm): what it displaces the ball by while the other slides stand at `c`; and three
//! functions `R` (rad): rotations that act through what the lever to the ball differs from the one that it has
//! while the other slides stand at `c`,
//!
//! ```text
//! d rho = ± basis(u) u_ball · e_i                          T
//! d rho = ± basis(u) u_ball · (e_i × (r(h) - r(h_own, c)))  R
//! ```
//!
//! each with the basis `P1, P2, P3` of Legendre and the sense `b`; what is constant is set-up. A rotation of the
//! paper's form is `R` with the `T` that it causes. This form does not know where the zero of the machine is, where a
//! pivot is, or how long the tool is: levers of metres, by which a scale and an angle are nearly one, are not in it.

use std::sync::Arc;

use nalgebra::Vector3;

use super::jacobian::Situation;
use super::local::Local;
use super::motion::Motion;
use super::term::{Parameter, ParameterId, Term};
use crate::machine::{Axis, ChainErrors, Machine, Mounting, Pose};

/// Where a test measured: its middle, its range, and how the levers change about the middle.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalFrame {
    /// `c`: machine coordinates of X, Y, Z, mm.
    pub middle_mm: Vector3<f64>,
    /// `r`: half of the range of X, Y, Z, mm; 0 of a slide that stood still.
    pub reach_mm: Vector3<f64>,
    /// Lever of each slide to the tool ball of the first mounting at the middle, mm.
    lever_mm: [Vector3<f64>; 3],
    /// By how much its component `k` grows with the coordinate of slide `k`.
    growth: [Vector3<f64>; 3],
    /// How far the tool ball of each mounting is from that of the first, mm.
    tool_mm: Vec<Vector3<f64>>,
}

impl LocalFrame {
    /// About the middle of these machine coordinates, mm; `None` where there are none.
    pub fn around(
        machine: &Machine,
        mountings: &[Mounting],
        positions_mm: impl Iterator<Item = Vector3<f64>>,
    ) -> Option<Self> {
        let first = mountings.first()?;
        let ends = |ends: Option<[Vector3<f64>; 2]>, at: Vector3<f64>| {
            let [low, high] = ends.unwrap_or([at, at]);
            Some([low.inf(&at), high.sup(&at)])
        };
        let [low, high] = positions_mm.fold(None, ends)?;
        let middle_mm = 0.5 * (low + high);
        let lever = |axis: Axis, at: &Vector3<f64>| machine.lever_mm(axis, first, at);
        let growth = Axis::ALL.map(|axis| {
            let by = |k: usize| {
                let further = middle_mm + Vector3::ith(k, 1.0);
                (lever(axis, &further) - lever(axis, &middle_mm))[k]
            };
            Vector3::new(by(0), by(1), by(2))
        });
        Some(Self {
            middle_mm,
            reach_mm: 0.5 * (high - low),
            lever_mm: Axis::ALL.map(|axis| lever(axis, &middle_mm)),
            growth,
            tool_mm: mountings.iter().map(|m| m.tool_ball_mm - first.tool_ball_mm).collect(),
        })
    }

    /// `P1, P2, P3, b` of a slide; a slide that stood still has but its sense.
    fn basis(&self, axis: Axis, pose: &Pose) -> [f64; 4] {
        let (k, sense) = (axis.index(), pose.sense[axis.index()]);
        if self.reach_mm[k] <= 0.0 {
            return [0.0, 0.0, 0.0, sense];
        }
        let u = (pose.position_mm[k] - self.middle_mm[k]) / self.reach_mm[k];
        [u, 1.5 * u * u - 0.5, u * (2.5 * u * u - 1.5), sense]
    }

    /// What the lever of a slide differs by from the one that it has while the other slides stand at the middle.
    fn beside_mm(&self, axis: Axis, pose: &Pose, mounting: usize) -> Vector3<f64> {
        let mut moved =
            (pose.position_mm - self.middle_mm).component_mul(&self.growth[axis.index()]);
        moved[axis.index()] = 0.0;
        moved + self.tool_mm[mounting]
    }

    /// The lever of a slide while the other slides stand at the middle, mm.
    fn alone_mm(&self, axis: Axis, pose: &Pose) -> Vector3<f64> {
        let k = axis.index();
        let mut lever_mm = self.lever_mm[k];
        lever_mm[k] += self.growth[k][k] * (pose.position_mm[k] - self.middle_mm[k]);
        lever_mm
    }
}

/// A local error as a term.
#[derive(Debug, Clone)]
pub struct LocalTerm {
    /// Which.
    pub of: Local,
    /// About what.
    pub frame: Arc<LocalFrame>,
}

impl LocalTerm {
    fn basis(&self, pose: &Pose) -> f64 {
        self.frame.basis(self.of.slide, pose)[self.of.shape as usize]
    }
}

impl Term for LocalTerm {
    fn parameters(&self) -> Vec<Parameter> {
        let unit = if self.of.component.is_angular() { "rad" } else { "mm" };
        vec![Parameter { id: ParameterId::Local(self.of), name: self.of.to_string(), unit }]
    }

    fn columns(&self, at: &Situation, out: &mut [f64]) {
        let Local { slide, component, .. } = self.of;
        // `± u` of the slide: minus on the workpiece side.
        let along = at.slides[slide.index()].translation;
        let one = if component.is_angular() {
            let beside_mm = self.frame.beside_mm(slide, &at.pose, at.mounting);
            beside_mm.cross(&along)[component.direction()]
        } else {
            along[component.direction()]
        };
        out[0] = one * self.basis(&at.pose);
    }

    fn bend(
        &self,
        values: &[f64],
        at: &Pose,
        _motion: &Motion,
        _mounting: usize,
        errors: &mut ChainErrors,
    ) {
        let Local { slide, component, .. } = self.of;
        let amount = values[0] * self.basis(at);
        let of_slide = &mut errors.slides[slide.index()];
        if component.is_angular() {
            let turn_rad = Vector3::ith(component.direction(), amount);
            of_slide.rotation_rad += turn_rad;
            // Where the other slides stand at the middle it displaces nothing.
            of_slide.translation_mm -= turn_rad.cross(&self.frame.alone_mm(slide, at));
        } else {
            of_slide.translation_mm[component.direction()] += amount;
        }
    }
}
