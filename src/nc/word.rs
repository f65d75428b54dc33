//! A word of a block, a set of addresses, and what can be wrong with either.

use std::ops::Range;

use super::keyword::Keyword;

/// What is wrong within one line; the line itself is added where it is known.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Fault {
    /// Bytes of the line that are at fault; none when it is the line as a whole.
    pub(crate) span: Option<Range<usize>>,
    /// What is wrong, one sentence without a full stop.
    pub(crate) what: String,
    /// What to do about it.
    pub(crate) hint: Option<String>,
}

impl Fault {
    /// A fault of some bytes of the line.
    pub(crate) fn span(span: Range<usize>, what: impl Into<String>) -> Self {
        Self { span: Some(span), what: what.into(), hint: None }
    }

    /// A fault of one word.
    pub(crate) fn word(word: &Word, what: impl Into<String>) -> Self {
        let start = word.start as usize;
        Self::span(start..start + word.width as usize, what)
    }

    /// A fault of the line as a whole.
    pub(crate) fn line(what: impl Into<String>) -> Self {
        Self { span: None, what: what.into(), hint: None }
    }

    /// Adds what to do about it.
    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// An address letter with its number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Word {
    /// The number as written, without a unit.
    pub(crate) value: f64,
    /// Byte of the line at which the letter stands.
    pub(crate) start: u32,
    /// Bytes from the letter to the end of the number.
    pub(crate) width: u32,
    /// The letter, in upper case.
    pub(crate) letter: u8,
    /// Whether the number has a decimal point, which changes its unit.
    pub(crate) point: bool,
    /// What stands for this address and number where that is more than a letter and a number.
    pub(crate) keyword: Option<Keyword>,
}

impl Word {
    /// The number when it is a whole one, not negative and without a point.
    pub(crate) fn whole(&self) -> Option<u32> {
        let fits = !self.point && (0.0..=f64::from(u32::MAX)).contains(&self.value);
        fits.then_some(self.value as u32)
    }

    /// The word as programs are usually written: `G04`, `G05.1`, `M30`, `X-1.5`, `SUPA`.
    pub(crate) fn name(&self) -> String {
        if let Some(keyword) = self.keyword {
            return keyword.name().to_owned();
        }
        let letter = char::from(self.letter);
        match self.whole() {
            Some(number) if matches!(self.letter, b'G' | b'M') => format!("{letter}{number:02}"),
            None if self.letter == b'G' && self.point => format!("G{:04.1}", self.value),
            _ => format!("{letter}{}", self.value),
        }
    }
}

/// A set of address letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Letters(u32);

impl Letters {
    /// The set of these letters, upper case.
    pub(crate) const fn of(letters: &[u8]) -> Self {
        let mut set = 0;
        let mut index = 0;
        while index < letters.len() {
            set |= 1 << (letters[index] - b'A');
            index += 1;
        }
        Self(set)
    }

    /// Both sets together.
    pub(crate) const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub(crate) fn has(self, letter: u8) -> bool {
        self.0 & (1 << (letter - b'A')) != 0
    }
}
