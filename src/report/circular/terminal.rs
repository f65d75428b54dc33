//! Circular tests for the terminal.

use std::fmt::Write as _;

use super::facts::{CircularFacts, CircularResult, CircularValue, ConformityItem};
use super::words::{test_name, worst_repeats};
use crate::report::text::layout::{paragraph, table};
use crate::report::text::numbers::{fixed, signed};
use crate::report::text::words::list;

/// The tests and the tolerances; empty where there are neither.
pub(in crate::report) fn text(facts: &CircularFacts) -> String {
    let mut text = String::new();
    let shown = worst_repeats(&facts.tests);
    if !shown.is_empty() {
        text.push_str(
            "\nCircular tests as in ISO 230-4 (um; minimum zone, in brackets least squares)\n",
        );
        let ways = ways(&shown);
        let [one, other] = ways.map(|way| format!("G {way}"));
        let head = ["", &one, &other, "G(b)", "H", "D", "F max", "F min"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(shown.iter().map(|test| row(test, ways)));
        text.push_str(&table(&rows, "lrrrrrrr"));
        for sentence in sentences(facts) {
            paragraph(&mut text, "  ", &sentence);
        }
    }
    if let Some(conformity) = &facts.conformity {
        let _ = writeln!(text, "\nTolerances: {}", conformity.verdict.words());
        let rows: Vec<Vec<String>> =
            conformity.items.iter().map(|item| judged(item).to_vec()).collect();
        text.push_str(&table(&rows, "lrll"));
        paragraph(&mut text, "  ", &format!("{}.", conformity.rule));
    }
    text
}

/// What the two directions are called.
pub(super) fn ways(shown: &[&CircularResult]) -> [&'static str; 2] {
    match shown.iter().flat_map(|test| &test.ways).next().map(|way| way.direction) {
        Some("CCW" | "CW") => ["CCW", "CW"],
        _ => ["forward", "backward"],
    }
}

fn row(test: &CircularResult, ways: [&str; 2]) -> Vec<String> {
    let none = || "-".to_owned();
    let plain = |of: Option<CircularValue>| of.map_or_else(none, |of| fixed(of.value_um, 2));
    let sign = |of: Option<f64>| of.map_or_else(none, |um| signed(um, 2));
    let mut cells = vec![test_name(test)];
    for way in ways {
        let way = test.ways.iter().find(|of| of.direction == way);
        cells.push(plain(way.map(|way| way.circular_deviation)));
    }
    let both = test
        .bidirectional_circular_deviation
        .zip(test.bidirectional_circular_deviation_least_squares);
    cells.push(both.map_or_else(none, |(by_zone, by_squares)| zone(&by_zone, &by_squares)));
    cells.push(plain(test.circular_hysteresis));
    cells.push(sign(test.mean_bidirectional_radial_deviation.map(|of| of.value_um)));
    let highest = test.ways.iter().filter_map(|way| Some(way.radial_deviation_max?.value_um));
    let lowest = test.ways.iter().filter_map(|way| Some(way.radial_deviation_min?.value_um));
    cells.push(sign(highest.reduce(f64::max)));
    cells.push(sign(lowest.reduce(f64::min)));
    cells
}

fn zone(by_zone: &CircularValue, by_squares: &CircularValue) -> String {
    format!("{} ({})", fixed(by_zone.value_um, 2), fixed(by_squares.value_um, 2))
}

/// What goes with the numbers: noise, filter, repeats, what is missing.
pub(super) fn sentences(facts: &CircularFacts) -> Vec<String> {
    let ranges = || {
        let ways = facts.tests.iter().flat_map(|t| t.ways.iter().map(|way| way.circular_deviation));
        ways.chain(facts.tests.iter().filter_map(|t| t.bidirectional_circular_deviation))
    };
    let noise_um = ranges().map(|of| of.noise_um).fold(0.0, f64::max);
    let widened_um = ranges().map(|of| of.widened_um).fold(0.0, f64::max);
    let shown = worst_repeats(&facts.tests);
    let mut diameters: Vec<String> = shown.iter().map(|test| fixed(test.diameter_mm, 0)).collect();
    diameters.dedup();
    let mut filters: Vec<&str> = Vec::new();
    for test in &facts.tests {
        if !filters.contains(&test.filter.as_str()) {
            filters.push(&test.filter);
        }
    }
    let mut told = vec![
        format!("Diameter {} mm. Filter: {}.", diameters.join(", "), filters.join("; ")),
        format!(
            "Noise: G and G(b) scatter by {} um and are larger by up to {} um than without it, which is not taken off.",
            fixed(noise_um, 2),
            fixed(widened_um, 2)
        ),
    ];
    if facts.tests.len() > shown.len() {
        told.push(format!(
            "Of the repeats that one with the largest deviation is shown; all {} are in analysis.json.",
            facts.tests.len()
        ));
    }
    let lengths = || facts.tests.iter().filter_map(|test| test.mean_bidirectional_radial_deviation);
    if lengths().next().is_some() && lengths().all(|of| of.sigma_um.is_none()) {
        told.push("F and D are right for a bar of exactly its nominal length: `length_sigma_um` says how well it is known.".to_owned());
    }
    let parts: Vec<String> = shown
        .iter()
        .filter(|test| !test.whole)
        .map(|test| {
            let condition = test.centre_condition.map_or("?".to_owned(), |of| fixed(of, 1));
            format!("{} (condition of the centre {condition})", test_name(test))
        })
        .collect();
    if !parts.is_empty() {
        told.push(format!(
            "Not whole, so without F and D: {}. Their G is about the centre of the minimum zone of the arc itself, G(b) about one of both ways (in brackets that of least squares), not about the place where the balls were set.",
            list(parts)
        ));
    }
    told.extend(facts.untold.iter().take(MOST_UNTOLD).cloned());
    if let Some(more @ 1..) = facts.untold.len().checked_sub(MOST_UNTOLD) {
        told.push(format!("And {more} more arcs: see analysis.json."));
    }
    told
}

/// So many arcs without values are told.
const MOST_UNTOLD: usize = 4;

/// Quantity, value with its uncertainty, limit, verdict.
pub(super) fn judged(item: &ConformityItem) -> [String; 4] {
    let uncertainty = item.expanded.map_or(String::new(), |u| format!(" +- {}", fixed(u, 2)));
    let value =
        item.value.map_or("-".to_owned(), |value| format!("{}{uncertainty}", fixed(value, 2)));
    let why = if item.why.is_empty() { String::new() } else { format!(": {}", item.why) };
    [
        item.quantity.clone(),
        format!("{value} {}", item.unit),
        format!("limit {}", fixed(item.limit, 2)),
        format!("{}{why}", item.verdict.words()),
    ]
}
