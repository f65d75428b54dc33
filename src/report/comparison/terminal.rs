//! A comparison for the terminal.

use std::fmt::Write as _;

use super::words;
use crate::monitor::{Change, Comparison, Judged, Kind, Past};
use crate::report::analysis::place::decimals;
use crate::report::text::layout::{paragraph, table};
use crate::report::text::numbers::{fixed, signed};

/// What changed, as text.
pub fn comparison_text(comparison: &Comparison, [before, after]: [&Past; 2]) -> String {
    let mut text = String::from("Compared\n");
    let row = |what: &str, past: &Past| {
        let day = past.day.map_or_else(|| "-".to_owned(), |day| day.to_string());
        vec![
            what.to_owned(),
            day,
            past.test.clone(),
            past.machine.clone(),
            past.file.display().to_string(),
        ]
    };
    text.push_str(&table(&[row("before", before), row("after", after)], "lllll"));
    text.push_str("\nVerdict\n");
    for sentence in words::verdict(comparison) {
        paragraph(&mut text, "  ", &sentence);
    }
    if !comparison.differences.is_empty() {
        text.push_str("\nCautions\n");
        for sentence in &comparison.differences {
            paragraph(&mut text, "  - ", sentence);
        }
    }
    for judged in [Judged::Changed, Judged::WithIt, Judged::Same, Judged::Unknown] {
        let all = || comparison.changes.iter().filter(|change| change.judged == judged);
        // What has not changed and is of this test alone would fill pages.
        let shown = |change: &&Change| judged == Judged::Changed || change.kind != Kind::Range;
        let rows: Vec<Vec<String>> = all().filter(shown).map(cells).collect();
        if rows.is_empty() {
            continue;
        }
        let (heading, count) = (words::judged(judged), rows.len());
        let _ = writeln!(
            text,
            "\n{}{} (before, after, difference, +- its standard deviation)",
            heading[..1].to_uppercase(),
            &heading[1..]
        );
        text.push_str(&table(&rows, "lrrrrl"));
        if let Some(more @ 1..) = all().count().checked_sub(count) {
            let _ = writeln!(
                text,
                "  and {more} straightnesses, angles and the like: `--json` has them"
            );
        }
    }
    if !comparison.findings.is_empty() {
        text.push_str("\nFindings\n");
        for finding in &comparison.findings {
            paragraph(&mut text, "  - ", &words::finding(finding));
        }
    }
    if !comparison.untold.is_empty() {
        text.push_str("\nNot compared\n");
        for reason in comparison.untold.iter().take(MOST) {
            paragraph(&mut text, "  - ", reason);
        }
        if let Some(more @ 1..) = comparison.untold.len().checked_sub(MOST) {
            let _ = writeln!(text, "  and {more} more: `--json` has them");
        }
    }
    text.push('\n');
    paragraph(&mut text, "  ", &words::basis(comparison));
    text
}

/// So many reasons are listed.
const MOST: usize = 12;

/// Name, before, after, difference, its uncertainty, unit.
pub(super) fn cells(change: &Change) -> Vec<String> {
    let places = change.sigma.map_or(2, decimals);
    vec![
        change.name.clone(),
        fixed(change.before.0, places),
        fixed(change.after.0, places),
        signed(change.difference(), places),
        change.sigma.map_or_else(|| "?".to_owned(), |sigma| format!("+- {}", fixed(sigma, places))),
        change.unit.clone(),
    ]
}
