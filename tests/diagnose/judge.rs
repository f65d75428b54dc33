//! When a diagnosis is right.

use ballbar::diagnose::{Diagnosis, Finding, diagnose};
use ballbar::identify::{Campaign, Failure};
use ballbar::machine::Machine;
use ballbar::plan::Test;
use ballbar::report::{Analysis, diagnosis_text, summary};
use serde_json::Value;

/// What the best model leaves of the measured logs, mm rms: their noise.
pub(crate) const NOISE_MM: f64 = 0.153e-3;

/// The number that a finding states, within 5 % or three sigma of the truth.
#[track_caller]
pub(crate) fn near(finding: &Finding, name: &str, truth: f64) {
    let number = finding.numbers.iter().find(|n| n.name == name).unwrap();
    let allowed = (0.05 * truth.abs()).max(3.0 * number.sigma.unwrap_or(0.0));
    assert!((number.value - truth).abs() < allowed, "{name}, not {truth}: {number:?}");
}

/// Nothing but noise is left of the logs once the findings are taken into account.
#[track_caller]
pub(crate) fn explained(diagnosis: &Diagnosis) {
    let verdict = &diagnosis.verdict;
    assert!(verdict.after_mm < 1.02 * NOISE_MM, "{verdict:?}");
    assert!(verdict.explained.unwrap() > 0.97, "{verdict:?}");
}

/// The diagnosis of a test, of which no number contradicts another.
pub(crate) fn diagnosed(test: &Test) -> (Machine, Campaign, Diagnosis) {
    let machine = test.machine().unwrap();
    let campaign = Campaign::of(test, &machine, Failure::Refuse, &|| ()).unwrap();
    let diagnosis = diagnose(test, &machine, &campaign).unwrap();
    consistent(&Analysis::diagnosed(test, &machine, &campaign, &diagnosis));
    (machine, campaign, diagnosis)
}

/// Two numbers that are told as one; `share` is what samples at the ends of arcs may make.
#[track_caller]
fn alike(one: f64, other: f64, share: f64) {
    assert!((one - other).abs() <= share * one.abs().max(other.abs()), "{one}, {other}");
}

/// Numbers of an analysis with its diagnosis agree with each other, in tables, sentences and keys.
#[track_caller]
pub(crate) fn consistent(analysis: &Analysis) {
    let facts = analysis.diagnosis.as_ref().unwrap();
    let json: Value = serde_json::from_str(&analysis.to_json().unwrap()).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let diagnosis = &json["diagnosis"];
    let list = |of: &Value| of.as_array().unwrap().clone();
    let found = !list(&diagnosis["findings"]).is_empty();
    let corrected = !list(&diagnosis["wrong_settings"]).is_empty();

    // The extended model is never worse, on its own runs and on runs that took no part.
    let (before, after) = (number(&diagnosis["before_um"]), number(&diagnosis["after_um"]));
    assert!(after <= before, "{before} to {after}");
    let squares = |key: &str| -> f64 {
        let of = |run: &Value| number(&run[key]).powi(2) * number(&run["samples"]);
        list(&diagnosis["runs"]).iter().map(of).sum()
    };
    assert!(squares("after_um") <= squares("before_um"), "{diagnosis}");
    let samples: f64 = list(&diagnosis["runs"]).iter().map(|run| number(&run["samples"])).sum();
    alike((squares("before_um") / samples).sqrt(), before, 1e-3);
    for run in list(&diagnosis["runs"]) {
        let floor = run["floor_um"].as_f64().unwrap_or(0.0);
        assert!(floor <= 1.0001 * number(&run["before_um"]), "{run}");
        assert!(run["explained"].as_f64().is_none_or(|e| (0.0..=1.0).contains(&e)), "{run}");
    }

    // Shares are shares, and told of what is known only.
    let explained = diagnosis["explained"].as_f64();
    let ends = diagnosis["explained_interval"].as_array().cloned().unwrap_or_default();
    let ends = ends.iter().map(number);
    assert!(ends.chain(explained).all(|share| (0.0..=1.0).contains(&share)), "{explained:?}");
    let texts = [diagnosis_text(facts), summary(analysis)];
    let repeats = list(&json["repeats"]).len();
    for text in texts.iter().map(|text| text.split_whitespace().collect::<Vec<_>>().join(" ")) {
        if diagnosis["structure_before"].is_null() {
            assert!(!text.contains("% of the repeatable part"), "{text}");
            assert!(!found || !text.contains("not repeatable"), "{text}");
        }
        assert!(repeats > 1 || !text.contains("on runs that were not fitted"), "{text}");
        assert_eq!(text.contains("Found: "), found, "{text}");
        let words: Vec<&str> = text.split(' ').collect();
        for percent in words.windows(4).filter(|of| of[3].trim_end_matches(['.', ')']) == "%") {
            let share = percent[2].trim_start_matches('(').parse::<f64>();
            // By how much a feed differs from the stated one is no share.
            let low = if percent[..2] == ["differed", "by"] { -100.0 } else { 0.0 };
            assert!(share.is_ok_and(|of| (low..=100.0).contains(&of)), "{percent:?}: {text}");
        }
    }

    // After a finding, tables and sentences have the extended model, and the earlier numbers beside it.
    assert_eq!(json.get("before").is_some(), found || corrected);
    if !found {
        return;
    }
    let rms = |repeats: &Value| {
        let used = |repeat: &Value| number(&repeat["samples"]["used"]);
        let square = |r: &Value| number(&r["residual_rms_um"]).powi(2) * used(r);
        let all = list(repeats);
        (all.iter().map(square).sum::<f64>() / all.iter().map(used).sum::<f64>()).sqrt()
    };
    alike(rms(&json["repeats"]), after, 0.02);
    let fit = rms(&json["before"]["repeats"]);
    if !corrected && fit < 0.98 * before {
        assert!(texts[0].replace('\n', " ").contains(&format!("leaves {fit:.3} um rms")), "{fit}");
    }
    for moved in list(&diagnosis["moved"]) {
        let of =
            |all: &Value| list(all).into_iter().find(|mean| mean["name"] == moved["name"]).unwrap();
        let now = of(&json["over_repeats"]);
        alike(number(&moved["after"]), number(&now["mean"]), 1e-9);
        alike(number(&moved["sigma_after"]), number(&now["sigma"]), 1e-9);
        if !corrected {
            let was = of(&json["before"]["over_repeats"]);
            alike(number(&moved["before"]), number(&was["mean"]), 1e-9);
        }
    }
    for asked in list(&json["at_the_place"]) {
        if let Some(all) = asked["all"].as_f64() {
            assert!(number(&asked["noise"]) <= all * 1.000_001, "{asked}");
        }
    }
}
