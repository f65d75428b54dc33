//! Where chords and reversals of the program put a leg whose time is known coarsely.

use super::input::RunInput;
use super::timing::{Detail, stride, view};
use crate::align::{MarkKind, Part, Sample};
use crate::machine::Pose;
use crate::model::Model;

/// Offsets that are known to this, s, are inside the catch of the facets: a chord of a usual program
/// takes some 80 ms, and rounding gives every one its own height.
pub(super) const FACET_S: f64 = 0.02;
/// Farther than this from the smooth fit no facet is looked for, s.
const FARTHEST_S: f64 = 2.0;
/// Step of the search, s.
const SEARCH_STEP_S: f64 = 0.0025;
/// Neighbouring readings are not independent: their misfits count half.
const CORRELATED: f64 = 2.0;

/// Moves the offset of every coarsely known leg to where the facets of the commanded path and the steps
/// at the reversals fit best, and states what else fits nearly as well.
///
/// For a shift `d` the slow part of the prediction is held, and what is told by steps and facets is
/// looked up anew. With `S(d)` the sum of squares, `s²` its least mean and `sigma` what the smooth fit
/// left of the offset,
///
/// `p(d) ~ exp(-S(d) / 2 s² - d² / 2 sigma²)`.
///
/// Chords that rounding does not tell apart leave several peaks a chord apart; what lies outside the
/// highest one becomes the offset's ambiguity.
pub(super) fn find(model: &Model, values: &[f64], run: &mut RunInput) {
    let stride = stride(Detail::Smooth, run.samples().len());
    for leg in run.alignment.legs() {
        let sigma_s = run.alignment.time_map.offset_sigmas_s[leg];
        if sigma_s < 0.1 * FACET_S {
            continue;
        }
        let held = LegReadings::of_leg(model, values, run, leg, stride);
        let reach = ((4.0 * sigma_s).clamp(0.1, FARTHEST_S) / SEARCH_STEP_S).ceil() as i32;
        let misfits: Vec<(f64, f64)> = (-reach..=reach)
            .map(|k| f64::from(k) * SEARCH_STEP_S)
            .map(|shift_s| (shift_s, held.misfit(shift_s)))
            .collect();
        let peaks = peaks(&misfits);
        let least = peaks.iter().map(|m| m.1).fold(f64::INFINITY, f64::min);
        let scale = CORRELATED * least / held.readings.len().max(1) as f64;
        if scale <= 0.0 {
            continue;
        }
        let cost =
            |(shift_s, misfit): &(f64, f64)| 0.5 * (misfit / scale + (shift_s / sigma_s).powi(2));
        let Some(best) = peaks.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))) else { continue };
        let (mut mass, mut outside_s2) = (0.0, 0.0);
        for other in &peaks {
            let weight = (cost(best) - cost(other)).exp();
            mass += weight;
            outside_s2 += weight * (other.0 - best.0).powi(2);
        }
        let map = &mut run.alignment.time_map;
        map.offsets_s[leg] -= best.0;
        map.offset_sigmas_s[leg] = SEARCH_STEP_S;
        map.ambiguities_s[leg] = (outside_s2 / mass).sqrt();
    }
}

/// How far a settled leg is looked up again, s: some chords either way.
const AGAIN_S: f64 = 0.2;
/// A leg that leaves this many times the mean square of the others did not find its facets.
const SUSPICIOUS: f64 = 1.5;

/// A leg that may lie some chords off, and where else it could lie.
pub(super) struct Doubt {
    pub(super) leg: usize,
    /// Shifts of the leg, s, the best first.
    pub(super) shifts_s: Vec<f64>,
}

/// Legs without a ramp that fit worse than the others do, now that the coefficients are known.
///
/// The coefficients have adapted to a wrong leg as well as they could, so a better place need not look
/// better before they are fitted again: the caller tries each.
pub(super) fn doubts(model: &Model, values: &[f64], run: &RunInput) -> Vec<Doubt> {
    let stride = stride(Detail::Smooth, run.samples().len());
    let misfit = |leg: usize, shift_s: f64| {
        let of_leg = run.samples().iter().step_by(stride);
        let of_leg = of_leg.filter(|s| s.leg == leg && matches!(s.part, Part::Arc(_)));
        let (mut sum, mut count) = (0.0, 0.0_f64);
        for sample in of_leg {
            let state = run.alignment.trajectory.at(sample.program_s + shift_s);
            let pose = Pose { position_mm: state.position_mm, sense: state.sense };
            let length_mm = model.length_mm(values, &pose, &sample.motion, run.mounting);
            sum += (sample.deviation_mm - (length_mm - run.nominal_mm)).powi(2);
            count += 1.0;
        }
        sum / count.max(1.0)
    };
    let map = &run.alignment.time_map;
    let legs = run.alignment.legs();
    let found: Vec<f64> = legs.iter().map(|&leg| misfit(leg, 0.0)).collect();
    let mut sorted = found.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted[sorted.len() / 2];
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
            let reach = (AGAIN_S / (2.0 * SEARCH_STEP_S)) as i32;
            let curve: Vec<(f64, f64)> = (-reach..=reach)
                .map(|k| f64::from(k) * 2.0 * SEARCH_STEP_S)
                .map(|shift_s| (shift_s, misfit(leg, shift_s)))
                .collect();
            let mut elsewhere = peaks(&curve);
            elsewhere.retain(|peak| peak.0.abs() > FACET_S);
            elsewhere.sort_by(|a, b| a.1.total_cmp(&b.1));
            Doubt { leg, shifts_s: elsewhere.iter().map(|peak| peak.0).collect() }
        })
        .collect()
}

/// Lowest points of a sampled curve, between its samples, each by the parabola through three of them:
/// two chords must not be told apart by how near a sample happens to lie.
fn peaks(curve: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let lowest =
        curve.windows(3).filter(|three| three[1].1 <= three[0].1 && three[1].1 <= three[2].1);
    let mut peaks: Vec<(f64, f64)> = lowest
        .map(|three| {
            let (left, middle, right) = (three[0].1, three[1].1, three[2].1);
            let bend = left - 2.0 * middle + right;
            let share = if bend > 0.0 { 0.5 * (left - right) / bend } else { 0.0 };
            let step_s = three[1].0 - three[0].0;
            (three[1].0 + share * step_s, middle - 0.25 * (left - right) * share)
        })
        .collect();
    if peaks.is_empty() {
        peaks.extend(curve.iter().min_by(|a, b| a.1.total_cmp(&b.1)));
    }
    peaks
}

/// The readings of a leg, each with what a shift of the leg leaves of its prediction.
struct LegReadings<'a> {
    model: &'a Model<'a>,
    values: &'a [f64],
    run: &'a RunInput,
    /// Sample, and its reading minus the slow part of the prediction, mm.
    readings: Vec<(&'a Sample, f64)>,
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
        Self { model, values, run, readings }
    }

    /// Sum of squares with steps and facets a shift later, mm².
    fn misfit(&self, shift_s: f64) -> f64 {
        let coincidence_mm = self.run.alignment.coincidence_mm();
        let length_mm = |pose: &Pose, sample: &Sample| {
            self.model.length_mm(self.values, pose, &sample.motion, self.run.mounting)
        };
        self.readings
            .iter()
            .map(|(sample, slow_mm)| {
                let state = self.run.alignment.trajectory.at(sample.program_s + shift_s);
                let facet_mm = (state.position_mm - coincidence_mm).norm() - self.run.nominal_mm;
                let step_mm = if state.sense == sample.pose.sense {
                    0.0
                } else {
                    let turned = Pose { sense: state.sense, ..sample.pose };
                    length_mm(&turned, sample) - length_mm(&sample.pose, sample)
                };
                (slow_mm - facet_mm - step_mm).powi(2)
            })
            .sum()
    }
}
