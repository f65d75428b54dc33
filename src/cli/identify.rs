//! `ballbar identify`: coefficients of the runs of a test.

use clap::Args;

use super::common::Common;
use super::estimate::Selection;
use super::output::Talk;
use super::results::Files;
use crate::error::Result;
use crate::report;

/// Identify the machine from the logs of a test
///
/// Writes analysis.json and prints the summary, or with --json the analysis itself.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar identify test.toml
  ballbar identify test.toml --terms observable35,-EAZ3 --loss huber
  ballbar identify test.toml --terms all --json")]
pub(super) struct Arguments {
    #[command(flatten)]
    selection: Selection,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let identified = self.selection.identify(talk)?;
        let own = identified.own(common)?;
        let analysis = identified.analysis_in(&own);
        let json = analysis.to_json()?;
        let mut files = Files::in_own(common, &own, self.selection.read(&identified));
        files.add("analysis.json", json.clone());
        files.deliver(common.json, talk, &json, &report::summary(&analysis))
    }
}
