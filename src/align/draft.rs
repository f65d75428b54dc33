//! A log laid over a program at one feed: what belongs to what, before the samples have their places.

use std::ops::Range;
use std::sync::Arc;

use super::breaks::Break;
use super::engaged::Engaged;
use super::engagement::{self, Engagement, Paired};
use super::ramp::{self, Mark, MarkKind};
use super::run::Run;
use super::samples::Alignment;
use super::time_map::TimeMap;
use super::{section, stops, window};
use crate::error::Result;
use crate::log::{Log, Reading};
use crate::motion::{Reversals, Trajectory};

/// Standard deviation of an offset that was found from standstill alone, s.
const STANDSTILL_SIGMA_S: f64 = 1.0;

/// A log laid over a program at one feed.
pub(super) struct Draft {
    pub(super) trajectory: Trajectory,
    /// The engagements that the program makes.
    engagements: Vec<Engagement>,
    /// For each engagement the readings of the log.
    stretches: Vec<Range<usize>>,
    /// Stretches of the log that are as long and belong to none.
    beside: Vec<Range<usize>>,
    pub(super) marks: Vec<Mark>,
    pub(super) time_map: TimeMap,
}

impl Draft {
    /// The time map from engagements and releases; `feed` is the real feed as a share of the programmed one.
    ///
    /// # Errors
    /// When the stretches in which the log `observed` something are not the engagements of the program, or their
    /// durations differ by more than a `tolerance`, a share.
    pub(super) fn new(
        run: &Run,
        observed: &[Range<usize>],
        feed: f64,
        tolerance: f64,
    ) -> Result<Self> {
        let trajectory = run.trajectory(feed);
        let engagements = engagement::expected(&trajectory, &run.rig);
        if engagements.is_empty() {
            return Err(engagement::never(run, &trajectory));
        }
        let Paired { stretches, beside } = engagement::pair(
            run.log,
            &engagements,
            observed,
            &trajectory,
            run.feed_override,
            tolerance,
        )?;
        let first_s = engagements.first().map_or(0.0, |e| e.start_s);
        let last_s = engagements.last().map_or(0.0, |e| e.end_s);
        let pivot_s = middle_s(run.log, &stretches);
        let mut time_map = TimeMap::new(&trajectory, first_s..last_s, pivot_s);
        let mut marks = Vec::new();
        for (stretch, engagement) in stretches.iter().zip(&engagements) {
            for kind in [MarkKind::Engagement, MarkKind::Release] {
                marks.push(ramp::mark(run, &trajectory, engagement, stretch, kind));
            }
        }
        time_map.fit_marks(&marks, run.rig.bar.clock_tolerance, false)?;
        Ok(Self { trajectory, engagements, stretches, beside, marks, time_map })
    }

    /// A log by angle, whose times are those of the program.
    pub(super) fn of_angles(
        trajectory: Trajectory,
        engagements: Vec<Engagement>,
        stretches: Vec<Range<usize>>,
        marks: Vec<Mark>,
        time_map: TimeMap,
    ) -> Self {
        Self { trajectory, engagements, stretches, beside: Vec::new(), marks, time_map }
    }

    /// Finds the operator's pauses inside the engagements by the readings that stand still.
    pub(super) fn find_pauses(&mut self, log: &Log) {
        for (stretch, engagement) in self.stretches.iter().zip(&self.engagements) {
            self.marks.extend(find_pauses(&mut self.time_map, log, stretch, engagement));
        }
    }

    /// Gives the readings of the engagements their places in the program.
    pub(super) fn laid(self, run: &Run) -> Alignment {
        let engaged = Engaged::new(run.log, self.stretches);
        let readings: Vec<Reading> = engaged.readings(&[]).collect();
        let period_s = run.log.sample_period_s();
        let averaged = window::readings(period_s);
        let first_s = run.log.readings().first().map_or(0.0, |reading| reading.time_s);
        let (began_log_s, began_sigma_s) = self.time_map.began(first_s);
        let sections = section::sections(&self.trajectory, &run.rig);
        let time_s = |index: usize| run.log.readings()[index].time_s;
        let other_runs_s = self.beside.iter().map(|of| [time_s(of.start), time_s(of.end - 1)]);
        Alignment {
            chord_sag_mm: section::chord_sag_mm(&self.trajectory, &sections, run.rig.bar.length_mm),
            means: Vec::new(),
            radius_mm: run.rig.bar.length_mm,
            moving: section::moving(&self.trajectory, &sections),
            began_log_s,
            began_sigma_s,
            other_runs_s: other_runs_s.collect(),
            log_notes: run.log.notes().to_vec(),
            clipped: Vec::new(),
            slips: Vec::new(),
            reversals: Reversals::of(&self.trajectory),
            sections,
            windows: Arc::new(window::means(&readings, averaged, period_s)),
            averaged,
            engaged,
            trajectory: self.trajectory,
            time_map: self.time_map,
            marks: self.marks,
            engagements: self.engagements,
            sample_period_s: averaged as f64 * period_s,
            coincidence_mm: run.rig.mounting.coincidence_mm,
        }
    }
}

/// The middle of what was measured, on the log's clock, s.
fn middle_s(log: &Log, stretches: &[Range<usize>]) -> f64 {
    let time = |index: usize| log.readings()[index].time_s;
    match (stretches.first(), stretches.last()) {
        (Some(first), Some(last)) => 0.5 * (time(first.start) + time(last.end - 1)),
        _ => 0.0,
    }
}

/// Offsets of the legs inside one engagement, between the pauses that the log shows, and the marks that
/// they are.
fn find_pauses(
    time_map: &mut TimeMap,
    log: &Log,
    stretch: &Range<usize>,
    engagement: &Engagement,
) -> Vec<Mark> {
    let mut marks = Vec::new();
    if engagement.stops == 0 {
        return marks;
    }
    // The breaks inside the engagement, each with the leg that it ends.
    let inside = engagement.start_s..engagement.end_s;
    let inner: Vec<(usize, Break)> = time_map
        .breaks()
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, at)| inside.contains(&at.program_s))
        .collect();
    let operators = || inner.iter().filter(|(_, at)| at.operator);
    let edges: Vec<f64> = std::iter::once(engagement.start_s)
        .chain(operators().map(|(_, at)| at.program_s))
        .chain(std::iter::once(engagement.end_s))
        .collect();
    let scale = 1.0 / (1.0 + time_map.rate);
    let stretches_s: Vec<f64> = edges.windows(2).map(|e| (e[1] - e[0]) * scale).collect();
    let first_leg = time_map.leg_of(engagement.start_s);
    let last_leg = time_map.leg_of(engagement.end_s);
    let start_s = time_map.log_time_s(engagement.start_s, first_leg);
    let end_s = time_map.log_time_s(engagement.end_s, last_leg);
    let lengths_s = stops::pauses_s(log, stretch, start_s, &stretches_s, end_s);
    let last_stop = operators().map(|(leg, _)| *leg).max();
    let mut lengths_s = lengths_s.into_iter();
    for (leg, at) in &inner {
        let (leg, next) = (*leg, leg + 1);
        let length_s = if at.operator { lengths_s.next().unwrap_or(0.0) } else { 0.0 };
        // What comes after the last pause hangs together with the release.
        if time_map.offset_sigmas_s[next].is_finite() || Some(leg) == last_stop {
            continue;
        }
        time_map.offsets_s[next] = time_map.offsets_s[leg] + length_s / scale;
        time_map.offset_sigmas_s[next] = STANDSTILL_SIGMA_S;
        if at.operator {
            marks.push(Mark {
                log_s: time_map.log_time_s(at.program_s, next),
                program_s: at.program_s,
                sigma_s: STANDSTILL_SIGMA_S,
                kind: MarkKind::Standstill,
                samples: 0,
            });
        }
    }
    marks
}
