//! What is uncertain, in a few sentences for page one: the cautions with those that say one thing as one.

use super::facts::Analysis;
use super::place::PlaceResult;
use crate::report::text::markup::shortened;
use crate::report::text::numbers::{decimals, fixed, many};
use crate::report::text::words::{capital, fine, list};

/// So many cautions stand on page one, each of at most so many letters; all of them below.
const MOST: usize = 3;
const LETTERS: usize = 450;
/// So many things that would look the same are named.
const ALIKE: usize = 3;

/// The sentences.
pub(super) fn of(analysis: &Analysis) -> Vec<String> {
    let open: Vec<&PlaceResult> =
        analysis.at_the_place.iter().filter(|of| of.caution().is_some()).collect();
    let of_place: Vec<String> = open.iter().filter_map(|of| of.caution()).collect();
    let left_out = analysis.diagnosis.iter().flat_map(|of| &of.left_out);
    let left_out = left_out.map(|of| format!("{} took no part: {}.", of.runs, of.reason));
    let others = analysis.cautions.iter().filter(|caution| !of_place.contains(caution)).cloned();
    let mut sentences: Vec<String> = left_out.chain(others).collect();
    let more = sentences.len().saturating_sub(MOST);
    sentences.truncate(MOST);
    let mut told: Vec<String> = as_one(&open)
        .into_iter()
        .chain(sentences)
        .map(|of| shortened(&fine(&of), LETTERS))
        .collect();
    if more > 0 {
        told.push(format!("And {}, below.", many(more, "more caution")));
    }
    told
}

/// What this test leaves open however little it scatters, the least known first, and what would look the same.
fn as_one(open: &[&PlaceResult]) -> Option<String> {
    let mut known: Vec<(f64, String)> = Vec::new();
    let mut alike: Vec<(usize, &str)> = Vec::new();
    for of in open {
        let all = of.all?;
        let told =
            format!("{} to {} {}", of.quantity, fixed(all, decimals(all, 2).min(3)), of.unit);
        known.push((all / of.noise.unwrap_or(all).max(f64::MIN_POSITIVE), told));
        for fault in &of.looks_like {
            match alike.iter_mut().find(|(_, other)| other == fault) {
                Some((count, _)) => *count += 1,
                None => alike.push((1, fault)),
            }
        }
    }
    known.sort_by(|a, b| b.0.total_cmp(&a.0));
    alike.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    let more = if alike.len() > ALIKE { " and others" } else { "" };
    let first = alike.iter().take(ALIKE).map(|(_, fault)| *fault);
    let first = list(first);
    (!known.is_empty()).then(|| {
        format!(
            "However little they scatter, this test knows {} only. {}{more} would look the same.",
            list(known.iter().map(|(_, told)| told.as_str())),
            capital(&first)
        )
    })
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
            deviation: None,
            looks_like: looks_like.iter().map(|of| (*of).to_owned()).collect(),
        }
    }

    #[test]
    fn what_says_one_thing_is_one_sentence() {
        let (bow, s) = ("a bow of X", "an S of Y");
        let open = [place("scale X", 2.0, &[bow]), place("scale Y", 34.0, &[s, bow])];
        let told = as_one(&open.each_ref()).unwrap();
        assert_eq!(
            told,
            "However little they scatter, this test knows scale Y to 34 um/m, scale X to 2.0 um/m only. A bow of X, an S of Y would look the same."
        );
        assert_eq!(as_one(&[]), None);
    }
}
