//! The machine where it was measured: errors of each slide about the middle of a test.
//!
//! With `c` the middle of a test in machine coordinates, `r` how far it went from there and `u = (h - c) / r`, a slide
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

use super::coefficient::Component;
use super::jacobian::{Situation, SlideGradient};
use super::local::{Local, LocalShape};
use super::motion::Motion;
use super::term::{Parameter, ParameterId, Term};
use crate::machine::{Axis, ChainErrors, Machine, Mounting, Plausible, Pose};

/// A slide that moves less than this in a test stands still, mm: so little is rounding of its program.
const STANDS_MM: f64 = 0.1;

/// Where a test measured: its middle, its range, and how the levers change about the middle.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalFrame {
    /// `c`: machine coordinates of X, Y, Z, mm: the centre of the sphere, of several mountings that of all.
    pub middle_mm: Vector3<f64>,
    /// `r`: how far from `c` X, Y, Z went, mm; 0 of a slide that stood still.
    pub reach_mm: Vector3<f64>,
    /// Lever of each slide to the tool ball of the first mounting at the middle, mm.
    lever_mm: [Vector3<f64>; 3],
    /// By how much its component `k` grows with the coordinate of slide `k`.
    growth: [Vector3<f64>; 3],
}

impl LocalFrame {
    /// About the middle of these mountings, as far as these machine coordinates go, mm; `None` where there are none.
    pub fn around(
        machine: &Machine,
        mountings: &[Mounting],
        positions_mm: impl Iterator<Item = Vector3<f64>>,
    ) -> Option<Self> {
        let first = mountings.first()?;
        let around = |ends: Option<[Vector3<f64>; 2]>, at: Vector3<f64>| {
            let [low, high] = ends.unwrap_or([at, at]);
            Some([low.inf(&at), high.sup(&at)])
        };
        let [low, high] = positions_mm.fold(None, around)?;
        let [nearest, farthest] = mountings.iter().map(|m| m.coincidence_mm).fold(None, around)?;
        let stands = (high - low).map(|way_mm| way_mm < STANDS_MM);
        let (of_stand, of_balls) = (0.5 * (low + high), 0.5 * (nearest + farthest));
        let middle_mm = Vector3::from_fn(|k, _| if stands[k] { of_stand[k] } else { of_balls[k] });
        let farthest_mm = (high - middle_mm).sup(&(middle_mm - low));
        let reach_mm = farthest_mm.zip_map(&stands, |mm, stands| if stands { 0.0 } else { mm });
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
            reach_mm,
            lever_mm: Axis::ALL.map(|axis| lever(axis, &middle_mm)),
            growth,
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

    /// The lever of a slide while the other slides stand at the middle, mm.
    fn alone_mm(&self, axis: Axis, pose: &Pose) -> Vector3<f64> {
        let k = axis.index();
        let mut lever_mm = self.lever_mm[k];
        lever_mm[k] += self.growth[k][k] * (pose.position_mm[k] - self.middle_mm[k]);
        lever_mm
    }
}

/// The local errors of one slide as a term.
#[derive(Debug, Clone)]
pub struct LocalTerm {
    slide: Axis,
    /// About what.
    frame: Arc<LocalFrame>,
    /// What is plausible for each of its shapes, mm and rad; 0 where a slide that stands still has none.
    plausible: [[f64; 4]; 6],
    /// Component and shape of each parameter; what cannot move has no slope.
    parts: Vec<(Component, LocalShape)>,
    /// Whether all can move: then the shapes of each component stand side by side.
    all: bool,
}

impl LocalTerm {
    /// The errors of a slide about a place, of a machine of which this is plausible.
    pub fn new(slide: Axis, frame: &Arc<LocalFrame>, plausible: &Plausible) -> Self {
        let reach_mm = frame.reach_mm[slide.index()];
        let plausible = Component::ALL.map(|component| {
            LocalShape::ALL
                .map(|shape| Local { slide, component, shape }.plausible(plausible, reach_mm))
        });
        let each = Component::ALL
            .into_iter()
            .flat_map(|component| LocalShape::ALL.into_iter().map(move |shape| (component, shape)));
        let moves = |(component, shape): &(Component, LocalShape)| {
            plausible[*component as usize][*shape as usize] > 0.0
        };
        let count = each.clone().count();
        let parts: Vec<_> = each.filter(moves).collect();
        let all = parts.len() == count;
        Self { slide, frame: Arc::clone(frame), plausible, parts, all }
    }
}

impl Term for LocalTerm {
    fn parameters(&self) -> Vec<Parameter> {
        let parameter = |&(component, shape): &(Component, LocalShape)| {
            let of = Local { slide: self.slide, component, shape };
            let unit = if component.is_angular() { "rad" } else { "mm" };
            let plausible = Some(self.plausible[component as usize][shape as usize]);
            Parameter { id: ParameterId::Local(of), name: of.to_string(), unit, plausible }
        };
        self.parts.iter().map(parameter).collect()
    }

    fn parameter_count(&self) -> usize {
        self.parts.len()
    }

    fn columns(&self, at: &Situation, out: &mut [f64]) {
        // `± u` of the slide: minus on the workpiece side.
        let SlideGradient { translation: along, rotation_mm } = at.slides[self.slide.index()];
        // What is displaced besides where the other slides stand at the middle; of a machine that is bent, too.
        let turned = rotation_mm - self.frame.alone_mm(self.slide, &at.pose).cross(&along);
        let basis = self.frame.basis(self.slide, &at.pose);
        for (column, &(component, shape)) in out.iter_mut().zip(&self.parts) {
            let one = if component.is_angular() { &turned } else { &along };
            *column = one[component.direction()] * basis[shape as usize];
        }
    }

    fn bend(
        &self,
        values: &[f64],
        at: &Pose,
        _motion: &Motion,
        _mounting: usize,
        errors: &mut ChainErrors,
    ) {
        let basis = self.frame.basis(self.slide, at);
        let (mut moved_mm, mut turned_rad) = (Vector3::zeros(), Vector3::zeros());
        let mut add = |component: Component, by: f64| {
            let of = if component.is_angular() { &mut turned_rad } else { &mut moved_mm };
            of[component.direction()] += by;
        };
        if let (Ok(values), true) = (<&[[f64; 4]; 6]>::try_from(values.as_chunks().0), self.all) {
            for (component, of) in Component::ALL.into_iter().zip(values) {
                add(component, of.iter().zip(&basis).map(|(value, of)| value * of).sum());
            }
        } else {
            for (value, &(component, shape)) in values.iter().zip(&self.parts) {
                add(component, value * basis[shape as usize]);
            }
        }
        // Where the other slides stand at the middle a rotation displaces nothing.
        moved_mm -= turned_rad.cross(&self.frame.alone_mm(self.slide, at));
        let of_slide = &mut errors.slides[self.slide.index()];
        of_slide.rotation_rad += turned_rad;
        of_slide.translation_mm += moved_mm;
    }
}
