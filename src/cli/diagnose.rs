//! `ballbar diagnose`: what the model gets wrong.

use clap::Args;

use super::analyse::add_results;
use super::common::Common;
use super::estimate::Selection;
use super::output::Talk;
use super::results::Files;
use crate::error::{Error, Kind, Result};
use crate::identify::Failure;
use crate::report;

/// Say what the model of a test gets wrong: the cause, its size, and what to do
///
/// Aligns and identifies like `analyse`, then searches the residuals for effects that the model lacks and
/// measures what they explain on runs that took no part. A run whose log does not fit its program is left
/// out and named. Writes report.html, analysis.json, samples-RUN.csv and, where something was found, the
/// extended model as model.toml, and prints the diagnosis.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar diagnose test.toml
  ballbar diagnose test.toml -o results --json | jq '.findings[].effects'")]
pub(super) struct Arguments {
    #[command(flatten)]
    selection: Selection,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let identified = self.selection.identify_or(Failure::LeaveOut, talk)?;
        for (run, reason) in &identified.campaign.left_out {
            talk.say(&format!("left out: {run}: {}", reason.what));
        }
        let identified = identified.diagnosed(talk)?;
        let own = identified.own(common)?;
        let analysis = identified.analysis_in(&own);
        for caution in identified.campaign.cautions(&identified.test, &identified.machine) {
            talk.say(&format!("caution: {caution}"));
        }
        let facts = analysis.diagnosis.as_ref().ok_or_else(|| {
            Error::new(Kind::Undetermined, "there is nothing to diagnose")
                .hint("give the test file at least one `[[run]]`")
        })?;
        let mut files = Files::in_own(common, &own, self.selection.read(&identified));
        add_results(&mut files, &identified, &analysis)?;
        let text = report::diagnosis_text(facts) + &report::place_text(&analysis);
        files.deliver(common.json, talk, &facts.to_json()?, &text)
    }
}
