//! How the words of each control are written: one entry of a table for each dialect.

use crate::machine::{Dialect, Machine};

/// How an arc says where its centre is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Centre {
    /// By the way from its start: I, J, K.
    FromStart,
    /// By a block before it: CC.
    Pole,
}

/// How a dialect is written. Pairs stand before and behind what they are about.
#[derive(Debug)]
pub(super) struct Spelling {
    /// Ending of the file of a program.
    ending: &'static str,
    /// What its name begins with, before the number.
    prefix: &'static str,
    /// A comment that is a line.
    pub(super) comment: [&'static str; 2],
    /// Comments that begin so are more than comments.
    pub(super) active: &'static [&'static str],
    /// The first blocks: what a path depends on.
    pub(super) safe: &'static [&'static str],
    /// Spindle and coolant off.
    pub(super) off: [&'static str; 2],
    /// Work offsets that it has, with how they are called; none where the operator chooses the datum.
    pub(super) offsets: &'static [u8],
    /// What the header says of the zero that the program counts from, and of the length of the tool.
    pub(super) zero: Option<&'static str>,
    pub(super) tool: &'static str,
    /// Positioning, in the work offset and in machine coordinates.
    pub(super) rapid: [&'static str; 2],
    pub(super) machine_rapid: [&'static str; 2],
    /// A straight line at feed, and one behind another.
    pub(super) line: [&'static str; 2],
    pub(super) chord: &'static str,
    /// The senses of arcs, clockwise first.
    pub(super) arc: [&'static str; 2],
    pub(super) centre: Centre,
    /// The block that says in which plane arcs without a plane of their own lie.
    pub(super) arc_plane: Option<&'static str>,
    /// Positive coordinates have a sign.
    pub(super) plus: bool,
    /// A whole feed ends with a point.
    pub(super) point: bool,
    /// All lines are numbered, from 0.
    pub(super) numbered: bool,
    /// Lines before the header.
    above: usize,
}

static FANUC: Spelling = Spelling {
    ending: "nc",
    prefix: "O",
    comment: ["(", ")"],
    active: &[],
    safe: &["G21 G17 G90 G94 G40 G49 G80"],
    off: ["M05", "M09"],
    offsets: &[54, 55, 56, 57, 58, 59],
    zero: None,
    tool: "TOOL LENGTH IS PART OF THE WORK OFFSET - G49 IS IN FORCE",
    rapid: ["G00 ", ""],
    machine_rapid: ["G00 G53 ", ""],
    line: ["G01 ", ""],
    chord: "",
    arc: ["G02", "G03"],
    centre: Centre::FromStart,
    arc_plane: None,
    plus: false,
    point: true,
    numbered: false,
    above: 2,
};

static LINUXCNC: Spelling = Spelling {
    // Messages, logs, files, Python.
    active: &["MSG", "PRINT", "DEBUG", "LOG", "PROBEOPEN", "PROBECLOSE", "ABORT", "PY"],
    ..FANUC
};

static SIEMENS: Spelling = Spelling {
    ending: "MPF",
    prefix: "BALLBAR_",
    comment: ["; ", ""],
    // Paths of archives, attributes of files, programs of steps.
    active: &["$", "*", "#"],
    safe: &["G710 G17 G90 G94 G40", "D0", "MCALL"],
    off: ["M5", "M9"],
    offsets: &[54, 55, 56, 57],
    zero: None,
    tool: "TOOL LENGTH IS PART OF THE WORK OFFSET - D0 IS IN FORCE",
    rapid: ["G0 ", ""],
    machine_rapid: ["G0 SUPA ", ""],
    line: ["G1 ", ""],
    chord: "",
    arc: ["G2", "G3"],
    centre: Centre::FromStart,
    arc_plane: None,
    plus: false,
    point: false,
    numbered: false,
    above: 1,
};

static HEIDENHAIN: Spelling = Spelling {
    ending: "H",
    prefix: "BALLBAR_",
    comment: ["; ", ""],
    active: &[],
    safe: &[],
    off: ["M5", "M9"],
    offsets: &[],
    zero: Some("DATUM"),
    tool: "THE TOOL THAT HOLDS THE BALL IS ACTIVE - ITS LENGTH COUNTS IN THE DATUM",
    rapid: ["L ", " R0 FMAX"],
    machine_rapid: ["L ", " R0 FMAX M91"],
    line: ["L ", " R0"],
    chord: "L ",
    arc: ["DR-", "DR+"],
    centre: Centre::Pole,
    arc_plane: Some("TOOL CALL Z"),
    plus: true,
    point: false,
    numbered: true,
    above: 2,
};

impl Spelling {
    /// That of a dialect.
    pub(super) fn of(dialect: Dialect) -> &'static Self {
        match dialect {
            Dialect::Fanuc => &FANUC,
            Dialect::LinuxCnc => &LINUXCNC,
            Dialect::Siemens => &SIEMENS,
            Dialect::Heidenhain => &HEIDENHAIN,
        }
    }

    /// What the program of a number is called.
    pub(super) fn name(&self, number: u32) -> String {
        format!("{}{number:04}", self.prefix)
    }

    /// The lines of one of the options of the control.
    pub(super) fn option(option: &str) -> Vec<&str> {
        match option {
            "CYCL DEF 7" => vec![
                "CYCL DEF 7.0 DATUM SHIFT",
                "CYCL DEF 7.1 X+0",
                "CYCL DEF 7.2 Y+0",
                "CYCL DEF 7.3 Z+0",
            ],
            "CYCL DEF 8" => vec!["CYCL DEF 8.0 MIRROR IMAGE", "CYCL DEF 8.1"],
            "CYCL DEF 10" => vec!["CYCL DEF 10.0 ROTATION", "CYCL DEF 10.1 ROT+0"],
            "CYCL DEF 11" => vec!["CYCL DEF 11.0 SCALING", "CYCL DEF 11.1 SCL 1"],
            words => vec![words],
        }
    }

    /// How the zero of a work offset is called.
    pub(super) fn zero(&self, work_offset: u8) -> String {
        self.zero.map_or_else(|| format!("G{work_offset}"), str::to_owned)
    }

    /// A text with numbers before its lines where the dialect has them.
    pub(super) fn number(&self, text: &str) -> String {
        if !self.numbered {
            return text.to_owned();
        }
        let lines = text.lines().enumerate().map(|(number, line)| format!("{number} {line}\n"));
        lines.collect()
    }

    /// A program with further lines behind its title.
    pub(super) fn with(&self, program: &str, lines: &[String]) -> String {
        let bare = |line: &'_ str| -> String {
            let line = if self.numbered {
                line.split_once(' ').map_or("", |(_, rest)| rest)
            } else {
                line
            };
            format!("{line}\n")
        };
        let mut all: Vec<String> = program.lines().map(bare).collect();
        let at = self.above.min(all.len());
        all.splice(at..at, lines.iter().cloned());
        self.number(&all.concat())
    }
}

/// The name of the file of a program by its number, such as `O1001.nc`.
pub fn file_name(machine: &Machine, number: u32) -> String {
    let spelling = Spelling::of(machine.controller().dialect);
    format!("{}.{}", spelling.name(number), spelling.ending)
}

/// The number that a program says it has in its first lines, by which it is named.
pub fn number_in(program: &str) -> Option<u32> {
    let behind = |prefix: &str, text: &str| -> Option<u32> {
        let digits: &str =
            text.split(prefix).nth(1)?.split(|c: char| !c.is_ascii_digit()).next()?;
        digits.parse().ok()
    };
    let numbered = program.lines().map(str::trim).find(|line| line.starts_with(FANUC.prefix));
    let named = program.lines().take(SIEMENS.above.max(HEIDENHAIN.above));
    let mut named = named.filter_map(|line| behind(SIEMENS.prefix, line));
    named.next().or_else(|| behind(FANUC.prefix, numbered?))
}
