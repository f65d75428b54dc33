//! A text as lines.

/// A line of the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// Counted from 1.
    pub(crate) number: usize,
    /// Byte of the source at which it begins.
    pub(crate) start: usize,
}

/// All lines of a text. A block ends with LF, CR LF or LF CR CR, so that carriage returns can stand at
/// both ends of a line.
pub(crate) fn lines(source: &str) -> impl Iterator<Item = Line> {
    let mut start = 0;
    source.split('\n').enumerate().map(move |(index, text)| {
        let blanks = text.len() - text.trim_start_matches('\r').len();
        let line = Line { number: index + 1, start: start + blanks };
        start += text.len() + 1;
        line
    })
}

/// The text of a line without its end.
pub(crate) fn text(source: &str, line: Line) -> &str {
    let rest = source.get(line.start..).unwrap_or("");
    rest.split('\n').next().unwrap_or("").trim_end_matches('\r')
}
