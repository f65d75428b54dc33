//! Runs whose time the test file states wrong: the feed override, or the clock.
//!
//! From engagement to release a log takes longer than the program by a factor. What the clock's tolerance
//! does not cover the alignment has taken for the feed; one factor cannot say which of the two it was.

use serde::Serialize;

use crate::identify::{Campaign, IdentifiedRun};
use crate::plan::Test;

/// A knob stands at whole percents: so near to one, the feed is the likelier reason, percent.
const WHOLE_PERCENT: f64 = 0.05;
/// A clock that is off by more than so many times what the test file allows is none: a quartz is within 100 parts per million, and a
/// computer that stamps the samples within 1000.
const NO_CLOCK: f64 = 10.0;
/// A factor within so many standard deviations of 1 is none: 1 in 370 by chance.
const SIGMAS: f64 = 3.0;

/// One run whose time differs from what the test file says.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// Which of the two it is, as far as one factor can say.
    pub cause: OffCause,
}

/// What is likelier to be stated wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OffCause {
    /// The override: it stood at a whole percent, as a knob does, or no clock is so far off.
    FeedOverride,
    /// The clock.
    Clock,
}

impl OffCause {
    /// Of a feed in percent; the clock would be off by so many times what the test file allows.
    fn of(stated: f64, percent: f64, sigma: f64, clock_off: f64) -> Self {
        let whole = (percent - percent.round()).abs() < WHOLE_PERCENT + sigma;
        if whole && (percent - stated).abs() > 0.5 || clock_off.abs() > NO_CLOCK {
            Self::FeedOverride
        } else {
            Self::Clock
        }
    }
}

/// The runs of a campaign whose time is not as stated.
pub(crate) fn off(test: &Test, campaign: &Campaign) -> Vec<OffTime> {
    let stated = |name: &str| {
        let mut runs = test.runs().into_iter().flatten();
        runs.find(|run| run.name == name).map_or(1.0, |run| run.feed_override)
    };
    let runs = campaign.repeats.iter().flat_map(|repeat| &repeat.runs);
    let excess = |run: &'_ IdentifiedRun| run.alignment.time_map.feed_excess();
    let off = runs.filter_map(|run| Some((run, excess(run)?)));
    let off = off.filter(|(_, [excess, sigma])| excess.abs() > SIGMAS * sigma);
    off.map(|(run, [excess, sigma])| {
        let map = &run.alignment.time_map;
        let stated_percent = 100.0 * stated(&run.name);
        let total = run.alignment.trajectory.duration();
        let share = total.feed_s / total.known_s().max(1e-9);
        let percent = stated_percent * (1.0 + excess);
        let sigma_percent = stated_percent * sigma;
        let clock = map.rate + excess * share;
        let clock_off = clock / test.ball_bar().clock_tolerance;
        OffTime {
            run: run.name.clone(),
            stated_percent,
            percent,
            sigma_percent,
            clock_ppm: 1e6 * clock,
            cause: OffCause::of(stated_percent, percent, sigma_percent, clock_off),
        }
    })
    .collect()
}
