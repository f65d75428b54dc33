//! `ballbar demo`: the whole chain on measured logs.

use std::path::Path;

use clap::Args;

use super::analyse::add_results;
use super::common::Common;
use super::estimate::Selection;
use super::output::{self, Talk};
use super::program::told;
use super::results::{Files, Own, path_from};
use crate::design::PlannedProgram;
use crate::error::{Error, Kind, Place, Result};
use crate::plan::Test;
use crate::report;

/// The test of the demonstration, relative to the project.
const TEST: &str = "tests/data/hu40t/test.toml";

/// Show the whole chain on five measured logs
///
/// Writes the 3D6 program for the HU40-T and checks it by reading it back, analyses five logs of it, which
/// are in the program, and writes program, report and samples to `out/demo`.
#[derive(Args)]
pub(super) struct Arguments {}

impl Arguments {
    // The other subcommands have arguments to look at.
    #[expect(clippy::unused_self)]
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let directory = unpacked()?;
        let file = directory.path().join(TEST);
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
        // The files are gone when it is over, and are called as in the sources.
        let unpacked = directory.path();
        let analysis = identified.analysis_naming(&|file| {
            path_from(unpacked, Path::new(file)).unwrap_or_else(|_| file.to_owned())
        });
        let own = Own::named(common, "demo");
        let mut files = Files::in_own(common, &own, selection.read(&identified));
        files.add(&written.file_name, written.text.clone());
        let json = add_results(&mut files, &identified, &analysis)?;
        let written = files.write()?;
        let files = &written.files;
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
        written.shown(talk);
        Ok(())
    }
}

/// The files of the demonstration, which are in the program: names relative to the project, and contents.
const FILES: [(&str, &[u8]); 8] = [
    ("machines/hu40t.toml", include_bytes!("../../machines/hu40t.toml")),
    (TEST, include_bytes!("../../tests/data/hu40t/test.toml")),
    ("tests/data/hu40t/O1005.nc.gz", include_bytes!("../../tests/data/hu40t/O1005.nc.gz")),
    ("tests/data/hu40t/run1.csv.gz", include_bytes!("../../tests/data/hu40t/run1.csv.gz")),
    ("tests/data/hu40t/run2.csv.gz", include_bytes!("../../tests/data/hu40t/run2.csv.gz")),
    ("tests/data/hu40t/run3.csv.gz", include_bytes!("../../tests/data/hu40t/run3.csv.gz")),
    ("tests/data/hu40t/run4.csv.gz", include_bytes!("../../tests/data/hu40t/run4.csv.gz")),
    ("tests/data/hu40t/run5.csv.gz", include_bytes!("../../tests/data/hu40t/run5.csv.gz")),
];

/// Writes them where they are gone when the demonstration is over.
fn unpacked() -> Result<tempfile::TempDir> {
    let write = || {
        let directory = tempfile::tempdir()?;
        for (name, content) in FILES {
            let file = directory.path().join(name);
            std::fs::create_dir_all(file.parent().unwrap_or(directory.path()))?;
            std::fs::write(file, content)?;
        }
        Ok(directory)
    };
    write().map_err(|error: std::io::Error| {
        Error::new(Kind::Output, format!("the measured logs cannot be unpacked: {error}"))
            .at(Place::file(&std::env::temp_dir()))
            .hint(if cfg!(windows) {
                "name another directory for what is temporary: `set TEMP=.`"
            } else {
                "name another directory for what is temporary, such as `TMPDIR=.`"
            })
    })
}
