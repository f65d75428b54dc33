//! The feed of a run: by how much it differs from the stated one, and what is told of it beside the readings.

use super::time_map::{NO_PACE, TimeMap};

impl TimeMap {
    /// By how much the real feed differs from the programmed one times the stated override, as a share of 1, and the
    /// standard deviation; `None` where the log's durations are the program's.
    pub fn feed_excess(&self) -> Option<[f64; 2]> {
        let excess = (1.0 + self.override_excess) * (1.0 + self.pace) - 1.0;
        let estimated = self.override_sigma > 0.0;
        estimated.then(|| [excess, self.override_sigma.hypot(self.pace_sigma)])
    }

    /// Takes the feed for known from the marks.
    pub(crate) fn hold_pace(&mut self) {
        self.pace_plausible = NO_PACE;
    }
}
