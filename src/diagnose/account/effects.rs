//! What each finding does to each reading.

use crate::residual::{Fitted, Residuals};

/// What the findings do to a reading that the fit used.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectsAt {
    /// Index of its run in the repeat.
    pub run: usize,
    /// When it was taken, on the clock of its log, s.
    pub log_s: f64,
    /// What each finding adds to it, mm, in their order.
    pub findings_mm: Vec<f64>,
}

/// The readings of each repeat, in the order of runs and time.
pub(crate) fn at_readings(residuals: &Residuals, fitted: &Fitted) -> Vec<Vec<EffectsAt>> {
    let parts: Vec<_> = (0..fitted.elements.len()).map(|k| fitted.part(k).sum(residuals)).collect();
    let repeats = residuals.repeats.iter().enumerate();
    repeats
        .map(|(index, repeat)| {
            let samples = repeat.samples.iter().enumerate().filter(|(_, s)| s.root_weight > 0.0);
            let of = |(k, sample): (usize, &crate::residual::Sample)| EffectsAt {
                run: sample.run,
                log_s: sample.log_s,
                findings_mm: parts
                    .iter()
                    .map(|part| part[index].get(k).map_or(0.0, |mm| mm / sample.root_weight))
                    .collect(),
            };
            samples.map(of).collect()
        })
        .collect()
}
