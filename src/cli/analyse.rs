//! `ballbar analyse`: align, identify, diagnose and report in one.

use clap::Args;

use super::common::Common;
use super::estimate::{Identified, Selection};
use super::output::Talk;
use super::results::Files;
use crate::error::Result;
use crate::report::{self, Analysis};

/// Align the logs of a test, identify the machine, say what the model gets wrong, write the report
///
/// Writes report.html, analysis.json and samples-RUN.csv, where something was found model.toml, and prints
/// the summary. Without -o they go to a folder of their own, out/DAY-NAME, after the day of the test (its record,
/// else its logs, else today) and its name; the same logs always to the same, other logs never to it.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar analyse test.toml
  ballbar analyse test.toml -o results --loss tukey
  ballbar analyse test.toml --terms paper37 --minimum-norm --json")]
pub(super) struct Arguments {
    #[command(flatten)]
    selection: Selection,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let identified = self.selection.identify(talk)?.diagnosed(talk)?;
        let own = identified.own(common)?;
        let analysis = identified.analysis_in(&own);
        let mut files = Files::in_own(common, &own, self.selection.read(&identified));
        let json = add_results(&mut files, &identified, &analysis)?;
        files.deliver(common.json, talk, &json, &report::summary(&analysis))
    }
}

/// Adds report, analysis and samples; returns the analysis as JSON.
pub(super) fn add_results(
    files: &mut Files,
    identified: &Identified,
    analysis: &Analysis,
) -> Result<String> {
    files.instead_of(is_result);
    let json = analysis.to_json()?;
    files.add("report.html", report::html::render(analysis, identified.shown())?);
    files.add("analysis.json", json.clone());
    if let Some(diagnosis) = identified.diagnosis.as_ref().filter(|d| !d.findings.is_empty()) {
        let model = diagnosis.model_file(&identified.campaign);
        files.add("model.toml", model.to_toml());
    }
    for (run, before) in identified.shown().runs() {
        let mut text = Vec::new();
        report::write_samples(&mut text, run, before)?;
        files.add(format!("samples-{}.csv", run.name), text);
    }
    Ok(json)
}

/// Whether [`add_results`] gives files such a name.
fn is_result(name: &str) -> bool {
    matches!(name, "report.html" | "analysis.json" | "model.toml")
        || name.strip_prefix("samples-").is_some_and(|rest| rest.strip_suffix(".csv").is_some())
}
