//! How circular tests are called, and which are shown.

use super::facts::CircularResult;
use crate::report::text::numbers::fixed;

/// Such as `XY plane F1000`; of a part of a circle with its angle.
pub(in crate::report) fn test_name(test: &CircularResult) -> String {
    let arc = if test.whole { String::new() } else { format!(" {} deg", fixed(test.sweep_deg, 0)) };
    format!("{}{arc} F{}", test.circle, fixed(test.feed_mm_min, 0))
}

/// The largest deviation of a test, um.
pub(super) fn size_um(test: &CircularResult) -> f64 {
    let ways = test.ways.iter().map(|way| way.circular_deviation.value_um);
    let both = test.bidirectional_circular_deviation.map(|both| both.value_um);
    both.into_iter().chain(ways).fold(0.0, f64::max)
}

/// Of the repeats of each test that with the largest deviation, in the order in which they were driven.
pub(super) fn worst_repeats(tests: &[CircularResult]) -> Vec<&CircularResult> {
    let key = |test: &CircularResult| (test_name(test), test.ways.len());
    let mut worst: Vec<&CircularResult> = Vec::new();
    for test in tests {
        match worst.iter_mut().find(|other| key(other) == key(test)) {
            Some(other) if size_um(test) > size_um(other) => *other = test,
            Some(_) => {}
            None => worst.push(test),
        }
    }
    worst
}
