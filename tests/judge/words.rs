//! What stands in a program: blocks of words, as far as a control reads them at all.
//!
//! Written apart from `src/nc`: a slip in one of the two readers must not stand in the other.

use ballbar::machine::Dialect;

use crate::modal::Motion;
use crate::{klartext, siemens};

/// A letter and its number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Word {
    pub(crate) letter: char,
    pub(crate) value: f64,
    /// Whether a decimal point was written.
    pub(crate) point: bool,
}

/// What Siemens and Klartext say in words of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spoken {
    Motion(Motion),
    /// By its normal.
    Plane(usize),
    /// Inches, when true.
    Unit(bool),
    MachineCoordinates,
    Dwell,
    /// What they end.
    NoRadius,
    NoLength,
    NoCycle,
    NoShift,
    NoTransformation,
    NoMirror,
    NoRotation,
    NoScaling,
    /// How the path is followed, in groups of which each may stand once in a block.
    Dynamics(u8),
}

/// A line that says something.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Block {
    /// Counted from 1.
    pub(crate) line: usize,
    /// Without N and O.
    pub(crate) words: Vec<Word>,
    pub(crate) spoken: Vec<Spoken>,
    /// The centre of an arc, where it is stated by itself.
    pub(crate) pole: Option<[Option<Word>; 3]>,
    /// What the operator reads.
    pub(crate) comment: String,
}

impl Block {
    pub(crate) fn new(line: usize) -> Self {
        Self { line, words: Vec::new(), spoken: Vec::new(), pole: None, comment: String::new() }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.words.is_empty() && self.spoken.is_empty() && self.comment.is_empty()
    }
}

/// A program of the file, and its number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    pub(crate) number: Option<u32>,
    pub(crate) blocks: Vec<Block>,
}

/// What a control does not take, or what has no one meaning.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Refused {
    pub(crate) line: usize,
    pub(crate) what: String,
}

/// A refusal, as the result that ends the reading.
pub(crate) fn refuse<T>(line: usize, what: impl Into<String>) -> Result<T, Refused> {
    Err(Refused { line, what: what.into() })
}

/// The programs of a file: the first is the main program.
pub(crate) fn parts(text: &str, dialect: Dialect) -> Result<Vec<Part>, Refused> {
    match dialect {
        Dialect::Siemens => siemens::parts(text),
        Dialect::Heidenhain => klartext::parts(text),
        Dialect::Fanuc | Dialect::LinuxCnc => numbered(text, dialect),
    }
}

/// Programs with O numbers between two lines `%`.
fn numbered(text: &str, dialect: Dialect) -> Result<Vec<Part>, Refused> {
    let lines: Vec<&str> = text.lines().collect();
    let marks: Vec<usize> = (0..lines.len()).filter(|&k| lines[k].trim() == "%").collect();
    let &[first, last] = &marks[..] else {
        return refuse(1, "a program stands between two lines %");
    };
    let mut parts: Vec<Part> = vec![Part { number: None, blocks: Vec::new() }];
    for (index, text) in lines.iter().enumerate().take(last).skip(first + 1) {
        let (number, block) = block(text, index + 1, dialect)?;
        if let Some(number) = number {
            if parts.iter().any(|part| part.number == Some(number)) {
                return refuse(index + 1, format!("a second program O{number}"));
            }
            let only = parts.len() == 1 && parts[0].number.is_none();
            if only && parts[0].blocks.iter().all(|block| block.words.is_empty()) {
                parts[0].number = Some(number);
            } else {
                parts.push(Part { number: Some(number), blocks: Vec::new() });
            }
        }
        if let (Some(part), false) = (parts.last_mut(), block.is_empty()) {
            part.blocks.push(block);
        }
    }
    Ok(parts)
}

/// The number at the beginning of a text, whether it has a point, and what stands behind it.
pub(crate) fn figures(text: &str, line: usize) -> Result<(f64, bool, &str), Refused> {
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+');
    let end = text.find(|c: char| !is_part(c)).unwrap_or(text.len());
    let (figures, behind) = text.split_at(end);
    match figures.parse::<f64>().ok().filter(|_| figures.len() <= 16) {
        Some(value) => Ok((value, figures.contains('.'), behind)),
        None => refuse(line, format!("`{figures}` is no number")),
    }
}

/// The block of a line, and the number of the program that begins in it.
fn block(text: &str, line: usize, dialect: Dialect) -> Result<(Option<u32>, Block), Refused> {
    let mut block = Block::new(line);
    let mut number = None;
    let mut rest = text.trim();
    let mut head = true;
    while let Some(letter) = rest.chars().next() {
        if letter == '(' {
            let Some((comment, after)) = rest[1..].split_once(')') else {
                return refuse(line, "a comment without its end");
            };
            comment.trim().clone_into(&mut block.comment);
            rest = after.trim_start();
            continue;
        }
        if letter == ';' && dialect == Dialect::LinuxCnc {
            rest[1..].trim().clone_into(&mut block.comment);
            break;
        }
        let small = letter.is_ascii_lowercase() && dialect == Dialect::Fanuc;
        if !letter.is_ascii_alphabetic() || small {
            return refuse(line, format!("`{letter}` begins no word"));
        }
        let (value, point, after) = figures(rest[1..].trim_start(), line)?;
        let word = Word { letter: letter.to_ascii_uppercase(), value, point };
        match word.letter {
            'N' | 'O' if !head => {
                return refuse(line, format!("{letter} in the middle of a block"));
            }
            'N' => {
                let range = if dialect == Dialect::Fanuc { 1.0..=99_999.0 } else { 0.0..=99_999.0 };
                if point || !range.contains(&value) {
                    return refuse(line, format!("N{value} is no block number"));
                }
                head = false;
            }
            'O' => {
                if point || !(1.0..=99_999_999.0).contains(&value) {
                    return refuse(line, format!("O{value} is no program number"));
                }
                number = Some(value as u32);
                head = false;
            }
            _ => {
                head = false;
                block.words.push(word);
            }
        }
        rest = after.trim_start();
    }
    Ok((number, block))
}
