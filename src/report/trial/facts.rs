//! A trial as JSON.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::trial::Outcome;

/// What a trial hid, found and took.
pub fn trial_json(outcome: &Outcome) -> Value {
    let found = outcome.judgement.found.iter();
    json!({
        "class": outcome.class.name(),
        "index": outcome.index,
        "size_um": 1e3 * outcome.size_mm,
        "hidden": outcome.hidden.iter().map(|(effect, share)| json!({
            "effect": effect.to_string(),
            "cause": effect.cause.id,
            "share_outside_of_model": share,
        })).collect::<Vec<_>>(),
        "found": found.map(|found| json!({
            "cause": found.cause,
            "text": found.text,
            "right": found.right,
            "correlation": found.correlation,
        })).collect::<Vec<_>>(),
        "verdict": outcome.judgement.verdict.name(),
        "wrong_named": outcome.judgement.wrong_named,
        "failure": outcome.failure,
        "strata": outcome.strata.iter().cloned().collect::<BTreeMap<_, _>>(),
        "numbers": outcome.off_by.iter().map(|off| json!({
            "quantity": off.name,
            "off_in_noise": off.noises,
            "off_in_all": off.alls,
        })).collect::<Vec<_>>(),
        "simulate_s": outcome.seconds.simulate_s,
        "identify_s": outcome.seconds.identify_s,
        "diagnose_s": outcome.seconds.diagnose_s,
    })
}
