//! From a log and a program to an alignment: the feed that really was, then the places of the samples.

use std::ops::Range;

use super::clipped::{self, Limit};
use super::draft::Draft;
use super::engagement;
use super::ramp::{Mark, MarkKind, UNEQUAL_DELAY_S};
use super::run::Run;
use super::samples::{Alignment, Part, Sample};
use super::time_map::{EXCESS_S, TimeMap};
use crate::error::{Error, Kind, Place, Result};
use crate::log::Log;

/// Rounds in which the feed is estimated from the times of engagement and release.
const MOST_ROUNDS: usize = 5;
/// A feed is found when what is left is so little of the clock's tolerance.
const NEAR: f64 = 0.1;
/// What marks tell of a feed, so many times its deviation away, is no chance: 1 in 370.
const BY_CHANCE: f64 = 3.0;
/// The feed really was between half and one and a half times what is stated, or the log is another program's.
const FEEDS: Range<f64> = 0.5..1.5;
/// A loss of time at one place is looked for so far, s.
const FARTHEST_LOSS_S: f64 = 30.0;

/// Lays a log over the program that ran.
///
/// # Errors
/// When the log does not belong to the program, with the reason.
pub fn align(run: &Run) -> Result<Alignment> {
    let limits = clipped::limits(run.log);
    let laid = cut_off(run, &limits);
    let engaged = |limit: &Limit| {
        is_within(run, limit) && laid.as_ref().map_or(true, |laid| is_on_arcs(laid, run, limit))
    };
    let (within, others): (Vec<Limit>, Vec<Limit>) = limits.iter().copied().partition(engaged);
    match engaged_throughout(run, within, &others) {
        Some(laid) => Ok(laid),
        None => laid.map_err(|error| said_to_be_cut_off(error, run, &limits)),
    }
}

/// As a bar that is cut off at some limits within its range, where it is engaged all the same: those readings tell when, and nothing
/// more. `None` where there is no such limit, one cuts ramps, or the log cannot be laid so.
fn engaged_throughout(run: &Run, mut within: Vec<Limit>, others: &[Limit]) -> Option<Alignment> {
    if within.is_empty() {
        return None;
    }
    let laid = cut_off(run, others).ok()?;
    if within.iter().any(|limit| cuts_ramps(&laid, run, limit)) {
        return None;
    }
    within.retain(|limit| !stood_at(&laid, run.log, limit));
    Some(if within.is_empty() { laid } else { laid.without(run.log, &within) })
}

/// Whether a limit is so near to the nominal length that no instrument reads it while it is out of range.
fn is_within(run: &Run, limit: &Limit) -> bool {
    limit.at_mm.abs() <= 0.5 * run.rig.bar.range_mm
}

/// How far the program holds the balls off at a reading, towards a limit, mm.
fn towards_mm(laid: &Alignment, run: &Run, limit: &Limit, sample: &Sample) -> f64 {
    let position_mm = laid.trajectory.at(sample.program_s).position_mm;
    run.rig.commanded_deviation_mm(&position_mm) * limit.at_mm.signum()
}

/// Whether readings on ramps are at a limit where the program is still beyond it: such ramps do not tell when the bar was engaged.
fn cuts_ramps(laid: &Alignment, run: &Run, limit: &Limit) -> bool {
    let at_limit = laid.readings_at(run.log, limit.at_mm).0;
    let mut on_ramps = at_limit.iter().filter(|sample| matches!(sample.part, Part::Ramp));
    on_ramps.any(|sample| towards_mm(laid, run, limit, sample) > limit.at_mm.abs())
}

/// Whether most readings at a limit are laid on arcs, and not where the bar is out of range: an instrument may read its limit there.
fn is_on_arcs(laid: &Alignment, run: &Run, limit: &Limit) -> bool {
    let (engaged, others) = laid.readings_at(run.log, limit.at_mm);
    let on_arcs = engaged.iter().filter(|sample| matches!(sample.part, Part::Arc(_)));
    2 * on_arcs.count() > engaged.len() + others.len()
}

/// Without what was cut off, at whichever of some limits.
fn cut_off(run: &Run, limits: &[Limit]) -> Result<Alignment> {
    // Millions of readings are not copied to take nothing out of them.
    if limits.is_empty() {
        return aligned(run);
    }
    let mut with_all_taken_out = None;
    // Readings at which the machine stood are none that were cut off: without them the log has a hole where the bar read.
    for taken_out in (0..1_usize << limits.len()).rev() {
        let is_taken_out = |k: usize| taken_out >> k & 1 == 1;
        let some = limits.iter().enumerate().filter(|(k, _)| is_taken_out(*k));
        let some: Vec<Limit> = some.map(|(_, limit)| *limit).collect();
        let (log, clipped) = clipped::without(run.log, &some);
        let laid = aligned(&Run { log: &log, ..*run }).map(|laid| Alignment { clipped, ..laid });
        let as_it_stood = |laid: &Alignment| {
            let stood = limits.iter().map(|limit| stood_at(laid, run.log, limit));
            stood.enumerate().all(|(k, stood)| stood != is_taken_out(k))
                && !some.iter().any(|limit| is_elsewhere(laid, run, limit))
        };
        if laid.as_ref().is_ok_and(as_it_stood) {
            return laid;
        }
        with_all_taken_out.get_or_insert(laid);
    }
    with_all_taken_out.unwrap_or_else(|| aligned(run))
}

/// A slide that hangs at a standstill still reads as there when its program has moved on for so long, s.
const HANGS_S: f64 = 0.1;

/// Whether the machine stood where readings are at a limit, as a quiet instrument reads one value throughout a dwell, and where
/// it moved they are not too many.
fn stood_at(laid: &Alignment, log: &Log, limit: &Limit) -> bool {
    let stands = |sample: &Sample| matches!(sample.part, Part::Dwell | Part::Stop);
    let (stood, mut moved): (Vec<Sample>, Vec<Sample>) =
        laid.readings_at(log, limit.at_mm).0.into_iter().partition(stands);
    let hangs = |moved: &Sample| {
        let after = stood.partition_point(|stood| stood.log_s < moved.log_s);
        let beside = &stood[after.saturating_sub(1)..stood.len().min(after + 1)];
        beside.iter().any(|stood| (moved.log_s - stood.log_s).abs() <= HANGS_S)
    };
    moved.retain(|moved| !hangs(moved));
    let next = laid.readings_at(log, limit.next_mm).0;
    let next = next.iter().filter(|sample| !stands(sample));
    !stood.is_empty() && !Limit::is_piled(moved.len(), next.count())
}

/// Whether most readings at a limit are laid where the program holds the balls as far off the other way: nothing was cut off
/// there, and the bar was engaged before.
fn is_elsewhere(laid: &Alignment, run: &Run, limit: &Limit) -> bool {
    let (engaged, others) = laid.readings_at(run.log, limit.at_mm);
    let half_mm = 0.5 * run.rig.bar.range_mm;
    let elsewhere = others.iter().filter(|of| towards_mm(laid, run, limit, of) < -half_mm);
    2 * elsewhere.count() > engaged.len() + others.len()
}

/// That readings are at a limit, where they cannot be laid over their program.
fn said_to_be_cut_off(error: Error, run: &Run, limits: &[Limit]) -> Error {
    let at = |limit: &Limit| {
        let at_mm = run.log.readings().iter().filter_map(|reading| reading.deviation_mm);
        (limit.at_mm, at_mm.filter(|mm| mm.total_cmp(&limit.at_mm).is_eq()).count())
    };
    // A bar that reads its limit while it is out of range is not to blame.
    let within = limits.iter().find(|limit| is_within(run, limit));
    let Some((cut_mm, count)) = within.map(at) else { return error };
    let hint = format!(
        "{count} readings are exactly {:.1} um, and none lies beyond: they were cut off there; find the limit of the bar, its amplifier or the program that wrote the log, and repeat the run",
        1e3 * cut_mm
    );
    Error { hint: Some(hint), ..error }
}

fn aligned(run: &Run) -> Result<Alignment> {
    let mut ways = engagement::observed(run).into_iter();
    let first = ways.next().unwrap_or_default();
    let found = at_real_feed(run, &first);
    let (mut draft, excess) =
        found.or_else(|error| ways.find_map(|way| at_real_feed(run, &way).ok()).ok_or(error))?;
    draft.find_pauses(run.log);
    draft.time_map.override_excess = excess.share;
    draft.time_map.override_sigma = excess.sigma;
    Ok(draft.laid(run))
}

/// By how much the real feed differs from the programmed one times the stated override.
#[derive(Debug, Clone, Copy, Default)]
struct Excess {
    /// As a share of 1.
    share: f64,
    /// Its standard deviation; 0 where it was not estimated.
    sigma: f64,
}

/// The log laid over the program at the feed that really was, with standstills as the program says; where that does not come
/// out, within what they plausibly take. A release and the next engagement may be known to a millisecond each, and where the
/// acceleration is not the stated one the pause of two seconds between them is a poor measure of a feed.
fn at_real_feed(run: &Run, observed: &[Range<usize>]) -> Result<(Draft, Excess)> {
    let consistent = |standing_s: f64| {
        let (mut draft, excess) = at_feed_of(run, observed, standing_s)?;
        if excess.sigma > 0.0 {
            draft.time_map.fit_marks(&draft.marks, run.rig.bar.clock_tolerance, true)?;
        }
        refuse_inconsistent(run.log, &draft.time_map, &draft.marks)?;
        Ok((draft, excess))
    };
    let error = match consistent(UNEQUAL_DELAY_S) {
        Ok(found) => return Ok(found),
        Err(error) => error,
    };
    consistent(EXCESS_S).map_err(|_: Error| error)
}

/// The same with each standstill within so much of the program's, s: what the clock cannot explain is the feed, unless it was
/// lost at one place. What is left after some rounds is what it is.
fn at_feed_of(run: &Run, observed: &[Range<usize>], standing_s: f64) -> Result<(Draft, Excess)> {
    let clock_tolerance = run.rig.bar.clock_tolerance;
    let mut excess = Excess::default();
    let (strict, any_feed) = (engagement::DURATION_TOLERANCE, engagement::ANY_FEED_TOLERANCE);
    let drafted =
        |feed: f64, tolerance: f64| Draft::new(run, observed, run.feed_override * feed, tolerance);
    let (mut draft, refused) = match drafted(1.0, strict) {
        Ok(draft) => (draft, None),
        // A log that was cut off has lost its time at its end.
        Err(error) if is_cut_off(run.log) => return Err(error),
        // Perhaps the feed was another one.
        Err(error) => match drafted(1.0, any_feed) {
            Ok(draft) => (draft, Some(error)),
            Err(_) => return Err(error),
        },
    };
    // At what feed it was driven is in the times of a motion that was recorded.
    let most_rounds = if run.driven.is_some() { 0 } else { MOST_ROUNDS };
    for round in 0..most_rounds {
        // The clock's tolerance would hold the rate back.
        let mut at_any_rate = draft.time_map.clone();
        at_any_rate.fit_marks_at_any_rate(&draft.marks, standing_s)?;
        let (rate, rate_sigma) = (at_any_rate.rate, at_any_rate.rate_sigma);
        // Marks between two readings of a slow log hardly move a rate that is held, however far off the feed is.
        let explained = draft.time_map.rate.abs() < 1.5 * clock_tolerance
            && rate.abs() < (1.5 * clock_tolerance).hypot(BY_CHANCE * rate_sigma);
        // Once it is the feed, longer standstills must not make up for a feed that went too far.
        if explained && (round == 0 || rate.abs() < NEAR * clock_tolerance) {
            break;
        }
        draft.time_map = at_any_rate;
        let total = draft.trajectory.duration();
        let share = total.known_s() / total.feed_s.max(1e-9);
        excess = Excess {
            share: (1.0 + excess.share) * (1.0 + rate * share) - 1.0,
            sigma: clock_tolerance.hypot(rate_sigma) * share,
        };
        if round == 0 {
            let longer_s = (rate.abs() * draft.trajectory.end_s()).min(FARTHEST_LOSS_S);
            draft.time_map = draft.time_map.at_equal_rates(&draft.marks);
            refuse_step(run.log, &draft.laid(run), longer_s)?;
        }
        let feed = 1.0 + excess.share;
        draft = match (drafted(feed, strict), &refused) {
            (Ok(draft), _) => draft,
            (Err(_), Some(_)) if FEEDS.contains(&feed) => drafted(feed, any_feed)?,
            (Err(error), _) => return Err(refused.unwrap_or(error)),
        };
    }
    match refused {
        // After all the durations are those of the program at that feed.
        Some(error) if drafted(1.0 + excess.share, strict).is_err() => Err(error),
        _ => Ok((draft, excess)),
    }
}

/// Whether the bar reads in the first line of a log or in its last.
fn is_cut_off(log: &Log) -> bool {
    let ends = [log.readings().first(), log.readings().last()];
    ends.into_iter().flatten().any(|reading| reading.deviation_mm.is_some())
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
    .at(Place::file(log.file()))
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
    .at(Place::file(log.file()))
    .hint(hint))
}
