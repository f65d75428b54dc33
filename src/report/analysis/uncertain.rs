//! What is uncertain, in a few sentences for page one: the cautions with those that say one thing as one.

use super::advice;
use super::facts::Analysis;
use super::place::{self, PlaceResult};
use crate::report::text::markup::shortened;
use crate::report::text::numbers::{fixed, many};
use crate::report::text::words::{capital, fine, list};

/// So many cautions stand on page one, all together with about so many letters; the sections below have all.
const MOST: usize = 3;
const LETTERS: usize = 520;
/// Less than so many letters of a caution say nothing.
const FEWEST: usize = 80;
/// So many things that would look the same are named.
const ALIKE: usize = 3;

/// The sentences.
pub(super) fn of(analysis: &Analysis) -> Vec<String> {
    let radius_mm = advice::radius_mm(analysis);
    let of_place: Vec<String> =
        analysis.at_the_place.iter().filter_map(PlaceResult::caution).collect();
    // What moves nothing that anybody repairs is told below.
    let matters =
        |of: &&PlaceResult| of.caution().is_some() && advice::is_worth(of.all, of.unit, radius_mm);
    let open: Vec<&PlaceResult> = analysis.at_the_place.iter().filter(matters).collect();
    let left_out = analysis.diagnosis.iter().flat_map(|of| &of.left_out);
    let left_out = left_out.map(|of| format!("{} took no part: {}.", of.runs, of.reason));
    let others = analysis.cautions.iter().filter(|caution| !of_place.contains(caution)).cloned();
    let others: Vec<String> = others.collect();
    let as_one = as_one(&open);
    // Where little is explained, what a test leaves open matters least.
    let (first, last) = if advice::little_explained(analysis).is_empty() {
        (as_one.into_iter().collect::<Vec<_>>(), others)
    } else {
        (others, as_one.into_iter().collect())
    };
    let all: Vec<String> = first.into_iter().chain(left_out).chain(last).collect();
    let mut told: Vec<String> = Vec::new();
    let mut room = LETTERS;
    for sentence in all.iter().take(MOST) {
        if room < FEWEST {
            break;
        }
        told.push(shortened(&fine(sentence), room));
        room -= room.min(sentence.chars().count());
    }
    let more = all.len() - told.len();
    if more > 0 {
        told.push(format!("And {}, below.", many(more, "more caution")));
    }
    told
}

/// What this test leaves open however little it scatters, a kind at a time, each as well as the least known of it; and what
/// would look the same.
fn as_one(open: &[&PlaceResult]) -> Option<String> {
    let mut kinds: Vec<(&str, Vec<&str>, f64, &str)> = Vec::new();
    let mut alike: Vec<(usize, &str)> = Vec::new();
    for of in open {
        let (kind, name) = kind_and_name(&of.quantity)?;
        let all = of.all?;
        match kinds.iter_mut().find(|(other, ..)| *other == kind) {
            Some((_, names, worst, _)) => {
                names.push(name);
                *worst = worst.max(all);
            }
            None => kinds.push((kind, vec![name], all, of.unit)),
        }
        for fault in &of.looks_like {
            match alike.iter_mut().find(|(_, other)| other == fault) {
                Some((count, _)) => *count += 1,
                None => alike.push((1, fault)),
            }
        }
    }
    alike.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    let more = if alike.len() > ALIKE { " and others" } else { "" };
    let first = list(alike.iter().take(ALIKE).map(|(_, fault)| *fault));
    let told = kinds.iter().map(|(kind, names, worst, unit)| {
        format!("{kind} {} to {} {unit}", names.join(", "), fixed(*worst, place::decimals(*worst)))
    });
    let told: Vec<String> = told.collect();
    (!told.is_empty()).then(|| {
        format!(
            "However little they scatter, this test knows only: {}. {}{more} would look the same.",
            told.join("; "),
            capital(&first)
        )
    })
}

/// `squareness` and `XY`, `lateral play` and `X in Y`.
fn kind_and_name(quantity: &str) -> Option<(&str, &str)> {
    const OF_TWO_WORDS: &str = "lateral play";
    match quantity.strip_prefix(OF_TWO_WORDS) {
        Some(name) => Some((OF_TWO_WORDS, name.trim_start())),
        None => quantity.split_once(' '),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn place(quantity: &str, all: f64, looks_like: &[&str]) -> PlaceResult {
        PlaceResult {
            quantity: quantity.into(),
            unit: "um/m",
            value: 1.0,
            noise: Some(0.1),
            all: Some(all),
            plausible: None,
            deviation: None,
            over_noise: None,
            looks_like: looks_like.iter().map(|of| (*of).to_owned()).collect(),
        }
    }

    #[test]
    fn what_says_one_thing_is_one_sentence() {
        let (bow, s) = ("a bow of X", "an S of Y");
        let open = [
            place("scale X", 2.0, &[bow]),
            place("lateral play X in Y", 5.0, &[bow]),
            place("scale Y", 34.0, &[s, bow]),
        ];
        let told = as_one(&open.each_ref()).unwrap();
        assert_eq!(
            told,
            "However little they scatter, this test knows only: scale X, Y to 34 um/m; lateral play X in Y to 5.0 um/m. A bow of X, an S of Y would look the same."
        );
        assert_eq!(as_one(&[]), None);
    }
}
