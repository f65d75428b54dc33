//! Text for a terminal: tables and filled paragraphs.

use std::fmt::Write as _;

/// Columns of the terminal.
pub(in crate::report) const WIDTH: usize = 100;

/// Columns of equal width, two spaces in front and between; `l` left, `r` right.
pub(in crate::report) fn table(rows: &[Vec<String>], sides: &str) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |k: usize| {
        let cells = rows.iter().filter_map(|row| row.get(k));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for ((cell, width), side) in row.iter().zip(&widths).zip(sides.chars()) {
            let padding = " ".repeat(width - cell.chars().count());
            let _ = match side {
                'r' => write!(line, "  {padding}{cell}"),
                _ => write!(line, "  {cell}{padding}"),
            };
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Words filled into lines, the first behind `lead`, the others under its end.
pub(in crate::report) fn paragraph(text: &mut String, lead: &str, words: &str) {
    let indent = " ".repeat(lead.chars().count());
    let mut line = lead.to_owned();
    let mut empty = true;
    // A space that must not break, as inside a grouped number, is no end of a word.
    for word in words.split(' ') {
        if !empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            let _ = writeln!(text, "{line}");
            line.clone_from(&indent);
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
        empty = false;
    }
    let _ = writeln!(text, "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_filled_under_their_lead() {
        let mut text = String::new();
        paragraph(&mut text, "  - ", &"word ".repeat(40));
        assert!(text.lines().skip(1).all(|line| line.starts_with("    word")));
    }
}
