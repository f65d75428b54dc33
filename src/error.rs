//! What went wrong, where, and what to do.
//!
//! One type serves every room: a metrologist reads the same three parts whether a machine file has a
//! wrong key, a program turns back inside an arc, or a log belongs to another program.

use std::borrow::Cow;
use std::fmt;
use std::path::{Path, PathBuf};

/// Result of everything in this crate that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// What kind of failure; it decides the exit code of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A file or a value given by the user cannot be used as it is. Exit code 1.
    Input,
    /// A log does not belong to the program it was given with. Exit code 3.
    Mismatch,
    /// The data cannot determine what was asked for. Exit code 4.
    Undetermined,
    /// A result cannot be written. Exit code 5.
    Output,
}

impl Kind {
    /// The exit code of the program, as documented in `docs/reference.md`.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Input => 1,
            Self::Mismatch => 3,
            Self::Undetermined => 4,
            Self::Output => 5,
        }
    }
}

/// A place in a text file, shown with the line and a caret.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file as the user named it.
    pub file: PathBuf,
    /// Line, counted from 1; 0 when only the file is known.
    pub line: usize,
    /// Column in characters, counted from 1; 0 when only the line is known.
    pub column: usize,
    /// The line itself, for the caret; empty when unknown.
    pub text: String,
    /// How many characters the caret underlines.
    pub width: usize,
}

impl Place {
    /// The whole file.
    pub fn file(file: &Path) -> Self {
        Self { file: file.to_path_buf(), line: 0, column: 0, text: String::new(), width: 0 }
    }

    /// A line of a file.
    pub fn line(file: &Path, line: usize, text: &str) -> Self {
        Self { line, text: text.to_owned(), ..Self::file(file) }
    }

    /// Characters `column .. column + width` of a line, columns counted from 1.
    pub fn span(file: &Path, line: usize, column: usize, width: usize, text: &str) -> Self {
        Self { column, width, ..Self::line(file, line, text) }
    }

    /// The place of a byte range of a text, as TOML's spans give it.
    pub fn bytes(file: &Path, source: &str, range: std::ops::Range<usize>) -> Self {
        let start = range.start.min(source.len());
        let start = (0..=start).rev().find(|&i| source.is_char_boundary(i)).unwrap_or(0);
        let before = &source[..start];
        let line = before.matches('\n').count() + 1;
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        let text = source[line_start..].lines().next().unwrap_or("");
        let column = source[line_start..start].chars().count() + 1;
        let rest = text.chars().count().saturating_sub(column - 1);
        let width = range.end.saturating_sub(range.start).clamp(1, rest.max(1));
        Self::span(file, line, column, width, text)
    }
}

/// A minified or binary line is cut here, and a word, so that a message stays a message.
const LONGEST: usize = 160;
/// What is shown of a longer word, characters.
const SHOWN: usize = 60;

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "  --> {}", self.file.display())?;
        if self.line == 0 {
            return Ok(());
        }
        write!(f, ":{}", self.line)?;
        if self.column > 0 {
            write!(f, ":{}", self.column)?;
        }
        if self.text.is_empty() {
            return Ok(());
        }
        let number = self.line.to_string();
        let gutter = " ".repeat(number.len());
        let shown: String =
            self.text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
        write!(f, "\n{gutter} |\n{number} | {shown}")?;
        if self.column > 0 && self.column <= LONGEST {
            let caret = "^".repeat(self.width.clamp(1, LONGEST));
            write!(f, "\n{gutter} | {}{caret}", " ".repeat(self.column - 1))?;
        }
        Ok(())
    }
}

/// What is wrong, where, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// What kind of failure.
    pub kind: Kind,
    /// One sentence without a full stop: what is wrong, with the value.
    pub what: String,
    /// Where, if it has a place.
    pub place: Option<Box<Place>>,
    /// What to do about it.
    pub hint: Option<String>,
}

impl Error {
    /// An error of a kind.
    pub fn new(kind: Kind, what: impl Into<String>) -> Self {
        Self { kind, what: what.into(), place: None, hint: None }
    }

    /// A file or a value given by the user cannot be used as it is.
    pub fn input(what: impl Into<String>) -> Self {
        Self::new(Kind::Input, what)
    }

    /// Adds the place; an error that has one already keeps it, because the inner place is the closer one.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.place.get_or_insert_with(|| Box::new(place));
        self
    }

    /// Adds what to do about it.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint.get_or_insert_with(|| hint.into());
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", brief(&self.what))?;
        if let Some(place) = &self.place {
            write!(f, "\n{place}")?;
        }
        if let Some(hint) = &self.hint {
            write!(f, "\nhint: {}", brief(hint))?;
        }
        Ok(())
    }
}

/// A text in which words that nobody wrote by hand are cut: a key of 100 KB is told by its beginning.
fn brief(text: &str) -> Cow<'_, str> {
    let is_long = |word: &str| word.len() > LONGEST && word.chars().count() > LONGEST;
    if !text.split_whitespace().any(is_long) {
        return Cow::Borrowed(text);
    }
    let cut = |word: &str| {
        if !is_long(word.trim_end()) {
            return word.to_owned();
        }
        let (shown, count): (String, _) =
            (word.chars().take(SHOWN).collect(), word.chars().count());
        format!("{shown}... ({count} characters) ")
    };
    Cow::Owned(text.split_inclusive(char::is_whitespace).map(cut).collect())
}

impl std::error::Error for Error {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_of_a_thousand_letters_is_told_by_its_beginning() {
        let error =
            Error::input(format!("unknown term `{}` on X", "Q".repeat(1000))).hint("write one");
        let told = error.to_string();
        assert!(told.starts_with("unknown term `QQQ") && told.len() < 200, "{told}");
        assert!(told.contains("... (1003 characters) on X\nhint: write one"), "{told}");
        let usual = "a sentence with a path /home/metrology/machines/five axes/HU40-T.toml";
        assert_eq!(Error::input(usual).to_string(), usual);
    }
}
