//! The errors of a machine, by an analysis that was written or a test that is analysed now.

use std::path::PathBuf;

use clap::Args;

use super::estimate::Selection;
use super::output::Talk;
use crate::compensate::Analysed;
use crate::error::{Error, Place, Result};
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
