//! `ballbar design`: the test that sees most in the time there is.

use std::path::{Path, PathBuf};

use clap::Args;

use super::common::Common;
use super::output::Talk;
use super::results::{Files, path_from};
use crate::design::{Designer, Measured, Outlook};
use crate::error::{Error, Kind, Place, Result};
use crate::machine::Machine;
use crate::plan::Test;
use crate::report;

/// Design a test: the arcs and mountings that determine most in a budget of time
///
/// Reads the `[design]` of a test file, chooses set-ups and arcs, and writes `test.toml`, ready for
/// `ballbar plan` and `ballbar program`.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar design wish.toml -o designed && ballbar plan designed/test.toml
  ballbar design wish.toml --given results/analysis.json    what to measure next")]
pub(super) struct Arguments {
    /// The test file with a `[design]`
    #[arg(value_name = "TEST")]
    test: PathBuf,
    /// An analysis of what was measured already; the design goes on from there
    #[arg(long, value_name = "ANALYSIS")]
    given: Option<PathBuf>,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let test = Test::read(&self.test)?;
        let machine = test.machine()?;
        let measured = self.given.as_deref().map(Measured::read).transpose()?;
        talk.reads(test.files().iter().chain(&self.given));
        // What there is to choose from, the choices, and what the test will know.
        let progress = talk.progress(Designer::CHOICES + 2, "designing");
        let step = || progress.inc(1);
        let designer = Designer::new(&test, &machine, measured.as_ref())?;
        step();
        let mut proposal = designer.propose(&step)?;
        if measured.is_some() {
            proposal.next = designer.next();
        }
        proposal.text = beside(&proposal.text, common.directory(), &machine)?;
        let designed = Test::parse(&proposal.text, &common.directory().join("test.toml"))?;
        let outlook = Outlook::new(&designed, &machine)?;
        talk.ended(&progress);
        // What was wanted and is not seen in the time there is.
        let unseen = report::unseen_of(&proposal, &outlook);
        if !unseen.is_empty() && measured.is_none() {
            return Err(Error::new(
                Kind::Undetermined,
                format!(
                    "the best test that was found for a budget of {:.1} min, {} of {:.1} min, leaves {} of {} wanted coefficients unseen: {}",
                    test.design()?.budget_s / 60.0,
                    match proposal.set_ups.len() {
                        1 => "one mounting".to_owned(),
                        count => format!("{count} mountings"),
                    },
                    proposal.total_s / 60.0,
                    unseen.len(),
                    proposal.wanted.len(),
                    report::list(&unseen)
                ),
            )
            .at(Place::file(&self.test))
            .hint("give more `budget_min` or `most_mountings`, or leave them out of `wanted`"));
        }
        // Designed beside what was measured, the test must not replace the one that the analysis is of.
        let mut read = test.files();
        read.extend(self.given.clone());
        read.extend(measured.as_ref().map(|measured| measured.test().file().to_path_buf()));
        let mut files = Files::of(common, read);
        files.add("test.toml", proposal.text.clone());
        let json = format!("{:#}\n", report::proposal_json(&test, &proposal, &outlook));
        files.deliver(common.json, talk, &json, &report::proposal_text(&test, &proposal, &outlook))
    }
}

/// The text of a test file with its machine file named from a directory.
fn beside(text: &str, directory: &Path, machine: &Machine) -> Result<String> {
    let faulty = |error: String| Error::new(Kind::Output, error);
    let mut table: toml::Table = toml::from_str(text).map_err(|error| faulty(error.to_string()))?;
    table.insert("machine".into(), path_from(directory, machine.file())?.into());
    toml::to_string(&table).map_err(|error| faulty(error.to_string()))
}
