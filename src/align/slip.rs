//! Steps of the readings where the machine moves on smoothly: a bar that slipped in its clamp.
//!
//! On either side of a moment the readings of a moment are a straight line. Where the two lines do not meet something stepped: by how
//! much is known to what the lines of other moments miss each other by.

use std::sync::Arc;

use super::engaged::Slip;
use super::samples::{Alignment, Part, Sample};
use crate::log::{Log, Reading};
use crate::solve;

/// The length of a line on either side, s: on a circle of 100 mm at 1500 mm/min 4 degrees, which misses an eccentricity of
/// 20 um by 0.1 um.
const SIDE_S: f64 = 0.25;
/// But so many samples at least, of which a line takes two.
const FEWEST: usize = 6;
/// Beside a slide that turns round a line of one side of that is not longer. What a slide does there steps readings, too, once each time;
/// which it was, a fit tells. Through two readings a line that leads over a step misses the other one by as much as the step.
const SHORTEST: usize = 3;
/// Lines that miss each other by more than so many times what is usual in the run are a step.
const FAR_OFF: f64 = 10.0;
/// And no slide turns round so near to either line, s, beside three standard deviations of its time: slides follow late
/// by some 30 ms at the most.
const LATE_S: f64 = 0.05;
/// What is bent somewhat more than usual makes a few of them at most.
const MOST: usize = 3;

impl Alignment {
    /// Moments at which the readings step, the largest first: away from where a slide turns round, then beside.
    pub fn steps_of_readings(&self) -> Vec<Slip> {
        let samples = self.samples();
        let side = ((SIDE_S / self.sample_period_s) as usize).max(FEWEST);
        let turns_s = self.trajectory.reversals_s();
        let turns_beside = |k: usize| {
            let first = &samples[k.saturating_sub(side)];
            let last = &samples[(k + side).min(samples.len() - 1)];
            let from_s = first.program_s - 3.0 * first.time_sigma_s - LATE_S;
            let to_s = last.program_s + 3.0 * last.time_sigma_s + LATE_S;
            turns_s.get(turns_s.partition_point(|t| *t < from_s)).is_some_and(|t| *t <= to_s)
        };
        let mut away = self.missed(side);
        away.retain(|(k, _)| !turns_beside(*k));
        let beside = self.missed(SHORTEST);
        let [scale_mm, beside_mm] = [&away, &beside].map(|of| scale_mm(of));
        let mut steps = self.far_off(away, scale_mm, side, MOST);
        let beside = beside.into_iter().filter(|(k, _)| turns_beside(*k)).collect();
        steps.extend(self.far_off(beside, beside_mm, side, turns_s.len()));
        steps
    }

    /// By how much the lines through so many samples on either side of a sample miss each other there, mm, where the bar is engaged.
    fn missed(&self, side: usize) -> Vec<(usize, f64)> {
        let samples = self.samples();
        let longest_s = Log::GAP_PERIODS * self.sample_period_s;
        let missed = |k: usize| {
            // The sample in between may be a mean over the step.
            let (before, after) = (&samples[k - side..k], &samples[k + 1..=k + side]);
            let at_s = samples[k].log_s;
            let quiet = smooth(before, longest_s) && smooth(after, longest_s);
            quiet.then(|| (k, line_at_mm(after, at_s) - line_at_mm(before, at_s)))
        };
        (side..samples.len().saturating_sub(side)).filter_map(missed).collect()
    }

    /// So many of what lines miss each other by, the largest that are far from what is usual.
    fn far_off(
        &self,
        mut missed: Vec<(usize, f64)>,
        usual_mm: f64,
        side: usize,
        most: usize,
    ) -> Vec<Slip> {
        missed.retain(|(_, step_mm)| step_mm.abs() > FAR_OFF * usual_mm);
        missed.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        let mut steps: Vec<(usize, f64)> = Vec::new();
        for (k, step_mm) in missed {
            if steps.len() < most && steps.iter().all(|(other, _)| k.abs_diff(*other) > side) {
                steps.push((k, step_mm));
            }
        }
        let samples = self.samples();
        let slip = |(k, step_mm): (usize, f64)| {
            let (log_s, line) = self.largest_change(samples[k - 1].log_s, samples[k + 1].log_s)?;
            Some(Slip { log_s, line, step_mm, sigma_mm: usual_mm })
        };
        steps.into_iter().filter_map(slip).collect()
    }

    /// Where neighbouring readings differ most between two times of the log: the time, and the line after it.
    fn largest_change(&self, from_s: f64, to_s: f64) -> Option<(f64, usize)> {
        let reach_s = from_s - self.sample_period_s..=to_s + self.sample_period_s;
        let readings = || self.engaged.readings(&self.slips);
        let within = |reading: &Reading| reach_s.contains(&reading.time_s);
        let neighbours = readings().zip(readings().skip(1));
        let between = neighbours.filter(|(before, after)| within(before) && within(after));
        let changes = between.filter_map(|(before, after)| {
            let change_mm = (after.deviation_mm? - before.deviation_mm?).abs();
            Some((change_mm, 0.5 * (before.time_s + after.time_s), after.line))
        });
        let largest = changes.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((largest.1, largest.2))
    }

    /// The same with a step taken out of the readings after it.
    #[must_use]
    pub fn without_step(mut self, slip: Slip) -> Self {
        let half_s = 0.5 * self.sample_period_s;
        let windows = Arc::make_mut(&mut self.windows);
        // A mean over the step is neither before it nor after.
        if self.averaged > 1 {
            windows.retain(|window| (window.time_s - slip.log_s).abs() > half_s);
        }
        for reading in windows {
            if reading.time_s > slip.log_s {
                reading.deviation_mm = reading.deviation_mm.map(|mm| mm - slip.step_mm);
            }
        }
        self.slips.push(slip);
        self
    }
}

/// What lines usually miss each other by, mm.
fn scale_mm(missed: &[(usize, f64)]) -> f64 {
    let mut missed_mm: Vec<f64> = missed.iter().map(|of| of.1).collect();
    solve::robust_scale(&mut missed_mm).unwrap_or(f64::INFINITY)
}

/// Whether the bar is engaged throughout, without a gap.
fn smooth(side: &[Sample], longest_s: f64) -> bool {
    side.iter().all(|sample| matches!(sample.part, Part::Arc(_) | Part::Dwell))
        && side.windows(2).all(|two| two[1].log_s - two[0].log_s <= longest_s)
}

/// Where the least-squares line through samples is at a time of the log, mm.
fn line_at_mm(side: &[Sample], at_s: f64) -> f64 {
    let count = side.len() as f64;
    let middle_s = side.iter().map(|sample| sample.log_s).sum::<f64>() / count;
    let middle_mm = side.iter().map(|sample| sample.deviation_mm).sum::<f64>() / count;
    let (mut squares, mut products) = (0.0, 0.0);
    for sample in side {
        let t = sample.log_s - middle_s;
        squares += t * t;
        products += t * (sample.deviation_mm - middle_mm);
    }
    middle_mm + products / squares * (at_s - middle_s)
}
