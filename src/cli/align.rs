//! `ballbar align`: lays the logs of a test over its programs.

use clap::Args;

use super::common::Common;
use super::estimate::Selection;
use super::output::{self, Talk};
use super::results::Files;
use crate::error::Result;
use crate::report;

/// Lay the logs of a test over its programs
///
/// The time map is refined together with the terms of the test file. Writes each run's samples, with
/// their positions and the uncertainty of their time, as samples-RUN.csv.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  ballbar align test.toml\n  ballbar align test.toml --json -o aligned"
)]
pub(super) struct Arguments {
    #[command(flatten)]
    selection: Selection,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let identified = self.selection.identify(talk)?;
        let own = identified.own(common)?;
        let mut files = Files::in_own(common, &own, self.selection.read(&identified));
        for identification in &identified.campaign.repeats {
            for run in &identification.runs {
                let mut text = Vec::new();
                report::write_aligned(&mut text, run)?;
                files.add(format!("samples-{}.csv", run.name), text);
            }
        }
        let analysis = identified.analysis_in(&own);
        let written = files.write()?;
        if common.json {
            let runs: Vec<_> = analysis.runs().collect();
            return output::print_json("align", serde_json::json!({ "runs": runs }));
        }
        output::print(&report::runs_table(&analysis))?;
        written.told(talk);
        Ok(())
    }
}
