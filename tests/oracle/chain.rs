//! From the files of a data set to an identification, as a command does it.

use std::io::Read as _;
use std::path::Path;

use ballbar::Result;
use ballbar::align::{self, Alignment};
use ballbar::identify::{self, Identification, Options, RunInput};
use ballbar::log::{self, Log};
use ballbar::machine::{Machine, Mounting};
use ballbar::model::{self, Model};
use ballbar::nc::{self, Program};
use ballbar::plan::{Run, Test};

use crate::common::repository;

/// A data set of `tests/data`.
pub(crate) struct Set {
    pub(crate) name: &'static str,
    pub(crate) test: Test,
    pub(crate) machine: Machine,
    pub(crate) truth: toml::Table,
}

impl Set {
    pub(crate) fn read(name: &'static str) -> Self {
        let folder = repository("tests/data").join(name);
        let test = Test::read(&folder.join("test.toml")).unwrap();
        let truth = std::fs::read_to_string(folder.join("truth.toml")).unwrap().parse().unwrap();
        Self { name, machine: test.machine().unwrap(), test, truth }
    }

    pub(crate) fn mountings(&self) -> Vec<Mounting> {
        self.test.mountings().iter().map(|named| named.mounting).collect()
    }

    /// Reads a program of this set, or of another by its path from this one.
    pub(crate) fn program(&self, file: &Path) -> Program {
        let mut reading = nc::Reading::default();
        for named in self.test.mountings() {
            reading.work_offsets_mm.insert(named.work_offset, named.mounting.coincidence_mm);
        }
        nc::read_file(file, &reading).unwrap()
    }

    /// Reads a log whose text a test may change first.
    pub(crate) fn log(&self, file: &Path, edit: impl Fn(&str) -> String) -> Result<Log> {
        let mut text = String::new();
        let bytes = std::fs::read(file).unwrap();
        flate2::read::GzDecoder::new(&bytes[..]).read_to_string(&mut text).unwrap();
        log::read_bytes(edit(&text).as_bytes(), file, &self.test.log_format_of(0))
    }

    pub(crate) fn align(&self, log: &Log, program: &Program) -> Result<Alignment> {
        let (mounting, bar) = (self.mountings()[0], self.test.ball_bar());
        let rig = align::Rig { machine: &self.machine, mounting: &mounting, bar };
        align::align(&align::Run { log, program, rig, feed_override: 1.0, driven: None })
    }

    /// A run of the test file, aligned.
    pub(crate) fn run(&self, index: usize) -> RunInput {
        let run = &self.test.runs().unwrap()[index];
        let log = self.log(&run.log, str::to_owned).unwrap();
        let alignment = self.align(&log, &self.program(&run.program)).unwrap();
        self.input(run, alignment)
    }

    /// A run of this set with an alignment.
    pub(crate) fn input(&self, run: &Run, alignment: Alignment) -> RunInput {
        let nominal_mm = self.test.bar_of(run.mounting).length_mm;
        RunInput::new(run.name.clone(), run.mounting, nominal_mm, alignment)
    }

    pub(crate) fn model(&self) -> Model<'_> {
        let names: Vec<String> = self.test.mountings().iter().map(|m| m.name.clone()).collect();
        let terms = model::terms(&self.test.estimation().terms, &names).unwrap();
        Model::new(&self.machine, self.mountings(), terms)
    }

    pub(crate) fn identify(&self, runs: Vec<RunInput>) -> Result<Identification> {
        let (bar, estimation) = (self.test.ball_bar(), self.test.estimation());
        let options = Options {
            noise_mm: bar.noise_mm,
            clock_tolerance: bar.clock_tolerance,
            loss: estimation.loss,
            minimum_norm: estimation.minimum_norm,
        };
        identify::identify(&self.model(), runs, &options)
    }

    /// What speaks against a fit of it.
    pub(crate) fn cautions(&self, found: &Identification) -> Vec<String> {
        found.cautions(&self.machine, self.test.estimation().loss)
    }

    /// Every repeat of the test file, in order.
    pub(crate) fn repeats(&self) -> Vec<Identification> {
        let runs = self.test.runs().unwrap();
        let mut repeats: Vec<u32> = runs.iter().map(|run| run.repeat).collect();
        repeats.dedup();
        repeats
            .into_iter()
            .map(|repeat| {
                let of = (0..runs.len()).filter(|&k| runs[k].repeat == repeat);
                self.identify(of.map(|k| self.run(k)).collect()).unwrap()
            })
            .collect()
    }
}

/// What was put into one run.
pub(crate) struct Truth<'a>(pub(crate) &'a toml::Table);

impl Truth<'_> {
    pub(crate) fn number(&self, key: &str) -> f64 {
        self.0[key].as_float().unwrap_or_else(|| panic!("{key} is not a number"))
    }

    /// A coefficient or set-up error; what the file does not name is 0.
    pub(crate) fn coefficient(&self, name: &str) -> f64 {
        self.0["coefficients"].get(name).map_or(0.0, |value| value.as_float().unwrap())
    }

    /// Program time of a log time on a leg, s, as the file says it.
    pub(crate) fn program_s(&self, log_s: f64, leg: usize) -> f64 {
        let pauses = self.0["pauses_s"].as_array().unwrap();
        let stood_s: f64 = pauses[..leg].iter().map(|pause| pause.as_float().unwrap()).sum();
        log_s * (1.0 + 1e-6 * self.number("clock_ppm")) - self.number("start_s") - stood_s
    }
}

/// The truth of every run of a set.
pub(crate) fn truths(set: &Set) -> Vec<Truth<'_>> {
    set.truth["run"].as_array().unwrap().iter().map(|run| Truth(run.as_table().unwrap())).collect()
}
