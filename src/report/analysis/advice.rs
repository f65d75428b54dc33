//! What to do: two sentences of what was found, the one that matters most on a circle first.

use super::facts::Analysis;
use super::place::{self, PlaceResult};
use crate::report::circular::facts::Verdict;
use crate::report::diagnosis::facts::FindingFacts;
use crate::report::ranked::facts::{FeatureResult, RankingResult};
use crate::report::ranked::remedies;
use crate::report::text::markup::shortened;
use crate::report::text::numbers::{decimals, fixed, signed, typeset};
use crate::report::text::words::{capital, fine};

/// Nobody repairs what moves the reading by less, um: the bar itself is not known better.
const WORTH_REPAIR_UM: f64 = 1.0;
/// A quantity is there where it is so many of its standard deviations.
const THERE: f64 = 2.0;
/// From highest to lowest of a sine, in root mean squares.
const RANGE_OF_RMS: f64 = 2.83;
/// So many sentences, each of at most so many letters.
const SENTENCES: usize = 2;
const LETTERS: usize = 320;

/// Something that can be repaired.
struct Lever {
    /// By how much it moves the reading on a circle, from highest to lowest, um.
    size_um: f64,
    sentence: String,
}

/// By how much a quantity moves the reading on the circle of the test, um; `None` of rotations, which depend on the place.
pub(super) fn size_um(of: &PlaceResult, radius_mm: f64) -> Option<f64> {
    on_the_circle_um(of.value, of.unit, radius_mm)
}

fn on_the_circle_um(value: f64, unit: &str, radius_mm: f64) -> Option<f64> {
    match unit {
        "um" => Some(value.abs()),
        "um/m" => Some(value.abs() * radius_mm * 1e-3),
        _ => None,
    }
}

/// Whether so much of a quantity, such as its uncertainty, would be worth repair.
pub(super) fn is_worth(value: Option<f64>, unit: &str, radius_mm: f64) -> bool {
    value.and_then(|value| on_the_circle_um(value, unit, radius_mm)) >= Some(WORTH_REPAIR_UM)
}

/// The radius at which quantities are compared, mm: that of the longest bar.
pub(super) fn radius_mm(analysis: &Analysis) -> f64 {
    analysis.test.mountings.iter().map(|of| of.bar_length_mm).fold(0.0, f64::max)
}

/// Whether a quantity stands out of all that is not known of it.
pub(super) fn is_there(of: &PlaceResult) -> bool {
    of.value.abs() > THERE * of.all.or(of.noise).unwrap_or(f64::INFINITY)
}

/// The runs of which the model explains little: then nothing that it says is a reason to touch a machine.
pub(super) fn little_explained(analysis: &Analysis) -> Vec<&str> {
    analysis
        .repeats
        .iter()
        .flat_map(|repeat| &repeat.little_explained)
        .map(String::as_str)
        .collect()
}

/// What to do, in sentences.
pub(super) fn of(analysis: &Analysis) -> Vec<String> {
    let little_explained = little_explained(analysis);
    if !little_explained.is_empty() {
        return vec![format!(
            "Repair nothing by these numbers: of {} the model explains little beside the set-up. See that each log is of its run and its program, and what is uncertain.",
            little_explained.join(", ")
        )];
    }
    let diagnosis = analysis.diagnosis.as_ref();
    // What the files state wrong is neither repaired nor compensated, and comes before all else.
    let stated = diagnosis.iter().flat_map(|of| &of.verdict.wrong_settings).cloned();
    let stated = stated.chain(diagnosis.iter().flat_map(|of| &of.verdict.off_times).cloned());
    let mut sentences: Vec<String> = stated.take(1).map(|sentence| fine(&sentence)).collect();
    let kept = analysis.circular.conformity.as_ref().map(|of| of.verdict == Verdict::Pass);
    let (mut levers, small) = two_levers(analysis);
    if kept == Some(true) {
        sentences
            .push("Nothing has to be repaired: every tolerance of the test file is kept.".into());
        if let Some(largest) = levers.first() {
            sentences.push(format!("To become better still: {}", largest.sentence));
        }
    } else if levers.is_empty() && sentences.is_empty() {
        sentences.push(if kept.is_none() {
            format!(
                "Nothing to repair: nothing that is certain moves the reading by more than {} µm.",
                fixed(WORTH_REPAIR_UM, 0)
            )
        } else {
            "No single cause stands out of what this test leaves open: measure again, or in a way that tells more.".into()
        });
        sentences.extend(
            small.map(|cause| format!("The largest cause that was found: {}", cause.sentence)),
        );
    } else {
        sentences.extend(levers.drain(..).map(|lever| lever.sentence));
    }
    sentences.truncate(SENTENCES);
    sentences.iter().map(|sentence| shortened(sentence, LETTERS)).collect()
}

/// The largest cause that was named and the largest quantity, or two of one where there is none of the other; the larger
/// first. And the largest cause that nobody would repair.
fn two_levers(analysis: &Analysis) -> (Vec<Lever>, Option<Lever>) {
    if let Some(features) = of_a_plane(analysis) {
        return features;
    }
    let named = analysis.diagnosis.iter().flat_map(|of| &of.findings).filter(|of| of.named);
    let radius_mm = radius_mm(analysis);
    let (seen, _) = place::seen(&analysis.at_the_place);
    let there = seen.into_iter().filter(|of| is_there(of));
    let by_size = |mut levers: Vec<Lever>| {
        levers.sort_by(|a, b| b.size_um.total_cmp(&a.size_um));
        let worth = levers.partition_point(|lever| lever.size_um >= WORTH_REPAIR_UM);
        let small = levers.split_off(worth);
        (levers, small.into_iter().next())
    };
    let (mut causes, small) = by_size(named.map(cause).collect());
    let (mut quantities, _) = by_size(there.filter_map(|of| quantity(of, radius_mm)).collect());
    let of_causes = if quantities.is_empty() { SENTENCES } else { 1 };
    causes.truncate(of_causes);
    quantities.truncate(SENTENCES - causes.len());
    causes.append(&mut quantities);
    (by_size(causes).0, small)
}

/// The features of the worst circular test in the order of their table, where every test has one; `None` elsewhere: what
/// a sphere shows beside its circles counts too.
fn of_a_plane(analysis: &Analysis) -> Option<(Vec<Lever>, Option<Lever>)> {
    let facts = &analysis.ranking;
    if facts.tests.len() < analysis.circular.tests.len() {
        return None;
    }
    let by_size =
        |a: &&RankingResult, b: &&RankingResult| a.deviation_um.total_cmp(&b.deviation_um);
    let worst = facts.tests.iter().max_by(by_size)?;
    let told = worst.features.iter().filter(|of| of.told_apart_from_0 && !of.what_to_do.is_empty());
    let (mut levers, small): (Vec<Lever>, Vec<Lever>) = told
        .map(|of| feature(of, worst.deviation))
        .partition(|lever| lever.size_um >= WORTH_REPAIR_UM);
    levers.truncate(SENTENCES);
    Some((levers, small.into_iter().next()))
}

fn feature(of: &FeatureResult, deviation: &str) -> Lever {
    let value = typeset(&signed(of.value, decimals(of.value, 3).min(3)));
    let side = if of.in_words.is_empty() { String::new() } else { format!(", {}", of.in_words) };
    let sentence = format!(
        "{} ({}{side}; {deviation} falls by {} µm): {}.",
        capital(&of.feature),
        fine(&format!("{value} {}", of.unit)),
        fixed(of.fall_um, 1),
        of.what_to_do
    );
    Lever { size_um: of.fall_um, sentence }
}

fn cause(of: &FindingFacts) -> Lever {
    let rms_um = of.rms_mm * 1e3;
    Lever {
        size_um: RANGE_OF_RMS * rms_um,
        sentence: format!("{} ({} µm rms): {}.", of.title, fixed(rms_um, 2), of.remedy),
    }
}

fn quantity(of: &PlaceResult, radius_mm: f64) -> Option<Lever> {
    let kind = of.quantity.split(' ').next()?;
    // Motion is lost where the step from negative to positive motion is negative.
    let lost = of.value < 0.0;
    let remedy = remedies::of(kind, lost)?;
    let side = match (kind, lost) {
        ("reversal", true) => ", lost motion",
        ("reversal", false) => ", over-compensated",
        _ => "",
    };
    let size_um = size_um(of, radius_mm)?;
    let value = typeset(&signed(of.value, decimals(of.value, 3).min(3)));
    let on_the_circle = if of.unit == "um" {
        String::new()
    } else {
        format!(", {} µm at {} mm", fixed(size_um, 1), fixed(radius_mm, 0))
    };
    let sentence = format!(
        "{} ({}{on_the_circle}{side}): {remedy}.",
        capital(&of.quantity),
        fine(&format!("{value} {}", of.unit))
    );
    Some(Lever { size_um, sentence })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::report::fixture;

    #[test]
    fn a_cause_and_the_largest_quantity_are_told_the_larger_first() {
        let told = of(&fixture::diagnosed().analysis);
        assert_eq!(told.len(), 2, "{told:?}");
        let findings = &fixture::diagnosed().analysis.diagnosis.as_ref().unwrap().findings;
        let largest = findings.iter().find(|of| of.named).unwrap();
        let with_remedy =
            |of: &&String| of.starts_with(&largest.title) && of.contains(largest.remedy);
        assert_eq!(told.iter().filter(with_remedy).count(), 1, "{told:?}");
        let asked = ["squareness", "reversal", "scale", "lateral", "straightness", "positioning"];
        let to_do = |of: &str| {
            asked
                .iter()
                .any(|word| remedies::of(word, true).is_some_and(|to_do| of.contains(to_do)))
        };
        assert!(told.iter().any(|of| to_do(of)), "{told:?}");
    }

    #[test]
    fn nothing_is_repaired_by_what_explains_nothing() {
        let mut analysis = fixture::diagnosed().analysis.clone();
        analysis.repeats[0].little_explained = vec!["run2".to_owned()];
        let told = of(&analysis);
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].starts_with("Repair nothing by these numbers"), "{told:?}");
        assert!(told[0].contains("of run2 the model explains little"), "{told:?}");
    }

    #[test]
    fn what_is_small_or_not_known_is_not_repaired() {
        let mut analysis = fixture::identified("planar").analysis.clone();
        let keep = |value: f64, sigma: f64, analysis: &mut crate::report::Analysis| {
            analysis.at_the_place.retain(|of| of.quantity == "reversal X");
            let of = &mut analysis.at_the_place[0];
            (of.value, of.noise, of.all) = (value, Some(sigma), None);
        };
        for (value, sigma, told) in [
            (0.9, 0.1, "Nothing to repair"),
            (9.0, 5.0, "Nothing to repair"),
            (-9.0, 0.1, "Reversal X (−9.00 µm, lost motion)"),
            (9.0, 0.1, "Reversal X (+9.00 µm, over-compensated)"),
        ] {
            keep(value, sigma, &mut analysis);
            analysis.ranking.tests.clear();
            let sentences = of(&analysis);
            assert!(sentences[0].starts_with(told), "{sentences:?}");
            assert_eq!(sentences.len(), 1);
        }
    }
}
