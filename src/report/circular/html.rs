//! The section of the report.

use askama::Template;

use super::facts::{CircularFacts, CircularResult, CircularValue, ConformityItem, WayResult};
use super::terminal;
use super::words::{size_um, test_name, worst_repeats};
use crate::error::{Error, Kind, Result};
use crate::report::text::filters;
use crate::report::text::numbers::{count, fixed, signed, typeset};
use crate::report::text::words::fine;

#[derive(Template)]
#[template(path = "circular.html")]
struct Section {
    verdict: Option<String>,
    rule: String,
    judged: Vec<[String; 4]>,
    ways: Vec<[String; 9]>,
    both: Vec<[String; 8]>,
    sentences: Vec<String>,
}

/// The section, as HTML without a page around it; empty where there is nothing to tell.
pub(in crate::report) fn section(facts: &CircularFacts) -> Result<String> {
    if facts.tests.is_empty() && facts.conformity.is_none() {
        return Ok(String::new());
    }
    let shown = worst_repeats(&facts.tests);
    let conformity = facts.conformity.as_ref();
    let section = Section {
        verdict: conformity.map(|of| of.verdict.words().to_owned()),
        rule: conformity.map_or_else(String::new, |of| of.rule.to_owned()),
        judged: conformity
            .map(|of| of.items.iter().map(|item| terminal::judged(item).map(|cell| fine(&cell))))
            .into_iter()
            .flatten()
            .collect(),
        ways: shown.iter().flat_map(|t| t.ways.iter().map(|way| of_way(t, way))).collect(),
        both: shown.iter().map(|test| of_both(test)).collect(),
        sentences: terminal::sentences(facts).iter().map(|sentence| fine(sentence)).collect(),
    };
    section.render().map_err(|error| {
        Error::new(Kind::Output, format!("the circular tests cannot be rendered: {error}"))
    })
}

/// The tests as page one has them.
pub(in crate::report) struct InShort {
    /// What the two directions are called.
    pub(in crate::report) ways: [&'static str; 2],
    /// Test, G of each way, G(b), H, D; the largest first.
    pub(in crate::report) rows: Vec<[String; 6]>,
    /// So many others.
    pub(in crate::report) more: usize,
}

/// The tests with the largest deviations.
pub(in crate::report) fn in_short(facts: &CircularFacts, most: usize) -> InShort {
    let mut shown = worst_repeats(&facts.tests);
    shown.sort_by(|a, b| size_um(b).total_cmp(&size_um(a)));
    let ways = terminal::ways(&shown);
    let value = |of: Option<CircularValue>| of.map_or_else(none, |of| fixed(of.value_um, 2));
    let rows = shown.iter().take(most).map(|test| {
        let way = |name: &str| {
            let way = test.ways.iter().find(|way| way.direction == name);
            value(way.map(|way| way.circular_deviation))
        };
        let mean = test.mean_bidirectional_radial_deviation;
        [
            test_name(test),
            way(ways[0]),
            way(ways[1]),
            value(test.bidirectional_circular_deviation),
            value(test.circular_hysteresis),
            mean.map_or_else(none, |of| typeset(&signed(of.value_um, 2))),
        ]
    });
    InShort { ways, rows: rows.collect(), more: shown.len().saturating_sub(most) }
}

/// The largest circular deviation: which, and how large, um.
pub(in crate::report) fn largest(facts: &CircularFacts) -> Option<(String, f64)> {
    let worst = largest_test(facts)?;
    let name = if worst.bidirectional_circular_deviation.is_some() { "G(b)" } else { "G" };
    Some((format!("{name} of {}", test_name(worst)), size_um(worst)))
}

/// The circle that has it.
pub(in crate::report) fn largest_circle(facts: &CircularFacts) -> Option<&str> {
    largest_test(facts).map(|test| test.circle.as_str())
}

fn largest_test(facts: &CircularFacts) -> Option<&CircularResult> {
    facts.tests.iter().max_by(|a, b| size_um(a).total_cmp(&size_um(b)))
}

/// What tolerances say, the gravest first.
pub(in crate::report) fn judged(facts: &CircularFacts, most: usize) -> Vec<[String; 4]> {
    let mut items: Vec<&ConformityItem> =
        facts.conformity.iter().flat_map(|of| &of.items).collect();
    items.sort_by_key(|item| std::cmp::Reverse(item.verdict));
    let rows = items.into_iter().take(most);
    let cells = rows.map(|item| {
        let [name, value, _, verdict] = terminal::judged(item).map(|cell| fine(&cell));
        [name, value, fixed(item.limit, 2), verdict]
    });
    cells.collect()
}

fn of_way(test: &CircularResult, way: &WayResult) -> [String; 9] {
    [
        test_name(test),
        way.direction.to_owned(),
        with_sigma(Some(way.circular_deviation)),
        fixed(way.circular_deviation_least_squares.value_um, 2),
        radial(way.radial_deviation_max),
        radial(way.radial_deviation_min),
        fixed(way.start_deg, 1),
        fixed(test.sweep_deg, 0),
        count(way.points),
    ]
}

fn of_both(test: &CircularResult) -> [String; 8] {
    let [x, y, z] = test.centre_mm.map(|mm| typeset(&fixed(mm, 3)));
    let by_squares = test.bidirectional_circular_deviation_least_squares;
    [
        test_name(test),
        with_sigma(test.bidirectional_circular_deviation),
        by_squares.map_or_else(none, |of| fixed(of.value_um, 2)),
        radial(test.mean_bidirectional_radial_deviation),
        with_sigma(test.circular_hysteresis),
        fixed(test.diameter_mm, 0),
        format!("{} {x}, {y}, {z}", test.mounting),
        test.repeat.to_string(),
    ]
}

fn none() -> String {
    "–".to_owned()
}

fn with_sigma(of: Option<CircularValue>) -> String {
    of.map_or_else(none, |of| {
        let sigma_um = of.sigma_um.unwrap_or(of.noise_um);
        format!("{} ± {}", fixed(of.value_um, 2), fixed(sigma_um, 2))
    })
}

fn radial(of: Option<CircularValue>) -> String {
    of.map_or_else(none, |of| {
        let sigma = of.sigma_um.map_or(String::new(), |sigma| format!(" ± {}", fixed(sigma, 2)));
        format!("{}{sigma}", typeset(&signed(of.value_um, 2)))
    })
}
