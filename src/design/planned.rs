//! The program of a mounting: planned, written, read back, timed.

use crate::error::{Error, Kind, Result};
use crate::machine::Machine;
use crate::motion::Trajectory;
use crate::nc::{self, Program, ReadBack, Reading, Severity, Sphere};
use crate::plan::{Path, Test};

/// A program that was written and read back.
#[derive(Debug, Clone)]
pub struct PlannedProgram {
    /// Name of its file, such as `O1001.nc`.
    pub file_name: String,
    /// Index of the mounting.
    pub mounting: usize,
    /// Its name.
    pub mounting_name: String,
    /// What was planned.
    pub path: Path,
    /// The text for the control.
    pub text: String,
    /// What the control makes of the text.
    pub program: Program,
    /// How the one compares with the other.
    pub back: ReadBack,
    /// The program with its times.
    pub trajectory: Trajectory,
}

impl PlannedProgram {
    /// Plans and writes the program of a mounting, by its index, and reads it back.
    ///
    /// # Errors
    /// When it leaves the travel; and when it does not come back within 0.75 of the last decimal: then it
    /// must not reach a machine.
    pub fn new(test: &Test, machine: &Machine, mounting: usize) -> Result<Self> {
        let path = Path::plan(test, machine, mounting)?;
        let text = nc::write(test, machine, &path)?;
        let file_name = nc::file_name(machine, test.plan()?.program_number + mounting as u32);
        let named = &test.mountings()[mounting];
        let reading = reading_of(test, machine, mounting);
        let program = nc::read(&text, file_name.as_ref(), &reading)?;
        let back = nc::read_back(&program, test, &path)?;
        let last_decimal_mm = 10_f64.powi(-(machine.controller().decimals as i32));
        if back.worst_mm > 0.75 * last_decimal_mm {
            return Err(Error::new(
                Kind::Output,
                format!("the program reads back {} mm away from the plan", back.worst_mm),
            )
            .hint("this is a fault of this tool; please report the test file"));
        }
        let trajectory = Trajectory::new(&program, machine, 1.0);
        let mounting_name = named.name.clone();
        Ok(Self { file_name, mounting, mounting_name, path, text, program, back, trajectory })
    }

    /// What speaks against running it: the errors of a check with its test.
    ///
    /// # Errors
    /// When it cannot be checked.
    pub fn objections(&self, test: &Test, machine: &Machine) -> Result<Vec<Error>> {
        let reading = reading_of(test, machine, self.mounting);
        let file = self.file_name.as_ref();
        let sphere = Sphere::of(test, self.mounting);
        let checked = nc::check(&self.text, file, machine, &reading, sphere.as_ref())?;
        let errors = checked.findings.into_iter().filter(|f| f.severity == Severity::Error);
        Ok(errors.map(|finding| finding.error).collect())
    }

    /// The same with what speaks against it in its header.
    #[must_use]
    pub fn warned(mut self, machine: &Machine, objections: &[Error]) -> Self {
        self.text = nc::with_warnings(&self.text, machine, objections.iter().map(|o| &*o.what));
        self
    }
}

/// How the control reads the program of a mounting.
fn reading_of(test: &Test, machine: &Machine, mounting: usize) -> Reading {
    let named = &test.mountings()[mounting];
    let mut reading = Reading::of(machine);
    reading.work_offsets_mm.insert(named.work_offset, named.mounting.coincidence_mm);
    reading
}
