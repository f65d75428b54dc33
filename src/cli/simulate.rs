//! `ballbar simulate`: logs of a virtual machine.

use std::path::{Path, PathBuf};

use clap::Args;

use super::common::Common;
use super::output::{self, Files, Talk};
use crate::design::PlannedProgram;
use crate::error::{Error, Kind, Result};
use crate::model::{Effect, ModelFile};
use crate::nc;
use crate::plan::Test;
use crate::simulate::{Coincidence, Scenario, SimulatedRun, TrueRun, run, truth_toml};

/// Simulate the logs of a test on a virtual machine
///
/// The programs are those of the test's plan or, without a plan, those of its runs. Logs, programs, what
/// was put in (truth.toml) and a test file that names them all are written, ready for `ballbar analyse`.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar simulate test.toml -o virtual && ballbar analyse virtual/test.toml
  ballbar simulate test.toml --scenario warm.toml --repeats 5 --seed 7
  ballbar simulate test.toml --hide cyclic:on=EXX,period_mm=10,amplitude_um=1.2 \\
                             --hide drift:on=EZt,amplitude_um=6,time_constant_s=500

The causes that can be hidden, their keys and equations: section Causes of docs/reference.md")]
pub(super) struct Arguments {
    /// The test file
    #[arg(value_name = "TEST")]
    test: PathBuf,
    /// What the machine and the instrument are like; without it the paper's machine
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
    /// Hide an effect, besides those of the scenario: CAUSE:key=value,... Give it again for several
    #[arg(long, value_name = "EFFECT")]
    hide: Vec<String>,
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

/// A program to simulate: its text under a file name, and the mounting it runs in.
struct Source {
    file: String,
    text: String,
    mounting: usize,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let test = Test::read(&self.test)?;
        let machine = test.machine()?;
        let mut scenario = match &self.scenario {
            Some(file) => Scenario::read(file)?,
            // In several places, far from the middle of the travel, an operator brings the balls together
            // as the machine has them there, or the bar would not reach.
            None if test.mountings().len() > 1 => {
                Scenario { coincidence: Coincidence::Touched, ..Scenario::default() }
            }
            None => Scenario::default(),
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
        let sources = Self::sources(&test, &machine)?;
        let progress = talk.progress(sources.len() * self.repeats as usize, "simulating");
        let mut files = Files::default();
        let mut simulated: Vec<(String, usize, u32, SimulatedRun)> = Vec::new();
        for source in &sources {
            files.add(common.output.join(&source.file), source.text.clone());
        }
        for repeat in 1..=self.repeats {
            for (index, source) in sources.iter().enumerate() {
                let mounting = &test.mountings()[source.mounting];
                let mut reading = nc::Reading::of(&machine);
                reading
                    .work_offsets_mm
                    .insert(mounting.work_offset, mounting.mounting.coincidence_mm);
                let program = nc::read(&source.text, Path::new(&source.file), &reading)?;
                // Every run its own noise, and the same noise whichever other runs there are.
                let seed = scenario.seed.wrapping_add(u64::from(repeat - 1) * 1000 + index as u64);
                // Runs count in the order in which their logs are written and stand in the test file.
                let number = simulated.len() as u32 + 1;
                let done = run(
                    &machine,
                    &mounting.mounting,
                    &program,
                    &test.bar_of(source.mounting),
                    &scenario
                        .clone()
                        .with_seed(seed)
                        .with_run_number(number)
                        .with_mounting_number(source.mounting as u32 + 1),
                )?;
                let alike = sources.iter().filter(|other| other.file == source.file).count();
                let name = match (sources.len(), alike) {
                    (1, _) => format!("run{repeat}.csv"),
                    (_, 1) => format!("run{repeat}-{}.csv", stem(&source.file)),
                    // One program, run in several mountings.
                    _ => format!("run{repeat}-{}-{}.csv", stem(&source.file), index + 1),
                };
                files.add(common.output.join(&name), done.csv());
                simulated.push((name, index, repeat, done));
                progress.inc(1);
            }
        }
        progress.finish_and_clear();
        let truths: Vec<TrueRun> = simulated
            .iter()
            .map(|(log, source, _, run)| TrueRun { log, program: &sources[*source].file, run })
            .collect();
        files.add(common.output.join("truth.toml"), truth_toml(&truths));
        let runs: Vec<_> = simulated
            .iter()
            .map(|(log, source, repeat, _)| (log.as_str(), &sources[*source], *repeat))
            .collect();
        files.add(common.output.join("test.toml"), self.test_of(&test, &runs)?);
        let mut inputs = vec![self.test.clone(), machine.file().to_path_buf()];
        inputs.extend(self.scenario.clone());
        for run in test.runs().unwrap_or_default() {
            inputs.extend([run.program.clone(), run.log.clone()]);
        }
        files.keep(&inputs)?;
        let files = files.write()?;
        if common.json {
            let names: Vec<_> = files.iter().map(|file| file.display().to_string()).collect();
            return output::print(&format!("{:#}\n", serde_json::json!({ "files": names })));
        }
        for file in files {
            output::print(&format!("{}\n", file.display()))?;
        }
        talk.say(&format!(
            "analyse them with: ballbar analyse {}",
            common.output.join("test.toml").display()
        ));
        Ok(())
    }

    fn sources(test: &Test, machine: &crate::machine::Machine) -> Result<Vec<Source>> {
        if test.plan().is_ok() {
            return (0..test.mountings().len())
                .map(|mounting| {
                    let written = PlannedProgram::new(test, machine, mounting)?;
                    Ok(Source { file: written.file_name, text: written.text, mounting })
                })
                .collect();
        }
        let mut sources: Vec<Source> = Vec::new();
        for run in test.runs()? {
            let file =
                run.program.file_name().map_or(String::new(), |n| n.to_string_lossy().into());
            let file = file.trim_end_matches(".gz").to_owned();
            if sources.iter().all(|source| source.file != file || source.mounting != run.mounting) {
                let text = crate::nc::text_of(&run.program)?;
                sources.push(Source { file, text, mounting: run.mounting });
            }
        }
        Ok(sources)
    }

    /// The test file with the simulated runs in place of its own.
    fn test_of(&self, test: &Test, runs: &[(&str, &Source, u32)]) -> Result<String> {
        let faulty = |what: String| Error::new(Kind::Output, what);
        let source = crate::toml_text::read(&self.test)?;
        let mut table: toml::Table =
            toml::from_str(&source).map_err(|error| faulty(error.to_string()))?;
        let machine = test.machine()?.file().to_path_buf();
        let machine = std::fs::canonicalize(&machine).unwrap_or(machine);
        table.insert("machine".into(), machine.display().to_string().into());
        // The simulated log has the usual columns, whatever the measured ones had.
        table.remove("log");
        let runs: Vec<toml::Value> = runs
            .iter()
            .map(|(log, source, repeat)| {
                let mut run = toml::Table::new();
                run.insert("program".into(), source.file.clone().into());
                run.insert("log".into(), (*log).into());
                let mounting = test.mountings()[source.mounting].name.clone();
                run.insert("mounting".into(), mounting.into());
                run.insert("repeat".into(), i64::from(*repeat).into());
                run.into()
            })
            .collect();
        table.insert("run".into(), runs.into());
        toml::to_string(&table).map_err(|error| faulty(error.to_string()))
    }
}

fn stem(file: &str) -> &str {
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}
