//! `ballbar simulate`: logs of a virtual machine.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::common::Common;
use super::output::{self, Talk};
use super::results::{Files, path_from};
use crate::error::{Error, Kind, Place, Result};
use crate::log::Recording;
use crate::machine::Machine;
use crate::model::{Effect, ModelFile};
use crate::plan::Test;
use crate::simulate::Scenario;
use crate::virtual_test::{self, VirtualProgram, VirtualRun};

/// Simulate the logs of a test on a virtual machine
///
/// The programs are those of the test's plan or, without a plan, those of its runs. Logs, programs, what
/// was put in (truth.toml) and a test file that names them all are written, ready for `ballbar analyse`.
/// The machine is drawn from what its file takes for plausible, another one with every seed.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar simulate test.toml -o virtual && ballbar analyse virtual/test.toml
  ballbar simulate test.toml --scenario warm.toml --repeats 5 --seed 7
  ballbar simulate test.toml --hide cyclic:on=EXX,period_mm=10,amplitude_um=1.2 \\
                             --hide drift:on=EZt,amplitude_um=6,time_constant_s=500

The causes that can be hidden, their keys and equations: ballbar reference causes")]
pub(super) struct Arguments {
    /// The test file
    #[arg(value_name = "TEST")]
    test: PathBuf,
    /// What the machine and the instrument are like
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
    /// Take the coefficients of the paper's Table 5 where the scenario has none, instead of drawing a machine
    #[arg(long, conflicts_with = "model")]
    paper: bool,
    /// Hide an effect, besides those of the scenario: CAUSE:key=value,... Give it again for several
    #[arg(long, value_name = "EFFECT")]
    hide: Vec<String>,
    /// What a control recorded of its motion, in place of the estimate: once for each program, in their order
    #[arg(long, value_name = "FILE")]
    motion: Vec<PathBuf>,
    /// Coefficients, set-up errors and effects of a model that `diagnose` has written
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Where everything random begins; overrides the scenario's
    #[arg(long)]
    seed: Option<u64>,
    /// How often the test is repeated
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeats: u32,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let test = Test::read(&self.test)?;
        let machine = test.machine()?;
        talk.reads(&self.inputs(&test));
        let scenario = self.scenario_of(&test, &machine)?;
        let programs = self.driven(virtual_test::programs(&test, &machine)?)?;
        let progress = talk.progress(programs.len() * self.repeats as usize, "simulating");
        let done = || progress.inc(1);
        let simulated =
            virtual_test::simulate(&test, &machine, &scenario, &programs, self.repeats, &done);
        talk.ended(&progress);
        let simulated = simulated?;
        let mut files = Files::of(common, self.inputs(&test));
        for (index, program) in programs.iter().enumerate() {
            if programs[..index].iter().all(|before| before.file != program.file) {
                files.add(&program.file, program.text.clone());
            }
        }
        for one in &simulated {
            files.add(&one.log, one.run.csv());
        }
        let truth = virtual_test::truth(&test, &machine, &scenario, &programs, &simulated)?;
        files.add("truth.toml", truth);
        files.add("test.toml", self.test_of(&test, &programs, &simulated, common.directory())?);
        let files = files.write()?.files;
        if common.json {
            let names: Vec<_> = files.iter().map(|file| file.display().to_string()).collect();
            return output::print_json("simulate", serde_json::json!({ "files": names }));
        }
        for file in files {
            output::print(&format!("{}\n", file.display()))?;
        }
        talk.say(&format!(
            "analyse them with: ballbar analyse {}",
            output::typed(&common.directory().join("test.toml"))
        ));
        Ok(())
    }

    /// The scenario of the file with what the command line adds.
    fn scenario_of(&self, test: &Test, machine: &Machine) -> Result<Scenario> {
        let mut scenario = match &self.scenario {
            Some(file) => Scenario::read(file)?,
            None => virtual_test::usual_scenario(test),
        };
        if let Some(seed) = self.seed {
            scenario.seed = seed;
        }
        if let Some(file) = &self.model {
            scenario.take(&ModelFile::read(file)?)?;
        }
        for effect in &self.hide {
            scenario.hide(Effect::parse(effect)?)?;
        }
        if !self.paper {
            virtual_test::draw_machine(&mut scenario, test, machine);
        }
        Ok(scenario)
    }

    /// The programs with what was recorded of each.
    fn driven(&self, mut programs: Vec<VirtualProgram>) -> Result<Vec<VirtualProgram>> {
        if !self.motion.is_empty() && self.motion.len() != programs.len() {
            return Err(Error::input(format!(
                "{} recorded motion(s) for {} program(s)",
                self.motion.len(),
                programs.len()
            ))
            .at(Place::file(&self.test))
            .hint("give `--motion` once for each program of the test, in their order"));
        }
        for (program, file) in programs.iter_mut().zip(&self.motion) {
            program.motion = Some(Arc::new(Recording::read(file)?));
        }
        Ok(programs)
    }

    /// The files that are read.
    fn inputs(&self, test: &Test) -> Vec<PathBuf> {
        let beside = self.scenario.iter().chain(&self.model).chain(&self.motion);
        test.files().into_iter().chain(beside.cloned()).collect()
    }

    /// The test file with the simulated runs in place of its own.
    fn test_of(
        &self,
        test: &Test,
        programs: &[VirtualProgram],
        simulated: &[VirtualRun],
        folder: &Path,
    ) -> Result<String> {
        let faulty = |what: String| Error::new(Kind::Output, what);
        let source = crate::toml_text::read(&self.test)?;
        let mut table: toml::Table =
            toml::from_str(&source).map_err(|error| faulty(error.to_string()))?;
        let machine = test.machine()?;
        let named = path_from(folder, machine.file())?;
        table.insert("machine".into(), named.into());
        // The simulated log has the usual columns, whatever the measured ones had.
        table.remove("log");
        let runs: Vec<toml::Value> = simulated
            .iter()
            .map(|one| {
                let program = &programs[one.program];
                let mut run = toml::Table::new();
                run.insert("program".into(), program.file.clone().into());
                run.insert("log".into(), one.log.clone().into());
                let mounting = test.mountings()[program.mounting].name.clone();
                run.insert("mounting".into(), mounting.into());
                run.insert("repeat".into(), i64::from(one.repeat).into());
                run.into()
            })
            .collect();
        table.insert("run".into(), runs.into());
        toml::to_string(&table).map_err(|error| faulty(error.to_string()))
    }
}
