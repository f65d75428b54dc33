//! Inverse kinematics: from a ball position relative to the workpiece ball to axis positions.

use nalgebra::Vector3;

use super::axis::Axis;
use super::chain::Mounting;
use super::file::Machine;
use crate::error::{Error, Result};

impl Machine {
    /// Machine coordinates that put the tool ball at `ball_mm` from the workpiece ball, mm.
    ///
    /// `h = h_coincidence + ball`: with parallel slides, the programmed sense of every axis is the
    /// direction of the tool relative to the workpiece, whatever the topology.
    ///
    /// # Errors
    /// When an axis would leave its travel; the message says by how much.
    pub fn axis_positions_mm(
        &self,
        mounting: &Mounting,
        ball_mm: &Vector3<f64>,
    ) -> Result<Vector3<f64>> {
        let position = mounting.coincidence_mm + ball_mm;
        for axis in Axis::ALL {
            let at = position[axis.index()];
            let [low, high] = self.slide(axis).travel_mm;
            if !(low..=high).contains(&at) {
                let beyond = if at < low { low - at } else { at - high };
                return Err(Error::input(format!(
                    "axis {axis} would have to go to {at:.3} mm, {beyond:.3} mm beyond its travel of {low} to {high} mm"
                ))
                .hint(format!(
                    "move the mounting in {axis}, use a shorter bar, or a smaller arc"
                )));
            }
        }
        Ok(position)
    }
}
