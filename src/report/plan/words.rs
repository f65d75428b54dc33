//! Sentences that terminal and page share.

use super::facts::{ForeseenPlace, TestOutlook};
use crate::report::text::numbers::{fixed, many};
use crate::report::text::words::list;

/// What the terms are that nothing separates.
const OF_THE_REST: &str = "most describe where the machine's zero is, or repeat what is kept";

/// What a step is in the table of machine errors.
pub(super) const STEP: &str = "The step at a reversal is twice the coefficient.";

/// What the test is, in a line.
pub(super) fn under_title(test: &TestOutlook) -> String {
    let mut bars: Vec<String> =
        test.mountings.iter().map(|mounting| mounting.bar_length_mm.to_string()).collect();
    bars.sort();
    bars.dedup();
    format!(
        "{} ({}), bar {} mm, strategy {}, feed {} mm/min, {}",
        test.machine.name,
        test.machine.topology,
        bars.join(" and "),
        test.strategy,
        list(test.feeds_mm_min.iter().map(|feed| fixed(*feed, 0))),
        many(test.mountings.len(), "mounting")
    )
}

/// Where the bodies come nearest; mountings where that is the same share a sentence.
pub(super) fn clearances(test: &TestOutlook) -> Vec<String> {
    let mut told: Vec<(String, Vec<&str>)> = Vec::new();
    for mounting in &test.mountings {
        let Some(least) = &mounting.clearance else { continue };
        let words = format!(
            "least clearance {} mm between {} and support, on {} at the ball vector {} mm",
            fixed(least.clearance_mm, 1),
            least.part,
            least.section,
            vector(&least.ball_mm)
        );
        match told.iter_mut().find(|(same, _)| *same == words) {
            Some((_, names)) => names.push(&mounting.name),
            None => told.push((words, vec![&mounting.name])),
        }
    }
    told.into_iter().map(|(words, names)| format!("{}: {words}.", names.join(", "))).collect()
}

/// `(12.0, -3.5, 0.0)`.
pub(super) fn vector(mm: &[f64; 3]) -> String {
    format!("({})", mm.map(|mm| fixed(mm, 1)).join(", "))
}

/// What the operator's time assumes.
pub(super) fn assumed(test: &TestOutlook, repeats: u32) -> String {
    let operator = &test.operator;
    let again = if repeats > 1 { "; the balls stay in place between the repeats" } else { "" };
    format!(
        "The operator's time is an assumption of the test file: {} min to set up a mounting, {} min to fit the bar, {} s at a stop between arcs{again}.",
        operator.set_up_min, operator.fit_bar_min, operator.stop_s
    )
}

/// What stands before the terms of a group.
pub(super) fn heading(what: &str) -> String {
    if what.is_empty() {
        format!("Separated by nothing that was tried; {OF_THE_REST}")
    } else {
        format!("Separated by {what}")
    }
}

/// What stands for the terms that nothing separates, where there is no room for their names.
pub(super) fn not_separated(terms: usize) -> String {
    format!("Separated by nothing that was tried: {}; {OF_THE_REST}", many(terms, "other"))
}

/// What the two uncertainties are.
pub(super) const BOTH: &str = "noise: what repeats scatter; all: noise and what this test cannot tell from other plausible faults of the machine (`[plausible]` in the machine file).";

/// What would look like a scale or a squareness in a test.
pub(super) fn looks_like(test: &TestOutlook) -> Vec<String> {
    let open = test
        .at_the_place
        .iter()
        .filter(|foreseen| foreseen.unit == "um/m" && !foreseen.looks_like.is_empty());
    let line = |foreseen: &ForeseenPlace| {
        let faults = list(foreseen.looks_like.iter().map(String::as_str));
        format!("{}: {faults} would look the same", foreseen.quantity)
    };
    open.map(line).collect()
}
