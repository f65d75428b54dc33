//! `ballbar analyse`: align, identify, diagnose and report in one.

use std::path::Path;

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
/// the summary.
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
        let analysis = identified.analysis();
        let mut files = Files::default();
        let json = add_results(&mut files, &common.output, &identified, &analysis)?;
        files.deliver(common.json, talk, &json, &report::summary(&analysis))
    }
}

/// Adds report, analysis and samples; returns the analysis as JSON.
pub(super) fn add_results(
    files: &mut Files,
    directory: &Path,
    identified: &Identified,
    analysis: &Analysis,
) -> Result<String> {
    let json = analysis.to_json()?;
    files.add(directory.join("report.html"), report::html::render(analysis, identified.shown())?);
    files.add(directory.join("analysis.json"), json.clone());
    if let Some(diagnosis) = identified.diagnosis.as_ref().filter(|d| !d.findings.is_empty()) {
        let model = diagnosis.model_file(&identified.campaign);
        files.add(directory.join("model.toml"), model.to_toml());
    }
    for (run, before) in identified.shown().runs() {
        let mut text = Vec::new();
        report::write_samples(&mut text, run, before)?;
        files.add(directory.join(format!("samples-{}.csv", run.name)), text);
    }
    Ok(json)
}
