//! Steps of time inside a leg: readings that are missing without a gap in the log's times, or a machine
//! that stood where the program does not say so.
//!
//! A program of chords and rounded coordinates gives every chord its own height over the sphere, some
//! 0.3 um. Between neighbouring readings that pattern outweighs all that an error of the machine can
//! change, so it tells the time of each arc by itself, without any model: where the differences of the
//! readings fit those of the commanded length best.

use super::samples::{Alignment, Part, Sample};

/// The time of an arc by the pattern of its chords.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArcTime {
    /// Index of the section.
    pub section: usize,
    /// What has to be added to the program time of its samples, s.
    pub shift_s: f64,
    /// By how many standard deviations it fits better than the next best, some chords away.
    pub lead: f64,
}

/// A step of time between two arcs of one leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeStep {
    /// The last section before it.
    pub before: usize,
    /// The first section after it.
    pub after: usize,
    /// How much program time passed there that is not in the log, s; negative where the log has more.
    pub lost_s: f64,
    /// By how much that plausibly differs from what passes at other arcs, s: standstills are not alike.
    pub sigma_s: f64,
}

/// Step of the search, s; at 1500 mm/min a chord of 0.65 mm takes 26 ms.
const GRID_S: f64 = 0.005;
/// Fewer differences than this say nothing.
const FEWEST: usize = 60;
/// With less lead than this the next best may be the right one.
const LEAD: f64 = 3.0;
/// Weakest pattern that is looked for, mm rms: much less drowns in the resolution.
const PATTERN_MM: f64 = 5e-5;

/// How well the differences of the readings fit the commanded ones at one shift.
struct Fit {
    /// In steps of the search.
    shift: i64,
    /// Correlation, as the root of the sum of squares that it explains, mm.
    effect_mm: f64,
    /// Sum of squares that is left, mm².
    rest_mm2: f64,
    used: usize,
}

impl Fit {
    fn at(shift: i64, pairs: &[(i64, i64, f64)], lengths_mm: &[f64]) -> Option<Self> {
        let length_mm =
            |cell: i64| usize::try_from(cell + shift).ok().and_then(|cell| lengths_mm.get(cell));
        let (mut products, mut squares, mut all, mut used) = (0.0, 0.0, 0.0, 0);
        for &(from, to, change_mm) in pairs {
            let (Some(from_mm), Some(to_mm)) = (length_mm(from), length_mm(to)) else { continue };
            let commanded_mm = to_mm - from_mm;
            products += commanded_mm * change_mm;
            squares += commanded_mm * commanded_mm;
            all += change_mm * change_mm;
            used += 1;
        }
        if used < FEWEST || squares < used as f64 * PATTERN_MM * PATTERN_MM {
            return None;
        }
        let effect_mm = products / squares.sqrt();
        Some(Self { shift, effect_mm, rest_mm2: all - effect_mm * effect_mm, used })
    }
}

impl Alignment {
    /// The time of every arc whose chords tell it; shifts are looked for this far either way.
    pub fn arc_times(&self, reach_s: f64) -> Vec<ArcTime> {
        let samples = self.samples();
        (0..self.sections.len())
            .filter_map(|section| self.arc_time(section, &samples, reach_s))
            .collect()
    }

    fn arc_time(&self, index: usize, samples: &[Sample], reach_s: f64) -> Option<ArcTime> {
        let section = &self.sections[index];
        let on_arc: Vec<&Sample> = samples.iter().filter(|s| s.part == Part::Arc(index)).collect();
        // Neighbours without a gap, so that what changes slowly drops out.
        let longest_s = crate::log::Log::GAP_PERIODS * self.sample_period_s;
        let cell = |time_s: f64| ((time_s - section.start_s) / GRID_S).round() as i64;
        let pairs: Vec<(i64, i64, f64)> = on_arc
            .windows(2)
            .filter(|two| two[1].log_s - two[0].log_s <= longest_s)
            .map(|two| {
                let change_mm = two[1].deviation_mm - two[0].deviation_mm;
                (cell(two[0].program_s), cell(two[1].program_s), change_mm)
            })
            .collect();
        let count = ((section.end_s - section.start_s) / GRID_S) as i64;
        let lengths_mm: Vec<f64> = (0..=count)
            .map(|k| {
                let at = self.trajectory.at(section.start_s + k as f64 * GRID_S);
                (at.position_mm - self.coincidence_mm()).norm()
            })
            .collect();
        let reach = (reach_s / GRID_S) as i64;
        let fits: Vec<Fit> =
            (-reach..=reach).filter_map(|shift| Fit::at(shift, &pairs, &lengths_mm)).collect();
        let best = fits.iter().max_by(|a, b| a.effect_mm.total_cmp(&b.effect_mm))?;
        // The sagitta alone repeats with every chord: only the rounding tells one chord from the next.
        let chords = self.trajectory.block_at(section.end_s - 1e-6)
            - self.trajectory.block_at(section.start_s + 1e-6);
        let chord_s = (section.end_s - section.start_s) / (chords + 1) as f64;
        let lobe = (0.5 * chord_s / GRID_S).ceil() as i64;
        let others = fits.iter().filter(|fit| (fit.shift - best.shift).abs() > lobe);
        let second_mm = others.map(|fit| fit.effect_mm).fold(f64::NEG_INFINITY, f64::max);
        let scatter_mm = (best.rest_mm2 / best.used as f64).sqrt();
        let lead = (best.effect_mm - second_mm) / (std::f64::consts::SQRT_2 * scatter_mm);
        (lead.is_finite() && lead > LEAD).then_some(ArcTime {
            section: index,
            shift_s: best.shift as f64 * GRID_S,
            lead,
        })
    }

    /// The largest step of time between neighbouring arcs of one leg, beyond the drift that all of them
    /// share; `None` where fewer than four arcs of one leg tell their time.
    pub fn time_step(&self, reach_s: f64) -> Option<TimeStep> {
        let times = self.arc_times(reach_s);
        let leg = |time: &ArcTime| self.time_map.leg_of(self.sections[time.section].start_s);
        let offset_s = |time: &ArcTime| self.time_map.offsets_s[leg(time)];
        let stood_s = |first: &ArcTime, second: &ArcTime| offset_s(second) - offset_s(first);
        let mut steps: Vec<TimeStep> = times
            .windows(2)
            .filter(|two| self.time_map.hang_together(leg(&two[0]), leg(&two[1])))
            .map(|two| TimeStep {
                before: two[0].section,
                after: two[1].section,
                // A standstill between them may have taken in a part of it.
                lost_s: two[1].shift_s - two[0].shift_s - stood_s(&two[0], &two[1]),
                sigma_s: self.time_map.stands_s(leg(&two[0]), leg(&two[1]))[1],
            })
            .collect();
        if steps.len() < 3 {
            return None;
        }
        // Corners that the control takes slower than the model add the same at every arc, also at those that tell no time.
        let each_s = |step: &TimeStep| step.lost_s / (step.after - step.before) as f64;
        steps.sort_by(|a, b| each_s(a).total_cmp(&each_s(b)));
        let drift_s = each_s(&steps[steps.len() / 2]);
        steps
            .into_iter()
            .map(|step| {
                let drift_s = drift_s * (step.after - step.before) as f64;
                TimeStep { lost_s: step.lost_s - drift_s, ..step }
            })
            .max_by(|a, b| a.lost_s.abs().total_cmp(&b.lost_s.abs()))
    }
}
