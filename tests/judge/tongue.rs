//! How programs of each control say what faults are put into.

use ballbar::machine::Dialect;
use rand::seq::IndexedRandom;
use rand_pcg::Pcg64Mcg;

/// The words of a language.
#[derive(Debug)]
pub(crate) struct Tongue {
    /// Lines that begin so say nothing to the machine.
    silent: &'static [&'static str],
    pub(crate) comment: char,
    pub(crate) rapid: &'static str,
    pub(crate) line: &'static str,
    pub(crate) arcs: [&'static str; 2],
    pub(crate) planes: [&'static str; 3],
    pub(crate) units: [&'static str; 2],
    /// What has to be stated, or may have been left otherwise.
    modal: &'static [&'static str],
    /// Lines are numbered from 0, what a block is stands at its head, and rapid is a word at its end.
    pub(crate) klartext: bool,
}

static NUMBERED: Tongue = Tongue {
    silent: &["%", "(", "O"],
    comment: '(',
    rapid: "G00",
    line: "G01",
    arcs: ["G02", "G03"],
    planes: ["G17", "G18", "G19"],
    units: ["G21", "G20"],
    modal: &["G21", "G17", "G90", "G94", "G40", "G49", "G80", "G69", "G15", "G50", "G54", "G64"],
    klartext: false,
};

static SIEMENS: Tongue = Tongue {
    silent: &["%", ";"],
    comment: ';',
    rapid: "G0",
    line: "G1",
    arcs: ["G2", "G3"],
    units: ["G710", "G700"],
    modal: &[
        "G710", "G17", "G90", "G94", "G40", "D0", "MCALL", "TRAFOOF", "TRANS", "COMPOF", "G54",
        "G64",
    ],
    ..NUMBERED
};

static KLARTEXT: Tongue = Tongue {
    silent: &["BEGIN", "END", ";"],
    comment: ';',
    rapid: "FMAX",
    line: "L",
    arcs: ["DR-", "DR+"],
    planes: ["TOOL CALL Z", "TOOL CALL Y", "TOOL CALL X"],
    units: ["MM", "INCH"],
    modal: &["R0", "TOOL CALL Z", "CYCL DEF 7", "CYCL DEF 8", "CYCL DEF 10", "CYCL DEF 11"],
    klartext: true,
};

impl Tongue {
    pub(crate) fn of(dialect: Dialect) -> &'static Self {
        match dialect {
            Dialect::Fanuc | Dialect::LinuxCnc => &NUMBERED,
            Dialect::Siemens => &SIEMENS,
            Dialect::Heidenhain => &KLARTEXT,
        }
    }

    /// A line without the number that every line has.
    pub(crate) fn bare(&self, line: &str) -> String {
        let bare =
            if self.klartext { line.split_once(' ').map_or("", |(_, rest)| rest) } else { line };
        bare.to_owned()
    }

    /// Lines as a text, numbered anew where they are.
    pub(crate) fn text(&self, lines: &[String]) -> String {
        let numbered = |(number, line): (usize, &String)| {
            if self.klartext { format!("{number} {line}\n") } else { format!("{line}\n") }
        };
        lines.iter().enumerate().map(numbered).collect()
    }

    /// A line that has words, not only a comment.
    pub(crate) fn is_block(&self, line: &str) -> bool {
        !line.is_empty() && !self.silent.iter().any(|silent| line.starts_with(silent))
    }

    /// A point of an arc in chords.
    pub(crate) fn is_chord(&self, line: &str) -> bool {
        if self.klartext {
            line.starts_with("L X") && !line.contains("R0")
        } else {
            line.starts_with('X')
        }
    }

    pub(crate) fn is_rapid(&self, line: &str) -> bool {
        exchanged(line, self.rapid, "").is_some()
    }

    pub(crate) fn is_feed(&self, line: &str) -> bool {
        !self.is_rapid(line)
            && [self.line, self.arcs[0], self.arcs[1]]
                .iter()
                .any(|word| exchanged(line, word, "").is_some())
    }

    /// The modal words that a line states.
    pub(crate) fn modal(&self, line: &str) -> Vec<&'static str> {
        let states = |word: &&str| {
            exchanged(line, word, "").is_some() || line.starts_with(&format!("{word}.0"))
        };
        self.modal.iter().copied().filter(states).collect()
    }

    /// One of several words at random.
    pub(crate) fn one_of<'a>(words: &[&'a str], random: &mut Pcg64Mcg) -> Option<&'a str> {
        words.choose(random).copied()
    }
}

/// The line with one of its words exchanged for another.
pub(crate) fn exchanged(line: &str, from: &str, to: &str) -> Option<String> {
    let blank = |byte: Option<&u8>| byte.is_none_or(|byte| *byte == b' ');
    let bytes = line.as_bytes();
    let at = line.match_indices(from).map(|(at, _)| at).find(|at| {
        blank(at.checked_sub(1).and_then(|before| bytes.get(before)))
            && blank(bytes.get(at + from.len()))
    })?;
    Some(format!("{}{to}{}", &line[..at], &line[at + from.len()..]))
}
