//! G and M words: what they are called, and what excludes what.

use super::word::{Fault, Word};
use crate::machine::Dialect;

/// How X, Y and Z are followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motion {
    /// G00.
    Rapid,
    /// G01.
    Line,
    /// G02 when false, G03 when true.
    Arc {
        /// Counter-clockwise, looking against the axis normal to the plane.
        counter_clockwise: bool,
    },
}

/// A function that switches the look-ahead of the control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LookAhead {
    /// The address of its argument.
    pub(crate) letter: u8,
    /// The argument that switches it on; 0 switches it off.
    pub(crate) on: u32,
}

/// What a G word says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
    /// G00 to G03.
    Motion(Motion),
    /// G17, G18, G19: the axis normal to the plane, 2, 1 or 0.
    Plane(usize),
    /// G20 (true), G21.
    Inch(bool),
    /// G91 (true), G90.
    Incremental(bool),
    /// G54 to G59.
    WorkOffset(u8),
    /// G61 (true), G64.
    ExactStopMode(bool),
    /// A word that states what holds anyway: G15, G40, G49, G50, G69, G80, G94.
    Default(u8),
    /// G09.
    ExactStop,
    /// G04.
    Dwell,
    /// G53.
    MachineCoordinates,
    /// G05, G05.1, G08.
    LookAhead(LookAhead),
}

impl Code {
    /// The meaning of a G word.
    pub(crate) fn of(word: &Word, dialect: Dialect) -> Result<Self, Fault> {
        let tenths = (word.value * 10.0).round();
        // G05.1 is a name, not a quantity; G1. or G17.0 is neither.
        let is_name = word.value >= 0.0
            && (word.value * 10.0 - tenths).abs() < 1e-9
            && word.point == (tenths % 10.0 != 0.0);
        if !is_name || tenths > 9999.0 {
            return Err(unknown(word));
        }
        let tenths = tenths as u32;
        match (dialect, tenths) {
            (Dialect::LinuxCnc, 50 | 51 | 80 | 90 | 150 | 500 | 690) => return Err(unknown(word)),
            (Dialect::LinuxCnc, 611) => return Ok(Self::ExactStopMode(true)),
            _ => {}
        }
        Ok(match tenths {
            0 => Self::Motion(Motion::Rapid),
            10 => Self::Motion(Motion::Line),
            20 => Self::Motion(Motion::Arc { counter_clockwise: false }),
            30 => Self::Motion(Motion::Arc { counter_clockwise: true }),
            40 => Self::Dwell,
            50 => Self::LookAhead(LookAhead { letter: b'P', on: 10_000 }),
            51 => Self::LookAhead(LookAhead { letter: b'Q', on: 1 }),
            80 => Self::LookAhead(LookAhead { letter: b'P', on: 1 }),
            90 => Self::ExactStop,
            170 => Self::Plane(2),
            180 => Self::Plane(1),
            190 => Self::Plane(0),
            200 => Self::Inch(true),
            210 => Self::Inch(false),
            150 => Self::Default(15),
            400 => Self::Default(40),
            490 => Self::Default(49),
            500 => Self::Default(50),
            530 => Self::MachineCoordinates,
            tenths @ (540 | 550 | 560 | 570 | 580 | 590) => Self::WorkOffset((tenths / 10) as u8),
            610 => Self::ExactStopMode(true),
            640 => Self::ExactStopMode(false),
            690 => Self::Default(69),
            800 => Self::Default(80),
            900 => Self::Incremental(false),
            910 => Self::Incremental(true),
            940 => Self::Default(94),
            _ => return Err(unknown(word)),
        })
    }

    /// What excludes each other in one block: a number below 16 and its name.
    pub(crate) fn group(self) -> (u16, &'static str) {
        match self {
            Self::Motion(_) => (0, "the kind of motion"),
            Self::Plane(_) => (1, "the plane"),
            Self::Inch(_) => (2, "inch or metric"),
            Self::Incremental(_) => (3, "absolute or incremental"),
            Self::WorkOffset(_) => (4, "the work offset"),
            Self::ExactStopMode(_) => (5, "exact stop or cutting mode"),
            Self::Default(40) => (6, "cutter compensation"),
            Self::Default(49) => (7, "tool length compensation"),
            Self::Default(80) => (8, "fixed cycles"),
            Self::Default(15) => (12, "polar coordinates"),
            Self::Default(50) => (13, "scaling"),
            Self::Default(69) => (14, "rotation of coordinates"),
            Self::Default(_) => (9, "the kind of feed"),
            Self::ExactStop => (10, "exact stop"),
            Self::Dwell | Self::MachineCoordinates | Self::LookAhead(_) => {
                (11, "functions of one block")
            }
        }
    }
}

/// What an M word says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Miscellaneous {
    /// M00.
    Stop,
    /// M01.
    OptionalStop,
    /// M02, M30.
    End,
    /// M98.
    Call,
    /// M99.
    Return,
    /// Spindle and coolant: M03, M04, M05, M08, M09.
    NoMotion,
}

impl Miscellaneous {
    /// The meaning of an M word.
    pub(crate) fn of(word: &Word) -> Result<Self, Fault> {
        Ok(match word.whole() {
            Some(0) => Self::Stop,
            Some(1) => Self::OptionalStop,
            Some(2 | 30) => Self::End,
            Some(3 | 4 | 5 | 8 | 9) => Self::NoMotion,
            Some(98) => Self::Call,
            Some(99) => Self::Return,
            _ => return Err(unknown(word)),
        })
    }
}

/// A word that this reader does not know, with what is known about it.
pub(crate) fn unknown(word: &Word) -> Fault {
    let hint = match (word.letter, word.value as u32) {
        (b'G', 5 | 8 | 9) => {
            "this control has no such word: take it out, or name the dialect of the program in the machine file"
        }
        (b'G', 28 | 30) => {
            "where the reference point is and how it is reached is not known here: position with G00 G53"
        }
        (b'G', 41 | 42) => {
            "cutter compensation moves the path by a value that the program does not hold: use G40"
        }
        (b'G', 43 | 44) | (b'H', _) => {
            "tool length compensation moves the path by a value that the program does not hold: put it into the work offset"
        }
        (b'D', _) => "cutter compensation moves the path by a value that the program does not hold",
        (b'G', 10 | 51 | 52 | 68 | 92) => "put every shift of the coordinates into the work offset",
        (b'G', 54) => "work offsets are G54 to G59",
        (b'G', 65..=67) => "macros are not followed: write the coordinates as numbers",
        (b'G', 70..=89) => "fixed cycles are not followed: write their moves",
        (b'G', 93 | 95) => "the feed is in mm/min or inch/min: G94",
        (b'A' | b'B' | b'C', _) => {
            "the path is one of X, Y and Z: set rotary axes before the program"
        }
        (b'U' | b'V' | b'W', _) => "the axes are X, Y and Z; U belongs to G04",
        (b'I' | b'J' | b'K' | b'R', _) => "it belongs to an arc, G02 or G03",
        (b'P' | b'Q' | b'L', _) => "it belongs to G04, G05, G05.1, G08 or M98",
        (b'M', 6) => "change the tool before the program",
        _ => "nothing is skipped, because it may move the machine: remove it if it does not",
    };
    let what = if matches!(word.letter, b'G' | b'M') {
        format!("{} is not known", word.name())
    } else {
        format!("{} has no meaning in this block", word.name())
    };
    Fault::word(word, what).hint(hint)
}
