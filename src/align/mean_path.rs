//! The commanded length along a leg, in its mean over a while: what is left of a path where its chords and the rounding of
//! its blocks are not told.
//!
//! Where the program steps at a reversal the mean steps, too: the machine steps there against it, at once, and a mean over both
//! would tell the time of the reversal by what is not there.

use nalgebra::Vector3;

use super::path_steps::{PathStep, path_steps};
use super::section::Section;
use crate::motion::Trajectory;

/// Points of a chord at which the path is looked at.
const POINTS_A_CHORD: f64 = 8.0;
/// Without chords it is looked at every so often, s.
const STEP_S: f64 = 5e-3;
/// And at most so many times in a leg.
const MOST_POINTS: f64 = 100_000.0;

/// Commanded length minus radius along the arcs of a leg.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MeanPath {
    /// From where to where each arc goes, s of program time.
    arcs_s: Vec<[f64; 2]>,
    step_s: f64,
    /// Integral of the path without its steps from the start of the first arc to each point, mm s.
    sums: Vec<f64>,
    /// Where it steps, and the sum of all steps until then and this one, mm.
    steps: Vec<(PathStep, f64)>,
}

impl MeanPath {
    /// Of the arcs that begin in a span of program time, with chords that take so long, s; `None` where there are none.
    pub(super) fn of(
        trajectory: &Trajectory,
        arcs: &[Section],
        coincidence_mm: &Vector3<f64>,
        radius_mm: f64,
        chord_s: f64,
    ) -> Option<Self> {
        let (first, last) = (arcs.first()?, arcs.last()?);
        let lasts_s = last.end_s - first.start_s;
        let finest_s = if chord_s > 0.0 { chord_s / POINTS_A_CHORD } else { STEP_S };
        let step_s = finest_s.max(lasts_s / MOST_POINTS);
        let points = (lasts_s / step_s).ceil() as usize;
        let beyond_mm =
            |then_s: f64| (trajectory.at(then_s).position_mm - coincidence_mm).norm() - radius_mm;
        let arcs_s: Vec<[f64; 2]> = arcs.iter().map(|arc| [arc.start_s, arc.end_s]).collect();
        let reversals_s = trajectory.reversals_s();
        let of_arc =
            |arc: &[f64; 2]| path_steps(trajectory, &reversals_s, *arc, chord_s, &beyond_mm);
        let mut sum_mm = 0.0;
        let summed = arcs_s.iter().flat_map(of_arc).map(|step| {
            sum_mm += step.by_mm;
            (step, sum_mm)
        });
        let mut path = Self { steps: summed.collect(), arcs_s, step_s, sums: vec![0.0] };
        let smooth_mm = |k: usize| {
            let then_s = (first.start_s + k as f64 * step_s).min(last.end_s);
            let smooth_mm = |at_s: f64| beyond_mm(at_s) - path.stepped_mm(at_s);
            let Some(step) = path.step_at(then_s, 0.0) else { return smooth_mm(then_s) };
            // Straight across the blocks that step.
            let [from_s, to_s] = step.over_s;
            let share = (then_s - from_s) / (to_s - from_s);
            (1.0 - share) * smooth_mm(from_s) + share * smooth_mm(to_s)
        };
        let mut before_mm = smooth_mm(0);
        let mut sums = vec![0.0];
        for k in 1..=points {
            let here_mm = smooth_mm(k);
            sums.push(sums[k - 1] + 0.5 * step_s * (before_mm + here_mm));
            before_mm = here_mm;
        }
        path.sums = sums;
        Some(path)
    }

    /// The step that the path leads over within so long of a program time, s.
    pub(super) fn step_at(&self, program_s: f64, within_s: f64) -> Option<&PathStep> {
        let ended = |step: &PathStep| step.over_s[1] <= program_s - within_s;
        let next = self.steps.get(self.steps.partition_point(|(step, _)| ended(step)));
        next.map(|(step, _)| step).filter(|step| step.over_s[0] < program_s + within_s)
    }

    /// The sum of all steps until a program time, mm.
    pub(super) fn stepped_mm(&self, program_s: f64) -> f64 {
        let until = self.steps.partition_point(|(step, _)| step.turns_s <= program_s);
        until.checked_sub(1).map_or(0.0, |last| self.steps[last].1)
    }

    /// Whether it steps anywhere.
    pub(super) fn steps(&self) -> bool {
        !self.steps.is_empty()
    }

    /// `1 / T * integral of (length - radius - stepped)` over `T` about a program time, mm; near the end of an arc over less, so
    /// that all of it lies on the arc.
    pub(super) fn smooth_mm(&self, program_s: f64, over_s: f64) -> f64 {
        let next = self.arcs_s.partition_point(|arc| arc[0] <= program_s);
        let [start_s, end_s] = self.arcs_s[next.saturating_sub(1)];
        let at_s = program_s.clamp(start_s, end_s);
        let half_s = (0.5 * over_s).min(at_s - start_s).min(end_s - at_s).max(self.step_s);
        let (low_s, high_s) = ((at_s - half_s).max(start_s), (at_s + half_s).min(end_s));
        (self.integral(high_s) - self.integral(low_s)) / (high_s - low_s)
    }

    /// From the start of the first arc, mm s.
    fn integral(&self, program_s: f64) -> f64 {
        let place = ((program_s - self.arcs_s[0][0]) / self.step_s).max(0.0);
        let below = (place as usize).min(self.sums.len().saturating_sub(2));
        let above = (below + 1).min(self.sums.len() - 1);
        self.sums[below] + (place - below as f64) * (self.sums[above] - self.sums[below])
    }
}
