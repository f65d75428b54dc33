//! What changed, in words.

use crate::monitor::{Change, Comparison, FindingChange, Found, Judged, Kind};
use crate::report::analysis::place::decimals;
use crate::report::text::numbers::{fixed, many, signed};
use crate::report::text::words::{capital, list};

pub(super) fn judged(judged: Judged) -> &'static str {
    match judged {
        Judged::Changed => "changed",
        Judged::WithIt => "changed, or what looks like it",
        Judged::Same => "no change that could be told",
        Judged::Unknown => "not known",
    }
}

/// The verdict in sentences, the gravest first.
pub(super) fn verdict(comparison: &Comparison) -> Vec<String> {
    let of = |judged: Judged| comparison.changes.iter().filter(move |c| c.judged == judged);
    let mut told = Vec::new();
    let mut changed: Vec<&Change> = of(Judged::Changed).collect();
    let size =
        |change: &Change| change.sigma.map_or(0.0, |sigma| change.difference().abs() / sigma);
    // What is of the machine first: circles show what it does to them.
    let of_machine = |change: &Change| change.kind == Kind::Machine;
    changed.sort_by(|a, b| of_machine(b).cmp(&of_machine(a)).then(size(b).total_cmp(&size(a))));
    told.extend(
        changed
            .iter()
            .take(MOST)
            .map(|change| format!("{} changed by {}.", capital(&change.name), difference(change))),
    );
    if changed.len() > MOST {
        let more = many(changed.len() - MOST, "more quantity").replace("quantitys", "quantities");
        told.push(format!("And {more}: see the table."));
    }
    let finding = |change: &FindingChange| match change.found {
        Found::New => Some(format!("New: {}.", change.title)),
        Found::Gone => Some(format!("No longer found: {}.", change.title)),
        _ => {
            let changed: Vec<&str> =
                change.numbers.iter().filter(|n| n.4).map(|n| n.0.as_str()).collect();
            (!changed.is_empty())
                .then(|| format!("Of {} changed: {}.", change.title, list(changed)))
        }
    };
    told.extend(comparison.findings.iter().filter_map(finding));
    let with: Vec<&str> = of(Judged::WithIt).map(|change| change.name.as_str()).collect();
    if !with.is_empty() {
        let what = if told.is_empty() {
            "Something has changed, and these tests cannot tell which of"
        } else {
            "These moved by no more than what has changed may look like"
        };
        told.push(format!("{what}: {}.", list(with)));
    }
    let compared =
        comparison.changes.iter().filter(|change| change.judged != Judged::Unknown).count();
    if told.is_empty() && compared > 0 {
        told.push(format!(
            "No change that could be told in {}.",
            many(compared, "quantity").replace("quantitys", "quantities")
        ));
    }
    if compared == 0 {
        told.push("There is nothing that both tests tell with an uncertainty.".to_owned());
    }
    told
}

/// So many changes are told in sentences.
const MOST: usize = 6;

/// Such as `+5.15 +- 0.05 um, from 1.20 to 6.35`.
pub(super) fn difference(change: &Change) -> String {
    let sigma = change.sigma.unwrap_or(0.0);
    let places = decimals(sigma);
    format!(
        "{} +- {} {}, from {} to {}",
        signed(change.difference(), places),
        fixed(sigma, places),
        change.unit,
        fixed(change.before.0, places),
        fixed(change.after.0, places)
    )
}

/// What the standard deviations are of.
pub(super) fn basis(comparison: &Comparison) -> String {
    let seldom = format!(
        "A change is what exceeds {} standard deviations of the difference: chance does that in one of a hundred comparisons of a machine that has not changed.",
        fixed(comparison.beyond, 1)
    );
    let of = if comparison.equal {
        "The tests are equal: what one cannot tell from other faults the other cannot either, so that the difference is known better than either value. That holds as far as those faults have not changed as well; they are given the same share of what is plausible as the largest change."
    } else {
        "The tests are not equal: the difference is as uncertain as both values together, with all that either test cannot tell from other faults."
    };
    format!("{seldom} {of}")
}

/// A finding before and after.
pub(super) fn finding(change: &FindingChange) -> String {
    let um =
        |of: Option<f64>| of.map_or_else(|| "-".to_owned(), |um| format!("{} um", fixed(um, 2)));
    let [before, after] = change.rms_um.map(um);
    let what = match change.found {
        Found::Both => format!("in both, {before} and {after} rms"),
        Found::New => format!("only after, {after} rms"),
        Found::Gone => format!("only before, {before} rms"),
        Found::Below(least) => {
            let (which, size) =
                if change.rms_um[0].is_some() { ("before", before) } else { ("after", after) };
            format!(
                "only {which}, {size} rms; the other test sees nothing below {} um",
                fixed(least, 2)
            )
        }
        Found::NotLooked => format!("{before} and {after} rms; in one of them nobody looked"),
    };
    let numbers = change.numbers.iter().map(|(name, before, after, sigma, changed)| {
        let places = sigma.map_or(3, decimals);
        let sigma = sigma.map_or_else(String::new, |sigma| format!(" +- {}", fixed(sigma, places)));
        let told = if *changed { ", changed" } else { "" };
        format!("; {name} {} and {}{sigma}{told}", fixed(*before, places), fixed(*after, places))
    });
    format!("{}: {what}{}", change.title, numbers.collect::<String>())
}
