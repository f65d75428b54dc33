//! Options and steps that `align`, `identify`, `analyse` and `demo` share.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::common::Common;
use super::output::Talk;
use super::results::{Own, path_from};
use crate::diagnose::{self, Diagnosis};
use crate::error::Result;
use crate::identify::{Campaign, Failure};
use crate::machine::Machine;
use crate::model::ModelFile;
use crate::plan::Test;
use crate::report::{Analysis, Shown};
use crate::solve::Loss;

/// A test, and what to estimate where it differs from the test file.
#[derive(Args)]
pub(super) struct Selection {
    /// The test file
    #[arg(value_name = "TEST")]
    test: PathBuf,
    /// Terms instead of the test file's: sets, names, -NAME; separated by commas
    #[arg(long, value_name = "TERMS", value_delimiter = ',', allow_hyphen_values = true)]
    terms: Vec<String>,
    /// Terms and curves of a model that `diagnose` has written, instead of the test file's
    #[arg(long, value_name = "FILE", conflicts_with = "terms")]
    model: Option<PathBuf>,
    /// Weights of far-off samples
    #[arg(long, value_parser = losses())]
    loss: Option<Loss>,
    /// What the control recorded of its motion, in place of the estimate: once for each run, in their order
    #[arg(long, value_name = "FILE")]
    motion: Vec<PathBuf>,
    /// Where terms are confounded, take the shortest solution instead of refusing
    #[arg(long)]
    minimum_norm: bool,
}

/// The losses by their names.
fn losses() -> impl TypedValueParser<Value = Loss> {
    let names = PossibleValuesParser::new(Loss::NAMED.map(|(name, _)| name));
    names.map(|written| {
        let named = Loss::NAMED.into_iter().find(|(name, _)| *name == written);
        named.map_or(Loss::default(), |(_, loss)| loss)
    })
}

/// A test whose runs were identified.
pub(super) struct Identified {
    pub(super) test: Test,
    pub(super) machine: Machine,
    pub(super) campaign: Campaign,
    pub(super) diagnosis: Option<Diagnosis>,
}

impl Selection {
    /// The test as its file says.
    pub(super) fn of_file(test: PathBuf) -> Self {
        Self {
            test,
            terms: Vec::new(),
            model: None,
            loss: None,
            motion: Vec::new(),
            minimum_norm: false,
        }
    }

    /// Reads the test and identifies its runs; one that cannot be fails the test.
    pub(super) fn identify(&self, talk: &Talk) -> Result<Identified> {
        self.identify_or(Failure::Refuse, talk)
    }

    /// The same, with a choice of what becomes of a run that cannot be.
    pub(super) fn identify_or(&self, failure: Failure, talk: &Talk) -> Result<Identified> {
        let mut test = Test::read(&self.test)?;
        if !self.motion.is_empty() {
            test = test.with_motions(&self.motion)?;
        }
        let machine = test.machine()?;
        let mut estimation = test.estimation().clone();
        if !self.terms.is_empty() {
            estimation.terms.clone_from(&self.terms);
            estimation.minimum_norm |= self.terms.iter().any(|name| name == "all");
        }
        if let Some(file) = &self.model {
            estimation.take(&ModelFile::read(file)?);
        }
        if let Some(loss) = self.loss {
            estimation.loss = loss;
        }
        estimation.minimum_norm |= self.minimum_norm;
        let test = test.with_estimation(estimation);
        talk.reads(&test.files());
        let progress = talk.progress(test.repeat_count(), "identifying");
        let campaign = Campaign::of(&test, &machine, failure, &|| progress.inc(1));
        talk.ended(&progress);
        Ok(Identified { campaign: campaign?, test, machine, diagnosis: None })
    }
}

impl Selection {
    /// The files that were read for it.
    pub(super) fn read(&self, identified: &Identified) -> Vec<PathBuf> {
        identified.test.files().into_iter().chain(self.model.clone()).collect()
    }
}

impl Identified {
    /// The same with what the model gets wrong.
    pub(super) fn diagnosed(mut self, talk: &Talk) -> Result<Self> {
        let progress = talk.progress(diagnose::STEPS, "looking for what the model gets wrong");
        let step = || progress.inc(1);
        let diagnosis = diagnose::watched(&self.test, &self.machine, &self.campaign, &step);
        talk.ended(&progress);
        self.diagnosis = Some(diagnosis?);
        Ok(self)
    }

    /// Where its results go.
    pub(super) fn own(&self, common: &Common) -> Result<Own> {
        let (record, began) = (&self.test.record().date, self.campaign.began());
        let date = record.clone().or_else(|| began.map(|day| day.to_string()));
        Own::choose(common, self.test.name(), date.as_deref(), &self.campaign.readings_sha256())
    }

    /// What is told about it, files named from the folder that it is written to.
    pub(super) fn analysis_in(&self, folder: &Own) -> Analysis {
        self.analysis_naming(&|file| {
            if file == "-" {
                return file.to_owned();
            }
            // Names that are no text are told as well as they can be.
            path_from(folder.directory(), Path::new(file)).unwrap_or_else(|_| file.to_owned())
        })
    }

    /// What is told about it, each file under another name.
    pub(super) fn analysis_naming(&self, name: &dyn Fn(&str) -> String) -> Analysis {
        let Self { test, machine, campaign, diagnosis } = self;
        let mut analysis = match diagnosis {
            Some(diagnosis) => Analysis::diagnosed(test, machine, campaign, diagnosis),
            None => Analysis::new(test, machine, campaign),
        };
        analysis.name_files(name);
        analysis
    }

    /// The repeats as they are told: with what was found, and without.
    pub(super) fn shown(&self) -> Shown<'_> {
        let extended = self.diagnosis.as_ref().and_then(|diagnosis| diagnosis.extended.as_ref());
        let stated = &self.campaign.repeats;
        Shown {
            repeats: extended.map_or(stated, |extended| &extended.campaign.repeats),
            before: extended.map_or(&[], |_| stated),
            effects: self.diagnosis.as_ref().map_or(&[], |diagnosis| &diagnosis.effects),
        }
    }
}
