//! The two files that somebody begins with.

use std::path::Path;

use nalgebra::Vector3;

use super::machine_file::machine_file;
use super::place::place_mm;
use super::test_file::{PROGRAM_NUMBER, test_file};
use super::travel::Travel;
use super::wish::{MACHINE_FILE, Wish};
use crate::design::PlannedProgram;
use crate::error::{Error, Result};
use crate::machine::Machine;
use crate::nc;
use crate::plan::Test;

/// A machine file and a test file, checked, the balls where the test fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Begun {
    /// Text of the machine file.
    pub machine_text: String,
    /// Text of the test file.
    pub test_text: String,
    /// What the one says.
    pub machine: Machine,
    /// What the other says.
    pub test: Test,
    /// Of what was measured already, the file and the text of the program that its test file names.
    pub program: Option<(String, String)>,
}

/// Bars that a kit is put together to, mm, the commonest first; calibrated lengths but for the last.
const BARS_MM: [f64; 3] = [150.0, 100.0, 50.0];

impl Begun {
    /// Name of the machine file.
    pub const MACHINE: &'static str = MACHINE_FILE;
    /// Name of the test file, which names the other.
    pub const TEST: &'static str = "test.toml";

    /// Writes both for a folder, and checks them by reading them.
    ///
    /// # Errors
    /// A number that is beyond its bounds; a test that does not fit into the travel with the bar that was asked for, or
    /// with any of the usual ones.
    pub fn new(wish: &Wish, folder: &Path) -> Result<Self> {
        // Nobody has these files yet: what speaks against them is told of the options.
        Self::checked(wish, folder).map_err(|error| Error {
            place: None,
            hint: Some(format!(
                "nothing was written; the travel is {} (`--travel`, machine coordinates of X, Y and Z in mm): give another one, \
                 {}",
                Travel::text(&wish.travel_mm),
                if wish.measured.is_some() {
                    "that of the machine, or with `--arc` the degrees that were measured, such as 220"
                } else {
                    "a shorter `--bar`, a lower `--feed`, or a `--test` that needs less"
                }
            )),
            ..error
        })
    }

    fn checked(wish: &Wish, folder: &Path) -> Result<Self> {
        let machine_text = machine_file(wish);
        let machine = Machine::parse(&machine_text, &folder.join(Self::MACHINE))?;
        let program_file = nc::file_name(&machine, PROGRAM_NUMBER);
        let with = |bar_mm: f64| {
            let parse = |place_mm: &Vector3<f64>| {
                let text = test_file(wish, bar_mm, place_mm, &program_file);
                Test::parse(&text, &folder.join(Self::TEST)).map(|test| (text, test))
            };
            let (_, anywhere) = parse(&Vector3::zeros())?;
            parse(&place_mm(&anywhere, &machine)?)
        };
        let (test_text, test) = if let Some(bar_mm) = wish.bar_mm {
            with(bar_mm)?
        } else {
            // What speaks against the shortest bar speaks against all of them.
            let [first, second, last] = BARS_MM;
            with(first).or_else(|_| with(second)).or_else(|_| with(last))?
        };
        let measured = wish.measured.as_ref();
        let program = measured.map(|_| PlannedProgram::new(&test, &machine, 0)).transpose()?;
        let program = program.map(|program| (program.file_name, program.text));
        Ok(Self { machine_text, test_text, machine, test, program })
    }
}
