//! How the language of each control is read: one entry of a table for each dialect.

use super::code::{Code, Held, LookAhead, Miscellaneous, Motion};
use super::word::{Fault, Letters, Word};
use crate::machine::Dialect;

/// How a dwell is written.
#[derive(Debug)]
pub(crate) struct Dwell {
    /// Addresses of its time.
    pub(crate) letters: Letters,
    /// Without a decimal point it counts in milliseconds.
    pub(crate) milliseconds: bool,
    /// No other word may stand in its block.
    pub(crate) alone: bool,
    /// Its longest time, s.
    pub(crate) longest_s: f64,
    /// What to write.
    pub(crate) hint: &'static str,
}

/// What holds where a program says nothing, and what it has to say for its path to be the same everywhere.
#[derive(Debug)]
pub(crate) struct Stating {
    /// What every path depends on, each group by the word that our programs write.
    pub(crate) depends: &'static [(Code, &'static str)],
    /// What a path may depend on.
    pub(crate) may_depend: &'static [(Code, &'static str)],
    /// The words that state a plane of arcs.
    pub(crate) planes: &'static str,
}

/// What files and blocks are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// Letters with numbers; programs with O numbers between two lines `%`.
    Numbered,
    /// Letters with numbers, longer words, and values behind `=`; the file is the program.
    Keywords,
    /// HEIDENHAIN Klartext.
    Klartext,
}

/// How comments begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Comments {
    /// `( )`; a `;` ends a block.
    Parentheses,
    /// `( )`, and `;` up to the end of the line.
    Both,
    /// `;` up to the end of the line.
    Semicolon,
}

/// How a dialect is read.
#[derive(Debug)]
pub(crate) struct Grammar {
    /// What files and blocks are made of.
    pub(crate) form: Form,
    /// How comments begin.
    pub(crate) comments: Comments,
    /// A number without a decimal point counts in least increments.
    pub(crate) increments: bool,
    /// How positioning to a place is written.
    pub(crate) rapid: &'static str,
    /// The same in machine coordinates.
    pub(crate) machine_rapid: &'static str,
    /// G64 and G61 may have P and Q.
    pub(crate) tolerance: bool,
    /// Positioning may lead each axis at its own rapid traverse.
    pub(crate) bends: bool,
    /// How a dwell is written.
    pub(crate) dwell: Dwell,
    /// What a program has to state.
    pub(crate) stating: Stating,
    /// G words by tenths of their number, where they are not those of all dialects.
    codes: fn(u32) -> Option<Code>,
    /// M words that are neither stop nor end nor spindle and coolant.
    calls: &'static [(u32, Miscellaneous)],
    /// What is known of words that are not followed: a letter, numbers from and to, and what to do.
    hints: &'static [(u8, u32, u32, &'static str)],
}

/// Eight digits of milliseconds, s.
const DIGITS_S: f64 = 99_999.999;
const METRIC: (Code, &str) = (Code::Inch(false), "G21");
const ABSOLUTE: (Code, &str) = (Code::Incremental(false), "G90");
const OFFSET: (Code, &str) = (Code::WorkOffset(54), "G54");
const PER_MINUTE: (Code, &str) = (Code::Default(Held::FeedKind), "G94");
const NO_RADIUS: (Code, &str) = (Code::Default(Held::CutterCompensation), "G40");
const NO_LENGTH: (Code, &str) = (Code::Default(Held::ToolLength), "G49");
const NO_CYCLE: (Code, &str) = (Code::Default(Held::FixedCycles), "G80");
const PLANE: (Code, &str) = (Code::Plane(2), "G17");
const CUTTING: (Code, &str) = (Code::ExactStopMode(false), "G64");

static FANUC: Grammar = Grammar {
    form: Form::Numbered,
    increments: true,
    comments: Comments::Parentheses,
    rapid: "G90 G00",
    machine_rapid: "G90 G00 G53",
    tolerance: false,
    bends: true,
    dwell: Dwell {
        letters: Letters::of(b"PXU"),
        milliseconds: true,
        alone: false,
        longest_s: DIGITS_S,
        hint: "write G04 P2000 or G04 X2.0 for two seconds, alone in a block",
    },
    stating: Stating {
        depends: &[METRIC, ABSOLUTE, OFFSET, PER_MINUTE, NO_RADIUS, NO_LENGTH, NO_CYCLE],
        may_depend: &[
            PLANE,
            CUTTING,
            (Code::Default(Held::Rotation), "G69"),
            (Code::Default(Held::PolarCoordinates), "G15"),
            (Code::Default(Held::Scaling), "G50"),
        ],
        planes: "G17, G18 or G19",
    },
    codes: |tenths| {
        Some(match tenths {
            50 => Code::LookAhead(LookAhead { letter: b'P', on: 10_000 }),
            51 => Code::LookAhead(LookAhead { letter: b'Q', on: 1 }),
            80 => Code::LookAhead(LookAhead { letter: b'P', on: 1 }),
            90 => Code::ExactStop,
            150 => Code::Default(Held::PolarCoordinates),
            500 => Code::Default(Held::Scaling),
            690 => Code::Default(Held::Rotation),
            _ => return iso(tenths),
        })
    },
    calls: ISO_CALLS,
    hints: &[],
};

static LINUXCNC: Grammar = Grammar {
    increments: false,
    comments: Comments::Both,
    tolerance: true,
    bends: false,
    dwell: Dwell {
        letters: Letters::of(b"P"),
        milliseconds: false,
        alone: false,
        longest_s: DIGITS_S,
        hint: "write G04 P2.0 for two seconds, alone in a block",
    },
    stating: Stating {
        depends: FANUC.stating.depends,
        may_depend: &[PLANE, CUTTING],
        planes: "G17, G18 or G19",
    },
    codes: |tenths| if tenths == 611 { Some(Code::ExactStopMode(true)) } else { iso(tenths) },
    hints: &[],
    ..FANUC
};

static SIEMENS: Grammar = Grammar {
    form: Form::Keywords,
    increments: false,
    comments: Comments::Semicolon,
    rapid: "G90 G0",
    machine_rapid: "G90 G0 SUPA",
    tolerance: false,
    bends: true,
    dwell: Dwell {
        letters: Letters::of(b"F"),
        milliseconds: false,
        alone: true,
        longest_s: DIGITS_S,
        hint: "write G4 F2. for two seconds, alone in a block",
    },
    stating: Stating {
        depends: &[
            (Code::Inch(false), "G710"),
            ABSOLUTE,
            OFFSET,
            PER_MINUTE,
            NO_RADIUS,
            (Code::Default(Held::ToolLength), "D0"),
            (Code::Default(Held::FixedCycles), "MCALL"),
        ],
        may_depend: &[
            PLANE,
            CUTTING,
            (Code::Default(Held::Transformation), "TRAFOOF"),
            (Code::Default(Held::Frames), "TRANS"),
            (Code::Default(Held::Compressor), "COMPOF"),
        ],
        planes: "G17, G18 or G19",
    },
    codes: |tenths| {
        Some(match tenths {
            90 => Code::ExactStop,
            600 => Code::ExactStopMode(true),
            640 => Code::ExactStopMode(false),
            1530 => Code::MachineCoordinates,
            7000 => Code::Inch(true),
            710 | 7100 => Code::Inch(false),
            0 | 10 | 20 | 30 | 40 | 170 | 180 | 190 | 400 | 540 | 550 | 560 | 570 | 900 | 910
            | 940 => return iso(tenths),
            _ => return None,
        })
    },
    calls: &[],
    hints: &[
        (b'G', 5, 8, "write arcs as G2 and G3 with their centre by I, J, K"),
        (b'G', 53, 53, "a base offset stays in force with it: write SUPA"),
        (b'G', 58, 59, "they shift the work offset that is in force: work offsets are G54 to G57"),
        (b'G', 70, 70, "the unit of F stays that of the control: write G710, or G700 for inches"),
        (b'G', 500, 599, "work offsets are G54 to G57"),
        (b'G', 641, 645, "it rounds the corners of the path: write G64"),
        (b'G', 74, 75, "where it leads is not known here: position with G0 SUPA"),
        (
            b'D',
            0,
            u32::MAX,
            "a tool offset moves the path by a value that the program does not hold: put it into the work offset and write D0",
        ),
        (b'M', 17, 99, "subprograms are files of their own, and are not followed"),
    ],
};

static HEIDENHAIN: Grammar = Grammar {
    form: Form::Klartext,
    increments: false,
    comments: Comments::Semicolon,
    rapid: "L and FMAX",
    machine_rapid: "L, FMAX and M91",
    tolerance: false,
    bends: false,
    dwell: Dwell {
        letters: Letters::of(b"P"),
        milliseconds: false,
        alone: true,
        longest_s: 3600.0,
        hint: "write CYCL DEF 9.0 DWELL TIME and after it CYCL DEF 9.1 DWELL 2.0 for two seconds",
    },
    stating: Stating {
        depends: &[(Code::Inch(false), "MM"), (Code::Default(Held::CutterCompensation), "R0")],
        may_depend: &[
            (Code::Default(Held::DatumShift), "CYCL DEF 7"),
            (Code::Default(Held::Mirror), "CYCL DEF 8"),
            (Code::Default(Held::Rotation), "CYCL DEF 10"),
            (Code::Default(Held::Scaling), "CYCL DEF 11"),
        ],
        planes: "TOOL CALL Z",
    },
    codes: |_| None,
    calls: &[],
    hints: &[],
};

const ISO_CALLS: &[(u32, Miscellaneous)] =
    &[(98, Miscellaneous::Call), (99, Miscellaneous::Return)];

/// G words that all dialects of RS-274 have.
fn iso(tenths: u32) -> Option<Code> {
    Some(match tenths {
        0 => Code::Motion(Motion::Rapid),
        10 => Code::Motion(Motion::Line),
        20 => Code::Motion(Motion::Arc { counter_clockwise: false }),
        30 => Code::Motion(Motion::Arc { counter_clockwise: true }),
        40 => Code::Dwell,
        170 => Code::Plane(2),
        180 => Code::Plane(1),
        190 => Code::Plane(0),
        200 => Code::Inch(true),
        210 => Code::Inch(false),
        400 => Code::Default(Held::CutterCompensation),
        490 => Code::Default(Held::ToolLength),
        530 => Code::MachineCoordinates,
        540 | 550 | 560 | 570 | 580 | 590 => Code::WorkOffset((tenths / 10) as u8),
        610 => Code::ExactStopMode(true),
        640 => Code::ExactStopMode(false),
        800 => Code::Default(Held::FixedCycles),
        900 => Code::Incremental(false),
        910 => Code::Incremental(true),
        940 => Code::Default(Held::FeedKind),
        _ => return None,
    })
}

impl Grammar {
    /// That of a dialect.
    pub(crate) fn of(dialect: Dialect) -> &'static Self {
        match dialect {
            Dialect::Fanuc => &FANUC,
            Dialect::LinuxCnc => &LINUXCNC,
            Dialect::Siemens => &SIEMENS,
            Dialect::Heidenhain => &HEIDENHAIN,
        }
    }

    /// The meaning of a G word.
    pub(crate) fn code(&self, word: &Word) -> Result<Code, Fault> {
        if let Some(keyword) = word.keyword {
            return Ok(keyword.code());
        }
        let tenths = (word.value * 10.0).round();
        // G05.1 is a name, not a quantity; G1. or G17.0 is neither.
        let is_name = word.value >= 0.0
            && (word.value * 10.0 - tenths).abs() < 1e-9
            && word.point == (tenths % 10.0 != 0.0);
        if !is_name || tenths > 9999.0 {
            return Err(self.unknown(word));
        }
        (self.codes)(tenths as u32).ok_or_else(|| self.unknown(word))
    }

    /// The meaning of an M word.
    pub(crate) fn miscellaneous(&self, word: &Word) -> Result<Miscellaneous, Fault> {
        Ok(match word.whole() {
            Some(0) => Miscellaneous::Stop,
            Some(1) => Miscellaneous::OptionalStop,
            Some(2 | 30) => Miscellaneous::End,
            Some(3 | 4 | 5 | 8 | 9) => Miscellaneous::NoMotion,
            number => {
                let call = self.calls.iter().find(|(call, _)| Some(*call) == number);
                call.ok_or_else(|| self.unknown(word))?.1
            }
        })
    }

    /// A word that this reader does not know, with what is known about it.
    pub(crate) fn unknown(&self, word: &Word) -> Fault {
        let number = word.value as u32;
        let own = self.hints.iter().find(|(letter, from, to, _)| {
            word.letter == *letter && (*from..=*to).contains(&number)
        });
        let hint = own.map_or_else(|| hint_of(word.letter, number), |(.., hint)| hint);
        let what = if matches!(word.letter, b'G' | b'M') {
            format!("{} is not known", word.name())
        } else {
            format!("{} has no meaning in this block", word.name())
        };
        Fault::word(word, what).hint(hint)
    }
}

/// What is known of words in any dialect.
fn hint_of(letter: u8, number: u32) -> &'static str {
    match (letter, number) {
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
    }
}
