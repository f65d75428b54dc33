//! Where chords and reversals of the program put a leg whose time is known coarsely.

use rayon::prelude::*;

use super::input::RunInput;
use super::leg_path::Senses;
use super::leg_readings::{LegReadings, Misfit};
use super::timing::stride;
use crate::align::TimeMap;
use crate::model::Model;

/// And of a leg without chords, or with long ones, of its reversals, s.
const CATCH_S: f64 = 0.02;
/// Farther than this from the smooth fit no facet is looked for, s.
const FARTHEST_S: f64 = 2.0;
/// Steps of the search in a catch.
pub(super) const STEPS_A_CATCH: f64 = 8.0;
/// And where no other place is looked at, but how much of its facets is left: a sixteenth of a chord.
const STEPS_WITHIN: f64 = 4.0;
/// And most steps either way.
const MOST_STEPS: f64 = 800.0;
/// Neighbouring readings are not independent: their misfits count half.
const CORRELATED: f64 = 2.0;

/// Offsets that are known to this, s, are inside the catch of a leg's facets: a quarter of a chord.
pub(super) fn catch_s(map: &TimeMap, leg: usize) -> f64 {
    let chord_s = map.chords[leg].lasts_s;
    if chord_s > 0.0 { (0.25 * chord_s).min(CATCH_S) } else { CATCH_S }
}

/// Known to this part of its catch a leg is not looked for elsewhere.
const KNOWN: f64 = 0.1;
/// Logarithm of a thousand.
const LN_1000: f64 = 6.9;
/// What a control may leave of facets, or slides that follow.
const PARTS: [f64; 2] = [0.5, 0.25];

/// Which legs are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// All.
    First,
    /// Those whose facets do not count yet; of the others only whether they were driven.
    Again,
}

/// Moves the offset of every coarsely known leg to where the facets of the commanded path and the steps
/// at the reversals fit best, if they tell it.
///
/// For a shift `d` the slow part of the prediction is held, and what is told by steps and facets is
/// looked up anew. With `S(d)` the sum of squares with steps alone, as near as slides turn round with the program, `G(d)` by how
/// much facets lower it, `s²` the least mean of what is left, and `sigma` what is known of the offset otherwise,
///
/// `p(d) ~ exp(-S(d) / 2 s² - d² / 2 sigma²) (1 + exp(G(d) / 2 s²)) / 2`:
///
/// a control may as well have rounded all facets out, and where all legs together [tell](are_rounded_out) that it has, `G` is
/// nothing. There, where the deviation of the offset is more than the catch of a facet, or where the
/// pace lets times differ by more along the leg, the slope at a reading is not that of its chord: the path counts by
/// its mean, and `p` by its mean and its variance, what `sigma` knows left out. Whether any leg counts otherwise than before.
pub(super) fn find(model: &Model, values: &[f64], run: &mut RunInput, look: Look) -> bool {
    let senses = Senses::of(&run.alignment.trajectory);
    let of_leg = |leg: usize| Looked::of_leg(model, values, (run, &senses), leg, look);
    let looked: Vec<Looked> = run.alignment.legs().into_iter().filter_map(of_leg).collect();
    let rounded_out = are_rounded_out(&looked);
    let map = &mut run.alignment.time_map;
    looked.iter().fold(false, |changed, looked| looked.lay(map, rounded_out) | changed)
}

/// Whether the facets of a path were rounded out: a thousand times likelier than that they were driven, and likelier than that a
/// part was. How much a control leaves is the same for all legs of a run. A part `a` changes how likely the readings of one are by
///
/// `∫ p(d) exp((2 a b(d) - a² f(d)) / 2 s²) dd`, `p(d) ~ exp(-S(d) / 4 s² - d² / 2 sigma²)`,
///
/// with `b` the product of facets with what is left without them and `f` their square. What hangs together among neighbours is slow
/// against facets: here each reading counts for itself, or what they have would be taken for what they have not.
fn are_rounded_out(looked: &[Looked]) -> bool {
    let visible = || looked.iter().filter(|looked| looked.visible);
    let likelier = |part: f64| visible().map(|looked| looked.likelier(part)).sum::<f64>();
    likelier(1.0) < -LN_1000 && PARTS.into_iter().all(|part| likelier(part) < 0.0)
}

/// A leg that was looked at.
struct Looked {
    leg: usize,
    /// Part of a chord within which facets tell the offset, s.
    catch_s: f64,
    /// By so much times differ along the leg that no offset takes up, s.
    along_s: f64,
    /// Between two shifts, s.
    step_s: f64,
    /// Where the offset lies by all but what chords and reversals told before, as a shift from here, and how well that is known, s.
    untold_s: [f64; 2],
    /// Whether no other place is looked at: the offset is known too well, or facets count already.
    known: bool,
    /// Whether times are known well enough along the leg for its facets to be seen.
    visible: bool,
    /// Whether the program steps where slides turn round.
    steps: bool,
    /// What the square of what is left is counted in, mm².
    scale_mm2: f64,
    misfits: Vec<(f64, Misfit)>,
}

impl Looked {
    /// None where nothing is left of its readings.
    fn of_leg(
        model: &Model,
        values: &[f64],
        (run, senses): (&RunInput, &Senses),
        leg: usize,
        look: Look,
    ) -> Option<Self> {
        let map = &run.alignment.time_map;
        let (catch_s, chords) = (catch_s(map, leg), &map.chords[leg]);
        let stride = stride(run.samples().len());
        let mut held = LegReadings::of_leg(model, values, (run, senses), leg, stride);
        let along_s = 0.5 * held.lasts_s() * map.rate_sigma.hypot(map.pace_sigma);
        let counts = look == Look::Again && chords.blur_s <= 0.0;
        let known = counts || map.offset_sigmas_s[leg] < KNOWN * catch_s;
        let visible = chords.there_are() && (known || along_s < catch_s);
        let steps = run.alignment.steps(leg);
        // Within the catch the fit finds a leg by itself, and its offset is no better than that beside what is not fitted yet.
        let untold_s = if known {
            [0.0, catch_s]
        } else {
            chords.untold_s(map.offsets_s[leg], map.offset_sigmas_s[leg])
        };
        let reach_s = if known {
            catch_s
        } else if steps && !visible {
            0.0
        } else {
            (4.0 * untold_s[1]).clamp(5.0 * catch_s, FARTHEST_S)
        };
        let a_catch = if known { STEPS_WITHIN } else { STEPS_A_CATCH };
        let step_s = (catch_s / a_catch).max(reach_s / MOST_STEPS);
        let reach = (reach_s / step_s).ceil() as i32;
        held.look_up(reach_s + step_s, catch_s / STEPS_A_CATCH, 2 * reach as usize + 1);
        let shifts = (-reach..=reach).into_par_iter().map(|k| f64::from(k) * step_s);
        let misfits: Vec<(f64, Misfit)> =
            shifts.map(|shift_s| (shift_s, held.misfit(shift_s, visible))).collect();
        let left = misfits.iter().map(|(_, misfit)| misfit.steps_mm2 - misfit.facets_mm2());
        let least_mm2 = left.fold(f64::INFINITY, f64::min) / held.readings.len().max(1) as f64;
        let scale_mm2 = 2.0 * CORRELATED * least_mm2;
        (scale_mm2 > 0.0).then_some(Self {
            leg,
            catch_s,
            along_s,
            step_s,
            untold_s,
            known,
            visible,
            steps,
            scale_mm2,
            misfits,
        })
    }

    /// Minus the logarithm of how likely a shift is without facets.
    fn cost(&self, shift_s: f64, misfit: &Misfit) -> f64 {
        let [prior_s, sigma_s] = self.untold_s;
        misfit.steps_mm2 / self.scale_mm2 + 0.5 * ((shift_s - prior_s) / sigma_s).powi(2)
    }

    /// By how much likelier its readings are with this part of its facets than without any, as a logarithm.
    fn likelier(&self, part: f64) -> f64 {
        let with_and_without = |(shift_s, misfit): &(f64, Misfit)| {
            let cost = self.cost(*shift_s, misfit);
            [cost - CORRELATED * misfit.part_mm2(part) / self.scale_mm2, cost]
        };
        let costs: Vec<[f64; 2]> = self.misfits.iter().map(with_and_without).collect();
        let [with, without] = [0, 1].map(|which| {
            let of = || costs.iter().map(|costs| costs[which]);
            let lowest = of().fold(f64::INFINITY, f64::min);
            of().map(|cost| (lowest - cost).exp()).sum::<f64>().ln() - lowest
        });
        with - without
    }

    /// Lays the leg where it fits best; whether its facets count now and did not, or no more.
    fn lay(&self, map: &mut TimeMap, rounded_out: bool) -> bool {
        let (leg, visible) = (self.leg, self.visible && !rounded_out);
        let counted = map.chords[leg].blur_s <= 0.0;
        let [prior_s, sigma_s] = self.untold_s;
        if self.known {
            let changes = self.visible && counted == rounded_out;
            match (changes, counted) {
                (true, true) => map.chords[leg].blur(map.offset_sigmas_s[leg], None),
                (true, false) => map.chords[leg].see(),
                (false, _) => {}
            }
            return changes;
        }
        if !visible && self.steps {
            // What the program steps the machine steps back: where neither is seen by itself, they tell no time.
            map.chords[leg].blur(sigma_s, None);
            return false;
        }
        let cost = |(shift_s, misfit): &(f64, Misfit)| {
            let gain = if visible { misfit.facets_mm2() / self.scale_mm2 } else { 0.0 };
            // ln(1 + exp(gain)), whatever the gain
            let seen = gain.max(0.0) + (-gain.abs()).exp().ln_1p();
            (*shift_s, self.cost(*shift_s, misfit) - seen)
        };
        let costs: Vec<(f64, f64)> = self.misfits.iter().map(cost).collect();
        let peaks = peaks(&costs);
        let Some(best) = peaks.iter().min_by(|a, b| a.1.total_cmp(&b.1)) else { return false };
        let [mass, first_s, second_s2, outside_s2] = moments(&costs, best.0, self.catch_s);
        let outside_s = (outside_s2 / mass).sqrt();
        if visible && outside_s < self.catch_s {
            map.chords[leg].see();
            map.offsets_s[leg] -= best.0;
            map.offset_sigmas_s[leg] = self.step_s;
            map.chords[leg].ambiguity_s = outside_s;
            return !counted;
        }
        let mean_s = best.0 + first_s / mass;
        let variance_s2 = (second_s2 / mass - (first_s / mass).powi(2)).max(self.step_s.powi(2));
        let told = variance_s2.recip() - sigma_s.powi(2).recip();
        let told_s = (told > 0.0).then(|| {
            let shift_s = (mean_s / variance_s2 - prior_s / sigma_s.powi(2)) / told;
            [map.offsets_s[leg] - shift_s, told.recip().sqrt().hypot(self.along_s)]
        });
        map.chords[leg].blur(sigma_s, told_s);
        false
    }
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
pub(super) fn peaks(curve: &[(f64, f64)]) -> Vec<(f64, f64)> {
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

    /// Sixteen legs, with so much left of their facets at one place of 21, and elsewhere nothing. Where it is where, chance decides.
    fn legs(left: f64, squares_mm2: f64) -> Vec<Looked> {
        let mut drawn: u64 = 3;
        let mut uniform = || {
            drawn = drawn.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (drawn >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let mut looked = |leg: usize| Looked {
            leg,
            catch_s: 1e-3,
            along_s: 0.0,
            step_s: 1e-3,
            untold_s: [0.0, 0.02],
            known: false,
            visible: true,
            steps: false,
            // Twice two times the variance of a reading, 1 mm².
            scale_mm2: 4.0,
            misfits: (-10..=10)
                .map(|k| {
                    let is = if k == 3 { left * squares_mm2 } else { 0.0 };
                    let both_mm2 = is + squares_mm2.sqrt() * normal();
                    (1e-3 * f64::from(k), Misfit { steps_mm2: 200.0, both_mm2, squares_mm2 })
                })
                .collect(),
        };
        (0..16).map(&mut looked).collect()
    }

    #[test]
    fn all_legs_together_tell_whether_facets_were_rounded_out() {
        // All of them tell it, and no leg alone.
        for squares_mm2 in [6.0, 30.0] {
            assert!(are_rounded_out(&legs(0.0, squares_mm2)), "{squares_mm2}");
        }
        assert!(!are_rounded_out(&legs(0.0, 6.0)[..1]) && !are_rounded_out(&[]));
        // What has facets is not taken for what has none, however small they are; nor what has a half of them that can be seen.
        for squares_mm2 in [0.1, 1.0, 3.0, 6.0, 10.0, 30.0] {
            assert!(!are_rounded_out(&legs(1.0, squares_mm2)), "{squares_mm2}");
        }
        assert!(!are_rounded_out(&legs(0.5, 60.0)));
    }
}
