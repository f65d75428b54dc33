//! Lines and fields of a log, without an allocation a row.

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
        !self.text.is_empty() && self.text.trim_start().starts_with('#')
    }

    pub(super) fn is_blank(self) -> bool {
        self.text.is_empty() || self.text.trim_start().is_empty()
    }

    /// An error about a range of bytes of this line.
    pub(super) fn error(self, file: &Path, field: &Range<usize>, what: String) -> Error {
        let column = self.text[..field.start].chars().count() + 1;
        let width = self.text[field.clone()].chars().count().max(1);
        Error::input(what).at(Place::span(file, self.number, column, width, self.text))
    }
}

/// The lines of a text, numbered from 1. Where nothing else ends a line, CR does; DOS ended a file with ^Z.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    const END_OF_FILE: char = '\u{1A}';
    // Without the mark, blank lines at the end are readings where there is a single column.
    let is_marked =
        text.rfind(END_OF_FILE).is_some_and(|at| text[at + 1..].trim_start().is_empty());
    let is_end = |c: char| c.is_whitespace() || c == END_OF_FILE;
    let text = if is_marked { text.trim_end_matches(is_end) } else { text };
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let lines = text.strip_suffix(end).unwrap_or(text).split(end);
    (1..).zip(lines).map(|(number, text)| Line { number, text: without_cr(text) })
}

/// Most lines have none, and many logs millions of lines.
fn without_cr(line: &str) -> &str {
    if line.ends_with('\r') { line.trim_end_matches('\r') } else { line }
}

/// The fields of a line, without the blanks and the quotes around them.
///
/// A quoted field may hold the delimiter but not the end of its line: a quote that is never closed
/// then spoils one line, and not the file from there on.
pub(super) fn split(line: &str, delimiter: Delimiter, fields: &mut Vec<Range<usize>>) {
    fields.clear();
    if delimiter == Delimiter::Blanks {
        let words = line.split_whitespace();
        let start = |word: &str| word.as_ptr() as usize - line.as_ptr() as usize;
        fields.extend(words.map(|word| content(line, start(word)..start(word) + word.len())));
        return;
    }
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
        let text = line[field.clone()].trim_start();
        let start = field.end - text.len();
        start..start + text.trim_end().len()
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
