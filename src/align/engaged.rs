//! The readings that were taken while the bar was engaged, shared with their log.

use std::ops::Range;
use std::sync::Arc;

use crate::log::{Log, Reading};

/// A step of the readings, which stay where it took them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip {
    /// On the log's clock, s: half way between the readings before and after.
    pub log_s: f64,
    /// Line of the first reading after it.
    pub line: usize,
    /// What was read more from there on, mm.
    pub step_mm: f64,
    /// Standard deviation of that, by the lines on either side, mm.
    pub sigma_mm: f64,
}

/// Readings in engagements. Millions of them are in memory once, however many copies an alignment has.
#[derive(Debug, Clone)]
pub(super) struct Engaged {
    log: Arc<Vec<Reading>>,
    stretches: Vec<Range<usize>>,
}

impl Engaged {
    pub(super) fn new(log: &Log, stretches: Vec<Range<usize>>) -> Self {
        Self { log: log.shared(), stretches }
    }

    /// The same of another log of these readings.
    pub(super) fn of(self, log: &Log) -> Self {
        Self { log: log.shared(), ..self }
    }

    /// Those that are in range, with the steps of these slips taken out of the ones after them.
    pub(super) fn readings<'a>(&'a self, slips: &'a [Slip]) -> impl Iterator<Item = Reading> + 'a {
        let all = self.stretches.iter().flat_map(|stretch| &self.log[stretch.clone()]);
        all.filter(|reading| reading.deviation_mm.is_some()).map(|reading| {
            let before = slips.iter().filter(|slip| reading.time_s > slip.log_s);
            let step_out = |mm, slip: &Slip| mm - slip.step_mm;
            let deviation_mm = reading.deviation_mm.map(|mm| before.fold(mm, step_out));
            Reading { deviation_mm, ..*reading }
        })
    }
}
