//! `ballbar program`: the NC programs of a test.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::common::Common;
use super::output::{self, Files, Talk};
use super::time;
use crate::design::PlannedProgram;
use crate::error::Result;
use crate::plan::Test;

/// Write the NC programs of a test, one for each mounting
///
/// Each program is read back before it is written and compared with the plan.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  ballbar program test.toml\n  ballbar program test.toml -o programs --json"
)]
pub(super) struct Arguments {
    /// The test file
    #[arg(value_name = "TEST")]
    test: PathBuf,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let test = Test::read(&self.test)?;
        let machine = test.machine()?;
        let mut files = Files::default();
        let mut written = Vec::new();
        for mounting in 0..test.mountings().len() {
            let program = PlannedProgram::new(&test, &machine, mounting)?;
            files.add(common.output.join(&program.file_name), program.text.clone());
            written.push(program);
        }
        files.write()?;
        if common.json {
            let list: Vec<_> = written.iter().map(|program| as_json(program, common)).collect();
            return output::print(&format!("{:#}\n", json!(list)));
        }
        for program in &written {
            output::print(&format!("{}\n", common.output.join(&program.file_name).display()))?;
            talk.say(&told(program));
        }
        Ok(())
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
        "file": common.output.join(&program.file_name).display().to_string(),
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
