//! Checking a program: everything that is wrong with it, not only what comes first.
//!
//! A program is checked as [`read`](super::read()) follows it, so that nothing passes here that cannot be
//! followed later; a block that cannot be followed is told and left out, and the check goes on with
//! what its words say as far as they can be understood. On top of that come the rules of the control
//! and those of the ball-bar.
//!
//! An **error** is what a control refuses, what drives the machine elsewhere than meant, what damages
//! the bar, or what leaves nothing to analyse. A **warning** is worth a look.
//!
//! | rules | need |
//! | --- | --- |
//! | characters, length of blocks, `%`, N and O numbers, size | the program and the controller's keys |
//! | words, modal groups, decimal points, spindle | the program |
//! | what is in force before the first motion | the dialect |
//! | travel | the work offset, from a test file; without one only the extent is held against the travel |
//! | reach, engagement, release, bar taken off, second start, sphere, sag, corners, stops inside arcs | the mounting and the bar of a test file |
//! | tool and spindle nose against the support of the workpiece ball | the same, and `[clearance]` of the machine file |
//!
//! **Not checked:** workpiece, fixture and machine beside these bodies, compensation that is switched on in the
//! control, what the operator does at a stop.

mod arcs;
mod bar;
mod bodies;
mod findings;
mod path;
mod power_on;
mod sphere;
mod start;
mod text;
mod words;

use std::path::Path;

pub use findings::{Finding, Severity};
pub use sphere::Sphere;

use findings::Findings;

use super::grammar::Grammar;
use super::listing::Listing;
use super::program::Program;
use super::reading::Reading;
use super::run;
use crate::error::Result;
use crate::machine::Machine;

/// What a check has found.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// In the order of the file.
    pub findings: Vec<Finding>,
    /// Blocks of the file.
    pub blocks: usize,
    /// The program as far as it could be followed.
    pub program: Program,
}

impl Checked {
    /// How many findings are of a severity, those counted with another included.
    pub fn count(&self, severity: Severity) -> usize {
        let of = self.findings.iter().filter(|finding| finding.severity == severity);
        of.map(|finding| 1 + finding.more).sum()
    }
}

/// Checks a program on a machine, and around a ball-bar if one is given.
///
/// `reading` says what the control knows: without the sphere, a work offset that it does not name is
/// taken as zero.
///
/// # Errors
/// When there is nothing to check: an empty file.
///
/// ```
/// use ballbar::machine::Machine;
/// use ballbar::nc::{self, Reading, Severity};
///
/// let machine = Machine::read("machines/hu40t.toml".as_ref())?;
/// let source = "%\nO1\nG21 G90 G94 G40 G49 G80 G54\nG00 X0. Y0. Z0.\nG01 X30 F600.\nM30\n%\n";
/// let checked = nc::check(source, "O1.nc".as_ref(), &machine, &Reading::of(&machine), None)?;
/// let error = checked.findings.iter().find(|f| f.severity == Severity::Error).unwrap();
/// assert_eq!(error.error.what, "X30 has no decimal point: the control reads 0.030 mm");
/// # Ok::<(), ballbar::Error>(())
/// ```
pub fn check(
    source: &str,
    file: &Path,
    machine: &Machine,
    reading: &Reading,
    sphere: Option<&Sphere>,
) -> Result<Checked> {
    let mut reading = reading.clone();
    if sphere.is_none() {
        for number in 54..=59 {
            reading.work_offsets_mm.entry(number).or_default();
        }
    }
    let mut findings = Findings::default();
    // What the reader cannot follow is kept, and it goes on.
    let mut keep = |error| {
        findings.error("reading", error);
        Ok(())
    };
    let listing = Listing::new(source, file, &reading, &mut keep)?;
    let ran = run::run(&listing, &reading, run::MOST_BLOCKS, &mut keep)?;
    let controller = machine.controller();
    let grammar = Grammar::of(controller.dialect);
    text::check(&listing, controller, &mut findings);
    words::check(&listing, &ran, controller, &mut findings);
    path::check(&listing, &ran, machine, sphere.is_some(), &mut findings);
    power_on::check(&listing, &ran, grammar, &mut findings);
    if let Some(sphere) = sphere {
        bar::check(&listing, &ran, machine, sphere, &mut findings);
    }
    Ok(Checked {
        findings: findings.sorted(&listing),
        blocks: listing.blocks.len(),
        program: Program {
            file: file.to_path_buf(),
            number: listing.sections.first().and_then(|main| main.number),
            labels: listing.labels,
            steps: ran.steps,
        },
    })
}
