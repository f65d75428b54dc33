//! A whole test on a virtual machine: its programs, every run of each, and the truth behind their logs.

use std::path::Path;
use std::sync::Arc;

use crate::design::PlannedProgram;
use crate::error::Result;
use crate::log::Recording;
use crate::machine::Machine;
use crate::nc;
use crate::plan::Test;
use crate::simulate::{
    Coincidence, Scenario, SimulatedRun, TrueRun, at_the_place, run, truth_toml,
};

/// A program to simulate, and the mounting it runs in.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualProgram {
    /// Name under which it is written; where it runs in several mountings, each time the same.
    pub file: String,
    /// Its text.
    pub text: String,
    /// Index of the mounting.
    pub mounting: usize,
    /// How a real control drove it.
    pub motion: Option<Arc<Recording>>,
}

/// A run that was simulated, and the log that it wrote.
#[derive(Debug)]
pub struct VirtualRun {
    /// File name of the log.
    pub log: String,
    /// Index of the program that ran.
    pub program: usize,
    /// The runs of a repeat are identified together; counted from 1.
    pub repeat: u32,
    /// What came of it.
    pub run: SimulatedRun,
}

/// What a machine and an instrument are like of which nobody says anything else.
pub fn usual_scenario(test: &Test) -> Scenario {
    // In several places, far from the middle of the travel, an operator brings the balls together as the machine has them
    // there, or the bar would not reach.
    if test.mountings().len() > 1 {
        Scenario { coincidence: Coincidence::Touched, ..Scenario::default() }
    } else {
        Scenario::default()
    }
}

/// Draws a machine for a test from what its file takes for plausible, where the scenario does not say how it errs.
pub fn draw_machine(scenario: &mut Scenario, test: &Test, machine: &Machine) {
    let mountings: Vec<_> = test.mountings().iter().map(|m| m.mounting).collect();
    let longest_mm = (0..mountings.len()).map(|m| test.bar_of(m).length_mm);
    scenario.draw_machine(machine, &mountings, longest_mm.fold(0.0, f64::max));
}

/// The programs of a test's plan or, without a plan, those of its runs.
///
/// # Errors
/// When the plan leaves the travel, or a program cannot be read.
pub fn programs(test: &Test, machine: &Machine) -> Result<Vec<VirtualProgram>> {
    if test.plan().is_ok() {
        return (0..test.mountings().len())
            .map(|mounting| {
                let written = PlannedProgram::new(test, machine, mounting)?;
                Ok(VirtualProgram {
                    file: written.file_name,
                    text: written.text,
                    mounting,
                    motion: None,
                })
            })
            .collect();
    }
    let mut sources: Vec<VirtualProgram> = Vec::new();
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
        let text = nc::text_of(path)?;
        sources.push(VirtualProgram { file, text, mounting: run.mounting, motion: None });
    }
    Ok(sources)
}

/// Runs every program as often as the test is repeated, in the order in which the logs are written; `done` is called after
/// each.
///
/// # Errors
/// When a program cannot be followed, or the scenario hides what cannot be.
pub fn simulate(
    test: &Test,
    machine: &Machine,
    scenario: &Scenario,
    programs: &[VirtualProgram],
    repeats: u32,
    done: &dyn Fn(),
) -> Result<Vec<VirtualRun>> {
    let mut simulated: Vec<VirtualRun> = Vec::new();
    for repeat in 1..=repeats {
        for (index, source) in programs.iter().enumerate() {
            let mounting = &test.mountings()[source.mounting];
            let mut reading = nc::Reading::of(machine);
            reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
            let program = nc::read(&source.text, Path::new(&source.file), &reading)?;
            // Every run its own noise, and the same noise whichever other runs there are.
            let seed = scenario.seed.wrapping_add(u64::from(repeat - 1) * 1000 + index as u64);
            // Runs count in the order in which their logs are written and stand in the test file.
            let number = simulated.len() as u32 + 1;
            let mut scenario = scenario
                .clone()
                .with_seed(seed)
                .with_run_number(number)
                .with_mounting_number(source.mounting as u32 + 1);
            scenario.control.recorded.clone_from(&source.motion);
            let bar = test.bar_of(source.mounting);
            let run = run(machine, &mounting.mounting, &program, &bar, &scenario)?;
            simulated.push(VirtualRun {
                log: log_name(programs, index, repeat),
                program: index,
                repeat,
                run,
            });
            done();
        }
    }
    Ok(simulated)
}

/// What was put in, as TOML; see [`truth_toml`].
///
/// # Errors
/// When the chain cannot be followed at the place of the test.
pub fn truth(
    test: &Test,
    machine: &Machine,
    scenario: &Scenario,
    programs: &[VirtualProgram],
    runs: &[VirtualRun],
) -> Result<String> {
    let truths: Vec<TrueRun> = runs
        .iter()
        .map(|one| TrueRun { log: &one.log, program: &programs[one.program].file, run: &one.run })
        .collect();
    Ok(truth_toml(&truths, &asked_of(test, machine, scenario)?))
}

/// What is true at the place about which a machine was drawn.
fn asked_of(test: &Test, machine: &Machine, scenario: &Scenario) -> Result<Vec<(String, f64)>> {
    let Some(place) = &scenario.place else { return Ok(Vec::new()) };
    let mounting = &test.mountings()[0].mounting;
    at_the_place(machine, mounting, scenario, &place.middle_mm, &place.reach_mm)
}

/// What the log of a program is called, by what tells it from the others.
fn log_name(programs: &[VirtualProgram], index: usize, repeat: u32) -> String {
    let file = &programs[index].file;
    let alike = programs.iter().filter(|other| other.file == *file).count();
    match (programs.len(), alike) {
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
