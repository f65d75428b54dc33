//! The errors of a machine, by an analysis that was written or a test that is analysed now.

use std::path::PathBuf;

use clap::Args;
use nalgebra::Vector3;

use super::estimate::Selection;
use super::output::Talk;
use crate::compensate::{Analysed, ErrorModel, Field, Measured, Shrunk, Sigmas, Volume, VolumeMap};
use crate::error::{Error, Kind, Place, Result};
use crate::identify::Failure;
use crate::monitor::resolved;

/// Where the errors of a machine are read.
#[derive(Args)]
pub(super) struct Errors {
    /// analysis.json, the folder it is in, or a test file (.toml)
    #[arg(value_name = "ANALYSIS")]
    source: PathBuf,
    /// The machine file, where it is not where the analysis names it
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
}

impl Errors {
    /// The files that are read, and the errors.
    pub(super) fn read(&self, talk: &Talk) -> Result<(Vec<PathBuf>, Analysed)> {
        if self.source.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
            return self.of_test(talk);
        }
        let file = resolved(&self.source)?;
        let analysed = Analysed::read(&file, self.machine.as_deref())?;
        let read = vec![file, analysed.errors.machine.file().to_path_buf()];
        talk.reads(&read);
        Ok((read, analysed))
    }

    fn of_test(&self, talk: &Talk) -> Result<(Vec<PathBuf>, Analysed)> {
        if let Some(machine) = &self.machine {
            return Err(Error::input("a test file names its machine")
                .at(Place::file(machine))
                .hint("leave `--machine` out, or give an analysis"));
        }
        let selection = Selection::of_file(self.source.clone());
        let identified = selection.identify_or(Failure::LeaveOut, talk)?.diagnosed(talk)?;
        let (test, machine) = (&identified.test, &identified.machine);
        let diagnosis = identified.diagnosis.as_ref();
        let analysed = Analysed::of(test, machine, &identified.campaign, diagnosis);
        let analysed = analysed.ok_or_else(|| {
            Error::input("this test does not describe the machine where it was measured")
                .at(Place::file(&self.source))
                .hint("leave `terms` out of it, or write `terms = [\"local\"]`")
        })?;
        Ok((selection.read(&identified), analysed))
    }
}

/// The errors that are worth compensating: shrunk where they are smaller than their uncertainty.
pub(super) struct Worth {
    pub(super) errors: ErrorModel,
    pub(super) shrunk: Shrunk,
    /// The volumetric error where something was measured near, before and after, mm rms.
    pub(super) before_mm: f64,
    pub(super) after_mm: f64,
    /// What is not known of it, mm rms.
    pub(super) unknown: Sigmas,
}

/// Shrinks the errors of an analysis.
///
/// # Errors
/// When all of them are noise.
pub(super) fn worth(analysed: &Analysed, tool_ball_mm: Vector3<f64>) -> Result<Worth> {
    let before = near_mm(&analysed.errors, tool_ball_mm)?;
    let (errors, shrunk) = analysed.errors.clone().shrunk();
    let (after_mm, unknown) = near_mm(&errors, tool_ball_mm)?;
    if after_mm < unknown.noise {
        return Err(Error::new(
            Kind::Undetermined,
            format!("the errors of this machine, {:.2} um rms, are smaller than their noise, {:.2} um: there is nothing to correct", 1e3 * after_mm, 1e3 * unknown.noise),
        )
        .at(Place::file(&analysed.file))
        .hint("repeat the test more often, or leave the machine as it is"));
    }
    Ok(Worth { errors, shrunk, before_mm: before.0, after_mm, unknown })
}

/// The volumetric error where something was measured near, and what is not known of it, mm rms.
fn near_mm(errors: &ErrorModel, tool_ball_mm: Vector3<f64>) -> Result<(f64, Sigmas)> {
    let ends_mm = Measured::by(errors).range_mm();
    let field = Field::new(errors, tool_ball_mm)?;
    let map = VolumeMap::of(&field, &Volume { ends_mm, points: 5, keep_rigid: false });
    Ok(map.near.map_or((0.0, Sigmas::default()), |near| (near.rms.value_mm, near.unknown)))
}

/// Numbers that are separated by commas.
pub(super) fn numbers<const N: usize>(text: &str) -> std::result::Result<[f64; N], String> {
    let each: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>().ok().filter(|n| n.abs() <= FARTHEST_MM))
        .collect::<Option<_>>()
        .ok_or(format!(
            "`{text}` is not {N} numbers from -{FARTHEST_MM} to {FARTHEST_MM}, separated by commas"
        ))?;
    <[f64; N]>::try_from(each).map_err(|each| format!("{N} numbers are needed, not {}", each.len()))
}

/// No machine is larger, mm.
const FARTHEST_MM: f64 = crate::toml_text::FARTHEST_MM;
