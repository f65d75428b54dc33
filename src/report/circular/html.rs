//! The section of the report.

use askama::Template;

use super::facts::{CircularFacts, CircularResult, CircularValue, WayResult};
use super::terminal;
use super::words::{test_name, worst_repeats};
use crate::error::{Error, Kind, Result};
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
    of.map_or_else(none, |of| format!("{} ± {}", fixed(of.value_um, 2), fixed(of.noise_um, 2)))
}

fn radial(of: Option<CircularValue>) -> String {
    of.map_or_else(none, |of| {
        let sigma = of.sigma_um.map_or(String::new(), |sigma| format!(" ± {}", fixed(sigma, 2)));
        format!("{}{sigma}", typeset(&signed(of.value_um, 2)))
    })
}
