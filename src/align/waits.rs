//! Bars that read where the program has them wait out of their range, because the machine errs by the rest of the way.
//!
//! Their log shows an engagement that lasts as long as the operator waits, and is laid over its program at a feed that comes of
//! that. But there the bar stands, farther out than half of where the program has it wait, and as the log was laid the machine
//! moves meanwhile. A bar that reads no further than that half would have shown the engagements of the program: its readings
//! beyond are left out, and what is left is laid over.

use std::borrow::Cow;

use super::lay::align;
use super::run::{Rig, Run};
use super::samples::{Alignment, Part};
use crate::log::Reading;
use crate::motion::{BlockKind, Trajectory};
use crate::plan::BallBar;

/// A bar stands that is farther out than that half for longer than this, s, ...
const STANDS_S: f64 = 1.0;
/// ... in the middle half of which it reads the same within this part of its range. Of a range of 1.2 mm that is 7 mm/min: nobody drives
/// a ramp so slowly, and no machine shakes so much.
const STILL: f64 = 0.05;

/// How the program was driven, as its log was laid over it, or else as it is planned.
pub(super) fn trajectory_of<'a>(run: &Run, laid: Option<&'a Alignment>) -> Cow<'a, Trajectory> {
    match laid {
        Some(laid) => Cow::Borrowed(&laid.trajectory),
        None => Cow::Owned(run.trajectory(run.feed_override)),
    }
}

/// The nearest to the sphere that the bar waits out of its range, mm.
pub(super) fn waits_mm(run: &Run, trajectory: &Trajectory) -> Option<f64> {
    let stops = trajectory.blocks().iter().filter(|block| block.kind == BlockKind::Stop);
    let at_mm = stops.map(|block| run.rig.commanded_deviation_mm(&block.start_mm).abs());
    at_mm.filter(|mm| *mm > run.rig.bar.range_mm).min_by(f64::total_cmp)
}

/// The log laid over its program as one of a bar that reads no further than this.
pub(super) fn laid_within(run: &Run, within_mm: f64) -> Option<Alignment> {
    let log = run.log.without(|reading| is_beyond(reading, within_mm));
    let bar = BallBar { range_mm: within_mm, ..run.rig.bar.clone() };
    align(&Run { log: &log, rig: Rig { bar: &bar, ..run.rig }, ..*run }).ok()
}

fn is_beyond(reading: &Reading, within_mm: f64) -> bool {
    reading.deviation_mm.is_some_and(|mm| mm.abs() > within_mm)
}

/// A log that was `laid` over its program, or was not, by where the bar read while it waited, or after its end: as it is laid without,
/// and beyond which readings, mm, were left out. `None` where it did not.
pub fn read_while_it_waited(run: &Run, laid: Option<&Alignment>) -> Option<(Alignment, f64)> {
    let trajectory = trajectory_of(run, laid);
    let end = trajectory.at(trajectory.end_s());
    let ends_mm = run.rig.commanded_deviation_mm(&end.position_mm).abs();
    let ends_mm = Some(ends_mm).filter(|mm| *mm > run.rig.bar.range_mm);
    let waits_mm = waits_mm(run, &trajectory).into_iter().chain(ends_mm).reduce(f64::min)?;
    let within_mm = 0.5 * waits_mm;
    let stands_s = longest_stand_s(run, within_mm)?;
    let moves = |laid: &Alignment| {
        let samples = laid.samples().into_iter();
        let meanwhile = samples.filter(|of| (stands_s[0]..=stands_s[1]).contains(&of.log_s));
        let on_arc: Vec<bool> = meanwhile.map(|of| matches!(of.part, Part::Arc(_))).collect();
        2 * on_arc.iter().filter(|on_arc| **on_arc).count() > on_arc.len()
    };
    if laid.is_some_and(|laid| !moves(laid)) {
        return None;
    }
    laid_within(run, within_mm).map(|laid| (laid, within_mm))
}

/// From when to when, s on the clock of the log, the bar stood longest so far out; `None` where no longer than on a ramp.
fn longest_stand_s(run: &Run, within_mm: f64) -> Option<[f64; 2]> {
    let beyond = |reading: &Reading| is_beyond(reading, within_mm);
    let stretches = run.log.readings().chunk_by(|a, b| beyond(a) == beyond(b));
    let stands = stretches.filter(|of| beyond(&of[0])).filter_map(|of| {
        // The ramps to it and from it are at its ends.
        let middle = &of[of.len() / 4..of.len() - of.len() / 4];
        let read_mm = middle.iter().filter_map(|reading| reading.deviation_mm);
        let ends_mm = read_mm.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], mm| {
            [low.min(mm), high.max(mm)]
        });
        let still = ends_mm[1] - ends_mm[0] < STILL * run.rig.bar.range_mm;
        let from_to_s = [of[0].time_s, of[of.len() - 1].time_s];
        (still && from_to_s[1] - from_to_s[0] > STANDS_S).then_some(from_to_s)
    });
    stands.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))
}
