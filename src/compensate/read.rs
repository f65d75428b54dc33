//! An analysis read back, with the machine that it is of.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::error_model::ErrorModel;
use super::stored::Stored;
use crate::diagnose::{Diagnosis, Finding};
use crate::error::{Error, Place, Result};
use crate::identify::Campaign;
use crate::input;
use crate::machine::Machine;
use crate::monitor::Past;
use crate::plan::Test;

#[derive(Deserialize)]
struct RawAnalysis {
    machine: RawMachine,
    #[serde(default)]
    error_model: Option<Stored>,
}

#[derive(Deserialize)]
struct RawMachine {
    name: String,
    file: PathBuf,
    topology: String,
}

/// An analysis that was written, ready to compute with.
#[derive(Debug)]
pub struct Analysed {
    /// The file.
    pub file: PathBuf,
    /// Name of the test.
    pub test: String,
    /// What compensation was active when it was measured, as the test file states it.
    pub compensation: Option<String>,
    /// What a diagnosis found, and what each leaves in the residual, mm rms; what hangs on position alone is in the errors.
    pub found: Vec<(String, f64)>,
    /// The errors of the machine.
    pub errors: ErrorModel,
}

impl Analysed {
    /// # Errors
    /// When a machine is not the one that was analysed.
    pub fn is_of(&self, machine: &Machine) -> Result<()> {
        let own = &self.errors.machine;
        is_of([own.name(), own.topology().as_str()], machine, &self.file)
    }
}

impl Analysed {
    /// Of a test that was just identified, and diagnosed; `None` where it does not describe the machine where it was
    /// measured.
    pub fn of(
        test: &Test,
        machine: &Machine,
        campaign: &Campaign,
        diagnosis: Option<&Diagnosis>,
    ) -> Option<Self> {
        let title = |of: &Finding| match of.element.shape() {
            Some(shape) => format!("{}, {}", shape.cause.title, shape.seat),
            None => "unexplained".to_owned(),
        };
        let findings = diagnosis.iter().flat_map(|diagnosis| &diagnosis.findings);
        Some(Self {
            file: test.file().to_path_buf(),
            test: test.name().to_owned(),
            compensation: test.record().compensation.clone(),
            found: findings.map(|of| (title(of), of.rms_mm)).collect(),
            errors: ErrorModel::of(test, machine, campaign, diagnosis)?,
        })
    }

    /// Reads an `analysis.json`, and the machine file that it names or another one that is given.
    ///
    /// # Errors
    /// When it is none, when it has no error model or one that cannot be, or when the machine is another one.
    pub fn read(file: &Path, machine: Option<&Path>) -> Result<Self> {
        let bytes = input::read(file, "analysis")?;
        let past = Past::parse(&bytes, file)?;
        let raw: RawAnalysis = serde_json::from_slice(&bytes).map_err(|error| {
            Error::input(format!("the errors in this analysis cannot be read: {error}"))
                .at(Place::line(file, error.line(), ""))
                .hint(AGAIN)
        })?;
        let beside = file.parent().unwrap_or(Path::new("")).join(&raw.machine.file);
        let named = machine.unwrap_or(&beside);
        if machine.is_none() && !named.is_file() {
            return Err(Error::input(format!(
                "the machine file that this analysis names is not there: {}",
                named.display()
            ))
            .at(Place::file(file))
            .hint("name it with `--machine FILE`"));
        }
        let machine = Machine::read(named)?;
        is_of([&raw.machine.name, &raw.machine.topology], &machine, file)?;
        let Some(stored) = raw.error_model else {
            return Err(Error::input("this analysis does not describe the machine where it was measured")
                .at(Place::file(file))
                .hint("leave `terms` out of the test file, or write `terms = [\"local\"]`, and analyse it again with this version"));
        };
        let errors = stored.of_machine(machine).map_err(|why| {
            Error::input(format!("the `error_model` of this analysis cannot be: {why}"))
                .at(Place::file(file))
                .hint(AGAIN)
        })?;
        let Past { test, compensation, findings, .. } = past;
        let found = findings.unwrap_or_default();
        let found = found.into_iter().map(|of| (of.title, 1e-3 * of.rms_um)).collect();
        Ok(Self { file: file.to_path_buf(), test, compensation, found, errors })
    }
}

const AGAIN: &str = "analyse the test again";

/// What was measured on another machine says nothing about this one.
fn is_of([name, topology]: [&str; 2], machine: &Machine, file: &Path) -> Result<()> {
    let other = [machine.name(), machine.topology().as_str()];
    if other == [name, topology] {
        return Ok(());
    }
    Err(Error::input(format!(
        "this analysis is of `{name}` ({topology}), and the machine file is of `{}` ({})",
        other[0], other[1]
    ))
    .at(Place::file(file))
    .hint("give an analysis of this machine, or with `--machine` its own file"))
}
