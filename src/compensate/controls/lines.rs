//! Lines of a file that is read strictly.

use std::path::Path;

use super::asked::Named;
use crate::error::{Error, Place, Result};

/// A file of a control has not more lines.
const MOST_LINES: usize = 200_000;
/// No number in one is larger.
const LARGEST: f64 = 1e6;

/// A line with its place.
pub(super) struct Line<'a> {
    file: &'a str,
    number: usize,
    pub(super) text: &'a str,
}

impl Line<'_> {
    /// An error at it.
    pub(super) fn faulty(&self, what: impl Into<String>) -> Error {
        Error::input(what).at(Place::line(Path::new(self.file), self.number, self.text))
    }

    /// A number of it.
    pub(super) fn number(&self, text: &str) -> Result<f64> {
        let number = text.trim().parse::<f64>().ok().filter(|number| number.abs() <= LARGEST);
        number.ok_or_else(|| self.faulty(format!("`{}` is no number that can be", text.trim())))
    }

    /// A whole number of it, from 0.
    pub(super) fn whole(&self, text: &str) -> Result<usize> {
        let number = text.trim().parse::<usize>().ok().filter(|number| *number <= MOST_LINES);
        number
            .ok_or_else(|| self.faulty(format!("`{}` is no whole number that can be", text.trim())))
    }
}

/// The lines of a file.
///
/// # Errors
/// When it has too many.
pub(super) fn lines((file, text): &Named) -> Result<Vec<Line<'_>>> {
    let all: Vec<Line> = text
        .lines()
        .take(MOST_LINES + 1)
        .enumerate()
        .map(|(k, text)| Line { file, number: k + 1, text })
        .collect();
    if all.len() > MOST_LINES {
        return Err(Error::input(format!("it has more than {MOST_LINES} lines"))
            .at(Place::file(Path::new(file))));
    }
    Ok(all)
}

/// An error of a file as a whole.
pub(super) fn whole(file: &str, what: impl Into<String>) -> Error {
    Error::input(what).at(Place::file(Path::new(file)))
}
