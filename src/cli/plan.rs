//! `ballbar plan`: what tests take and what they will know, before they are run.

use std::path::PathBuf;

use clap::Args;

use super::common::Common;
use super::output::Talk;
use super::results::Files;
use crate::design::Outlook;
use crate::error::Result;
use crate::model::ModelFile;
use crate::plan::Test;
use crate::report::{self, PlanReport, Planned};

/// Say what a test takes and what it will determine, before it is run
///
/// The programs run on a perfect virtual machine; what the noise of the test file leaves uncertain, what
/// the test confounds and what would separate it follow from that. Writes plan.html and plan.json, and
/// prints the summary; several tests stand side by side.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar plan test.toml
  ballbar plan test.toml --repeats 5 -o results
  ballbar plan one-place.toml three-places.toml
  ballbar plan test.toml --json | jq .tests[0].volume_noise.rms_um")]
pub(super) struct Arguments {
    /// The test files
    #[arg(value_name = "TEST", required = true)]
    tests: Vec<PathBuf>,
    /// How often each test is run: the sigma of the mean of N is smaller by the root of N
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: u32,
    /// Terms of a model that `diagnose` has written, instead of the test files'
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// List all that the tests cannot distinguish, and several tests each by itself
    #[arg(long)]
    all: bool,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let model = self.model.as_deref().map(ModelFile::read).transpose()?;
        let tests = self.tests.iter().map(|file| {
            let mut test = Test::read(file)?;
            if let Some(model) = &model {
                let mut estimation = test.estimation().clone();
                estimation.take(model);
                test = test.with_estimation(estimation);
            }
            let machine = test.machine()?;
            Ok((test, machine))
        });
        // All files are read before the first is rehearsed: a slip in the last one is told at once.
        let tests = tests.collect::<Result<Vec<_>>>()?;
        for (test, _) in &tests {
            talk.reads(&test.files());
        }
        let steps = tests.iter().map(|(test, _)| Outlook::steps(test)).sum();
        let bar = talk.progress(steps, "rehearsing");
        let mut planned = Vec::with_capacity(tests.len());
        for (test, machine) in tests {
            let outlook = Outlook::watched(&test, &machine, &|| bar.inc(1));
            if outlook.is_err() {
                talk.ended(&bar);
            }
            planned.push(Planned { outlook: outlook?, test, machine });
        }
        talk.ended(&bar);
        let plan = PlanReport::new(&planned, self.repeats);
        let json = plan.to_json()?;
        let mut read: Vec<PathBuf> =
            planned.iter().flat_map(|planned| planned.test.files()).collect();
        read.extend(self.model.clone());
        let mut files = Files::of(common, read);
        files.add("plan.html", report::plan_page(&plan, &planned)?);
        files.add("plan.json", json.clone());
        files.deliver(common.json, talk, &json, &report::plan_summary(&plan, self.all))
    }
}
