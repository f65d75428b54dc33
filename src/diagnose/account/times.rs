//! Runs whose time the test file states wrong: the feed override, or the clock.
//!
//! From engagement to release a log takes longer than the program by a factor. What the clock's tolerance
//! does not cover the alignment has taken for the feed; one factor cannot say which of the two it was.

use crate::identify::Campaign;
use crate::plan::Test;

/// A knob stands at whole percents: so near to one, the feed is the likelier reason, percent.
const WHOLE_PERCENT: f64 = 0.05;

/// One run whose time differs from what the test file says.
#[derive(Debug, Clone, PartialEq)]
pub struct OffTime {
    /// Name of the run.
    pub run: String,
    /// Feed override that the test file states, percent.
    pub stated_percent: f64,
    /// And that explains the log, percent.
    pub percent: f64,
    /// Its standard deviation, from the clock's tolerance, percent.
    pub sigma_percent: f64,
    /// By how much the clock would be off instead, parts per million.
    pub clock_ppm: f64,
    /// What the test file says that a clock may be off, parts per million.
    pub tolerance_ppm: f64,
}

impl OffTime {
    /// Whether the override stood at a whole percent, as a knob does.
    pub fn is_feed(&self) -> bool {
        (self.percent - self.percent.round()).abs() < WHOLE_PERCENT + self.sigma_percent
            && (self.percent - self.stated_percent).abs() > 0.5
    }
}

/// The runs of a campaign whose time is not as stated.
pub(crate) fn off(test: &Test, campaign: &Campaign) -> Vec<OffTime> {
    let stated = |name: &str| {
        let mut runs = test.runs().into_iter().flatten();
        runs.find(|run| run.name == name).map_or(1.0, |run| run.feed_override)
    };
    let runs = campaign.repeats.iter().flat_map(|repeat| &repeat.runs);
    let off = runs.filter(|run| run.alignment.time_map.override_sigma > 0.0);
    off.map(|run| {
        let map = &run.alignment.time_map;
        let stated_percent = 100.0 * stated(&run.name);
        let total = run.alignment.trajectory.duration();
        let share = total.feed_s / total.known_s().max(1e-9);
        OffTime {
            run: run.name.clone(),
            stated_percent,
            percent: stated_percent * (1.0 + map.override_excess),
            sigma_percent: stated_percent * map.override_sigma,
            clock_ppm: 1e6 * (map.rate + map.override_excess * share),
            tolerance_ppm: 1e6 * test.bar_of(run.mounting).clock_tolerance,
        }
    })
    .collect()
}
