//! A history for the terminal.

use super::words;
use crate::monitor::{History, Series};
use crate::report::analysis::place::decimals;
use crate::report::text::layout::{paragraph, table};
use crate::report::text::numbers::fixed;

/// The tests, and what drifts.
pub fn history_text(history: &History) -> String {
    let mut text = format!("{}\n", history.machine);
    for sentence in words::verdict(history) {
        paragraph(&mut text, "  ", &sentence);
    }
    text.push_str("\nTests\n");
    let rows: Vec<Vec<String>> = history
        .tests
        .iter()
        .map(|(day, past)| {
            vec![day.to_string(), past.test.clone(), past.file.display().to_string()]
        })
        .collect();
    text.push_str(&table(&rows, "lll"));
    let rows: Vec<Vec<String>> =
        history.series.iter().filter(|of| of.points.len() > 1 && of.is_seen()).map(cells).collect();
    if !rows.is_empty() {
        text.push_str("\nQuantities (first, last, their number, trend)\n");
        text.push_str(&table(&rows, "lrrrll"));
    }
    if !history.left_out.is_empty() {
        text.push_str("\nLeft out\n");
        for of in &history.left_out {
            paragraph(&mut text, "  - ", &format!("{}: {}", of.file.display(), of.reason));
        }
    }
    text.push('\n');
    paragraph(&mut text, "  ", words::BASIS);
    text
}

/// Name, first value, last value, number, trend, whether it is one.
pub(super) fn cells(series: &Series) -> Vec<String> {
    let value = |point: Option<&crate::monitor::Point>| {
        point.map_or_else(String::new, |point| {
            let places = point.noise.map_or(2, decimals);
            format!("{} {}", fixed(point.value, places), series.unit)
        })
    };
    vec![
        series.name.clone(),
        value(series.points.first()),
        value(series.points.last()),
        series.points.len().to_string(),
        series.trend.map_or_else(|| "-".to_owned(), |trend| words::per_year(series, trend)),
        series.trend.map_or("", words::judged).to_owned(),
    ]
}
