//! The test file: what is tested, with what, where, and what was measured.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::design_request::DesignRequest;
use super::log_format::{Format, ReadingKind};
use super::operator::Operator;
use super::parts::{BallBar, Estimation, NamedMounting, PathPlan, Run};
use super::raw::RawTest;
use super::raw_mounting::check_mountings;
use super::record::Record;
use super::tolerance::Tolerance;
use crate::error::{Error, Place, Result};
use crate::machine::{Machine, Mounting};
use crate::toml_text::{self, Text};

/// A checked test file.
#[derive(Debug, Clone, PartialEq)]
pub struct Test {
    name: String,
    file: PathBuf,
    hash: String,
    machine: PathBuf,
    ball_bar: BallBar,
    log_format: Format,
    mountings: Vec<NamedMounting>,
    plan: Option<PathPlan>,
    design: Option<DesignRequest>,
    operator: Operator,
    record: Record,
    estimation: Estimation,
    tolerance: Tolerance,
    runs: Vec<Run>,
}

/// One every ten minutes makes as many in a week; all of them are kept in memory and fitted together.
const MOST_RUNS: usize = 1000;
const RUNS_HINT: &str = "a test is what was measured of one machine in one state: give each day a test file of its own, and compare them with `ballbar history`";

impl Test {
    /// Reads and checks a test file.
    pub fn read(file: &Path) -> Result<Self> {
        Self::parse(&toml_text::read(file)?, file)
    }

    /// Checks the text of a test file; `file` is for messages and for paths relative to it.
    pub fn parse(source: &str, file: &Path) -> Result<Self> {
        let text = Text { source, file };
        let raw: RawTest = text.parse()?;
        let beside = |path: &str| file.parent().unwrap_or(Path::new("")).join(path);
        let beyond = raw.run.get(MOST_RUNS).map(|run| run.program.span());
        text.at_most(raw.run.len(), MOST_RUNS, "runs", beyond, RUNS_HINT)?;
        let ball_bar = raw.ball_bar.check(&raw.log, &text)?;
        let log_format = raw.log.check(ball_bar.length_mm, ball_bar.range_mm, &text)?;
        let mountings = check_mountings(&raw.mounting, &ball_bar, &text)?;
        let design = raw.design.map(|design| design.check(ball_bar.range_mm, &text)).transpose()?;
        let designed = design.is_some();
        let plan =
            raw.plan.map(|plan| plan.check(&ball_bar, &mountings, designed, &text)).transpose()?;
        let mut runs = Vec::new();
        for run in raw.run {
            let run = run.check(&runs, &mountings, &beside, &text)?;
            runs.push(run);
        }
        Ok(Self {
            name: raw.name,
            file: file.to_path_buf(),
            hash: hexadecimal(&Sha256::digest(source.as_bytes())),
            machine: beside(&raw.machine),
            ball_bar,
            log_format,
            mountings,
            plan,
            design,
            operator: raw.operator.check(&text)?,
            record: raw.record.check(&text)?,
            estimation: raw.identify.check(&text)?,
            tolerance: raw.tolerance.check(&text)?,
            runs,
        })
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file that it was read from.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// All files that belong to the test: its own, that of the machine, programs, logs and recorded motions of the runs.
    pub fn files(&self) -> Vec<PathBuf> {
        let of = |run: &'_ Run| {
            [&run.program, &run.log].into_iter().chain(&run.motion).cloned().collect::<Vec<_>>()
        };
        let runs = self.runs.iter().flat_map(of);
        [&self.file, &self.machine].into_iter().cloned().chain(runs).collect()
    }

    /// SHA-256 of the file's text, in hexadecimal.
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// Reads the machine file that the test names.
    pub fn machine(&self) -> Result<Machine> {
        Machine::read(&self.machine)
    }

    /// The instrument; its length is that of mountings which name none of their own.
    pub fn ball_bar(&self) -> &BallBar {
        &self.ball_bar
    }

    /// The instrument with the length that a mounting, by its index, uses.
    pub fn bar_of(&self, mounting: usize) -> BallBar {
        let mut bar = self.ball_bar.clone();
        if let Some(named) = self.mountings.get(mounting) {
            bar.length_mm = named.bar_length_mm;
        }
        bar
    }

    /// How the logs of a mounting, by its index, are written.
    pub fn log_format_of(&self, mounting: usize) -> Format {
        let mut format = self.log_format.clone();
        if let ReadingKind::Length { nominal_mm } = &mut format.reading.kind {
            *nominal_mm = self.bar_of(mounting).length_mm;
        }
        format
    }

    /// The same test with the balls of a mounting elsewhere.
    #[must_use]
    pub fn with_balls(mut self, mounting: usize, balls: Mounting) -> Self {
        if let Some(named) = self.mountings.get_mut(mounting) {
            named.mounting = balls;
        }
        self
    }

    /// The mountings, at least one.
    pub fn mountings(&self) -> &[NamedMounting] {
        &self.mountings
    }

    /// How the path is driven.
    ///
    /// # Errors
    /// When the test has no `[plan]`.
    pub fn plan(&self) -> Result<&PathPlan> {
        self.plan.as_ref().ok_or_else(|| {
            Error::input("the test has no `[plan]`, so there is no program to write")
                .at(Place::file(&self.file))
                .hint("add `[plan]` with `strategy = \"3d6\"` and `feed_mm_min = 500.0`")
        })
    }

    /// What the time of the test assumes of its operator.
    pub fn operator(&self) -> &Operator {
        &self.operator
    }

    /// Who measured what, when and with what.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// What a test is to be designed for.
    ///
    /// # Errors
    /// When the test has no `[design]`.
    pub fn design(&self) -> Result<&DesignRequest> {
        self.design.as_ref().ok_or_else(|| {
            Error::input("the test has no `[design]`, so there is nothing to design it for")
                .at(Place::file(&self.file))
                .hint("add `[design]` with `budget_min = 90.0`")
        })
    }

    /// What the identification does.
    pub fn estimation(&self) -> &Estimation {
        &self.estimation
    }

    /// What the machine must keep.
    pub fn tolerance(&self) -> &Tolerance {
        &self.tolerance
    }

    /// The same test, identified otherwise than its file says.
    #[must_use]
    pub fn with_estimation(mut self, estimation: Estimation) -> Self {
        self.estimation = estimation;
        self
    }

    /// The same test with these recorded motions for its runs, in their order.
    ///
    /// # Errors
    /// When there are not as many as runs.
    pub fn with_motions(mut self, motions: &[PathBuf]) -> Result<Self> {
        let runs = self.runs()?.len();
        if motions.len() != runs {
            return Err(Error::input(format!(
                "{} recorded motion(s) for {runs} run(s)",
                motions.len()
            ))
            .at(Place::file(&self.file))
            .hint("give `--motion` once for each `[[run]]`, in their order, or name the file in the run: `motion = \"motion.csv\"`"));
        }
        for (run, motion) in self.runs.iter_mut().zip(motions) {
            run.motion = Some(motion.clone());
        }
        Ok(self)
    }

    /// How many tests the runs make: runs of the same repeat are one.
    pub fn repeat_count(&self) -> usize {
        let mut repeats: Vec<u32> = self.runs.iter().map(|run| run.repeat).collect();
        repeats.sort_unstable();
        repeats.dedup();
        repeats.len()
    }

    /// The measured runs.
    ///
    /// # Errors
    /// When there are none.
    pub fn runs(&self) -> Result<&[Run]> {
        if self.runs.is_empty() {
            return Err(Error::input("the test has no runs, so there is nothing to analyse")
                .at(Place::file(&self.file))
                .hint("add `[[run]]` with `program = \"O1005.nc\"` and `log = \"run1.csv\"`"));
        }
        Ok(&self.runs)
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
