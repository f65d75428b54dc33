//! A text as lines.

/// A line of the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// Counted from 1.
    pub(crate) number: usize,
    /// Byte of the source at which it begins.
    pub(crate) start: usize,
}

/// All lines of a text, each without its end. A block ends with LF, CR LF or LF CR CR, so that carriage returns can stand at
/// both ends of a line.
pub(crate) fn lines(source: &str) -> impl Iterator<Item = (Line, &str)> {
    let mut start = 0;
    source.split('\n').enumerate().map(move |(index, whole)| {
        let mut line = Line { number: index + 1, start };
        start += whole.len() + 1;
        // Most lines have none.
        if !(whole.starts_with('\r') || whole.ends_with('\r')) {
            return (line, whole);
        }
        let text = whole.trim_start_matches('\r');
        line.start += whole.len() - text.len();
        (line, text.trim_end_matches('\r'))
    })
}

/// The text of a line without its end.
pub(crate) fn text(source: &str, line: Line) -> &str {
    let rest = source.get(line.start..).unwrap_or("");
    rest.split('\n').next().unwrap_or("").trim_end_matches('\r')
}
