//! `ballbar program`: the NC programs of a test.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::common::Common;
use super::output::{self, Talk};
use super::results::Files;
use super::time;
use crate::design::PlannedProgram;
use crate::error::{Error, Place, Result};
use crate::machine::Machine;
use crate::plan::Test;

/// Write the NC programs of a test, one for each mounting
///
/// Each program is read back and compared with the plan, and checked with the settings of the machine file, before
/// it is written. What is not safe is refused.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  ballbar program test.toml\n  ballbar program test.toml -o programs --json"
)]
pub(super) struct Arguments {
    /// The test file
    #[arg(value_name = "TEST")]
    test: PathBuf,
    /// Write what is not safe too, with the reasons in its header
    #[arg(long)]
    force: bool,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let test = Test::read(&self.test)?;
        let machine = test.machine()?;
        let mut files = Files::of(common, test.files());
        let mut written = Vec::new();
        for mounting in 0..test.mountings().len() {
            let program = self.safe(&test, &machine, mounting, talk)?;
            files.add(&program.file_name, program.text.clone());
            written.push(program);
        }
        files.write()?;
        if common.json {
            let list: Vec<_> = written.iter().map(|program| as_json(program, common)).collect();
            return output::print_json("program", json!({ "programs": list }));
        }
        for program in &written {
            output::print(&format!("{}\n", common.directory().join(&program.file_name).display()))?;
            talk.say(&told(program));
        }
        Ok(())
    }
}

impl Arguments {
    /// The program of a mounting, if nothing speaks against it or the user insists.
    fn safe(
        &self,
        test: &Test,
        machine: &Machine,
        mounting: usize,
        talk: &Talk,
    ) -> Result<PlannedProgram> {
        let program = PlannedProgram::new(test, machine, mounting)?;
        let objections = program.objections(test, machine)?;
        if objections.is_empty() {
            return Ok(program);
        }
        let what = format!("{} is not safe: {}", program.file_name, &objections[0].what);
        if !self.force {
            let more = objections.len() - 1;
            let more = if more > 0 { format!(", and {more} more") } else { String::new() };
            let reason = objections[0].hint.clone().unwrap_or_default();
            let hint = format!(
                "{reason}; `--force` writes it all the same, with the reasons in its header"
            );
            return Err(Error::input(what + &more).at(Place::file(test.file())).hint(hint));
        }
        for objection in &objections {
            talk.say(&format!("{} is not safe: {}", program.file_name, objection.what));
        }
        Ok(program.warned(machine, &objections))
    }
}

/// What the operator wants to know before he runs a program.
pub(super) fn told(program: &PlannedProgram) -> String {
    format!(
        "  mounting {}: {} moves, read back within {:.5} mm, sag {:.2} um\n  time {}",
        program.mounting_name,
        program.back.points,
        program.back.worst_mm,
        program.back.sag_mm * 1e3,
        time::told(&program.trajectory.duration())
    )
}

fn as_json(program: &PlannedProgram, common: &Common) -> serde_json::Value {
    let time = program.trajectory.duration();
    json!({
        "file": common.directory().join(&program.file_name).display().to_string(),
        "mounting": program.mounting_name,
        "moves": program.back.points,
        "read_back_worst_mm": program.back.worst_mm,
        "sag_um": program.back.sag_mm * 1e3,
        "feed_s": time.feed_s,
        "dwell_s": time.dwell_s,
        "rapid_s": time.rapid_s,
        "operator_stops": time.stops,
    })
}
