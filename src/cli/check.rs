//! `ballbar check`: everything that is wrong with a program.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::common::Common;
use super::output::{self, Talk};
use super::results::{Files, Written};
use crate::error::{Error, Result};
use crate::machine::Machine;
use crate::motion::Trajectory;
use crate::nc::{self, Finding, Program, Reading, Severity, Sphere};
use crate::plan::Test;
use crate::report;

/// Check a program, also one that was edited
///
/// Prints every finding with its place and what to do. Errors make the exit code 1, warnings do not.
/// What concerns the bar (reach, engagement, sphere, stops inside arcs) needs a test file.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar check O1001.nc --machine machine.toml
  ballbar check O1001.nc --test test.toml --mounting A --plot
  ballbar check O1001.nc --test test.toml --json | jq '.findings[] | select(.severity == \"error\")'")]
pub(super) struct Arguments {
    /// The program, gzipped or not
    #[arg(value_name = "PROGRAM")]
    program: PathBuf,
    #[command(flatten)]
    on: On,
    /// Write a picture of the path on the sphere and of the speed; needs --test
    #[arg(long, requires = "test")]
    plot: bool,
}

/// The machine that a program runs on, and the test that it belongs to.
#[derive(Args)]
pub(super) struct On {
    /// The machine file; without it, the one that the test file names
    #[arg(short, long, value_name = "FILE", required_unless_present = "test")]
    machine: Option<PathBuf>,
    /// The test file, for work offset, bar and plan
    #[arg(short, long, value_name = "TEST")]
    test: Option<PathBuf>,
    /// The mounting of the test file; without it, the one whose program number it is, or the first
    #[arg(long, value_name = "NAME", requires = "test")]
    mounting: Option<String>,
}

/// What is known around a program.
pub(super) struct Around {
    pub(super) machine: Machine,
    pub(super) reading: Reading,
    pub(super) sphere: Option<Sphere>,
}

impl On {
    /// Reads machine and test.
    pub(super) fn read(&self, program: &str, talk: &Talk) -> Result<Around> {
        let test = self.test.as_deref().map(Test::read).transpose()?;
        let machine = match (&self.machine, &test) {
            (Some(file), _) => Machine::read(file)?,
            (None, Some(test)) => test.machine()?,
            (None, None) => return Err(Error::input("neither a machine nor a test is given")),
        };
        let mut reading = Reading::of(&machine);
        let Some(test) = test else { return Ok(Around { machine, reading, sphere: None }) };
        let index = self.mounting(&test, program)?;
        let mounting = &test.mountings()[index];
        if self.mounting.is_none() && test.mountings().len() > 1 {
            talk.say(&format!("mounting {}", mounting.name));
        }
        reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
        Ok(Around { machine, reading, sphere: Sphere::of(&test, index) })
    }

    fn mounting(&self, test: &Test, program: &str) -> Result<usize> {
        let mountings = test.mountings();
        let Some(name) = &self.mounting else {
            let number = nc::number_in(program);
            let first = test.plan().map_or(0, |plan| plan.program_number);
            let index = number.and_then(|number| number.checked_sub(first)).unwrap_or(0) as usize;
            return Ok(if index < mountings.len() { index } else { 0 });
        };
        mountings.iter().position(|mounting| mounting.name == *name).ok_or_else(|| {
            let names: Vec<&str> = mountings.iter().map(|m| m.name.as_str()).collect();
            Error::input(format!("there is no mounting `{name}`"))
                .hint(format!("the mountings are `{}`", names.join("`, `")))
        })
    }
}

/// The text of a program; a byte that is no character is left to the check.
pub(super) fn text_of(file: &Path) -> Result<String> {
    let bytes = crate::input::read(file, "program")?;
    if bytes.contains(&0) {
        return nc::text_of(file);
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let text = text_of(&self.program)?;
        let around = self.on.read(&text, talk)?;
        let Around { machine, reading, sphere } = &around;
        let checked = nc::check(&text, &self.program, machine, reading, sphere.as_ref())?;
        let plot = sphere.as_ref().filter(|_| self.plot);
        let picture = plot.map(|sphere| self.picture(common, &checked.program, machine, sphere));
        let picture = picture.transpose()?;
        let (errors, warnings) = (checked.count(Severity::Error), checked.count(Severity::Warning));
        if common.json {
            let value = json!({
                "program": self.program.display().to_string(),
                "blocks": checked.blocks,
                "errors": errors,
                "warnings": warnings,
                "sphere_checked": sphere.is_some(),
                "findings": checked.findings.iter().map(as_json).collect::<Vec<_>>(),
            });
            output::print_json("check", value)?;
        } else {
            for finding in &checked.findings {
                output::print(&format!("{finding}\n\n"))?;
            }
        }
        talk.say(&format!("{} blocks, {errors} error(s), {warnings} warning(s)", checked.blocks));
        if let Some(picture) = picture {
            picture.told(talk);
        }
        if sphere.is_none() {
            talk.say("without --test: bar, sphere and work offset were not checked");
        }
        if errors == 0 {
            return Ok(());
        }
        Err(Error::input(format!("{errors} error(s) in {}", self.program.display())).hint(
            "correct what the findings name, or write the program anew with `ballbar program`",
        ))
    }
}

impl Arguments {
    /// Draws what could be followed, also of a program with errors: it may show them.
    fn picture(
        &self,
        common: &Common,
        program: &Program,
        machine: &Machine,
        sphere: &Sphere,
    ) -> Result<Written> {
        let name =
            self.program.file_name().map_or_else(String::new, |n| n.to_string_lossy().into());
        let stem = name.trim_end_matches(".gz");
        let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
        let trajectory = Trajectory::new(program, machine, 1.0);
        let mut read = vec![self.program.clone(), machine.file().to_path_buf()];
        read.extend(self.on.test.clone());
        let mut files = Files::of(common, read);
        files.add(format!("{stem}-path.html"), report::path_page(&name, &trajectory, sphere)?);
        files.write()
    }
}

fn as_json(finding: &Finding) -> serde_json::Value {
    let place = finding.error.place.as_deref().filter(|place| place.line > 0);
    json!({
        "severity": finding.severity.name(),
        "rule": finding.rule,
        "line": place.map(|place| place.line),
        "column": place.filter(|place| place.column > 0).map(|place| place.column),
        "block": place.map(|place| place.text.trim()),
        "what": finding.error.what,
        "hint": finding.error.hint,
        "more": finding.more,
    })
}
