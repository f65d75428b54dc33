//! The alignment of one run, and its samples.

use std::ops::Range;

use nalgebra::Vector3;

use super::engagement::{self, Engagement};
use super::ramp::{Mark, MarkKind};
use super::section::Section;
use super::time_map::TimeMap;
use super::{ramp, section, stops};
use crate::error::{Error, Kind, Result};
use crate::log::Log;
use crate::machine::{Machine, Mounting, Pose};
use crate::model::Motion;
use crate::motion::{Reversals, Trajectory};
use crate::nc::Program;
use crate::plan::BallBar;

/// Where in the program a sample was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// On a section of the sphere; its index.
    Arc(usize),
    /// On a feed-in or feed-out.
    Ramp,
    /// In a dwell, or at rest at the end of a block.
    Dwell,
    /// In an operator's pause.
    Stop,
}

/// One reading with the place at which it was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time on the instrument's clock, s.
    pub log_s: f64,
    /// Line of the log.
    pub line: usize,
    /// Program time, s, operator's pauses counted as zero.
    pub program_s: f64,
    /// Standard deviation of the program time, s.
    pub time_sigma_s: f64,
    /// Length minus nominal length, mm.
    pub deviation_mm: f64,
    /// Axis positions and senses.
    pub pose: Pose,
    /// How the machine moved there.
    pub motion: Motion,
    /// Where in the program.
    pub place: Place,
    /// Index of the leg of the time map.
    pub leg: usize,
}

/// One run: a log laid over a program.
#[derive(Debug, Clone)]
pub struct Alignment {
    /// The program with its times, at the estimated feed override.
    pub trajectory: Trajectory,
    /// From log time to program time.
    pub time_map: TimeMap,
    /// Engagements and releases.
    pub marks: Vec<Mark>,
    /// The engagements that the program makes.
    pub engagements: Vec<Engagement>,
    /// The arcs.
    pub sections: Vec<Section>,
    /// The readings, in order.
    pub samples: Vec<Sample>,
    /// Sample period of the log, s.
    pub sample_period_s: f64,
    /// When the program began, on the log's clock, s: half way between what the log allows where an
    /// operator's pause hides it.
    pub began_log_s: f64,
    /// Standard deviation of that, s.
    pub began_sigma_s: f64,
    reversals: Reversals,
    coincidence_mm: Vector3<f64>,
    /// Readings in engagements: log time, line, deviation.
    readings: Vec<(f64, usize, f64)>,
}

impl Alignment {
    /// Lays the samples over the program again, after the time map has changed.
    pub fn place_samples(&mut self) {
        let (trajectory, time_map) = (&self.trajectory, &self.time_map);
        let mut samples = Vec::with_capacity(self.readings.len());
        for &(log_s, line, deviation_mm) in &self.readings {
            let moment = time_map.at(log_s);
            // In a pause the senses are still those of the motion before it.
            let before_s = if moment.in_stop { 1e-6 } else { 0.0 };
            let state = trajectory.at(moment.program_s - before_s);
            let place = if moment.in_stop {
                Place::Stop
            } else if state.velocity_mm_s.norm() < 1e-9 {
                Place::Dwell
            } else {
                match self
                    .sections
                    .partition_point(|s| s.start_s <= moment.program_s)
                    .checked_sub(1)
                    .filter(|&index| moment.program_s < self.sections[index].end_s)
                {
                    Some(index) => Place::Arc(index),
                    None => Place::Ramp,
                }
            };
            samples.push(Sample {
                log_s,
                line,
                program_s: moment.program_s,
                time_sigma_s: time_map.sigma_s(log_s, moment.leg),
                deviation_mm,
                pose: Pose { position_mm: state.position_mm, sense: state.sense },
                motion: Motion {
                    velocity_mm_s: state.velocity_mm_s,
                    elapsed_s: (1.0 + time_map.rate) * (log_s - self.began_log_s),
                    reversals: self.reversals.last(moment.program_s, &state.position_mm),
                    corner: trajectory.corner(moment.program_s, state.block),
                },
                place,
                leg: moment.leg,
            });
        }
        self.samples = samples;
    }

    /// Machine coordinates at which the ball centres coincide, mm.
    pub fn coincidence_mm(&self) -> &Vector3<f64> {
        &self.coincidence_mm
    }

    /// Legs that have samples, in order.
    pub fn legs(&self) -> Vec<usize> {
        let mut legs: Vec<usize> = self.samples.iter().map(|s| s.leg).collect();
        legs.dedup();
        legs.sort_unstable();
        legs.dedup();
        legs
    }
}

/// Standard deviation of an offset that was found from standstill alone, s.
const STANDSTILL_SIGMA_S: f64 = 1.0;

/// Rounds in which the feed is estimated from the times of engagement and release.
const MOST_ROUNDS: usize = 3;

/// Lays a log over the program that ran.
///
/// # Errors
/// When the log does not belong to the program, with the reason.
pub fn align(
    log: &Log,
    program: &Program,
    machine: &Machine,
    mounting: &Mounting,
    bar: &BallBar,
    feed_override: f64,
) -> Result<Alignment> {
    let coincidence_mm = mounting.coincidence_mm;
    let observed = engagement::observed(log, bar);
    let mut excess = 0.0;
    let mut excess_sigma = 0.0;
    let mut round = 0;
    loop {
        let trajectory = Trajectory::new(program, machine, feed_override * (1.0 + excess));
        let expected = engagement::expected(&trajectory, &coincidence_mm, bar);
        let stretches = engagement::pair(log, &expected, &observed, &trajectory, feed_override)?;
        let pivot_s = middle_s(log, &stretches);
        let mut time_map = TimeMap::new(&trajectory, pivot_s);
        let mut marks = Vec::new();
        for (stretch, engagement) in stretches.iter().zip(&expected) {
            for engages in [true, false] {
                marks.push(ramp::mark(
                    log,
                    stretch,
                    &trajectory,
                    engagement,
                    &coincidence_mm,
                    bar,
                    engages,
                ));
            }
        }
        time_map.fit_marks(&marks, bar.clock_tolerance);
        // What the clock cannot explain is the feed, unless it was lost at one place. What is left after
        // some rounds is what it is.
        if time_map.rate.abs() > 1.5 * bar.clock_tolerance && round < MOST_ROUNDS {
            // The clock's tolerance would hold the rate back.
            time_map.fit_marks(&marks, f64::INFINITY);
            let total = trajectory.duration();
            let share = total.known_s() / total.feed_s.max(1e-9);
            excess = (1.0 + excess) * (1.0 + time_map.rate * share) - 1.0;
            excess_sigma = bar.clock_tolerance.hypot(time_map.rate_sigma) * share;
            if round == 0 {
                let longer_s = time_map.rate.abs() * trajectory.end_s();
                let plain = time_map.at_equal_rates(&marks);
                let probe = lay(log, &stretches, trajectory, plain, marks, expected, mounting, bar);
                refuse_step(log, &probe, longer_s)?;
            }
            round += 1;
            continue;
        }
        refuse_inconsistent(log, &time_map, &marks)?;
        for (stretch, engagement) in stretches.iter().zip(&expected) {
            marks.extend(find_pauses(&mut time_map, log, stretch, engagement));
        }
        time_map.override_excess = excess;
        time_map.override_sigma = excess_sigma;
        return Ok(lay(log, &stretches, trajectory, time_map, marks, expected, mounting, bar));
    }
}

/// Lays the readings of the engagements over the program.
#[allow(clippy::too_many_arguments)]
fn lay(
    log: &Log,
    stretches: &[Range<usize>],
    trajectory: Trajectory,
    time_map: TimeMap,
    marks: Vec<Mark>,
    engagements: Vec<Engagement>,
    mounting: &Mounting,
    bar: &BallBar,
) -> Alignment {
    let coincidence_mm = mounting.coincidence_mm;
    let sections = section::sections(&trajectory, &coincidence_mm, bar);
    let readings = stretches
        .iter()
        .flat_map(|stretch| &log.readings()[stretch.clone()])
        .filter_map(|r| r.deviation_mm.map(|deviation| (r.time_s, r.line, deviation)))
        .collect();
    let first_s = log.readings().first().map_or(0.0, |reading| reading.time_s);
    let (began_log_s, began_sigma_s) = time_map.began(first_s);
    let mut alignment = Alignment {
        began_log_s,
        began_sigma_s,
        reversals: Reversals::of(&trajectory),
        trajectory,
        time_map,
        marks,
        engagements,
        sections,
        samples: Vec::new(),
        sample_period_s: log.sample_period_s(),
        coincidence_mm,
        readings,
    };
    alignment.place_samples();
    alignment
}

/// Engagements and releases of one leg fit a straight map to some ms; more than this is lost time, s.
const INCONSISTENT_S: f64 = 0.05;

/// Refuses a log whose engagements and releases do not fit one clock and one feed.
fn refuse_inconsistent(log: &Log, time_map: &TimeMap, marks: &[Mark]) -> Result<()> {
    let off_s = |mark: &Mark| {
        time_map.on_leg_s(mark.log_s, time_map.leg_of(mark.program_s)) - mark.program_s
    };
    let worst = marks.iter().max_by(|a, b| off_s(a).abs().total_cmp(&off_s(b).abs()));
    let Some(mark) = worst.filter(|m| off_s(m).abs() > INCONSISTENT_S.max(4.0 * m.sigma_s)) else {
        return Ok(());
    };
    let what = if mark.kind == MarkKind::Engagement { "engagement" } else { "release" };
    Err(Error::new(
        Kind::Mismatch,
        format!(
            "the {what} at {:.2} s of the log is {:.2} s off from where the others put it: one clock and one feed do not explain them all",
            mark.log_s,
            off_s(mark).abs()
        ),
    )
    .at(crate::error::Place::file(log.file()))
    .hint("take the log as the instrument wrote it, from a run that was not interrupted"))
}

/// Refuses a log that differs from the program by `longer_s` when most of it was lost at one place: no
/// feed override does that.
fn refuse_step(log: &Log, probe: &Alignment, longer_s: f64) -> Result<()> {
    let Some(step) = probe.time_step(longer_s + 0.5) else { return Ok(()) };
    if step.lost_s.abs() < 0.5 * longer_s {
        return Ok(());
    }
    let name = |index: usize| &probe.sections[index].name;
    let (what, hint) = if step.lost_s > 0.0 {
        (
            "is missing from the log, without a gap in its times",
            "take the log as the instrument wrote it; readings must not be cut out of it",
        )
    } else {
        (
            "is in the log and not in the program",
            "the machine stood or the feed was held there; repeat the run, or write an M00 into the program",
        )
    };
    Err(Error::new(
        Kind::Mismatch,
        format!(
            "between the middle of `{}` and that of `{}`, {:.1} s {what}",
            name(step.before),
            name(step.after),
            step.lost_s.abs()
        ),
    )
    .at(crate::error::Place::file(log.file()))
    .hint(hint))
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
    let first_leg = time_map.leg_of(engagement.start_s);
    let last_leg = first_leg + engagement.stops;
    let inner: Vec<f64> = time_map.stops_s()[first_leg..last_leg].to_vec();
    let edges: Vec<f64> = std::iter::once(engagement.start_s)
        .chain(inner)
        .chain(std::iter::once(engagement.end_s))
        .collect();
    let scale = 1.0 / (1.0 + time_map.rate);
    let stretches_s: Vec<f64> = edges.windows(2).map(|e| (e[1] - e[0]) * scale).collect();
    let start_s = time_map.log_time_s(engagement.start_s, first_leg);
    let end_s = time_map.log_time_s(engagement.end_s, last_leg);
    let lengths_s = stops::pauses_s(log, stretch, start_s, &stretches_s, end_s);
    for (k, length_s) in lengths_s.iter().enumerate() {
        let leg = first_leg + k + 1;
        if leg < last_leg {
            time_map.offsets_s[leg] = time_map.offsets_s[leg - 1] + length_s / scale;
            time_map.offset_sigmas_s[leg] = STANDSTILL_SIGMA_S;
            let program_s = time_map.stops_s()[leg - 1];
            marks.push(Mark {
                log_s: time_map.log_time_s(program_s, leg),
                program_s,
                sigma_s: STANDSTILL_SIGMA_S,
                kind: MarkKind::Standstill,
                samples: 0,
            });
        }
    }
    marks
}
