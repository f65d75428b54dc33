//! What a campaign of the trial drives.

use std::path::Path;
use std::sync::Arc;

use crate::design::PlannedProgram;
use crate::error::Result;
use crate::machine::Machine;
use crate::nc::{Program, Reading, Source};
use crate::plan::Test;

/// The machine of the built-in test.
const MACHINE: &str = include_str!("../../machines/hu40t.toml");
/// The built-in test: the 3D6 of the sample measurements.
const TEST: &str = r#"name = "Blind trial"
machine = "machine.toml"

[ball_bar]
length_mm = 150.0
range_mm = 1.2
resolution_um = 0.1
clock_ppm = 100.0

[[mounting]]
name = "A"
coincidence_mm = [20.0, -35.0, 40.0]
tool_ball_mm = [0.0, 0.0, -200.0]

[plan]
strategy = "3d6"
feed_mm_min = 500.0
program_number = 1005

[identify]
terms = ["observable35"]
"#;

/// Runs of the built-in campaign: how many, feed in mm/min, samples a second.
const RUNS: [(u32, f64, f64); 2] = [(3, 500.0, 10.0), (2, 1500.0, 30.0)];

/// One run of a campaign.
#[derive(Debug, Clone)]
pub struct CourseRun {
    /// What it is called.
    pub name: String,
    /// Index of its program.
    pub program: usize,
    /// Index of its mounting.
    pub mounting: usize,
    /// Runs of the same repeat are identified together.
    pub repeat: u32,
    /// Samples a second; `None` for what the test file says.
    pub sample_rate_hz: Option<f64>,
    /// Where the override knob stands, as a share of 1.
    pub feed_override: f64,
}

/// A program of a course.
#[derive(Debug)]
pub struct CourseProgram {
    /// Its text.
    pub source: Arc<Source>,
    /// What it drives.
    pub program: Program,
}

impl From<PlannedProgram> for CourseProgram {
    fn from(planned: PlannedProgram) -> Self {
        let source = Source { file: planned.program.file.clone(), text: planned.text };
        Self { source: Arc::new(source), program: planned.program }
    }
}

/// A test, its machine and the programs of its runs.
#[derive(Debug)]
pub struct Course {
    /// The test.
    pub test: Test,
    /// The machine.
    pub machine: Machine,
    /// The programs.
    pub programs: Vec<CourseProgram>,
    /// The runs, in the order of their repeats.
    pub runs: Vec<CourseRun>,
    /// Of the built-in campaign: the texts of its files.
    pub(super) texts: Option<Texts>,
}

/// Files that hold the machine and the test, without its runs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Texts {
    pub(super) machine_toml: &'static str,
    pub(super) test_toml: &'static str,
}

impl Course {
    /// Three runs of 3D6 at 500 mm/min and two at 1500 mm/min in one mounting of the HU40-T.
    ///
    /// # Errors
    /// When a program does not read back as it was planned.
    pub fn built_in() -> Result<Self> {
        let machine = Machine::parse(MACHINE, Path::new("hu40t.toml"))?;
        let test = Test::parse(TEST, Path::new("blind.toml"))?;
        let mut programs = Vec::new();
        let mut runs: Vec<CourseRun> = Vec::new();
        for (count, feed_mm_min, sample_rate_hz) in RUNS {
            let text = TEST.replace("500.0", &format!("{feed_mm_min:.1}"));
            let of_feed = Test::parse(&text, Path::new("blind.toml"))?;
            programs.push(CourseProgram::from(PlannedProgram::new(&of_feed, &machine, 0)?));
            for _ in 0..count {
                let number = runs.len() as u32 + 1;
                runs.push(CourseRun {
                    name: format!("run{number}"),
                    program: programs.len() - 1,
                    mounting: 0,
                    repeat: number,
                    sample_rate_hz: Some(sample_rate_hz),
                    feed_override: 1.0,
                });
            }
        }
        let texts = Some(Texts { machine_toml: MACHINE, test_toml: TEST });
        Ok(Self { test, machine, programs, runs, texts })
    }

    /// The runs of a test file or, where it has none or `repeats` are asked for and it has a plan, the
    /// programs of its plan, repeated.
    ///
    /// # Errors
    /// When a program cannot be read or planned.
    pub fn of(file: &Path, repeats: Option<u32>) -> Result<Self> {
        let test = Test::read(file)?;
        let machine = test.machine()?;
        let (mut programs, mut runs) = (Vec::new(), Vec::new());
        match test.runs() {
            Ok(measured) if repeats.is_none() || test.plan().is_err() => {
                for run in measured {
                    let mut reading = Reading::of(&machine);
                    let mounting = &test.mountings()[run.mounting];
                    reading
                        .work_offsets_mm
                        .insert(mounting.work_offset, mounting.mounting.coincidence_mm);
                    let source = Arc::new(Source::read(&run.program)?);
                    let program = source.program(&reading)?;
                    programs.push(CourseProgram { source, program });
                    runs.push(CourseRun {
                        name: run.name.clone(),
                        program: programs.len() - 1,
                        mounting: run.mounting,
                        repeat: run.repeat,
                        sample_rate_hz: None,
                        feed_override: run.feed_override,
                    });
                }
            }
            _ => {
                for mounting in 0..test.mountings().len() {
                    programs
                        .push(CourseProgram::from(PlannedProgram::new(&test, &machine, mounting)?));
                }
                for repeat in 1..=repeats.unwrap_or(5) {
                    runs.extend((0..programs.len()).map(|mounting| CourseRun {
                        name: format!("run{repeat}-{}", test.mountings()[mounting].name),
                        program: mounting,
                        mounting,
                        repeat,
                        sample_rate_hz: None,
                        feed_override: 1.0,
                    }));
                }
            }
        }
        runs.sort_by_key(|run| run.repeat);
        Ok(Self { test, machine, programs, runs, texts: None })
    }

    /// Runs that are identified together, by index.
    pub(super) fn repeats(&self) -> Vec<Vec<usize>> {
        let mut repeats: Vec<Vec<usize>> = Vec::new();
        for (index, run) in self.runs.iter().enumerate() {
            match repeats.last_mut() {
                Some(last) if self.runs[last[0]].repeat == run.repeat => last.push(index),
                _ => repeats.push(vec![index]),
            }
        }
        repeats
    }
}
