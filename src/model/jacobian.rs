//! Closed-form derivatives of the length with respect to everything that bends the chain.

use nalgebra::Vector3;

use super::motion::Motion;
use crate::machine::{Axis, ChainErrors, Lever, Machine, Mounting, Pose};

/// Derivative of the length with respect to the six errors of one slide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlideGradient {
    /// `±u`: mm of length per mm of displacement.
    pub translation: Vector3<f64>,
    /// `±(r × u)`: mm of length per rad of rotation.
    pub rotation_mm: Vector3<f64>,
}

/// One pose seen by the terms: where it is, and what the length is sensitive to there.
///
/// With `r` the lever from the slide's pivot to the tool ball and `u` the unit ball vector, a slide
/// contributes `d rho = ± u · (e + eps × r) = ± (u · e + (r × u) · eps)`, plus on the tool side and minus
/// on the workpiece side (DESIGN.md section 3; paper, Eq. 5). These are derivatives at zero error, but for
/// [`Situation::bent`].
#[derive(Debug, Clone, PartialEq)]
pub struct Situation {
    /// The pose.
    pub pose: Pose,
    /// How the machine moves there.
    pub motion: Motion,
    /// Index of the mounting.
    pub mounting: usize,
    /// Unit vector from the workpiece ball to the tool ball.
    pub direction: Vector3<f64>,
    /// Derivatives for the X, Y and Z slides.
    pub slides: [SlideGradient; 3],
}

impl Situation {
    /// The situation at a pose of a machine that stands still.
    ///
    /// `None` where the two balls coincide, because the bar has no direction there.
    pub fn new(machine: &Machine, mounting: &Mounting, index: usize, pose: &Pose) -> Option<Self> {
        // Without errors the ball vector is what the inverse kinematics put in.
        let ball = pose.position_mm - mounting.coincidence_mm;
        let direction = ball.try_normalize(f64::EPSILON)?;
        Some(Self::along(machine, mounting, index, pose, direction))
    }

    /// The situation at a pose, seen along any unit vector: with X, Y and Z in turn the three rows of
    /// the Cartesian Jacobian (paper, Eq. 4), in the workpiece's frame.
    pub fn along(
        machine: &Machine,
        mounting: &Mounting,
        index: usize,
        pose: &Pose,
        direction: Vector3<f64>,
    ) -> Self {
        let levers_mm = machine.levers_mm(mounting, &pose.position_mm);
        let slides = Axis::ALL.map(|axis| {
            let sign = machine.topology().side(axis).sign();
            let lever = levers_mm[axis.index()];
            SlideGradient {
                translation: sign * direction,
                rotation_mm: sign * lever.cross(&direction),
            }
        });
        Self::of(index, pose, direction, slides)
    }

    /// The situation at a pose of a machine that is bent by errors already, so that the terms' columns are derivatives
    /// there: a bar whose balls lie a tenth of a millimetre aside of where they should be sees a little of what is
    /// across it. Only the balls' own set-up errors are taken in directions of `F`.
    ///
    /// `None` where the two balls coincide.
    pub fn bent(
        machine: &Machine,
        mounting: &Mounting,
        index: usize,
        pose: &Pose,
        errors: &ChainErrors,
    ) -> Option<Self> {
        let ball_mm = machine.ball_vector_mm(mounting, &pose.position_mm, errors);
        let direction = ball_mm.try_normalize(f64::EPSILON)?;
        let levers = machine.levers(mounting, &pose.position_mm, errors);
        let slides = Axis::ALL.map(|axis| {
            let sign = machine.topology().side(axis).sign();
            let Lever { turn, axes, lever_mm } = &levers[axis.index()];
            let along = turn.inverse_transform_vector(&direction);
            SlideGradient {
                translation: sign * along,
                rotation_mm: sign * axes.tr_mul(&lever_mm.cross(&along)),
            }
        });
        Some(Self::of(index, pose, direction, slides))
    }

    fn of(index: usize, pose: &Pose, direction: Vector3<f64>, slides: [SlideGradient; 3]) -> Self {
        Self { pose: *pose, motion: Motion::REST, mounting: index, direction, slides }
    }
}
