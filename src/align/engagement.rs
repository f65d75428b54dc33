//! Engagements: when the program brings the bar into its range, and when the log shows it.

use std::fmt::Write as _;
use std::ops::Range;

use super::run::{Rig, Run};
use crate::error::{Error, Kind, Place, Result};
use crate::log::Log;
use crate::motion::{BlockKind, Trajectory};

/// A stretch of program time during which the bar reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engagement {
    /// When the nominal length enters the range, s of program time.
    pub start_s: f64,
    /// When it leaves the range, s of program time.
    pub end_s: f64,
    /// Operator's pauses inside.
    pub stops: usize,
}

impl Engagement {
    /// How long it lasts without the operator's pauses, s.
    pub fn duration_s(&self) -> f64 {
        self.end_s - self.start_s
    }
}

/// The engagements that a program makes. Positioning through the sphere does not count: the bar is
/// not fitted then, or reads for a moment only.
pub(super) fn expected(trajectory: &Trajectory, rig: &Rig) -> Vec<Engagement> {
    let inside = |time_s: f64| {
        let position_mm = trajectory.at(time_s).position_mm;
        rig.commanded_deviation_mm(&position_mm).abs() < rig.bar.range_mm
    };
    let crossing = |mut low: f64, mut high: f64| {
        let begins = inside(low);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if inside(middle) == begins { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let mut engagements: Vec<Engagement> = Vec::new();
    let mut open: Option<(f64, usize, bool)> = None;
    let mut before = (0.0, false);
    for block in trajectory.blocks() {
        if block.kind == BlockKind::Stop
            && let Some((_, stops, _)) = &mut open
        {
            *stops += 1;
        }
        // Fine enough that no passage through the range of a fast move is missed.
        let travel_mm = block.motion().map_or(0.0, crate::nc::Move::length_mm);
        let pieces = (travel_mm / (0.5 * rig.bar.range_mm)).ceil().clamp(1.0, 4096.0) as usize;
        for piece in 1..=pieces {
            let time_s = block.start_s + block.duration_s * (piece as f64 / pieces as f64);
            // Just before the end: the next block begins at the end.
            let now = inside(time_s - 1e-9);
            match (&mut open, now) {
                (None, true) => open = Some((crossing(before.0, time_s), 0, false)),
                (Some((start_s, stops, feeds)), false) => {
                    let end_s = crossing(before.0, time_s);
                    if *feeds && block.kind == BlockKind::Feed {
                        engagements.push(Engagement { start_s: *start_s, end_s, stops: *stops });
                    }
                    open = None;
                }
                _ => {}
            }
            if let Some((_, _, feeds)) = &mut open {
                *feeds |= block.kind == BlockKind::Feed;
            }
            before = (time_s, now);
        }
    }
    engagements
}

/// The stretches of a log in which the bar reads, as ranges of sample indices: the ways to take its gaps, the likeliest first.
///
/// A gap between two readings that are both well inside the range is a dropout, not a release: at a release the last
/// reading is on the ramp. A ramp that is over between two readings leaves none on it, though; then the time tells: a
/// dropout is shorter than the program's shortest way out of the range and back. Where nothing else comes out such a gap is
/// one wherever the bar reads, but first not: a bar that is fitted at the edge of its range reads until it is engaged.
pub(super) fn observed(run: &Run) -> Vec<Vec<Range<usize>>> {
    let (log, range_mm) = (run.log, run.rig.bar.range_mm);
    let reading_mm = |index: usize| log.readings()[index].deviation_mm.unwrap_or(0.0).abs();
    let lasts_s =
        |gap: &Range<usize>| log.readings()[gap.end].time_s - log.readings()[gap.start].time_s;
    let inside = |gap: &Range<usize>| {
        [gap.start, gap.end].iter().all(|&k| reading_mm(k) < WELL_INSIDE * range_mm)
    };
    // The feed may have been one and a half times what is stated.
    let shortest_s = shortest_way_out_s(run).map(|shortest_s| 0.5 * shortest_s);
    let is_shorter = |gap: &Range<usize>| shortest_s.map(|shortest_s| lasts_s(gap) < shortest_s);
    let is_short = |gap: &Range<usize>| is_shorter(gap).unwrap_or(true);
    let runs = |stretch: &Range<usize>| is_on_ramp(log, stretch, range_mm);
    let ways = [
        // What comes before a single engagement may have passed through the range, at any time.
        joined(log, |of, gap| inside(gap) && (!runs(of) || is_shorter(gap) == Some(true))),
        joined(log, |_, gap| inside(gap) && is_short(gap)),
        joined(log, |_, gap| is_short(gap)),
    ];
    let mut different: Vec<Vec<Range<usize>>> = Vec::new();
    for way in ways {
        if !different.contains(&way) {
            different.push(way);
        }
    }
    different
}

/// Readings nearer to the middle of the range than this share of it are on no ramp's way out.
const WELL_INSIDE: f64 = 0.25;

/// Whether the last two readings of a stretch differ as on a ramp: what ran through the range was not engaged.
fn is_on_ramp(log: &Log, stretch: &Range<usize>, range_mm: f64) -> bool {
    let read = log.readings()[stretch.clone()].iter().rev();
    let mut last = read.filter_map(|reading| reading.deviation_mm);
    let differ_mm = last.next().zip(last.next()).map(|(last, before)| (last - before).abs());
    differ_mm.is_none_or(|mm| mm >= 0.1 * range_mm)
}

/// The stretches, those joined that a dropout parts: of a stretch and the gap behind it, from its last reading to the next.
fn joined(
    log: &Log,
    is_dropout: impl Fn(&Range<usize>, &Range<usize>) -> bool,
) -> Vec<Range<usize>> {
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for interval in log.in_range_intervals() {
        match stretches.last_mut() {
            Some(last) if is_dropout(last, &(last.end - 1..interval.start)) => {
                last.end = interval.end;
            }
            _ => stretches.push(interval),
        }
    }
    stretches
}

/// The shortest time for which a program takes the bar out of its range between two engagements, s; none with one.
fn shortest_way_out_s(run: &Run) -> Option<f64> {
    let engagements = expected(&run.trajectory(run.feed_override), &run.rig);
    let out_s = engagements.windows(2).map(|pair| pair[1].start_s - pair[0].end_s);
    out_s.reduce(f64::min)
}

/// How far a log's duration may be from the program's before it is another program's, as a share:
/// clocks differ by 1e-4, a control's own deceleration at corners by some 1e-3.
pub(super) const DURATION_TOLERANCE: f64 = 0.02;
/// And how far where the feed may have been between half and one and a half times the stated one.
pub(super) const ANY_FEED_TOLERANCE: f64 = 1.0;

/// What is said of a program without an engagement.
const NEVER: &str = "the program never brings the bar into its range";

/// That a program has no engagement, and how near to one it comes at the ends of its blocks.
pub(super) fn never(run: &Run, trajectory: &Trajectory) -> Error {
    let ends_mm = trajectory.blocks().iter().map(|block| &block.start_mm);
    let off_mm = ends_mm.map(|end_mm| run.rig.commanded_deviation_mm(end_mm));
    let nearest_mm = off_mm.min_by(|a, b| a.abs().total_cmp(&b.abs()));
    let how_near = nearest_mm.map_or_else(String::new, |mm| {
        let bar = run.rig.bar;
        format!(
            ": of the ends of its moves the nearest is at {:.1} mm from ball to ball, and the bar of {} mm reads {} mm either way",
            bar.length_mm + mm,
            bar.length_mm,
            bar.range_mm
        )
    });
    Error::new(Kind::Mismatch, format!("{NEVER}{how_near}"))
        .at(Place::file(&run.program.file))
        .hint("check the program, the mounting's `coincidence_mm` and the length of its bar in the test file")
}

/// Pairs every expected engagement with a stretch of the log, in order.
///
/// Short readings that no program makes, such as the operator's hand when he fits the bar, are passed
/// over.
pub(super) fn pair(
    log: &Log,
    expected: &[Engagement],
    observed: &[Range<usize>],
    trajectory: &Trajectory,
    feed_override: f64,
    tolerance: f64,
) -> Result<Paired> {
    let duration_s = |stretch: &Range<usize>| duration_s(log, stretch);
    let feed_s = expected
        .iter()
        .map(|e| trajectory.feed_elapsed_s(e.end_s) - trajectory.feed_elapsed_s(e.start_s))
        .sum();
    // The operator's hand is not told with the rest.
    let told: Vec<Range<usize>> =
        observed.iter().filter(|stretch| duration_s(stretch) > 1.0).cloned().collect();
    let refuse = |reason: &str| {
        Err(Refusal { log, expected, observed: &told, feed_override, feed_s }.error(reason))
    };
    let Some(shortest_s) = expected.iter().map(Engagement::duration_s).reduce(f64::min) else {
        return refuse(NEVER);
    };
    let long: Vec<Range<usize>> =
        observed.iter().filter(|s| duration_s(s) > 0.3 * shortest_s).cloned().collect();
    if long.len() < expected.len() {
        return refuse(&format!(
            "the program engages the bar {} time(s), the log shows {} of such a length",
            expected.len(),
            long.len()
        ));
    }
    match best_window(log, expected, &long) {
        Some((best, misfit)) if misfit <= tolerance => {
            let used = |stretch: &Range<usize>| best.contains(stretch);
            let beside = long.iter().filter(|stretch| !used(stretch)).cloned().collect();
            Ok(Paired { stretches: best.to_vec(), beside })
        }
        _ => refuse("the bar reads for another time than the program takes"),
    }
}

/// The stretches of a log that are the engagements of a program.
#[derive(Debug)]
pub(super) struct Paired {
    /// For each engagement one.
    pub(super) stretches: Vec<Range<usize>>,
    /// Others that are as long: of another run.
    pub(super) beside: Vec<Range<usize>>,
}

fn duration_s(log: &Log, stretch: &Range<usize>) -> f64 {
    log.readings()[stretch.end - 1].time_s - log.readings()[stretch.start].time_s
}

/// Of the stretches of a log those that fit the engagements of a program best, in order, and by how much they do not, as
/// a share of the duration: the log may hold more than one program's worth.
fn best_window<'a>(
    log: &Log,
    expected: &[Engagement],
    long: &'a [Range<usize>],
) -> Option<(&'a [Range<usize>], f64)> {
    let misfit = |window: &[Range<usize>]| -> f64 {
        let off = |(stretch, e): (&Range<usize>, &Engagement)| {
            // At most one sample period is lost at either end.
            let slack_s = 2.0 * log.sample_period_s();
            let longer = duration_s(log, stretch) - e.duration_s();
            let longer = if longer < 0.0 { (longer + slack_s).min(0.0) } else { longer };
            if e.stops > 0 {
                longer.min(0.0).abs() / e.duration_s()
            } else {
                longer.abs() / e.duration_s()
            }
        };
        window.iter().zip(expected).map(off).fold(0.0, f64::max)
    };
    let program_s = expected.last()?.end_s - expected.first()?.start_s;
    let apart_s = |window: &[Range<usize>]| {
        let (first, last) = (window.first(), window.last());
        let (Some(first), Some(last)) = (first, last) else { return f64::INFINITY };
        let time_s = |index: usize| log.readings()[index].time_s;
        (time_s(last.end - 1) - time_s(first.start) - program_s).abs()
    };
    // Where several fit, one run's engagements stand closer together than those of two.
    let windows = long.windows(expected.len()).map(|window| {
        let misfit = misfit(window);
        let fits = if misfit <= DURATION_TOLERANCE { 0.0 } else { misfit };
        (window, misfit, (fits, apart_s(window)))
    });
    let best = windows.min_by(|a, b| a.2.0.total_cmp(&b.2.0).then(a.2.1.total_cmp(&b.2.1)))?;
    Some((best.0, best.1))
}

/// Why a log does not belong to a program.
#[derive(Debug)]
pub struct Refusal<'a> {
    log: &'a Log,
    expected: &'a [Engagement],
    observed: &'a [Range<usize>],
    feed_override: f64,
    /// Time at feed in the engagements, s.
    feed_s: f64,
}

impl Refusal<'_> {
    /// The error: the reason, the durations side by side, and a picture in characters.
    fn error(&self, reason: &str) -> Error {
        let readings = self.log.readings();
        let origin_s = readings.first().map_or(0.0, |first| first.time_s);
        let span = |stretch: &Range<usize>| {
            (readings[stretch.start].time_s - origin_s, readings[stretch.end - 1].time_s - origin_s)
        };
        let observed: Vec<(f64, f64)> = self.observed.iter().map(span).collect();
        let first_s = self.expected.first().map_or(0.0, |e| e.start_s);
        let shift_s = observed.first().map_or(0.0, |o| o.0) - first_s;
        let expected: Vec<(f64, f64)> =
            self.expected.iter().map(|e| (e.start_s + shift_s, e.end_s + shift_s)).collect();
        let end_s = expected.iter().chain(&observed).map(|s| s.1).fold(self.log.span_s(), f64::max);
        let list = |spans: &[(f64, f64)]| {
            let mut text: Vec<String> =
                spans.iter().take(12).map(|(a, b)| format!("{:.1}", b - a)).collect();
            if spans.len() > 12 {
                text.push("...".into());
            }
            text.join(", ")
        };
        let mut what = format!("the log does not belong to the program: {reason}");
        let stops: usize = self.expected.iter().map(|e| e.stops).sum();
        let plus =
            if stops > 0 { format!(" plus {stops} operator's pause(s)") } else { String::new() };
        let _ = write!(
            what,
            "\n  program engages for (s): {}{plus}\n  log reads for (s):       {}\n  program |{}|\n  log     |{}| {:.0} s",
            list(&expected),
            list(&observed),
            timeline(&expected, end_s),
            timeline(&observed, end_s),
            end_s
        );
        let error = Error::new(Kind::Mismatch, what).at(Place::file(self.log.file()));
        // A log that was cut off explains itself better than an override would.
        let cut = |reading: Option<&crate::log::Reading>| {
            reading.is_some_and(|reading| reading.deviation_mm.is_some())
        };
        match (cut(readings.first()), cut(readings.last())) {
            (true, true) => {
                return error.hint(
                    "the bar reads from the log's first line to its last: its beginning and its end are missing",
                );
            }
            (true, false) => {
                return error
                    .hint("the bar reads from the log's first line on: its beginning is missing");
            }
            (false, true) => {
                return error.hint("the bar reads until the log's last line: its end is missing, or the balls are set up so far off that the feed-out does not release the bar");
            }
            (false, false) => {}
        }
        let log_s: f64 = observed.iter().map(|(a, b)| b - a).sum();
        // Dwells take their time at any override.
        let dwell_s = self.expected.iter().map(Engagement::duration_s).sum::<f64>() - self.feed_s;
        let percent = 100.0 * self.feed_override * self.feed_s / (log_s - dwell_s);
        // The knob has steps of 5 or 10.
        let near_step = (percent - 5.0 * (percent / 5.0).round()).abs() < 0.5;
        if self.expected.len() == observed.len()
            && stops == 0
            && near_step
            && (30.0..=200.0).contains(&percent)
        {
            let stopped = if percent < 100.0 {
                "; if the machine stood in between, write an M00 where it did"
            } else {
                ""
            };
            error.hint(format!(
                "take the program that ran; if the feed override stood at {percent:.0} %, say `feed_override_percent = {percent:.0}.0` in the run{stopped}"
            ))
        } else {
            error.hint("take the log and the program of the same run")
        }
    }
}

/// Characters of a timeline.
const WIDTH: usize = 60;

/// A line of time: `#` where the bar reads.
fn timeline(spans: &[(f64, f64)], end_s: f64) -> String {
    (0..WIDTH)
        .map(|k| {
            let (low, high) =
                (end_s * k as f64 / WIDTH as f64, end_s * (k + 1) as f64 / WIDTH as f64);
            if spans.iter().any(|(a, b)| *a < high && *b > low) { '#' } else { '.' }
        })
        .collect()
}
