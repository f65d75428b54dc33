//! Lines, fields and numbers of a log, without an allocation a row.

use std::ops::Range;
use std::path::Path;

use crate::error::{Error, Place};
use crate::plan::log_format::Delimiter;

/// A line of a log.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    /// Counted from 1, comments and blank lines included.
    pub(super) number: usize,
    /// Without its end.
    pub(super) text: &'a str,
}

impl Line<'_> {
    pub(super) fn is_comment(self) -> bool {
        self.text.trim_ascii_start().starts_with('#')
    }

    pub(super) fn is_blank(self) -> bool {
        self.text.trim_ascii_start().is_empty()
    }

    /// An error about a range of bytes of this line.
    pub(super) fn error(self, file: &Path, field: &Range<usize>, what: String) -> Error {
        let column = self.text[..field.start].chars().count() + 1;
        let width = self.text[field.clone()].chars().count().max(1);
        Error::input(what).at(Place::span(file, self.number, column, width, self.text))
    }
}

/// The fields of a line, without the blanks and the quotes around them.
///
/// A quoted field may hold the delimiter but not the end of its line: a quote that is never closed
/// then spoils one line, and not the file from there on.
pub(super) fn split(line: &str, delimiter: Delimiter, fields: &mut Vec<Range<usize>>) {
    fields.clear();
    let delimiter = delimiter.byte();
    let (mut start, mut quoted) = (0, false);
    for (i, byte) in line.bytes().enumerate() {
        if byte == b'"' {
            quoted = !quoted;
        } else if byte == delimiter && !quoted {
            fields.push(content(line, start..i));
            start = i + 1;
        }
    }
    fields.push(content(line, start..line.len()));
}

fn content(line: &str, field: Range<usize>) -> Range<usize> {
    let trim = |field: Range<usize>| {
        let text = line[field.clone()].trim_ascii_start();
        let start = field.end - text.len();
        start..start + text.trim_ascii_end().len()
    };
    let field = trim(field);
    let text = &line[field.clone()];
    if text.len() > 1 && text.starts_with('"') && text.ends_with('"') {
        trim(field.start + 1..field.end - 1)
    } else {
        field
    }
}

/// What a file says, for a message: a file that is no log may hold anything.
pub(super) fn quote(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut shown: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    format!("`{shown}`")
}

/// Why a field is not a number.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) what: String,
    /// What to do about it, when that does not depend on the column.
    pub(super) hint: Option<&'static str>,
}

/// Reads the numbers of one log.
pub(super) struct Numbers {
    comma_allowed: bool,
    /// The decimal mark of the numbers so far. One log has one: where some numbers have a point,
    /// `1,234` is more likely to be a thousand than one and a bit.
    mark: Option<char>,
    with_point: String,
}

impl Numbers {
    pub(super) fn new(delimiter: Delimiter) -> Self {
        Self { comma_allowed: delimiter != Delimiter::Comma, mark: None, with_point: String::new() }
    }

    /// The number that is written, in the unit that `convert` gives it; always finite.
    pub(super) fn parse(
        &mut self,
        written: &str,
        convert: impl Fn(f64) -> f64,
    ) -> Result<f64, Fault> {
        let fault = |what| Fault { what, hint: None };
        let mut plain = written;
        if self.comma_allowed
            && let Some(mark) = written.chars().find(|c| matches!(c, '.' | ','))
        {
            if *self.mark.get_or_insert(mark) != mark {
                return Err(Fault {
                    what: format!(
                        "{} has another decimal mark than the numbers above",
                        quote(written)
                    ),
                    hint: Some(
                        "write every number with the same decimal mark and without separators of \
                         thousands",
                    ),
                });
            }
            if mark == ',' {
                self.with_point.clear();
                self.with_point.extend(written.chars().map(|c| if c == ',' { '.' } else { c }));
                // `1,234.5` would become `1.234.5`, which is no number either.
                plain = &self.with_point;
            }
        }
        let value: f64 =
            plain.parse().map_err(|_| fault(format!("{} is not a number", quote(written))))?;
        let value = convert(value);
        if value.is_finite() {
            Ok(value)
        } else {
            Err(fault(format!("{} is not a finite number", quote(written))))
        }
    }
}
