//! The commanded length along a leg, in its mean over a while: what is left of a path where its chords and the rounding of
//! its blocks are not told.

use nalgebra::Vector3;

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
    /// Integral from the start of the first arc to each point, mm s.
    sums: Vec<f64>,
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
        let beyond_mm = |k: usize| {
            let then_s = (first.start_s + k as f64 * step_s).min(last.end_s);
            (trajectory.at(then_s).position_mm - coincidence_mm).norm() - radius_mm
        };
        let mut sums = vec![0.0];
        let mut before_mm = beyond_mm(0);
        for k in 1..=points {
            let here_mm = beyond_mm(k);
            sums.push(sums[k - 1] + 0.5 * step_s * (before_mm + here_mm));
            before_mm = here_mm;
        }
        let arcs_s = arcs.iter().map(|arc| [arc.start_s, arc.end_s]).collect();
        Some(Self { arcs_s, step_s, sums })
    }

    /// `1 / T * integral of (length - radius)` over `T` about a program time, mm; near the end of an arc over less, so that
    /// all of it lies on the arc.
    pub(super) fn mean_mm(&self, program_s: f64, over_s: f64) -> f64 {
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
