//! A comparison as JSON; the schema is documented field by field in `docs/monitor-schema.md`.

use serde_json::{Value, json};

use super::words;
use crate::monitor::{Change, Comparison, FindingChange, Found, Past};

/// The two analyses and what changed between them, without the name of the format.
pub fn comparison_json(
    comparison: &Comparison,
    [before, after]: [&Past; 2],
    name: &dyn Fn(&Past) -> String,
) -> Value {
    json!({
        "before": told(before, &name(before)),
        "after": told(after, &name(after)),
        "equal": comparison.equal,
        "differences": comparison.differences,
        "beyond": comparison.beyond,
        "share": comparison.share,
        "verdict": words::verdict(comparison),
        "quantities": comparison.changes.iter().map(quantity).collect::<Vec<_>>(),
        "findings": comparison.findings.iter().map(finding).collect::<Vec<_>>(),
        "not_compared": comparison.untold,
    })
}

/// Who was tested, when and with what.
pub(in crate::report) fn told(past: &Past, file: &str) -> Value {
    json!({
        "file": file,
        "test": past.test,
        "date": past.day.map(|day| day.to_string()),
        "machine": past.machine,
        "machine_serial": past.machine_serial,
        "bar_serial": past.bar_serial,
        "strategy": past.strategy,
        "repeats": past.repeats,
        "program_version": past.program_version,
    })
}

fn quantity(change: &Change) -> Value {
    json!({
        "quantity": change.name,
        "unit": change.unit,
        "before": change.before.0,
        "before_sigma": change.before.1,
        "after": change.after.0,
        "after_sigma": change.after.1,
        "difference": change.difference(),
        "noise": change.noise,
        "sigma": change.sigma,
        "verdict": words::judged(change.judged),
        "looks_like": change.looks_like,
    })
}

fn finding(change: &FindingChange) -> Value {
    let numbers: Vec<Value> = change
        .numbers
        .iter()
        .map(|(name, before, after, sigma, changed)| {
            json!({ "name": name, "before": before, "after": after, "sigma": sigma, "changed": changed })
        })
        .collect();
    json!({
        "title": change.title,
        "found": match change.found {
            Found::Both => "in both",
            Found::New => "only after",
            Found::Gone => "only before",
            Found::Below(_) => "in one, too small for the other",
            Found::NotLooked => "in one, not looked for in the other",
        },
        "before_um": change.rms_um[0],
        "after_um": change.rms_um[1],
        "numbers": numbers,
    })
}
