//! A log and its readings.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use jiff::civil::Date;

use super::by_angle::ByAngle;

/// One sample of a log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Time on the instrument's clock, s.
    pub time_s: f64,
    /// Length minus nominal length, mm, positive outward; `None` while the bar is out of range.
    pub deviation_mm: Option<f64>,
    /// Line of the file, counted from 1.
    pub line: usize,
}

/// A log: at least two samples, their times finite and strictly increasing, at least one in range.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    file: PathBuf,
    readings: Arc<Vec<Reading>>,
    period_s: f64,
    notes: Vec<String>,
    by_angle: Option<ByAngle>,
    began: Option<Date>,
}

/// So many steps of a log are looked at first.
const SOME_STEPS: usize = 1000;

impl Log {
    /// A step longer than this many sample periods is a gap: a sample or more is missing in it.
    pub const GAP_PERIODS: f64 = 1.5;

    /// Takes over readings for which the reader has established what [`Log`] promises.
    pub(super) fn new(file: &Path, readings: Vec<Reading>, notes: Vec<String>) -> Self {
        let period_s = middle_step_s(&readings);
        let readings = Arc::new(readings);
        Self { file: file.to_path_buf(), readings, period_s, notes, by_angle: None, began: None }
    }

    pub(super) fn begun(self, began: Option<Date>) -> Self {
        Self { began, ..self }
    }

    pub(super) fn with_angles(self, by_angle: ByAngle) -> Self {
        Self { by_angle: Some(by_angle), ..self }
    }

    /// The same log with times, for readings that had none: they increase, and there are two or more.
    pub(crate) fn timed(&self, readings: Vec<Reading>) -> Self {
        Self::new(&self.file, readings, self.notes.clone()).begun(self.began)
    }

    /// Whether another log has the same readings one after the other, at whatever times.
    pub fn has_the_readings_of(&self, other: &Self) -> bool {
        let inside = |reading: &&Reading| reading.deviation_mm.is_some();
        let (mine, others) = (self.readings.iter(), other.readings.iter());
        let (mine, others) = (mine.filter(inside), others.filter(inside));
        mine.map(|reading| reading.deviation_mm).eq(others.map(|reading| reading.deviation_mm))
    }

    /// The same log as it would be with its times and its readings in other units.
    pub(crate) fn scaled(&self, time: f64, reading: f64) -> Self {
        let scaled = |of: &Reading| Reading {
            time_s: time * of.time_s,
            deviation_mm: of.deviation_mm.map(|mm| reading * mm),
            ..*of
        };
        Self {
            file: self.file.clone(),
            readings: Arc::new(self.readings.iter().map(scaled).collect()),
            period_s: time * self.period_s,
            notes: self.notes.clone(),
            by_angle: self.by_angle.clone(),
            began: self.began,
        }
    }

    /// The same log with some of its readings out of range.
    pub(crate) fn without(&self, out: impl Fn(&Reading) -> bool) -> Self {
        let readings = self.readings.iter().map(|reading| {
            let deviation_mm = reading.deviation_mm.filter(|_| !out(reading));
            Reading { deviation_mm, ..*reading }
        });
        Self { readings: Arc::new(readings.collect()), ..self.clone() }
    }

    /// The file it was read from, as the user named it.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// What the reader found by itself and the user should know, sentences without a full stop.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The day on which it began, where the file says it so that it can be read in one way only.
    pub fn began(&self) -> Option<Date> {
        self.began
    }

    /// Where its readings were taken, for a log by angle: its times then only count its readings.
    pub fn by_angle(&self) -> Option<&ByAngle> {
        self.by_angle.as_ref()
    }

    /// All samples, in and out of range.
    pub fn readings(&self) -> &[Reading] {
        &self.readings
    }

    /// The same, to be kept without a copy.
    pub(crate) fn shared(&self) -> Arc<Vec<Reading>> {
        Arc::clone(&self.readings)
    }

    /// The sample period in s: the median of the time steps, so that gaps do not count.
    ///
    /// It is as coarse as the times in the file: 30 samples a second, written with four decimals,
    /// give 0.0333.
    pub fn sample_period_s(&self) -> f64 {
        self.period_s
    }

    /// Time from the first to the last sample, s.
    pub fn span_s(&self) -> f64 {
        match (self.readings.first(), self.readings.last()) {
            (Some(first), Some(last)) => last.time_s - first.time_s,
            _ => 0.0,
        }
    }

    /// Maximal runs of samples in range without a gap between them, as indices into
    /// [`Log::readings`].
    pub fn in_range_intervals(&self) -> Vec<Range<usize>> {
        let longest_s = Self::GAP_PERIODS * self.period_s;
        let mut intervals: Vec<Range<usize>> = Vec::new();
        for (k, reading) in self.readings.iter().enumerate() {
            if reading.deviation_mm.is_none() {
                continue;
            }
            match intervals.last_mut() {
                Some(run)
                    if run.end == k
                        && reading.time_s - self.readings[k - 1].time_s <= longest_s =>
                {
                    run.end = k + 1;
                }
                _ => intervals.push(k..k + 1),
            }
        }
        intervals
    }
}

/// The middle one of the time steps, s; of two or more readings.
fn middle_step_s(readings: &[Reading]) -> f64 {
    let step_s = |pair: &[Reading]| pair[1].time_s - pair[0].time_s;
    let middle_of = |mut steps: Vec<f64>| {
        let middle = steps.len() / 2;
        *steps.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let steps = || readings.windows(2).map(step_s);
    // Most steps are alike to the last bit or two: that of some is likely that of all, and to count which are shorter takes no copy.
    let some_s = middle_of(steps().step_by(1 + readings.len() / SOME_STEPS).collect());
    let (mut shorter, mut alike) = (0, 0);
    for step_s in steps() {
        shorter += usize::from(step_s < some_s);
        alike += usize::from(step_s <= some_s);
    }
    let middle = (readings.len() - 1) / 2;
    if (shorter..alike).contains(&middle) { some_s } else { middle_of(steps().collect()) }
}
