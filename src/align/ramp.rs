//! Ramps: the reading runs through the range at a known speed, which makes it a clock.

use std::ops::Range;

use super::engagement::Engagement;
use super::run::Run;
use crate::log::Log;
use crate::motion::Trajectory;
use crate::plan::BallBar;

/// What a mark was read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkKind {
    /// The feed-in runs through the bar's range.
    Engagement,
    /// The feed-out runs through the bar's range.
    Release,
    /// The reading stood still until then: the end of an operator's pause.
    Standstill,
    /// The log states angles in place of times: the middle of an arc.
    Angle,
}

/// A moment known on both clocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// On the instrument's clock, s.
    pub log_s: f64,
    /// In program time, s.
    pub program_s: f64,
    /// Standard deviation of their difference, s.
    pub sigma_s: f64,
    /// What it was read from.
    pub kind: MarkKind,
    /// How many samples of a ramp made it; 0 where only the edge of the range is known.
    pub samples: usize,
}

/// What the delays of two ramps differ by, s. Axes follow their commands late by some milliseconds; what all
/// ramps of a leg have in common is another offset and does no harm, but other axes drive another ramp.
pub(super) const UNEQUAL_DELAY_S: f64 = 1e-3;

/// Slides that follow a ramp with a lag of the first order plausibly have this time constant, s.
const LAG_S: f64 = 0.02;

/// By how much a reading at a height over the foot of a ramp may be later than what all of the ramp has in common, s.
///
/// With the lag `T` and the speed `v` a reading is late by `T` as long as it stands higher than `v T`. Below that it comes
/// to rest as `v T exp(-t / T)`, later by `T (ln(v T / h) - 1 + h / v T)`.
fn later_near_foot_s(height_mm: f64, speed_mm_s: f64) -> f64 {
    let share = height_mm / (speed_mm_s * LAG_S).max(f64::MIN_POSITIVE);
    if share < 1.0 { LAG_S * (share - 1.0 - share.ln()) } else { 0.0 }
}

/// The mark of one end of an engagement, which the log shows as a stretch of readings.
///
/// A ramp reading `d` was taken when the commanded length was `d - c`, with `c` the deviation right
/// after the engagement (or before the release), where the machine stands or is on its arc: the set-up
/// error and the machine's errors there drop out.
pub(super) fn mark(
    run: &Run,
    trajectory: &Trajectory,
    engagement: &Engagement,
    stretch: &Range<usize>,
    kind: MarkKind,
) -> Mark {
    let (log, bar) = (run.log, run.rig.bar);
    let engages = kind == MarkKind::Engagement;
    let period_s = log.sample_period_s();
    let edge_program_s = if engages { engagement.start_s } else { engagement.end_s };
    let deviation_mm =
        |time_s: f64| run.rig.commanded_deviation_mm(&trajectory.at(time_s).position_mm);
    // Samples from the edge of the range inwards.
    let inwards: Vec<usize> =
        if engages { stretch.clone().collect() } else { stretch.clone().rev().collect() };
    let foot_s = foot_of_ramp_s(edge_program_s, engages, &deviation_mm, bar);
    let ramp_s = (foot_s - edge_program_s).abs();
    let edge_log_s = inwards.first().map_or(0.0, |&first| log.readings()[first].time_s);
    let offset_mm = settled_mm(log, &inwards, ramp_s);
    let sign = if deviation_mm(edge_program_s) > 0.0 { 1.0 } else { -1.0 };
    let speed_mm_s =
        |time_s: f64| ((deviation_mm(time_s + 1e-4) - deviation_mm(time_s - 1e-4)) / 2e-4).abs();
    let edge_speed_mm_s = speed_mm_s(edge_program_s);
    let steps_s = steps_mm(run, trajectory, [edge_program_s, foot_s]) / edge_speed_mm_s.max(1e-3);
    let mut sum = (0.0, 0.0, 0.0);
    let mut samples = 0;
    for &index in &inwards {
        let reading = log.readings()[index];
        let Some(value_mm) = reading.deviation_mm else { continue };
        let level_mm = value_mm - offset_mm;
        // Near its foot the ramp is slow and says little; samples past it say nothing.
        if sign * level_mm < 0.05 * bar.range_mm || (reading.time_s - edge_log_s).abs() > ramp_s {
            break;
        }
        let program_s = bisect(edge_program_s, foot_s, level_mm, &deviation_mm);
        let sigma_s = (bar.noise_mm.hypot(bar.resolution_mm) / speed_mm_s(program_s).max(1e-3))
            .hypot(UNEQUAL_DELAY_S)
            .hypot(later_near_foot_s(sign * level_mm, edge_speed_mm_s));
        let weight = 1.0 / (sigma_s * sigma_s);
        sum = (sum.0 + weight, sum.1 + weight * reading.time_s, sum.2 + weight * program_s);
        samples += 1;
    }
    if samples > 0 {
        // The following error is common to the samples of a ramp: no gain from their number there.
        let sigma_s = (1.0 / sum.0).sqrt().max(UNEQUAL_DELAY_S).hypot(steps_s);
        return Mark { log_s: sum.1 / sum.0, program_s: sum.2 / sum.0, sigma_s, kind, samples };
    }
    // No sample on the ramp: the edge lies within one period outside the first reading.
    let half_s = if engages { -0.5 * period_s } else { 0.5 * period_s };
    Mark {
        log_s: edge_log_s + half_s,
        program_s: 0.5 * (edge_program_s + foot_s),
        sigma_s: (period_s + ramp_s) / 12.0_f64.sqrt(),
        kind,
        samples,
    }
}

/// Over so long past the foot of a ramp readings are counted, s.
const SETTLED_S: f64 = 1.0;

/// What the machine plausibly steps by from a ramp, from its edge to its foot, to the readings past it, mm: a slide that turns round
/// in between has a reversal error or a lateral play.
fn steps_mm(run: &Run, trajectory: &Trajectory, [edge_s, foot_s]: [f64; 2]) -> f64 {
    let past_s = foot_s + 0.5 * SETTLED_S * (foot_s - edge_s).signum();
    let [ramp, past] = [edge_s, past_s].map(|time_s| trajectory.at(time_s).sense);
    let turned = ramp.iter().zip(&past).filter(|(ramp, past)| *ramp * *past < 0.0).count();
    2.0 * run.rig.machine.plausible().reversal_mm * (turned as f64).sqrt()
}

/// The deviation past the foot of a ramp, by a second of readings there, mm; `inwards` are those from the edge on.
fn settled_mm(log: &Log, inwards: &[usize], ramp_s: f64) -> f64 {
    let edge_s = inwards.first().map_or(0.0, |&first| log.readings()[first].time_s);
    let past_s = ramp_s + log.sample_period_s();
    let settled: Vec<f64> = inwards
        .iter()
        .map(|&index| log.readings()[index])
        .skip_while(|r| (r.time_s - edge_s).abs() < past_s)
        .take_while(|r| (r.time_s - edge_s).abs() < past_s + SETTLED_S)
        .filter_map(|r| r.deviation_mm)
        .collect();
    if settled.is_empty() { 0.0 } else { settled.iter().sum::<f64>() / settled.len() as f64 }
}

/// How high the outermost reading of a ramp stands over its foot, and how high it should.
#[derive(Debug, Clone, Copy)]
pub(super) struct Height {
    /// As it was read, mm; above 0 on the side of the foot on which the program has it.
    pub(super) read_mm: f64,
    /// As the program has it half a sample period inside the range, mm.
    pub(super) programmed_mm: f64,
}

/// The height of a ramp, where it is slow enough that a reading must stand high on it.
pub(super) fn height(
    run: &Run,
    trajectory: &Trajectory,
    engagement: &Engagement,
    stretch: &Range<usize>,
    kind: MarkKind,
) -> Option<Height> {
    let (log, bar) = (run.log, run.rig.bar);
    let engages = kind == MarkKind::Engagement;
    let (edge_s, inwards_s) =
        if engages { (engagement.start_s, 1.0) } else { (engagement.end_s, -1.0) };
    let deviation_mm =
        |time_s: f64| run.rig.commanded_deviation_mm(&trajectory.at(time_s).position_mm);
    let sign = deviation_mm(edge_s).signum();
    let later_mm =
        |periods: f64| sign * deviation_mm(edge_s + inwards_s * periods * log.sample_period_s());
    let foot_s = foot_of_ramp_s(edge_s, engages, &deviation_mm, bar);
    let period_in_ramp = log.sample_period_s() < (foot_s - edge_s).abs();
    if !period_in_ramp || later_mm(1.0) < HIGH * bar.range_mm {
        return None;
    }
    let inwards: Vec<usize> =
        if engages { stretch.clone().collect() } else { stretch.clone().rev().collect() };
    let outermost_mm = log.readings()[*inwards.first()?].deviation_mm?;
    let offset_mm = settled_mm(log, &inwards, (foot_s - edge_s).abs());
    Some(Height { read_mm: sign * (outermost_mm - offset_mm), programmed_mm: later_mm(0.5) })
}

/// A reading that must stand higher on a ramp than this share of the range tells the unit: an inch is 25 mm, and with a
/// bar that reads a little less than is stated there is room still.
const HIGH: f64 = 0.25;

/// Where the ramp meets the sphere: the commanded deviation stops falling, or reaches zero.
fn foot_of_ramp_s(
    edge_s: f64,
    engages: bool,
    deviation_mm: &dyn Fn(f64) -> f64,
    bar: &BallBar,
) -> f64 {
    let step_s = if engages { 1e-3 } else { -1e-3 };
    let mut time_s = edge_s;
    // A feed-in slower than 5 mm/min through the range would take longer than this.
    for _ in 0..30_000 {
        let next = deviation_mm(time_s + step_s).abs();
        if next < 1e-4 * bar.range_mm || next >= deviation_mm(time_s).abs() {
            break;
        }
        time_s += step_s;
    }
    time_s
}

/// The time between edge and foot at which the commanded deviation is `level_mm`.
fn bisect(edge_s: f64, foot_s: f64, level_mm: f64, deviation_mm: &dyn Fn(f64) -> f64) -> f64 {
    let (mut outer, mut inner) = (edge_s, foot_s);
    // A reading beyond the range by the offset lies outside the edge: extend by one ramp.
    outer -= 0.2 * (inner - outer);
    for _ in 0..60 {
        let middle = 0.5 * (outer + inner);
        if deviation_mm(middle).abs() > level_mm.abs() { outer = middle } else { inner = middle }
    }
    0.5 * (outer + inner)
}
