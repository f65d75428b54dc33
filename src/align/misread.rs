//! Logs whose numbers are in other units, or of the other sign, than the test file says.
//!
//! The program says how long the bar is engaged, and the ramp on which it engages is a known step: the log shows both. A log
//! that contradicts them and fits under another unit was misread.

use std::ops::Range;

use super::clipped;
use super::engagement::{self, Engagement};
use super::ramp::{self, Height, MarkKind};
use super::run::Run;
use crate::log::Log;
use crate::motion::Trajectory;
use crate::plan::log_format::{Format, LengthUnit, ReadingKind, TimeColumn, TimeUnit};

/// What the test file says otherwise than the log shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Misread {
    /// What the log shows, a sentence without a full stop.
    pub what: String,
    /// The lines to write under `[log]` in the test file.
    pub lines: String,
}

/// The outermost reading of a ramp stands within this factor of where it should: it is at most a sample period inside the
/// range, and higher than a quarter of it.
const HEIGHT_FACTOR: f64 = 3.0;
/// Ramps lower than this share of what the program has are in another unit.
const LOW: f64 = 0.1;
/// No reading is larger than this share of the range; ranges are stated by eye.
const BEYOND: f64 = 2.0;
/// A knob may stand at half of what is stated, or at twice: beyond, the rate of the log is wrong.
const KNOB: f64 = 2.0;

/// A log with fewer readings than this in all its engagements tells nothing of a machine, whatever the unit of its times.
const FEWEST: usize = 32;

/// How a log may be read otherwise.
#[derive(Debug, Clone, Copy)]
struct Reading {
    /// What its times are multiplied with.
    time: f64,
    /// In this unit, if in another one.
    time_unit: Option<TimeUnit>,
    /// What its readings are multiplied with.
    length: f64,
    /// In this unit, if in another one.
    length_unit: Option<LengthUnit>,
}

/// What speaks for and against a reading of a log.
enum Verdict {
    /// Its stretches are not the engagements of the program.
    OfAnotherTime,
    /// The ramps are too high or too low, or turned over.
    Contradicted,
    /// Durations fit, and no ramp is slow enough to tell more.
    Possible,
    /// Durations and ramps fit.
    Right,
}

/// What a test file says wrong about a log; `None` where log and program agree, or nothing else would do better.
pub fn misread(run: &Run, format: &Format) -> Option<Misread> {
    let within = clipped::taken_out(run.log).map(|(log, _)| log);
    let run = &Run { log: within.as_ref().unwrap_or(run.log), ..*run };
    let trajectory = run.trajectory(run.feed_override);
    let expected = engagement::expected(&trajectory, &run.rig);
    let judge = |log: &Log| judge(&Run { log, ..*run }, &trajectory, &expected);
    if matches!(judge(run.log), Verdict::Possible | Verdict::Right) {
        return None;
    }
    let readable = readings(run.log, &expected, format);
    let found = readable.into_iter().find(|of| {
        match judge(&run.log.scaled(of.time, of.length)) {
            Verdict::Right => true,
            // Nothing but the ramps tells the unit of a length.
            Verdict::Possible => of.length_unit.is_none() && of.length > 0.0,
            Verdict::OfAnotherTime | Verdict::Contradicted => false,
        }
    })?;
    let program_s = engaged_s(&expected);
    Some(told(run, &found, format, program_s))
}

/// All other ways to read a log, those that change least first.
fn readings(log: &Log, expected: &[Engagement], format: &Format) -> Vec<Reading> {
    let mut times = vec![(1.0, None)];
    match &format.time {
        TimeColumn::Named { unit, .. } => {
            let others = TimeUnit::ALL.into_iter().filter(|other| other != unit);
            times.extend(others.map(|other| (other.to_s(1.0) / unit.to_s(1.0), Some(other))));
        }
        TimeColumn::Angle { .. } => {}
        TimeColumn::Rate { .. } => {
            let time = engaged_s(expected) / in_range_s(log).max(f64::MIN_POSITIVE);
            times.extend((!(1.0 / KNOB..=KNOB).contains(&time)).then_some((time, None)));
        }
    }
    let mut lengths = vec![(1.0, None)];
    if format.reading.kind == ReadingKind::Deviation {
        let stated = format.reading.unit;
        let others = LengthUnit::ALL.into_iter().filter(|other| *other != stated);
        lengths.extend(others.map(|other| (other.to_mm(1.0) / stated.to_mm(1.0), Some(other))));
        let turned: Vec<_> = lengths.iter().map(|(factor, unit)| (-factor, *unit)).collect();
        lengths.extend(turned);
    }
    let mut all: Vec<Reading> = times
        .into_iter()
        .flat_map(|(time, time_unit)| {
            lengths.iter().map(move |&(length, length_unit)| Reading {
                time,
                time_unit,
                length,
                length_unit,
            })
        })
        .collect();
    all.sort_by_key(Reading::changes);
    all
}

impl Reading {
    /// Whether its times are not those of the log as it stands.
    fn is_of_other_times(&self) -> bool {
        self.time.total_cmp(&1.0).is_ne()
    }

    fn changes(&self) -> usize {
        [self.is_of_other_times(), self.length_unit.is_some(), self.length < 0.0]
            .into_iter()
            .filter(|changed| *changed)
            .count()
    }
}

/// From the first engagement to the last release, s.
fn engaged_s(expected: &[Engagement]) -> f64 {
    match (expected.first(), expected.last()) {
        (Some(first), Some(last)) => last.end_s - first.start_s,
        _ => 0.0,
    }
}

/// From the first reading in range to the last, s.
fn in_range_s(log: &Log) -> f64 {
    let mut inside = log.readings().iter().filter(|reading| reading.deviation_mm.is_some());
    match (inside.next(), inside.next_back()) {
        (Some(first), Some(last)) => last.time_s - first.time_s,
        _ => 0.0,
    }
}

fn judge(run: &Run, trajectory: &Trajectory, expected: &[Engagement]) -> Verdict {
    let paired = |observed: &Vec<Range<usize>>| {
        let (tolerance, feed) = (engagement::DURATION_TOLERANCE, run.feed_override);
        engagement::pair(run.log, expected, observed, trajectory, feed, tolerance).ok()
    };
    let Some(paired) = engagement::observed(run).iter().find_map(paired) else {
        return Verdict::OfAnotherTime;
    };
    let stretches = &paired.stretches;
    // In days the milliseconds in which a bar at the edge of its range flickers are as long as the program.
    if stretches.iter().map(Range::len).sum::<usize>() < FEWEST {
        return Verdict::OfAnotherTime;
    }
    let heights: Vec<Height> = heights(run, trajectory, expected, stretches);
    let beyond_mm = BEYOND * run.rig.bar.range_mm;
    let of = |stretch: &Range<usize>| run.log.readings()[stretch.clone()].iter();
    let largest_mm = stretches.iter().flat_map(of).filter_map(|reading| reading.deviation_mm);
    if largest_mm.fold(0.0, |most: f64, mm| most.max(mm.abs())) > beyond_mm {
        return Verdict::Contradicted;
    }
    if heights.is_empty() {
        return Verdict::Possible;
    }
    let share = |height: &Height| height.read_mm / height.programmed_mm;
    let shares: Vec<f64> = heights.iter().map(share).collect();
    if shares.iter().all(|share| *share < LOW) {
        return Verdict::Contradicted;
    }
    let middle = shares.iter().map(|share| share.max(1e-9).ln()).sum::<f64>() / shares.len() as f64;
    if middle.abs() < HEIGHT_FACTOR.ln() { Verdict::Right } else { Verdict::Possible }
}

fn heights(
    run: &Run,
    trajectory: &Trajectory,
    expected: &[Engagement],
    stretches: &[Range<usize>],
) -> Vec<Height> {
    let both = [MarkKind::Engagement, MarkKind::Release];
    let pairs = stretches.iter().zip(expected);
    let ends = pairs.flat_map(|pair| both.map(|kind| (pair, kind)));
    ends.filter_map(|((stretch, of), kind)| ramp::height(run, trajectory, of, stretch, kind))
        .collect()
}

fn told(run: &Run, found: &Reading, format: &Format, program_s: f64) -> Misread {
    let mut lines = Vec::new();
    let mut what = Vec::new();
    if found.is_of_other_times() {
        let (line, whose) = match (&format.time, found.time_unit) {
            (TimeColumn::Rate { hz }, _) => {
                let rate_hz = rounded(hz / found.time);
                (
                    format!("sample_rate_hz = {rate_hz:?}"),
                    format!("it has {rate_hz} readings a second, and not {hz}"),
                )
            }
            (TimeColumn::Named { .. } | TimeColumn::Angle { .. }, unit) => {
                let unit = unit.unwrap_or(TimeUnit::Second).name();
                (format!("time_unit = \"{unit}\""), format!("its times are in {unit}"))
            }
        };
        what.push(format!(
            "{whose}: as the test file has it, the bar reads for {} s, and the program engages it for {} s",
            rounded(in_range_s(run.log)),
            rounded(program_s)
        ));
        lines.push(line);
    }
    if let Some(unit) = found.length_unit {
        what.push(format!(
            "its readings are in {}, and not in {}: on the feed-in they run through the range of the bar",
            unit.name(),
            format.reading.unit.name()
        ));
        lines.push(format!("reading_unit = \"{}\"", unit.name()));
    }
    if found.length < 0.0 {
        what.push(
            "its readings fall where the program makes the bar longer, and rise where it makes it shorter"
                .to_owned(),
        );
        lines.push(format!("reading_sign = {}", if format.reading.inverted { 1 } else { -1 }));
    }
    Misread { what: what.join("; "), lines: lines.join("` and `") }
}

/// Three digits.
fn rounded(value: f64) -> f64 {
    let step = 10f64.powf(value.abs().max(f64::MIN_POSITIVE).log10().floor() - 2.0);
    let steps = (value / step).round();
    // Powers of ten below 1 are not exact; their reciprocals are.
    if step < 1.0 { steps / (1.0 / step).round() } else { steps * step }
}
