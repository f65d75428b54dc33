//! The decision rule of ISO 14253-1: a limit is kept, or passed, only where the value says so with all of its uncertainty.

use super::facts::{CircularResult, CircularValue, ConformityItem, ConformityResult, Verdict};
use super::words::test_name;
use crate::plan::Tolerance;
use crate::report::analysis::place::PlaceResult;

/// The rule, in words.
const RULE: &str = "ISO 14253-1 with the expanded uncertainty U = 2 sigma (k = 2): pass where value + U keeps the limit, fail where value - U is beyond it";
/// Coverage factor: 95 % of a normal distribution.
const COVERAGE: f64 = 2.0;

/// What a tolerance says of a magnitude and its standard uncertainty.
fn verdict(value: f64, sigma: f64, limit: f64) -> Verdict {
    let expanded = COVERAGE * sigma;
    if value + expanded <= limit {
        Verdict::Pass
    } else if value - expanded > limit {
        Verdict::Fail
    } else {
        Verdict::WithinUncertainty
    }
}

/// What is judged, before it is.
struct Judged {
    quantity: String,
    value: f64,
    sigma: Option<f64>,
    why: &'static str,
}

fn item(of: Judged, limit: f64, unit: &'static str) -> ConformityItem {
    let known = of.sigma.map(|sigma| verdict(of.value, sigma, limit));
    ConformityItem {
        quantity: of.quantity,
        value: Some(of.value),
        expanded: of.sigma.map(|sigma| COVERAGE * sigma),
        limit,
        unit,
        verdict: known.unwrap_or(Verdict::NotDecided),
        why: if known.is_some() { String::new() } else { of.why.to_owned() },
    }
}

/// What to state where it is not known how long the bar is: a scale of all axes and a longer bar look the same.
const NO_LENGTH: &str = "`length_sigma_um` is not stated: how well the length of the bar is known";

/// Judges all that has a tolerance; `None` where nothing has. A scale is judged where it is stated how well the length of the bar is known.
pub(super) fn of(
    tolerance: &Tolerance,
    tests: &[CircularResult],
    at_the_place: &[PlaceResult],
    knows_length: bool,
) -> Option<ConformityResult> {
    let mut items = Vec::new();
    let circular = [
        (tolerance.circular_mm, "G", ways as fn(&CircularResult) -> Vec<Judged>),
        (tolerance.bidirectional_mm, "G(b)", both),
        (tolerance.radial_mm, "F", radial),
    ];
    for (limit_mm, name, judged) in circular {
        let Some(limit_mm) = limit_mm else { continue };
        let of_all: Vec<Judged> = tests.iter().flat_map(judged).collect();
        items.extend(or_unmeasured(of_all, name, limit_mm * 1e3, "um"));
    }
    let place = [
        (tolerance.squareness_rad.map(|limit| limit * 1e6), "squareness", "um/m"),
        (tolerance.reversal_mm.map(|limit| limit * 1e3), "reversal", "um"),
        (tolerance.scale.map(|limit| limit * 1e6), "scale", "um/m"),
    ];
    for (limit, name, unit) in place {
        let Some(limit) = limit else { continue };
        // A reversal of an axis, not that of an angle.
        let of_it = |p: &&PlaceResult| p.quantity.starts_with(name) && p.unit == unit;
        // Sizes hold at 20 C: where that is known, it is what is judged.
        let colder = |p: &PlaceResult| format!("{} at 20 C", p.quantity);
        let known_at_20_c =
            |p: &PlaceResult| at_the_place.iter().any(|other| other.quantity == colder(p));
        let of_all =
            at_the_place.iter().filter(of_it).filter(|p| !known_at_20_c(p)).map(|place| Judged {
                quantity: place.quantity.clone(),
                value: place.value.abs(),
                sigma: place.all.filter(|_| knows_length || !place.is_scale()),
                why: match place.all {
                    Some(_) => NO_LENGTH,
                    None => {
                        "the terms that were asked for do not say what else would look the same"
                    }
                },
            });
        items.extend(or_unmeasured(of_all.collect(), name, limit, unit));
    }
    let items = worst(items);
    let verdict = items.iter().map(|item: &ConformityItem| item.verdict).max()?;
    Some(ConformityResult { rule: RULE, verdict, items })
}

/// Of what has one name, such as the repeats of a test, what is judged worst.
fn worst(all: Vec<ConformityItem>) -> Vec<ConformityItem> {
    let mut worst: Vec<ConformityItem> = Vec::new();
    for item in all {
        let value = |of: &ConformityItem| of.value.unwrap_or(0.0);
        match worst.iter_mut().find(|other| other.quantity == item.quantity) {
            Some(other) if (item.verdict, value(&item)) > (other.verdict, value(other)) => {
                *other = item;
            }
            Some(_) => {}
            None => worst.push(item),
        }
    }
    worst
}

fn or_unmeasured(
    all: Vec<Judged>,
    name: &str,
    limit: f64,
    unit: &'static str,
) -> Vec<ConformityItem> {
    if all.is_empty() {
        return vec![ConformityItem {
            quantity: name.to_owned(),
            value: None,
            expanded: None,
            limit,
            unit,
            verdict: Verdict::NotDecided,
            why: "no run tells it".to_owned(),
        }];
    }
    all.into_iter().map(|judged| item(judged, limit, unit)).collect()
}

fn judged(quantity: String, of: &CircularValue) -> Judged {
    Judged { quantity, value: of.value_um.abs(), sigma: of.sigma_um, why: NO_LENGTH }
}

fn ways(test: &CircularResult) -> Vec<Judged> {
    let name = test_name(test);
    let way = |way: &super::facts::WayResult| {
        judged(format!("G {name} {}", way.direction), &way.circular_deviation)
    };
    test.ways.iter().map(way).collect()
}

fn both(test: &CircularResult) -> Vec<Judged> {
    let both = test.bidirectional_circular_deviation.iter();
    both.map(|of| judged(format!("G(b) {}", test_name(test)), of)).collect()
}

fn radial(test: &CircularResult) -> Vec<Judged> {
    let name = test_name(test);
    let ways = test.ways.iter().flat_map(|way| {
        let ends = [("F max", &way.radial_deviation_max), ("F min", &way.radial_deviation_min)];
        ends.into_iter().filter_map(|(end, value)| {
            Some(judged(format!("{end} {name} {}", way.direction), value.as_ref()?))
        })
    });
    ways.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_within_the_uncertainty_is_neither_kept_nor_passed() {
        for (value, is) in [
            (9.79, Verdict::Pass),
            (9.81, Verdict::WithinUncertainty),
            (10.0, Verdict::WithinUncertainty),
            (10.19, Verdict::WithinUncertainty),
            (10.21, Verdict::Fail),
        ] {
            assert_eq!(verdict(value, 0.1, 10.0), is, "{value}");
        }
    }

    #[test]
    fn of_repeats_the_worst_is_judged() {
        let item = |value: f64, verdict: Verdict| ConformityItem {
            quantity: "G".to_owned(),
            value: Some(value),
            expanded: Some(0.2),
            limit: 10.0,
            unit: "um",
            verdict,
            why: String::new(),
        };
        let all = [(9.0, Verdict::Pass), (10.1, Verdict::WithinUncertainty), (9.9, Verdict::Pass)];
        let judged = worst(all.map(|(value, verdict)| item(value, verdict)).into());
        assert_eq!(judged, [item(10.1, Verdict::WithinUncertainty)]);
    }

    #[test]
    fn what_has_no_uncertainty_is_not_decided_and_a_fault_outweighs_it() {
        let place = |quantity: &str, value: f64, all: Option<f64>| PlaceResult {
            quantity: quantity.to_owned(),
            unit: "um/m",
            value,
            noise: Some(0.1),
            all,
            plausible: None,
            deviation: None,
            over_noise: None,
            looks_like: Vec::new(),
        };
        let tolerance =
            Tolerance { squareness_rad: Some(10e-6), scale: Some(5e-6), ..Tolerance::default() };
        let known = place("squareness XY", -25.0, Some(5.0));
        let unknown = place("squareness YZ", 1.0, None);
        let [warm, cold] =
            [("scale X", 40.0), ("scale X at 20 C", 1.0)].map(|(of, v)| place(of, v, Some(1.0)));
        let scales = of(&tolerance, &[], &[warm, cold.clone()], true).unwrap();
        let told: Vec<&str> = scales.items.iter().map(|item| item.quantity.as_str()).collect();
        assert_eq!(told, ["squareness", "scale X at 20 C"]);
        assert_eq!(scales.items[1].verdict, Verdict::Pass);
        // A bar of another length would look the same.
        let of_any_bar = of(&tolerance, &[], &[cold], false).unwrap();
        assert_eq!(of_any_bar.items[1].verdict, Verdict::NotDecided);
        assert!(of_any_bar.items[1].why.contains("length_sigma_um"), "{of_any_bar:?}");
        let judged = of(&tolerance, &[], &[known, unknown.clone()], false).unwrap();
        let verdicts: Vec<Verdict> = judged.items.iter().map(|item| item.verdict).collect();
        assert_eq!(verdicts, [Verdict::Fail, Verdict::NotDecided, Verdict::NotDecided]);
        assert_eq!(judged.verdict, Verdict::Fail);
        assert_eq!(judged.items[2].value, None);
        assert_eq!(of(&Tolerance::default(), &[], &[unknown], true), None);
    }
}
