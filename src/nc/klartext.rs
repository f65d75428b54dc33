//! Blocks of HEIDENHAIN Klartext as words, and what several blocks make together.

use std::ops::Range;

use super::grammar::Grammar;
use super::keyword::Keyword;
use super::lex::{Lexer, Piece, spelled};
use super::word::{Fault, Word};

/// What holds from one block to the next while a file is taken apart.
#[derive(Debug, Default)]
pub(crate) struct Open {
    /// BEGIN PGM was read.
    begun: bool,
    /// END PGM was read.
    pub(crate) ended: bool,
    /// A cycle of which this part comes next.
    cycle: Option<(u32, u32)>,
    /// The number of the block that comes next.
    next: u32,
}

/// Cycles that are followed: number, parts behind the first, and what they say with the values that they must have.
const CYCLES: [(u32, &[&str], Keyword); 5] = [
    (7, &["X+0", "Y+0", "Z+0"], Keyword::DatumShift),
    (8, &[""], Keyword::Mirror),
    (9, &["DWELL"], Keyword::Dwell),
    (10, &["ROT+0"], Keyword::Rotation),
    (11, &["SCL1"], Keyword::Scaling),
];

/// A part of a block between blanks, with the byte of the line at which it stands.
type Token<'a> = (usize, &'a str);

fn span(token: Token<'_>) -> Range<usize> {
    token.0..token.0 + token.1.len()
}

fn fault(token: Token<'_>, what: impl Into<String>) -> Fault {
    Fault::span(span(token), what)
}

/// Its words and its comment.
pub(crate) struct Block<'a> {
    line: &'a str,
    grammar: &'static Grammar,
    pub(crate) pieces: Vec<Piece<'a>>,
}

impl<'a> Block<'a> {
    /// Takes a line apart. What could be read is there after a fault too.
    pub(crate) fn new(line: &'a str, grammar: &'static Grammar) -> Self {
        Self { line, grammar, pieces: Vec::with_capacity(8) }
    }

    /// Reads its pieces.
    pub(crate) fn read(&mut self, open: &mut Open) -> Result<(), Fault> {
        let (code, comment) = match self.line.split_once(';') {
            Some((code, comment)) => (code, comment.trim()),
            None => (self.line, ""),
        };
        let mut tokens = tokens(code);
        let Some(number) = tokens.next() else {
            return Err(Fault::line("a block without a number")
                .hint("blocks of Klartext are numbered from 0"));
        };
        self.number(number, open)?;
        if !comment.is_empty() {
            self.pieces.push(Piece::Comment(comment));
        }
        let tokens: Vec<Token<'a>> = tokens.collect();
        let Some((&first, rest)) = tokens.split_first() else {
            return Ok(());
        };
        if let Some(heading) = first.1.strip_prefix('*') {
            let from = first.0 + first.1.len() - heading.len();
            self.pieces.push(Piece::Comment(code[from..].trim_matches([' ', '-'])));
            return Ok(());
        }
        let names: Vec<&str> = tokens.iter().map(|token| token.1).collect();
        let waits = open.cycle.filter(|_| names[..names.len().min(2)] != ["CYCL", "DEF"]);
        if let Some((cycle, part)) = waits {
            open.cycle = None;
            return Err(fault(first, format!("cycle {cycle} lacks its block {cycle}.{part}"))
                .hint("all blocks of CYCL DEF follow each other"));
        }
        if !open.begun && names[0] != "BEGIN" {
            return Err(fault(first, "the program does not begin with BEGIN PGM")
                .hint("the first block is 0 BEGIN PGM NAME MM"));
        }
        match (names[0], &names[1..]) {
            ("BEGIN", ["PGM", _, unit @ ("MM" | "INCH")]) if !open.begun => {
                open.begun = true;
                self.keyword(Keyword::Unit(*unit == "INCH"), tokens[3]);
                Ok(())
            }
            ("END", ["PGM", ..]) => {
                open.ended = true;
                Ok(())
            }
            ("L", _) => {
                let rapid = names.contains(&"FMAX");
                self.keyword(if rapid { Keyword::Rapid } else { Keyword::Line }, first);
                self.words(rest)
            }
            ("C", _) => self.arc(first, rest),
            ("CC", _) => {
                self.keyword(Keyword::Pole, first);
                self.words(rest)
            }
            ("STOP", [] | ["M0" | "M00"]) => {
                let word = Word { letter: b'M', ..spelled(Keyword::R0, span(first)) };
                self.pieces.push(Piece::Word(Word { keyword: None, ..word }));
                Ok(())
            }
            ("PLANE", ["RESET", "STAY"]) => {
                self.keyword(Keyword::PlaneReset, first);
                Ok(())
            }
            ("TOOL", ["CALL", ..]) => self.tool(first, &tokens[2..]),
            ("CYCL", ["DEF", part, ..]) => self.cycle(tokens[2], part, &tokens[3..], open),
            (name, _) if name.starts_with('M') => self.words(&tokens),
            (name, _) => Err(fault(first, format!("`{name}` is not followed"))
                .hint("nothing is skipped, because it may move the machine: L, CC, C, STOP, TOOL CALL of an axis, cycles 7 to 11 back to nothing and M words are")),
        }
    }

    /// The number of the block: one after the other, from 0.
    fn number(&mut self, token: Token<'a>, open: &mut Open) -> Result<(), Fault> {
        let number: Option<u32> = token.1.parse().ok();
        let Some(number) = number.filter(|_| token.1.bytes().all(|c| c.is_ascii_digit())) else {
            return Err(fault(token, "a block without a number")
                .hint("blocks of Klartext are numbered from 0"));
        };
        let word =
            Word { letter: b'N', value: f64::from(number), ..spelled(Keyword::R0, span(token)) };
        self.pieces.push(Piece::Word(Word { keyword: None, ..word }));
        let expected = std::mem::replace(&mut open.next, number.saturating_add(1));
        if number != expected {
            return Err(fault(token, format!("block {number} where block {expected} comes next"))
                .hint("a block was lost or put in: number the blocks anew, from 0 in steps of 1"));
        }
        Ok(())
    }

    fn keyword(&mut self, keyword: Keyword, token: Token<'a>) {
        self.pieces.push(Piece::Word(spelled(keyword, span(token))));
    }

    /// An arc about the pole: its sense decides what it is.
    fn arc(&mut self, first: Token<'a>, rest: &[Token<'a>]) -> Result<(), Fault> {
        let sense = rest.iter().find_map(|token| match token.1 {
            "DR+" => Some(Keyword::Ccw),
            "DR-" => Some(Keyword::Cw),
            _ => None,
        });
        let Some(sense) = sense else {
            return Err(fault(first, "an arc without DR+ or DR-")
                .hint("DR+ turns counter-clockwise, DR- clockwise"));
        };
        self.keyword(sense, first);
        let turns = |token: &&Token<'a>| !matches!(token.1, "DR+" | "DR-");
        let words: Vec<Token<'a>> = rest.iter().filter(turns).copied().collect();
        if rest.len() - words.len() > 1 {
            return Err(fault(first, "an arc with two senses").hint("write DR+ or DR- once"));
        }
        self.words(&words)
    }

    /// The tool axis; a tool is called before the program.
    fn tool(&mut self, first: Token<'a>, rest: &[Token<'a>]) -> Result<(), Fault> {
        let Some((axis, more)) = rest.split_first() else {
            return Err(fault(first, "TOOL CALL without a tool axis").hint("write TOOL CALL Z"));
        };
        let normal = match axis.1 {
            "X" => 0,
            "Y" => 1,
            "Z" => 2,
            _ => {
                return Err(fault(*axis, "a tool is changed").hint(
                    "the length of another tool is not held by the program: call the tool before it, and write TOOL CALL Z",
                ));
            }
        };
        self.keyword(Keyword::ToolAxis(normal), first);
        self.words(more)
    }

    /// A block of a cycle that takes something back, or of a dwell.
    fn cycle(
        &mut self,
        at: Token<'a>,
        part: &str,
        rest: &[Token<'a>],
        open: &mut Open,
    ) -> Result<(), Fault> {
        let expected = open.cycle.take();
        let number = |text: &str| text.parse::<u32>().ok();
        let numbers = part.split_once('.').map(|(cycle, part)| (number(cycle), number(part)));
        let known = |cycle: u32| CYCLES.into_iter().find(|(known, ..)| *known == cycle);
        let Some((Some(cycle), Some(part))) = numbers else {
            return Err(not_followed(at));
        };
        let Some((_, parts, keyword)) = known(cycle) else {
            return Err(not_followed(at));
        };
        if (cycle, part) != expected.unwrap_or((cycle, 0)) {
            let (cycle, part) = expected.unwrap_or((cycle, 0));
            return Err(fault(at, format!("cycle {cycle} lacks its block {cycle}.{part}"))
                .hint("all blocks of CYCL DEF follow each other"));
        }
        if (part as usize) < parts.len() {
            open.cycle = Some((cycle, part + 1));
        }
        if part == 0 {
            return Ok(());
        }
        if keyword == Keyword::Dwell {
            return self.dwell(at, rest);
        }
        let written: String = rest.iter().map(|token| token.1).collect();
        let wanted = parts[part as usize - 1];
        if !same(&written, wanted) {
            return Err(fault(at, format!("cycle {cycle} moves the path by what it says"))
                .hint(format!("only its end is followed: CYCL DEF {cycle}.{part} {wanted}")));
        }
        if part as usize == parts.len() {
            self.keyword(keyword, at);
        }
        Ok(())
    }

    /// `DWELL 1.5`.
    fn dwell(&mut self, at: Token<'a>, rest: &[Token<'a>]) -> Result<(), Fault> {
        self.keyword(Keyword::Dwell, at);
        let time = match rest {
            [(_, "DWELL" | "V.ZEIT"), time] => Some(*time),
            [(start, glued)] => glued.strip_prefix("DWELL").map(|time| (start + 5, time)),
            _ => None,
        };
        let time =
            time.ok_or_else(|| fault(at, "a dwell needs one time").hint(self.grammar.dwell.hint))?;
        let word = self.value(time, b'P', 0)?;
        self.pieces.push(Piece::Word(word));
        Ok(())
    }

    /// Coordinates, feed, compensation and M words; the first fault, when all that can be read was read.
    fn words(&mut self, tokens: &[Token<'a>]) -> Result<(), Fault> {
        let mut first = Ok(());
        for token in tokens {
            let read = self.word(*token);
            first = first.and(read);
        }
        first
    }

    fn word(&mut self, token: Token<'a>) -> Result<(), Fault> {
        let keyword = match token.1 {
            "FMAX" => return Ok(()),
            "R0" => Some(Keyword::R0),
            "M91" => Some(Keyword::M91),
            "M129" => Some(Keyword::M129),
            _ => None,
        };
        if let Some(keyword) = keyword {
            self.keyword(keyword, token);
            return Ok(());
        }
        let mut letters = token.1.bytes();
        let word = match (letters.next(), letters.next()) {
            (Some(letter @ (b'X' | b'Y' | b'Z' | b'F' | b'S' | b'M')), _) => {
                self.value(token, letter, 1)?
            }
            (Some(b'I'), Some(b'X'..=b'Z')) => {
                return Err(fault(token, "an incremental coordinate")
                    .hint("write the coordinate itself: X+10"));
            }
            (Some(b'R'), Some(b'L' | b'R')) => {
                return Err(fault(token, format!("{} is not known", token.1)).hint(
                    "radius compensation moves the path by a value that the program does not hold: use R0",
                ));
            }
            _ => {
                return Err(fault(token, format!("`{}` has no meaning in this block", token.1))
                    .hint("nothing is skipped, because it may move the machine: remove it if it does not"));
            }
        };
        self.pieces.push(Piece::Word(word));
        Ok(())
    }

    /// The number of a token behind so many letters.
    fn value(&self, token: Token<'a>, letter: u8, letters: usize) -> Result<Word, Fault> {
        if token.1.contains(',') {
            return Err(fault(token, "a decimal comma").hint("the decimal sign is a point"));
        }
        let at = token.0 + letters;
        let (word, end) = Lexer::number(self.line, [token.0, at], letter, self.grammar)?;
        if end != token.0 + token.1.len() {
            return Err(fault(token, format!("`{}` is not a number", &token.1[letters..]))
                .hint("an address is followed by one number, such as X-12.345"));
        }
        Ok(Word { start: token.0 as u32, width: token.1.len() as u32, ..word })
    }
}

fn not_followed(at: Token<'_>) -> Fault {
    fault(at, format!("cycle {} is not followed", at.1))
        .hint("cycles 7, 8, 10 and 11 back to nothing, and 9, a dwell, are; the datum is chosen before the program")
}

/// Whether two ends of a cycle say the same: `ROT+0.000` and `ROT+0`.
fn same(written: &str, wanted: &str) -> bool {
    let split = |text: &str| {
        let letters = text.bytes().take_while(u8::is_ascii_alphabetic).count();
        let number = text.get(letters..).unwrap_or("").parse::<f64>().ok();
        (text.get(..letters).unwrap_or("").to_owned(), number)
    };
    if wanted.is_empty() {
        return written.is_empty();
    }
    split(written) == split(wanted)
}

/// What stands between blanks.
fn tokens(code: &str) -> impl Iterator<Item = Token<'_>> {
    let mut at = 0;
    code.split([' ', '\t']).filter_map(move |text| {
        let start = at;
        at += text.len() + 1;
        (!text.is_empty()).then_some((start, text))
    })
}
