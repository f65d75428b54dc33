//! Where chords and reversals of the program put a leg whose time is known coarsely.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::input::RunInput;
use super::record::Apart;
use super::timing::{Detail, SMOOTH_S, TURNING_S, stride, view};
use crate::align::{MarkKind, Part, Sample, TimeMap};
use crate::machine::Pose;
use crate::model::Model;

/// And of a leg without chords, or with long ones, of its reversals, s.
const CATCH_S: f64 = 0.02;
/// Farther than this from the smooth fit no facet is looked for, s.
const FARTHEST_S: f64 = 2.0;
/// Steps of the search in a catch.
const STEPS_A_CATCH: f64 = 8.0;
/// And most steps either way.
const MOST_STEPS: f64 = 800.0;
/// Neighbouring readings are not independent: their misfits count half.
const CORRELATED: f64 = 2.0;

/// Offsets that are known to this, s, are inside the catch of a leg's facets: a quarter of a chord.
pub(super) fn catch_s(map: &TimeMap, leg: usize) -> f64 {
    let chord_s = map.chords[leg].lasts_s;
    if chord_s > 0.0 { (0.25 * chord_s).min(CATCH_S) } else { CATCH_S }
}

/// Which legs are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// All.
    First,
    /// Those whose facets were not found.
    Again,
}

/// Moves the offset of every coarsely known leg to where the facets of the commanded path and the steps
/// at the reversals fit best, if they tell it.
///
/// For a shift `d` the slow part of the prediction is held, and what is told by steps and facets is
/// looked up anew. With `S(d)` the sum of squares with steps alone, as near as slides turn round with the program, `G(d)` by how much facets lower it, `s²` the least mean
/// of what is left, and `sigma` what is known of the offset otherwise,
///
/// `p(d) ~ exp(-S(d) / 2 s² - d² / 2 sigma²) (1 + exp(G(d) / 2 s²)) / 2`:
///
/// a control may as well have rounded all facets out. Where its deviation is more than the catch of a facet, or where the
/// pace lets times differ by more along the leg, the slope at a reading is not that of its chord: the path counts by
/// its mean, and `p` by its mean and its variance, what `sigma` knows left out. Whether the facets of any leg were
/// found that were not known before.
pub(super) fn find(model: &Model, values: &[f64], run: &mut RunInput, look: Look) -> bool {
    let mut found = false;
    let stride = stride(run.samples().len());
    for leg in run.alignment.legs() {
        let map = &run.alignment.time_map;
        let (sigma_s, catch_s, chord_s) =
            (map.offset_sigmas_s[leg], catch_s(map, leg), map.chords[leg].lasts_s);
        if look == Look::Again && map.chords[leg].blur_s <= 0.0 {
            continue;
        }
        if sigma_s < 0.1 * catch_s {
            found |= map.chords[leg].blur_s > 0.0;
            run.alignment.time_map.chords[leg].see();
            continue;
        }
        let held = LegReadings::of_leg(model, values, run, leg, stride);
        // By so much times differ along the leg that no offset takes up.
        let along_s = 0.5 * held.lasts_s() * map.rate_sigma.hypot(map.pace_sigma);
        let visible = chord_s > 0.0 && along_s < catch_s;
        // Where the offset lies by all but what chords and reversals told before, as a shift from here.
        let [prior_s, sigma_s] =
            map.chords[leg].untold_s(map.offsets_s[leg], map.offset_sigmas_s[leg]);
        if !visible && run.alignment.steps(leg) {
            // What the program steps the machine steps back: where neither is seen by itself, they tell no time.
            run.alignment.time_map.chords[leg].blur(sigma_s, None);
            continue;
        }
        let reach_s = (4.0 * sigma_s).clamp(5.0 * catch_s, FARTHEST_S);
        let step_s = (catch_s / STEPS_A_CATCH).max(reach_s / MOST_STEPS);
        let reach = (reach_s / step_s).ceil() as i32;
        let shifts = (-reach..=reach).into_par_iter().map(|k| f64::from(k) * step_s);
        let misfits: Vec<(f64, Misfit)> =
            shifts.map(|shift_s| (shift_s, held.misfit(shift_s, visible))).collect();
        let left = misfits.iter().map(|(_, misfit)| misfit.steps - misfit.facets);
        let least = left.fold(f64::INFINITY, f64::min);
        let scale = CORRELATED * least / held.readings.len().max(1) as f64;
        if scale <= 0.0 {
            continue;
        }
        let cost = |shift_s: f64, misfit: &Misfit| {
            let gain = 0.5 * misfit.facets / scale;
            // ln(1 + exp(gain)), whatever the gain
            let seen = gain.max(0.0) + (-gain.abs()).exp().ln_1p();
            0.5 * (misfit.steps / scale + ((shift_s - prior_s) / sigma_s).powi(2)) - seen
        };
        let costs: Vec<(f64, f64)> =
            misfits.iter().map(|(shift_s, misfit)| (*shift_s, cost(*shift_s, misfit))).collect();
        let peaks = peaks(&costs);
        let Some(best) = peaks.iter().min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
        let [mass, first_s, second_s2, outside_s2] = moments(&costs, best.0, catch_s);
        let map = &mut run.alignment.time_map;
        let outside_s = (outside_s2 / mass).sqrt();
        if visible && outside_s < catch_s {
            found |= map.chords[leg].blur_s > 0.0;
            map.chords[leg].see();
            map.offsets_s[leg] -= best.0;
            map.offset_sigmas_s[leg] = step_s;
            map.chords[leg].ambiguity_s = outside_s;
            continue;
        }
        let mean_s = best.0 + first_s / mass;
        let variance_s2 = (second_s2 / mass - (first_s / mass).powi(2)).max(step_s.powi(2));
        let told = variance_s2.recip() - sigma_s.powi(2).recip();
        let told_s = (told > 0.0).then(|| {
            let shift_s = (mean_s / variance_s2 - prior_s / sigma_s.powi(2)) / told;
            [map.offsets_s[leg] - shift_s, told.recip().sqrt().hypot(along_s)]
        });
        map.chords[leg].blur(sigma_s, told_s);
    }
    found
}

/// A leg that leaves this many times the mean square of the others did not find its facets.
const SUSPICIOUS: f64 = 1.5;

/// A leg that may lie some chords off, and where else it could lie.
pub(super) struct Doubt {
    pub(super) leg: usize,
    /// Shifts of the leg, s, the best first.
    pub(super) shifts_s: Vec<f64>,
}

/// Legs without a ramp whose chords were found and that fit worse than the others do, now that the coefficients are known, by the
/// samples that take part: why the others do not is told. A leg that counts by its mean lies on no chord.
///
/// The coefficients have adapted to a wrong leg as well as they could, so a better place need not look
/// better before they are fitted again: the caller tries each.
pub(super) fn doubts(
    model: &Model,
    values: &[f64],
    run: &RunInput,
    apart: &[Option<Apart>],
) -> Vec<Doubt> {
    let stride = stride(run.samples().len());
    let of_leg = |leg: usize| {
        let taken = run.samples().iter().zip(apart).step_by(stride);
        taken
            .filter(move |(sample, apart)| sample.leg == leg && apart.is_none())
            .map(|taken| taken.0)
    };
    let left_mm2 = |leg: usize| {
        let left_mm2 = of_leg(leg)
            .map(|sample| view(model, values, run, sample, Detail::Full).residual_mm.powi(2));
        left_mm2.sum::<f64>() / of_leg(leg).count().max(1) as f64
    };
    let misfit = |leg: usize, shift_s: f64| {
        let misfits = of_leg(leg).map(|sample| {
            let state = run.alignment.trajectory.at_near(sample.program_s + shift_s, sample.block);
            let pose = Pose { position_mm: state.position_mm, sense: state.sense };
            let length_mm = model.length_mm(values, &pose, &sample.motion, run.mounting);
            (sample.deviation_mm - (length_mm - run.nominal_mm)).powi(2)
        });
        misfits.sum::<f64>()
    };
    let map = &run.alignment.time_map;
    let mut legs = run.alignment.legs();
    legs.retain(|leg| map.chords[*leg].blur_s <= 0.0);
    let found: Vec<f64> = legs.iter().map(|&leg| left_mm2(leg)).collect();
    let mut sorted = found.clone();
    sorted.sort_by(f64::total_cmp);
    let Some(usual) = sorted.get(sorted.len() / 2) else { return Vec::new() };
    // A ramp tells the time of its leg.
    let coarse = |leg: usize| {
        let marks = &mut run.alignment.marks.iter();
        !marks.any(|m| m.kind != MarkKind::Standstill && map.leg_of(m.program_s) == leg)
    };
    let suspicious = legs
        .iter()
        .zip(&found)
        .filter(|(leg, found)| coarse(**leg) && **found > SUSPICIOUS * usual);
    suspicious
        .map(|(&leg, _)| {
            let catch_s = catch_s(map, leg);
            let step_s = 2.0 * catch_s / STEPS_A_CATCH;
            let reach = (10.0 * catch_s / step_s) as i32;
            let curve: Vec<(f64, f64)> = (-reach..=reach)
                .map(|k| f64::from(k) * step_s)
                .map(|shift_s| (shift_s, misfit(leg, shift_s)))
                .collect();
            let lowest_near = |peak: &(f64, f64)| {
                let near = curve.iter().filter(|one| (one.0 - peak.0).abs() < 2.0 * catch_s);
                near.fold(f64::INFINITY, |lowest, one| lowest.min(one.1)) >= peak.1
            };
            let mut elsewhere = peaks(&curve);
            // Places of a leg are a chord apart: what lies nearer to a lower one is noise.
            elsewhere.retain(|peak| peak.0.abs() > catch_s && lowest_near(peak));
            elsewhere.sort_by(|a, b| a.1.total_cmp(&b.1));
            Doubt { leg, shifts_s: elsewhere.iter().map(|peak| peak.0).collect() }
        })
        .collect()
}

/// Of shifts with minus the logarithm of how likely each is: mass, and moments about one of them, s and s²; the last one of those that
/// are more than a catch from it. The likeliest has the mass 1.
fn moments(costs: &[(f64, f64)], about_s: f64, catch_s: f64) -> [f64; 4] {
    // Of a curve that still falls at an end no peak is the lowest.
    let lowest = costs.iter().fold(f64::INFINITY, |lowest, one| lowest.min(one.1));
    costs.iter().fold([0.0; 4], |[mass, first, second, outside], (shift_s, cost)| {
        let (weight, aside_s) = ((lowest - cost).exp(), shift_s - about_s);
        let square = weight * aside_s.powi(2);
        // Inside the catch the fit tells the offset and how well it does.
        let outside = if aside_s.abs() > catch_s { outside + square } else { outside };
        [mass + weight, first + weight * aside_s, second + square, outside]
    })
}

/// Lowest points of a sampled curve, each between its samples by the parabola through three of them. How low is what was
/// sampled: beside a step a parabola goes far below.
fn peaks(curve: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let lowest =
        curve.windows(3).filter(|three| three[1].1 <= three[0].1 && three[1].1 <= three[2].1);
    let mut peaks: Vec<(f64, f64)> = lowest
        .map(|three| {
            let (left, middle, right) = (three[0].1, three[1].1, three[2].1);
            let bend = left - 2.0 * middle + right;
            let share = if bend > 0.0 { 0.5 * (left - right) / bend } else { 0.0 };
            let step_s = three[1].0 - three[0].0;
            (three[1].0 + share * step_s, middle)
        })
        .collect();
    if peaks.is_empty() {
        peaks.extend(curve.iter().min_by(|a, b| a.1.total_cmp(&b.1)));
    }
    peaks
}

/// The least that may be left of a sample whose middle is so long after a reversal of the program, from what is left with the
/// senses before and after it, mm: its slide turns up to [`TURNING_S`] earlier or later. A single reading is read on one
/// side, the mean of a window on both.
fn turning_mm([before_mm, after_mm]: [f64; 2], since_s: f64, window_s: f64) -> f64 {
    let ends_mm = [-TURNING_S, TURNING_S].map(|earlier_s| {
        let since_s = since_s + earlier_s;
        let after = if window_s > 0.0 {
            (since_s / window_s + 0.5).clamp(0.0, 1.0)
        } else {
            f64::from(u8::from(since_s > 0.0))
        };
        before_mm + after * (after_mm - before_mm)
    });
    let [one_mm, other_mm] = ends_mm;
    if window_s > 0.0 && one_mm * other_mm < 0.0 {
        0.0
    } else if one_mm.abs() < other_mm.abs() {
        one_mm
    } else {
        other_mm
    }
}

/// What a shift of a leg leaves.
struct Misfit {
    /// Sum of squares with the steps at reversals, mm².
    steps: f64,
    /// By how much facets lower it, mm².
    facets: f64,
}

/// The readings of a leg, each with what a shift of the leg leaves of its prediction.
struct LegReadings<'a> {
    model: &'a Model<'a>,
    values: &'a [f64],
    run: &'a RunInput,
    /// Sample, and its reading minus the slow part of the prediction, mm.
    readings: Vec<(&'a Sample, f64)>,
    reversals_s: Vec<f64>,
}

impl<'a> LegReadings<'a> {
    fn of_leg(
        model: &'a Model<'a>,
        values: &'a [f64],
        run: &'a RunInput,
        leg: usize,
        stride: usize,
    ) -> Self {
        let readings = run
            .samples()
            .iter()
            .step_by(stride)
            .filter(|s| s.leg == leg && matches!(s.part, Part::Arc(_)))
            .map(|sample| {
                let view = view(model, values, run, sample, Detail::Smooth);
                (sample, view.residual_mm)
            })
            .collect();
        let reversals_s = run.alignment.trajectory.reversals_s();
        Self { model, values, run, readings, reversals_s }
    }

    /// From the first of its readings to the last, s.
    fn lasts_s(&self) -> f64 {
        let [first, last] = [self.readings.first(), self.readings.last()]
            .map(|reading| reading.map_or(0.0, |(sample, _)| sample.program_s));
        last - first
    }

    /// Over so long a sample goes, s; 0 of a single reading.
    fn window_s(&self) -> f64 {
        let alignment = &self.run.alignment;
        if alignment.averaged > 1 { alignment.sample_period_s } else { 0.0 }
    }

    /// Sum of squares with steps a shift later, and by how much facets lower it.
    ///
    /// `min over a of sum (left - a (facet - mean facet))²`, `0 <= a <= 1`: by how much a control rounds facets out is not
    /// known yet.
    fn misfit(&self, shift_s: f64, visible: bool) -> Misfit {
        let alignment = &self.run.alignment;
        let (coincidence_mm, trajectory) = (alignment.coincidence_mm(), &alignment.trajectory);
        let length_mm = |pose: &Pose, sample: &Sample| {
            self.model.length_mm(self.values, pose, &sample.motion, self.run.mounting)
        };
        let window_s = self.window_s();
        let zone_s = TURNING_S + 0.5 * window_s;
        let pairs: Vec<[f64; 2]> = self
            .readings
            .iter()
            .map(|(sample, slow_mm)| {
                let program_s = sample.program_s + shift_s;
                let state = trajectory.at_near(program_s, sample.block);
                let mean_mm = |over_s: f64| alignment.mean_mm(sample.leg, program_s, over_s);
                // A sample that is the mean of readings has the mean of the facets that went by.
                let commanded_mm = if window_s > 0.0 {
                    mean_mm(window_s)
                } else {
                    (state.position_mm - coincidence_mm).norm() - alignment.radius_mm
                };
                let facet_mm = commanded_mm - mean_mm(SMOOTH_S);
                // With senses and steps of the path as they are at another time.
                let left_mm = |then_s: f64, sense: Vector3<f64>| {
                    let left_mm =
                        slow_mm - alignment.steps_mm(sample.leg, sample.program_s, then_s);
                    if sense == sample.pose.sense {
                        return left_mm;
                    }
                    let turned = Pose { sense, ..sample.pose };
                    left_mm - (length_mm(&turned, sample) - length_mm(&sample.pose, sample))
                };
                let before = self.reversals_s.partition_point(|s| *s < program_s - zone_s);
                let near = self.reversals_s.get(before).filter(|s| **s < program_s + zone_s);
                let least_mm = match near {
                    None => left_mm(program_s, state.sense),
                    Some(&reversal_s) => {
                        let sides = [-zone_s, zone_s].map(|aside_s| {
                            let then_s = program_s + aside_s;
                            left_mm(then_s, trajectory.at_near(then_s, state.block).sense)
                        });
                        turning_mm(sides, program_s - reversal_s, window_s)
                    }
                };
                [least_mm, facet_mm]
            })
            .collect();
        let mean_mm = pairs.iter().map(|pair| pair[1]).sum::<f64>() / pairs.len().max(1) as f64;
        let (mut left, mut both, mut facets) = (0.0, 0.0, 0.0);
        for [left_mm, facet_mm] in pairs {
            let (left_mm, aside_mm) = (left_mm - mean_mm, facet_mm - mean_mm);
            left += left_mm.powi(2);
            both += left_mm * aside_mm;
            facets += aside_mm.powi(2);
        }
        if !visible || facets <= 0.0 {
            return Misfit { steps: left, facets: 0.0 };
        }
        let share = (both / facets).clamp(0.0, 1.0);
        Misfit { steps: left, facets: share * (2.0 * both - share * facets) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leg_that_lies_beyond_all_shifts_has_moments() {
        // A peak at 0 that a million tells from the end, where it still falls.
        let costs = [(-2.0, 2e6), (-1.0, 1e6 + 1.0), (0.0, 1e6), (1.0, 1e6 + 1.0), (2.0, 0.0)];
        assert_eq!(peaks(&costs)[0].0.total_cmp(&0.0), std::cmp::Ordering::Equal);
        let told = moments(&costs, 0.0, 1.5);
        assert!(
            told.iter().zip([1.0, 2.0, 4.0, 4.0]).all(|(a, b)| (a - b).abs() < 1e-12),
            "{told:?}"
        );
    }

    #[test]
    fn a_mean_over_a_reversal_lies_between_its_sides_and_a_reading_on_one_of_them() {
        let is = |since_s: f64, window_s: f64, mm: f64| {
            assert!((turning_mm([1.0, -3.0], since_s, window_s) - mm).abs() < 1e-12, "{since_s}");
        };
        // Of a window of 20 ms up to 10 ms earlier or later: at the reversal any mixture, 15 ms past it at least three quarters.
        is(0.0, 0.02, 0.0);
        is(0.015, 0.02, -2.0);
        is(-0.02, 0.02, 1.0);
        is(0.02, 0.02, -3.0);
        is(-0.005, 0.0, 1.0);
        is(0.005, 0.0, 1.0);
        is(0.011, 0.0, -3.0);
    }
}
