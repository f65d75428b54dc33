//! The comparison with the paper for the terminal.

use std::fmt::Write as _;

use super::rows::{HEAD, cells, geometry, nearest_lines, title};
use crate::paper::{Comparison, Nearest, Row};

/// For the terminal.
pub fn paper_text(paper: &Comparison) -> String {
    let mut text = geometry(paper);
    text.push_str("\n\nSection 4: random poses in the volume\n");
    text.push_str(&table(&paper.volume));
    for strategy in &paper.strategies {
        let _ = write!(
            text,
            "\n{}: lengths along its arcs\n{}",
            title(strategy),
            table(&strategy.rows)
        );
        for (pivot, sentences) in [("carriage", &strategy.carriage), ("base", &strategy.base)] {
            for sentence in sentences {
                let _ = writeln!(text, "  {pivot}: {sentence}");
            }
        }
    }
    text.push_str(
        "\nSeveral mountings of 3D6, every pivot on its carriage: coefficients of 53, of 90\n",
    );
    for row in &paper.mountings {
        let _ = writeln!(text, "  {:<40} {:>2} {:>3}", row.what, row.of_53, row.of_90);
    }
    text.push_str("\n* of the retained directions: the columns depend on each other\n");
    text
}

fn table(rows: &[Row]) -> String {
    let cells: Vec<[String; 10]> = rows.iter().map(cells).collect();
    let width = |k: usize| {
        let all = cells.iter().map(|row| row[k].len());
        all.chain([HEAD[k].len()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..9).map(width).collect();
    let mut text = String::new();
    let mut line = |cells: &[String]| {
        for (cell, width) in cells.iter().zip(&widths) {
            let _ = write!(text, "  {cell:>width$}");
        }
        let _ = writeln!(text, "  {}", cells[9]);
    };
    line(&HEAD.map(str::to_owned));
    for cells in &cells {
        line(cells);
    }
    let mut removed = String::new();
    for row in rows.iter().filter(|row| !row.stage.removed.is_empty()) {
        let _ = writeln!(removed, "  to {}: without {}", row.stage.columns, row.stage.removed);
    }
    text + &removed
}

/// What a search has found, for the terminal.
pub fn nearest_text(nearest: &Nearest) -> String {
    let mut text =
        "\nNearest to the paper's condition numbers, pivot of X on the base\n".to_owned();
    for line in nearest_lines(nearest) {
        let _ = writeln!(text, "  {line}");
    }
    text
}
