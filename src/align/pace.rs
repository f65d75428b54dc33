//! The feed of a run: by how much it differs from the stated one, and what is told of it beside the readings.

use super::time_map::{NO_PACE, TimeMap};

impl TimeMap {
    /// By how much the real feed differs from the programmed one times the stated override, as a share of 1, and the
    /// standard deviation; `None` where the log's durations are the program's.
    pub fn feed_excess(&self) -> Option<[f64; 2]> {
        let excess = (1.0 + self.override_excess) * (1.0 + self.pace) - 1.0;
        let estimated = self.override_sigma > 0.0;
        // What is held is known no better than it was told.
        let pace_sigma = self.pace_held.map_or(self.pace_sigma, |_| self.pace_plausible);
        estimated.then(|| [excess, self.override_sigma.hypot(pace_sigma)])
    }

    /// By how many of its plausible deviations the pace is off; 0 of one that is known.
    pub(crate) fn pace_off(&self) -> f64 {
        if self.pace_plausible > NO_PACE { self.pace / self.pace_plausible } else { 0.0 }
    }

    /// Holds the pace so many of its plausible deviations off, unless it is known.
    pub(crate) fn hold_pace(&mut self, off: f64) {
        self.pace_held = (self.pace_plausible > NO_PACE).then_some(off * self.pace_plausible);
    }

    /// What is told of the pace beside the readings, and the standard deviation of that.
    pub(crate) fn pace_told(&self) -> [f64; 2] {
        self.pace_held.map_or([0.0, self.pace_plausible], |held| [held, NO_PACE])
    }
}
