//! `ballbar demo`: the whole chain on measured logs.

use std::path::{Path, PathBuf};

use clap::Args;

use super::analyse::add_results;
use super::common::Common;
use super::estimate::Selection;
use super::output::{self, Talk};
use super::program::told;
use super::results::Files;
use crate::design::PlannedProgram;
use crate::error::{Error, Place, Result};
use crate::plan::Test;
use crate::report;

/// The test of the demonstration, relative to the project.
const TEST: &str = "tests/data/hu40t/test.toml";

/// Show the whole chain on five measured logs
///
/// Writes the 3D6 program for the HU40-T and checks it by reading it back, analyses the five logs of
/// tests/data/hu40t, and writes program, report and samples.
#[derive(Args)]
pub(super) struct Arguments {}

impl Arguments {
    // The other subcommands have arguments to look at.
    #[expect(clippy::unused_self)]
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let file = demonstration()?;
        let test = Test::read(&file)?;
        let written = PlannedProgram::new(&test, &test.machine()?, 0)?;
        talk.say(&format!(
            "1. the program of strategy 3D6, written and read back\n{}",
            told(&written)
        ));

        talk.say(
            "2. five measured logs, aligned, identified and searched for what the model gets wrong",
        );
        let selection = Selection::of_file(file);
        let identified = selection.identify(talk)?.diagnosed(talk)?;
        let analysis = identified.analysis();
        let mut files = Files::of(common, selection.read(&identified));
        files.add(&written.file_name, written.text.clone());
        let json = add_results(&mut files, &identified, &analysis)?;
        let files = files.write()?.files;
        if common.json {
            output::print(&json)?;
        } else {
            output::print_summary(&report::summary(&analysis))?;
        }

        talk.say("3. written, the report first");
        let (reports, others): (Vec<_>, Vec<_>) =
            files.iter().partition(|file| file.extension().is_some_and(|e| e == "html"));
        for file in reports.into_iter().chain(others) {
            talk.say(&format!("  {}", file.display()));
        }
        Ok(())
    }
}

/// The test file, from here or from where the program was built.
fn demonstration() -> Result<PathBuf> {
    let here = Path::new(TEST);
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).join(TEST);
    [here.to_path_buf(), built].into_iter().find(|file| file.is_file()).ok_or_else(|| {
        Error::input("the measured logs of the demonstration are not here")
            .at(Place::file(here))
            .hint("run it in the project's directory: `cargo run --release -- demo`")
    })
}
