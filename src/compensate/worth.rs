//! The errors that are worth compensating.

use nalgebra::Vector3;

use super::error_model::ErrorModel;
use super::field::{Field, Sigmas};
use super::near::Measured;
use super::read::Analysed;
use super::shrink::Shrunk;
use super::volume::{Volume, VolumeMap};
use crate::error::{Error, Kind, Place, Result};

/// The errors that are worth compensating: shrunk where they are smaller than their uncertainty.
#[derive(Debug)]
pub struct Worth {
    /// The errors.
    pub errors: ErrorModel,
    /// What was shrunk of them.
    pub shrunk: Shrunk,
    /// The volumetric error where something was measured near, before it, mm rms.
    pub before_mm: f64,
    /// And after it, mm rms.
    pub after_mm: f64,
    /// What is not known of it, mm rms.
    pub unknown: Sigmas,
}

impl Analysed {
    /// Shrinks the errors of an analysis.
    ///
    /// # Errors
    /// When all of them are noise.
    pub fn worth(&self, tool_ball_mm: Vector3<f64>) -> Result<Worth> {
        let before = near_mm(&self.errors, tool_ball_mm)?;
        let (errors, shrunk) = self.errors.clone().shrunk();
        let (after_mm, unknown) = near_mm(&errors, tool_ball_mm)?;
        if after_mm < unknown.noise {
            return Err(Error::new(
                Kind::Undetermined,
                format!("the errors of this machine, {:.2} um rms, are smaller than their noise, {:.2} um: there is nothing to correct", 1e3 * after_mm, 1e3 * unknown.noise),
            )
            .at(Place::file(&self.file))
            .hint("repeat the test more often, or leave the machine as it is"));
        }
        Ok(Worth { errors, shrunk, before_mm: before.0, after_mm, unknown })
    }
}

/// The volumetric error where something was measured near, and what is not known of it, mm rms.
fn near_mm(errors: &ErrorModel, tool_ball_mm: Vector3<f64>) -> Result<(f64, Sigmas)> {
    let ends_mm = Measured::by(errors).range_mm();
    let field = Field::new(errors, tool_ball_mm)?;
    let map = VolumeMap::of(&field, &Volume { ends_mm, points: 5, keep_rigid: false });
    Ok(map.near.map_or((0.0, Sigmas::default()), |near| (near.rms.value_mm, near.unknown)))
}
