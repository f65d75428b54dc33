//! When a diagnosis is right.

use ballbar::diagnose::{Diagnosis, Finding};

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
