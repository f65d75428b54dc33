//! Writing a planned path as a program of the control.

use askama::Template;

use super::header;
use super::spelling::Spelling;
use super::writer::{Line, Writer};
use crate::error::{Error, Kind, Place, Result};
use crate::machine::{Dialect, Machine};
use crate::plan::{Path, Step, Test};

/// A program in a language: what stands in it, and the template that puts it into words.
macro_rules! language {
    ($(#[$note:meta])* $name:ident, $path:tt) => {
        $(#[$note])*
        #[derive(Template)]
        #[template(path = $path, escape = "none")]
        struct $name<'a> {
            name: &'a str,
            title: &'a str,
            header: &'a [String],
            lines: &'a [Line],
        }
    };
}

language!(Fanuc, "fanuc.nc");
language! {
    /// With G64 alone, LinuxCNC would round the corners as far as its acceleration asks for; without Q0 it would put chords
    /// together as far as P lets it, and what was planned within 0.4 um would be driven within 10.
    LinuxCnc, "linuxcnc.nc"
}
language!(Siemens, "siemens.mpf");
language!(Heidenhain, "heidenhain.h");

/// The program of a path: header with machine, test and what to mount where; first what a path depends on and an operator or
/// another program may have left otherwise, the spindle standing and the coolant off; then G64, the
/// arcs in G01 chords or as G02 and G03, M30.
///
/// Chord blocks carry no N number: there are more of them than numbers. Every axis word has a decimal
/// point, because without one it counts in least increments. Coordinates are those of the mounting's
/// work offset, whose zero is the workpiece ball.
///
/// A program larger than the control's memory is divided: every arc and every transit becomes a
/// subprogram behind the main program, in the same file.
///
/// # Errors
/// When a single arc is larger than the memory, or there are no program numbers left for the arcs.
pub fn write(test: &Test, machine: &Machine, path: &Path) -> Result<String> {
    let whole = render(test, machine, path, None)?;
    let Some(memory_bytes) = machine.controller().memory_bytes.filter(|size| *size < whole.len())
    else {
        return Ok(whole);
    };
    let plan = test.plan()?;
    // Behind the main programs of all mountings, so that all fit into one control.
    let legs = path.legs.len() as u32;
    let first = plan.program_number + test.mountings().len() as u32 + path.mounting as u32 * legs;
    if first + legs > LARGEST_NUMBER + 1 {
        return Err(Error::input(format!(
            "the {legs} arcs of the program would need the numbers O{first} to O{}",
            first + legs - 1
        ))
        .hint(format!("numbers go to {LARGEST_NUMBER}: choose a smaller `program_number`")));
    }
    let divided = render(test, machine, path, Some(first))?;
    let largest = divided.split("\nO").map(|part| part.len() + 1).max().unwrap_or(0);
    if largest > memory_bytes {
        return Err(Error::input(format!(
            "an arc alone takes {} KB, and the control's memory is {} KB",
            largest.div_ceil(1024),
            memory_bytes / 1024
        ))
        .hint(
            "allow more `chord_sag_um`, or run the program from a card and leave `memory_kb` out",
        ));
    }
    Ok(divided)
}

/// With fewer the ends of an arc are rounded so far that their radii differ by more than a control lets pass.
const DECIMALS_OF_ARCS: usize = 3;

/// Largest program number that is free for users.
const LARGEST_NUMBER: u32 = 7999;

fn render(test: &Test, machine: &Machine, path: &Path, subprograms: Option<u32>) -> Result<String> {
    let plan = test.plan()?;
    let circular = |step: &Step| matches!(step, Step::Circular(..));
    if machine.controller().decimals < DECIMALS_OF_ARCS && path.steps.iter().any(circular) {
        return Err(Error::input(
            "with 2 decimals the two ends of an arc of G02 and G03 have radii up to 14 um apart, which controls refuse",
        )
        .at(Place::file(test.file()))
        .hint("write `interpolation = \"chords\"` in `[plan]`, or give the control the `decimals` that it has"));
    }
    let mounting = &test.mountings()[path.mounting];
    let spelling = Spelling::of(machine.controller().dialect);
    check_offset(test, machine, mounting.work_offset)?;
    let mut writer = Writer {
        controller: machine.controller(),
        spelling,
        lines: Vec::new(),
        subprograms: Vec::new(),
        next: subprograms,
        sequence: 0,
        at: None,
        zero_mm: mounting.mounting.coincidence_mm,
        work_offset: mounting.work_offset,
        feeding: false,
        feed_in_force: String::new(),
    };
    for words in spelling.safe {
        writer.block(words);
    }
    for option in &machine.controller().cancel_blocks {
        for words in Spelling::option(option) {
            writer.block(words);
        }
    }
    for words in spelling.off {
        writer.block(words);
    }
    if spelling.zero.is_none() {
        writer.block(&format!("G{}", mounting.work_offset));
    }
    if let Some(words) = spelling.arc_plane.filter(|_| path.steps.iter().any(circular)) {
        writer.block(words);
    }
    let n = writer.n();
    writer.lines.push(Line::Cutting(n));
    writer.steps(&path.steps);
    let n = writer.n();
    writer.lines.push(Line::End(n));
    writer.lines.append(&mut writer.subprograms);
    let comment = |text: String| writer.comment(&text);
    let name = spelling.name(plan.program_number + path.mounting as u32);
    let title = comment(header::title(plan, mounting));
    let header = header::lines(test, machine, path, spelling);
    let header: Vec<String> = header.into_iter().map(comment).collect();
    let (name, title, header, lines) = (&*name, &*title, &header[..], &writer.lines[..]);
    let rendered = match machine.controller().dialect {
        Dialect::Fanuc => Fanuc { name, title, header, lines }.render(),
        Dialect::LinuxCnc => LinuxCnc { name, title, header, lines }.render(),
        Dialect::Siemens => Siemens { name, title, header, lines }.render(),
        Dialect::Heidenhain => Heidenhain { name, title, header, lines }.render(),
    };
    let mut text = rendered.map_err(|error| {
        Error::new(Kind::Output, format!("the program template cannot be filled: {error}"))
    })?;
    if !text.ends_with('\n') {
        text.push('\n');
    }
    Ok(if spelling.numbered { spelling.number(&text) } else { text })
}

/// Whether the control has the work offset of a mounting.
fn check_offset(test: &Test, machine: &Machine, work_offset: u8) -> Result<()> {
    let offsets = Spelling::of(machine.controller().dialect).offsets;
    let (known, hint) = match offsets {
        [] => (
            work_offset == 54,
            "on this control the operator chooses the datum: leave `work_offset` out".to_owned(),
        ),
        [first, .., last] | [first @ last] => (
            offsets.contains(&work_offset),
            format!("on this control work offsets are G{first} to G{last}"),
        ),
    };
    if known {
        return Ok(());
    }
    Err(Error::input(format!("the control has no work offset G{work_offset}"))
        .at(Place::file(test.file()))
        .hint(hint))
}
