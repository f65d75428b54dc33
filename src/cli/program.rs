//! `ballbar program`: the NC programs of a test.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::output::{self, Files, Talk};
use super::{Common, time};
use crate::error::{Error, Kind, Result};
use crate::machine::Machine;
use crate::motion::Trajectory;
use crate::nc;
use crate::plan::{Path, Test};

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
            let program = Written::new(&test, &machine, mounting)?;
            files.add(common.output.join(&program.name), program.text.clone());
            written.push(program);
        }
        files.write()?;
        if common.json {
            let list: Vec<_> = written.iter().map(|program| program.as_json(common)).collect();
            return output::print(&format!("{:#}\n", json!(list)));
        }
        for program in &written {
            output::print(&format!("{}\n", common.output.join(&program.name).display()))?;
            talk.say(&program.told());
        }
        Ok(())
    }
}

/// A program that was read back.
pub(super) struct Written {
    pub(super) name: String,
    pub(super) text: String,
    mounting: String,
    back: nc::ReadBack,
    trajectory: Trajectory,
}

impl Written {
    /// Writes the program of a mounting and reads it back.
    ///
    /// # Errors
    /// When it does not come back within 0.75 of the last decimal: then it must not reach a machine.
    pub(super) fn new(test: &Test, machine: &Machine, mounting: usize) -> Result<Self> {
        let path = Path::plan(test, machine, mounting)?;
        let text = nc::write(test, machine, &path)?;
        let name = format!("O{:04}.nc", test.plan()?.program_number + mounting as u32);
        let named = &test.mountings()[mounting];
        let mut reading = nc::Reading::of(machine);
        reading.work_offsets_mm.insert(named.work_offset, named.mounting.coincidence_mm);
        let program = nc::read(&text, name.as_ref(), &reading)?;
        let back = nc::read_back(&program, test, &path)?;
        let last_decimal_mm = 10_f64.powi(-(machine.controller().decimals as i32));
        if back.worst_mm > 0.75 * last_decimal_mm {
            return Err(Error::new(
                Kind::Output,
                format!("the program reads back {} mm away from the plan", back.worst_mm),
            )
            .hint("this is a fault of this tool; please report the test file"));
        }
        let trajectory = Trajectory::new(&program, machine, 1.0);
        Ok(Self { name, text, mounting: named.name.clone(), back, trajectory })
    }

    /// What the operator wants to know before he runs it.
    pub(super) fn told(&self) -> String {
        format!(
            "  mounting {}: {} moves, read back within {:.5} mm, sag {:.2} um\n  time {}",
            self.mounting,
            self.back.points,
            self.back.worst_mm,
            self.back.sag_mm * 1e3,
            time::told(&self.trajectory.duration())
        )
    }

    fn as_json(&self, common: &Common) -> serde_json::Value {
        let time = self.trajectory.duration();
        json!({
            "file": common.output.join(&self.name).display().to_string(),
            "mounting": self.mounting,
            "moves": self.back.points,
            "read_back_worst_mm": self.back.worst_mm,
            "sag_um": self.back.sag_mm * 1e3,
            "feed_s": time.feed_s,
            "dwell_s": time.dwell_s,
            "rapid_s": time.rapid_s,
            "operator_stops": time.stops,
        })
    }
}
