//! The ranked features for the terminal.

use std::fmt::Write as _;

use super::facts::{FeatureResult, RankingFacts, RankingResult};
use crate::report::analysis::place::decimals;
use crate::report::text::layout::{paragraph, table};
use crate::report::text::numbers::{fixed, signed};
use crate::report::text::words::list;

/// What the columns mean.
pub(super) const MEANING: &str = "Falls: what the deviation of these readings is lower by if that one feature were repaired; a range is no sum, so they do not add up. Left: what is then left of it when those above are repaired as well, the order of repair. Share: what Ballbar 20 prints, each value in um over the sum of all; it says nothing of the circle.";

/// The features of every test; empty where there are none.
pub(in crate::report) fn text(facts: &RankingFacts) -> String {
    let mut text = String::new();
    let shown = worst_repeats(facts);
    for test in &shown {
        let _ = writeln!(
            text,
            "\nWhat to repair: {}, and by how much {} falls from {} um",
            test.test,
            test.deviation,
            fixed(test.deviation_um, 2)
        );
        let head = ["", "value", "noise", "all", "", "share", "falls", "left", ""];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(told(test).map(row));
        text.push_str(&table(&rows, "lrrrlrrrl"));
        for sentence in sentences(test) {
            paragraph(&mut text, "  ", &sentence);
        }
    }
    if !shown.is_empty() {
        paragraph(&mut text, "  ", MEANING);
    }
    for sentence in &facts.untold {
        paragraph(&mut text, "  ", sentence);
    }
    text
}

fn told(test: &RankingResult) -> impl Iterator<Item = &FeatureResult> {
    test.features.iter().filter(|feature| feature.told_apart_from_0)
}

fn row(of: &FeatureResult) -> Vec<String> {
    let [value, noise, all] = values(of);
    vec![
        of.feature.clone(),
        value,
        noise,
        all,
        of.unit.to_owned(),
        share(of),
        signed(of.fall_um, 2),
        left(of),
        of.in_words.clone(),
    ]
}

/// Value, noise and all that is not known, with as many digits as the noise has.
pub(super) fn values(of: &FeatureResult) -> [String; 3] {
    let places = decimals(of.noise.unwrap_or(0.0));
    let plain = |of: Option<f64>| of.map_or_else(|| "-".to_owned(), |of| fixed(of, places));
    [signed(of.value, places), plain(of.noise), plain(of.all)]
}

pub(super) fn share(of: &FeatureResult) -> String {
    of.share_percent.map_or_else(|| "-".to_owned(), |share| format!("{} %", fixed(share, 0)))
}

pub(super) fn left(of: &FeatureResult) -> String {
    of.left_um.map_or_else(|| "-".to_owned(), |um| fixed(um, 2))
}

/// What stands below the table.
pub(super) fn sentences(test: &RankingResult) -> Vec<String> {
    let ends = told(test).filter_map(|of| {
        let places = decimals(of.noise.unwrap_or(0.0));
        let [positive, negative] = [of.positive_end?, of.negative_end?];
        Some(format!(
            "{} {} um at the positive end and {} um at the negative one",
            of.feature,
            signed(positive, places),
            signed(negative, places)
        ))
    });
    let ends: Vec<String> = ends.collect();
    let apart = test.features.iter().filter(|feature| !feature.told_apart_from_0).map(|of| {
        let [value, _, all] = values(of);
        format!("{} ({value} +- {all} {})", of.feature, of.unit)
    });
    let apart: Vec<String> = apart.collect();
    let mut sentences = Vec::new();
    if !ends.is_empty() {
        sentences.push(format!("Outward positive: {}.", ends.join("; ")));
    }
    if !apart.is_empty() {
        sentences.push(format!(
            "Not told apart from 0: {}. Without all of these together {} would be {} um {}.",
            list(apart),
            test.deviation,
            fixed(test.untold_fall_um.abs(), 2),
            if test.untold_fall_um < 0.0 { "higher" } else { "lower" }
        ));
    }
    sentences.push(format!(
        "Without anything named here {} would be {} um. By itself noise, with whatever the model does not explain, makes {} um, and what the program's own chords and rounding lie off the circle {} um.",
        test.deviation,
        fixed(test.left_um, 2),
        fixed(test.unexplained_um, 2),
        fixed(test.commanded_um, 2)
    ));
    if !test.not_found.is_empty() {
        let smallest = test.smallest_um.map_or_else(String::new, |um| {
            format!(" (what does less than {} um rms would not have been)", fixed(um, 3))
        });
        sentences.push(format!("Not found: {}{smallest}.", list(&test.not_found)));
    }
    if let Some(volumetric_um) = test.volumetric_um {
        let falls: Vec<String> = told(test)
            .filter_map(|of| Some((of, of.volumetric_fall_um?, of.volumetric_left_um?)))
            .map(|(of, falls_um, left_um)| {
                format!("{} {} (left {})", of.feature, signed(falls_um, 2), fixed(left_um, 2))
            })
            .collect();
        sentences.push(format!(
            "Volumetric error over the sphere that was measured {} um rms; it falls by, in um, and is left when those before are repaired as well: {}.",
            fixed(volumetric_um, 2),
            list(falls)
        ));
    }
    sentences
}

/// Of the repeats of each test that with the largest deviation, in the order in which they were driven.
pub(super) fn worst_repeats(facts: &RankingFacts) -> Vec<&RankingResult> {
    let mut worst: Vec<&RankingResult> = Vec::new();
    for test in &facts.tests {
        let same = |other: &&mut &RankingResult| {
            (&other.test, other.deviation) == (&test.test, test.deviation)
        };
        match worst.iter_mut().find(same) {
            Some(other) if test.deviation_um > other.deviation_um => *other = test,
            Some(_) => {}
            None => worst.push(test),
        }
    }
    worst
}
