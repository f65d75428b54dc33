//! `ballbar simulate`: logs of a virtual machine.

use std::path::{Path, PathBuf};

use clap::Args;

use super::common::Common;
use super::output::{self, Talk};
use super::results::{Files, path_from};
use crate::design::PlannedProgram;
use crate::error::{Error, Kind, Result};
use crate::machine::Machine;
use crate::model::{Effect, ModelFile};
use crate::nc;
use crate::plan::Test;
use crate::simulate::{
    Coincidence, Scenario, SimulatedRun, TrueRun, at_the_place, run, truth_toml,
};

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

/// A program to simulate, and the mounting it runs in.
struct Source {
    /// Name under which it is written; where it runs in several mountings, each time the same.
    file: String,
    text: String,
    mounting: usize,
}

/// A run that was simulated, and the log that it wrote.
struct Simulated {
    /// File name of the log.
    log: String,
    /// Index of the program that ran.
    source: usize,
    repeat: u32,
    run: SimulatedRun,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let test = Test::read(&self.test)?;
        let machine = test.machine()?;
        talk.reads(&self.inputs(&test));
        let scenario = self.scenario_of(&test, &machine)?;
        let sources = Self::sources(&test, &machine)?;
        let progress = talk.progress(sources.len() * self.repeats as usize, "simulating");
        let simulated = self.simulate(&test, &machine, &scenario, &sources, &|| progress.inc(1));
        talk.ended(&progress);
        let simulated = simulated?;
        let mut files = Files::of(common, self.inputs(&test));
        for (index, source) in sources.iter().enumerate() {
            if sources[..index].iter().all(|before| before.file != source.file) {
                files.add(&source.file, source.text.clone());
            }
        }
        for one in &simulated {
            files.add(&one.log, one.run.csv());
        }
        let truths: Vec<TrueRun> = simulated
            .iter()
            .map(|one| TrueRun { log: &one.log, program: &sources[one.source].file, run: &one.run })
            .collect();
        files.add("truth.toml", truth_toml(&truths, &asked_of(&test, &machine, &scenario)?));
        files.add("test.toml", self.test_of(&test, &sources, &simulated, common.directory())?);
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
            common.directory().join("test.toml").display()
        ));
        Ok(())
    }

    /// The scenario of the file with what the command line adds.
    fn scenario_of(&self, test: &Test, machine: &Machine) -> Result<Scenario> {
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
        if !self.paper {
            let mountings: Vec<_> = test.mountings().iter().map(|m| m.mounting).collect();
            let longest_mm = (0..mountings.len()).map(|m| test.bar_of(m).length_mm);
            scenario.draw_machine(machine, &mountings, longest_mm.fold(0.0, f64::max));
        }
        Ok(scenario)
    }

    /// Every program as often as the test is repeated, in the order in which the logs are written.
    fn simulate(
        &self,
        test: &Test,
        machine: &Machine,
        scenario: &Scenario,
        sources: &[Source],
        done: &dyn Fn(),
    ) -> Result<Vec<Simulated>> {
        let mut simulated: Vec<Simulated> = Vec::new();
        for repeat in 1..=self.repeats {
            for (index, source) in sources.iter().enumerate() {
                let mounting = &test.mountings()[source.mounting];
                let mut reading = nc::Reading::of(machine);
                reading
                    .work_offsets_mm
                    .insert(mounting.work_offset, mounting.mounting.coincidence_mm);
                let program = nc::read(&source.text, Path::new(&source.file), &reading)?;
                // Every run its own noise, and the same noise whichever other runs there are.
                let seed = scenario.seed.wrapping_add(u64::from(repeat - 1) * 1000 + index as u64);
                // Runs count in the order in which their logs are written and stand in the test file.
                let number = simulated.len() as u32 + 1;
                let scenario = scenario
                    .clone()
                    .with_seed(seed)
                    .with_run_number(number)
                    .with_mounting_number(source.mounting as u32 + 1);
                let bar = test.bar_of(source.mounting);
                let run = run(machine, &mounting.mounting, &program, &bar, &scenario)?;
                simulated.push(Simulated {
                    log: log_name(sources, index, repeat),
                    source: index,
                    repeat,
                    run,
                });
                done();
            }
        }
        Ok(simulated)
    }

    /// The files that are read.
    fn inputs(&self, test: &Test) -> Vec<PathBuf> {
        test.files().into_iter().chain(self.scenario.clone()).chain(self.model.clone()).collect()
    }

    fn sources(test: &Test, machine: &Machine) -> Result<Vec<Source>> {
        if test.plan().is_ok() {
            return (0..test.mountings().len())
                .map(|mounting| {
                    let written = PlannedProgram::new(test, machine, mounting)?;
                    Ok(Source { file: written.file_name, text: written.text, mounting })
                })
                .collect();
        }
        let mut sources: Vec<Source> = Vec::new();
        // Programs in the order in which runs name them, and in which mountings they run.
        let mut programs: Vec<(&Path, String)> = Vec::new();
        let mut seen: Vec<(&Path, usize)> = Vec::new();
        for run in test.runs()? {
            let path = run.program.as_path();
            if seen.contains(&(path, run.mounting)) {
                continue;
            }
            seen.push((path, run.mounting));
            let known = programs.iter().find(|(program, _)| *program == path);
            let file = known.map_or_else(|| free_name(path, &programs), |(_, file)| file.clone());
            programs.push((path, file.clone()));
            let text = crate::nc::text_of(path)?;
            sources.push(Source { file, text, mounting: run.mounting });
        }
        Ok(sources)
    }

    /// The test file with the simulated runs in place of its own.
    fn test_of(
        &self,
        test: &Test,
        sources: &[Source],
        simulated: &[Simulated],
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
                let source = &sources[one.source];
                let mut run = toml::Table::new();
                run.insert("program".into(), source.file.clone().into());
                run.insert("log".into(), one.log.clone().into());
                let mounting = test.mountings()[source.mounting].name.clone();
                run.insert("mounting".into(), mounting.into());
                run.insert("repeat".into(), i64::from(one.repeat).into());
                run.into()
            })
            .collect();
        table.insert("run".into(), runs.into());
        toml::to_string(&table).map_err(|error| faulty(error.to_string()))
    }
}

/// What is true at the place about which a machine was drawn.
fn asked_of(test: &Test, machine: &Machine, scenario: &Scenario) -> Result<Vec<(String, f64)>> {
    let Some(place) = &scenario.place else { return Ok(Vec::new()) };
    let mounting = &test.mountings()[0].mounting;
    at_the_place(machine, mounting, scenario, &place.middle_mm, &place.reach_mm)
}

/// What the log of a program is called, by what tells it from the others.
fn log_name(sources: &[Source], index: usize, repeat: u32) -> String {
    let file = &sources[index].file;
    let alike = sources.iter().filter(|other| other.file == *file).count();
    match (sources.len(), alike) {
        (1, _) => format!("run{repeat}.csv"),
        (_, 1) => format!("run{repeat}-{}.csv", stem(file)),
        // One program, run in several mountings.
        _ => format!("run{repeat}-{}-{}.csv", stem(file), index + 1),
    }
}

/// The file name of a program, with a number where another directory has a program of that name: file systems may
/// not tell upper from lower case.
fn free_name(program: &Path, taken: &[(&Path, String)]) -> String {
    let name = program.file_name().map_or(String::new(), |name| name.to_string_lossy().into());
    let name = name.trim_end_matches(".gz");
    let free =
        |name: &String| taken.iter().all(|(_, taken)| taken.to_lowercase() != name.to_lowercase());
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, "nc"));
    // One of so many names is free.
    let numbers = 2..=taken.len() + 2;
    std::iter::once(name.to_owned())
        .chain(numbers.map(|number| format!("{stem}-{number}.{extension}")))
        .find(free)
        .unwrap_or_default()
}

fn stem(file: &str) -> &str {
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}
