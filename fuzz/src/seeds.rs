//! What mutations begin with: the project's own files, and programs and logs that the tool makes.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use ballbar::design::PlannedProgram;
use ballbar::machine::Machine;
use ballbar::nc::Reading;
use ballbar::plan::Test;
use ballbar::simulate::{self, Scenario};

/// Between the parts of an input that is several files.
pub const BETWEEN: &[u8] = b"\n=====\n";

/// A short test: every kind of arc, stops, an own bar, every table.
pub const SHORT_TEST: &str = include_str!("seeds/short.toml");
/// The same on a LinuxCNC, two mountings.
pub const OTHER_TEST: &str = include_str!("seeds/other.toml");
/// Circles in planes, for the other machine.
pub const PLANES_TEST: &str = include_str!("seeds/planes.toml");
/// A machine file with every key.
pub const FULL_MACHINE: &str = include_str!("seeds/machine.toml");
/// A LinuxCNC.
pub const OTHER_MACHINE: &str = include_str!("seeds/other-machine.toml");
/// A test with every key.
pub const FULL_TEST: &str = include_str!("seeds/test.toml");
/// A scenario with every key.
pub const SCENARIO: &str = include_str!("seeds/scenario.toml");
/// A model file with every table.
pub const MODEL: &str = include_str!("seeds/model.toml");

/// A file of the project; empty where it is not there.
#[must_use]
pub fn of_project(path: &str) -> Vec<u8> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    std::fs::read(file).unwrap_or_default()
}

/// Files of the project, by the end of their names, from a directory and those in it.
#[must_use]
pub fn all_of_project(directory: &str, end: &str) -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    let mut open = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(directory)];
    while let Some(directory) = open.pop() {
        let entries = std::fs::read_dir(directory).into_iter().flatten();
        for path in entries.filter_map(|entry| entry.ok().map(|entry| entry.path())) {
            if path.is_dir() {
                open.push(path);
            } else if path.to_string_lossy().ends_with(end) {
                files.push(path);
            }
        }
    }
    files.sort();
    files.iter().filter_map(|file: &PathBuf| std::fs::read(file).ok()).collect()
}

/// A machine and a test on it, with the programs that the tool writes for them.
#[derive(Debug)]
pub struct Rig {
    /// The machine.
    pub machine: Machine,
    /// The test.
    pub test: Test,
    /// Its programs, one for each mounting.
    pub programs: Vec<PlannedProgram>,
    /// A log of the first.
    pub log: String,
}

impl Rig {
    fn new(machine: &str, test: &str) -> Result<Self, ballbar::Error> {
        let machine = Machine::parse(machine, "machine.toml".as_ref())?;
        let test = Test::parse(test, "test.toml".as_ref())?;
        let programs = (0..test.mountings().len())
            .map(|mounting| PlannedProgram::new(&test, &machine, mounting))
            .collect::<Result<Vec<_>, _>>()?;
        let balls = test.mountings()[0].mounting;
        let scenario = Scenario::default();
        let run =
            simulate::run(&machine, &balls, &programs[0].program, &test.bar_of(0), &scenario)?;
        Ok(Self { machine, test, programs, log: run.csv() })
    }

    /// How its control reads the program of a mounting.
    #[must_use]
    pub fn reading(&self, mounting: usize) -> Reading {
        reading_of(&self.machine, &self.test, mounting)
    }
}

/// How a control reads the program of a mounting.
#[must_use]
pub fn reading_of(machine: &Machine, test: &Test, mounting: usize) -> Reading {
    let mut reading = Reading::of(machine);
    let named = &test.mountings()[mounting];
    reading.work_offsets_mm.insert(named.work_offset, named.mounting.coincidence_mm);
    reading
}

/// A short test on the Fanuc, two mountings on the LinuxCNC, planes on a Siemens and a HEIDENHAIN control.
///
/// # Panics
/// When one of them cannot be planned: then there is nothing to begin with.
pub static RIGS: LazyLock<[Rig; 4]> = LazyLock::new(|| {
    let speaks = |dialect: &str| OTHER_MACHINE.replace("linuxcnc", dialect);
    [
        (FULL_MACHINE.to_owned(), SHORT_TEST),
        (OTHER_MACHINE.to_owned(), OTHER_TEST),
        (speaks("siemens"), PLANES_TEST),
        (speaks("heidenhain"), PLANES_TEST),
    ]
    .map(|(machine, test)| {
        Rig::new(&machine, test).unwrap_or_else(|error| panic!("a seed cannot be planned: {error}"))
    })
});

/// Several texts as one input.
#[must_use]
pub fn joined(parts: &[&[u8]]) -> Vec<u8> {
    parts.join(BETWEEN)
}

/// The parts of an input that is several files; what is missing is empty.
#[must_use]
pub fn parts<const N: usize>(input: &[u8]) -> [&[u8]; N] {
    let mut rest = input;
    std::array::from_fn(|part| {
        let at = rest.windows(BETWEEN.len()).position(|window| window == BETWEEN);
        let Some(at) = at.filter(|_| part + 1 < N) else { return std::mem::take(&mut rest) };
        let (before, behind) = rest.split_at(at);
        rest = &behind[BETWEEN.len()..];
        before
    })
}

/// An input as text; what is no character is left to the targets of files.
#[must_use]
pub fn as_text(input: &[u8]) -> String {
    String::from_utf8_lossy(input).into_owned()
}
