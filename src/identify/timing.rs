//! How a sample's time enters the fit.

use nalgebra::Vector3;

use super::input::RunInput;
use super::state::Taking;
use crate::align::{Following, Sample};
use crate::machine::{ChainErrors, Pose};
use crate::model::{Model, Motion};

/// Over this long the path counts in its mean while times are known to a second, s.
pub(super) const SMOOTH_S: f64 = 0.4;
/// So near to a reversal the sense of a slide is not known, s: each slide follows the program late by some
/// milliseconds, and the offset of a leg takes on what they have in common only.
pub(super) const TURNING_S: f64 = 0.01;
/// What of the path a residual is taken against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// The commanded path with its chords and its rounding.
    Full,
    /// The sphere: chords and rounding count as noise, because a wrong time would misread them.
    Smooth,
}

impl Detail {
    /// What is kept from every reversal and every end of an arc at the least, s: while offsets are known to a second only, their
    /// stated sigma must not let in a sample with the wrong sense.
    pub(super) fn guard_s(self) -> f64 {
        match self {
            Self::Full => TURNING_S,
            Self::Smooth => 1.0,
        }
    }
}

/// So many samples of a run bring its offsets within reach of the facets; more only take longer.
const ENOUGH: usize = 20_000;
/// And so many bring all that is fitted to within its noise, of which a run has some hundred numbers at the most.
const ENOUGH_TO_FIT: usize = 5_000;

/// Every how many samples of a run one is looked at.
pub(super) fn stride(samples: usize) -> usize {
    samples.div_ceil(ENOUGH).max(1)
}

/// Samples of a run, by index, each of which stands for so many while a fit is sought: one of every so many, another one of
/// each. At even distances they might all lie at the same place of their chords.
pub(super) fn standing_for(samples: usize, taking: Taking) -> (usize, impl Iterator<Item = usize>) {
    let each = match taking {
        Taking::Each => 1,
        Taking::OneForSeveral => samples.div_ceil(ENOUGH_TO_FIT).max(1),
    };
    let taken = (0..samples.div_ceil(each)).map(move |k| {
        // The golden section fills an interval most evenly.
        let share = (k as f64 * 0.618_033_988_749_895).fract();
        k * each + (share * each as f64) as usize
    });
    (each, taken.filter(move |k| *k < samples))
}

/// A sample as the fit sees it.
pub(super) struct View {
    /// Measured minus predicted, mm.
    pub(super) residual_mm: f64,
    /// Change of the predicted deviation with time, mm/s.
    pub(super) speed_mm_s: f64,
    /// Change of the predicted deviation with the time constant with which the slides follow, mm/s.
    pub(super) following_mm_s: f64,
    /// Change of the predicted deviation with the delay of each slide, mm/s.
    pub(super) delayed_mm_s: Vector3<f64>,
    /// Change of the predicted deviation with the share by which the time constant of each slide is longer, its delay not counted,
    /// mm.
    pub(super) longer_mm: Vector3<f64>,
    /// By how much longer the bar were if corners of chords were wholly rounded out, mm; `None` where a share of none of them is.
    pub(super) rounding_mm: Option<f64>,
    /// What bends the chain there.
    pub(super) errors: ChainErrors,
}

/// By which share the time constant of one slide plausibly is longer than that of another: loops of one machine are tuned alike to a tenth.
pub(super) const LONGER: f64 = 0.1;
/// More than by this share none is, five of its deviations: no step makes a time constant negative.
pub(super) const FARTHEST: f64 = 0.5;
/// So far a step moves that time constant at the most, s.
pub(super) const STRIDE_S: f64 = 0.005;
/// What a control cuts off the corners of chords, or rounds them out by, is a part of how far chords are off their arc:
/// their mean lies two thirds of that inside, and a path that is driven smoothly anywhere about it.
pub(super) const CUT: f64 = 1.0 / 3.0;
/// And the share by which it rounds them out is anything from none to all.
pub(super) const ROUNDED: f64 = 1.0;
/// A step that is held is held to this.
pub(super) const HELD_SHARE: f64 = 1e-6;
/// Rounded corners and slides that follow both take chords away, and a step in one is right as far as the other stays: by so much
/// it goes at the most.
pub(super) const ROUNDED_STRIDE: f64 = 0.2;
/// Slides that are taken to follow at once do so within this, s: nothing, but not so much nothing that digits go.
pub(super) const AT_ONCE_S: f64 = 1e-7;
/// Half of the time over which the slope of single readings is taken, s.
const STEP_S: f64 = 2e-3;

/// Residual and speed of a sample.
///
/// The speed is taken with the senses held: the step at a reversal is no slope.
pub(super) fn view(
    model: &Model,
    values: &[f64],
    run: &RunInput,
    sample: &Sample,
    detail: Detail,
) -> View {
    let coincidence_mm = run.alignment.coincidence_mm();
    let map = &run.alignment.time_map;
    let velocity_mm_s = &sample.motion.velocity_mm_s;
    let late_mm = (map.delays_s - map.unlike_s()).component_mul(velocity_mm_s);
    // What the errors make of the length between the balls.
    let bent = |pose: &Pose, motion: &Motion| model.errors(values, pose, motion, run.mounting);
    let errs_mm = |pose: &Pose, motion: &Motion, errors: &ChainErrors| {
        let length_mm = model.bent_length_mm(values, errors, pose, motion, run.mounting);
        length_mm - (pose.position_mm - coincidence_mm).norm()
    };
    let length_mm = |position_mm: &Vector3<f64>| (position_mm - coincidence_mm).norm();
    // What a slide is late by is no facet.
    let all_late_mm = map.delays_s.component_mul(velocity_mm_s);
    let late_only_mm = |position_mm: &Vector3<f64>| {
        length_mm(position_mm) - length_mm(&(position_mm + all_late_mm))
    };
    let (facets_count, mean_s) = match detail {
        Detail::Full => (map.chords[sample.leg].blur_s <= 0.0, map.chords[sample.leg].blur_s),
        Detail::Smooth => (false, SMOOTH_S),
    };
    let ball_mm = sample.pose.position_mm - coincidence_mm;
    let along = ball_mm.try_normalize(f64::EPSILON).unwrap_or_else(Vector3::zeros);
    let radius_mm = run.alignment.radius_mm;
    let inside_mm = |following: &Following| {
        let [inside_mm, slope_mm_s] = following.inside_mm(&along, velocity_mm_s.norm(), radius_mm);
        (inside_mm.sum(), slope_mm_s)
    };
    let commanded_mm = |then_s: f64, position_mm: &Vector3<f64>| {
        if facets_count {
            length_mm(position_mm)
        } else {
            // Like the step of the senses, that of the path is no slope.
            let here_s = sample.program_s;
            let mean_mm = run.alignment.mean_stepped_mm(sample.leg, then_s, mean_s, here_s);
            radius_mm + mean_mm - inside_mm(&run.following[0]).0 + late_only_mm(position_mm)
        }
    };
    // Where facets do not count, long enough to see over them; where they do, short against one, but not
    // so short that a vertex between this step's time and the next turns the slope at once.
    // The slope of a mean over a window is that from one end of it to the other.
    let averaged = run.alignment.averaged > 1;
    let window_s = if averaged { run.alignment.sample_period_s } else { 0.0 };
    let step_s = match detail {
        Detail::Full if window_s > 0.0 => 0.5 * window_s,
        Detail::Full => STEP_S,
        Detail::Smooth => 0.5 * SMOOTH_S,
    };
    let [before_s, after_s] = [-1.0, 1.0].map(|sign| sample.program_s + sign * step_s);
    let beside = |then_s: f64| {
        let [path_mm, _] = run.following[0].at(&run.alignment.trajectory, then_s, sample.block);
        let position_mm = path_mm - late_mm;
        Pose { position_mm, sense: sample.pose.sense }
    };
    let (before, after) = (beside(before_s), beside(after_s));
    let errors = bent(&sample.pose, &sample.motion);
    let here_mm = errs_mm(&sample.pose, &sample.motion, &errors);
    let errs_there_mm = |then_s: f64, pose: &Pose| {
        let motion = moves(model, run, sample, then_s);
        errs_mm(pose, &motion, &bent(pose, &motion))
    };
    // Errors are smooth over some milliseconds, and the path with its vertices is not.
    let errs_grow_mm = if step_s <= STEP_S {
        2.0 * (errs_there_mm(after_s, &after) - here_mm)
    } else {
        errs_there_mm(after_s, &after) - errs_there_mm(before_s, &before)
    };
    let commanded_grows_mm =
        commanded_mm(after_s, &after.position_mm) - commanded_mm(before_s, &before.position_mm);
    // A mean over a chord grows from one end of it to the other.
    let of_chords = facets_count && map.chords[sample.leg].there_are();
    let rounded = if of_chords { map.rounded } else { 0.0 };
    let rounded_grows_mm = if rounded.abs() > 0.0 {
        let chord_s = map.chords[sample.leg].lasts_s;
        let [from, to] = [-0.5, 0.5].map(|share| beside(sample.program_s + share * chord_s));
        (length_mm(&to.position_mm) - length_mm(&from.position_mm)) * 2.0 * step_s / chord_s
    } else {
        0.0
    };
    let grows_mm = errs_grow_mm + (1.0 - rounded) * commanded_grows_mm + rounded * rounded_grows_mm;
    // Where slides are, and what more of the time constant of each does, along the bar.
    let followed = |following: &Following| followed(run, sample, following, &along, rounded);
    let delayed_mm_s = -along.component_mul(velocity_mm_s);
    let apart_s = if run.following[0].at_once() { 0.0 } else { map.following_s };
    let (following_mm_s, longer_mm, rounding_mm) = if facets_count {
        let [here, longer] = run.following.each_ref().map(followed);
        // What slides are late by is told by their delays.
        let grows_mm_s = (longer.0 - here.0) / run.following_step_s - delayed_mm_s.dot(&map.longer);
        (grows_mm_s, apart_s * (here.1 - delayed_mm_s), here.2)
    } else if detail == Detail::Full {
        let [here, longer] = run.following.each_ref().map(inside_mm);
        ((here.0 - longer.0) / run.following_step_s, -apart_s * here.1, None)
    } else {
        // While times are known to a second only, a radius tells no lag.
        (0.0, Vector3::zeros(), None)
    };
    // Where its mean counts, the sample is laid on it already.
    let commanded_mm = match detail {
        Detail::Full => length_mm(&sample.pose.position_mm),
        Detail::Smooth => commanded_mm(sample.program_s, &sample.pose.position_mm),
    };
    View {
        residual_mm: sample.deviation_mm - (here_mm + commanded_mm - run.nominal_mm) - map.cut_mm,
        following_mm_s,
        delayed_mm_s,
        longer_mm,
        rounding_mm,
        speed_mm_s: grows_mm / (2.0 * step_s),
        errors,
    }
}

/// How the machine moves at a program time near a sample, its senses held. Only effects that are held beside the parameters hang on that:
/// the lag near standstill of a slide that turns with 15 mm/s² may change by a micrometre in a millisecond.
fn moves(model: &Model, run: &RunInput, sample: &Sample, then_s: f64) -> Motion {
    if !model.holds() {
        return sample.motion;
    }
    let velocity_mm_s = |at_s: f64| {
        let state = run.alignment.trajectory.at_near(at_s, sample.block);
        state.velocity_mm_s
    };
    let faster_mm_s = velocity_mm_s(then_s) - velocity_mm_s(sample.program_s);
    sample.motion.later(then_s - sample.program_s, &faster_mm_s)
}

/// Where slides that follow are along the bar at a sample, mm, by how much more of its time constant moves each, mm/s, where this share of
/// the corners of chords is rounded out, and by how much longer the bar were with all of it, mm.
fn followed(
    run: &RunInput,
    sample: &Sample,
    following: &Following,
    along: &Vector3<f64>,
    rounded: f64,
) -> (f64, Vector3<f64>, Option<f64>) {
    let alignment = &run.alignment;
    let driven = if alignment.averaged > 1 {
        let times = alignment.times(sample.program_s);
        following.mean(&alignment.trajectory, &times, sample.block)
    } else {
        following.at(&alignment.trajectory, sample.program_s, sample.block)
    };
    if rounded.abs() <= 0.0 {
        return (along.dot(&driven[0]), along.component_mul(&driven[1]), None);
    }
    let whole = alignment.over_chord(following, sample.leg, sample.program_s, sample.block);
    let [position_mm, slope_mm_s] = [0, 1].map(|k| driven[k].lerp(&whole[k], rounded));
    let across_mm = if alignment.averaged > 1 {
        alignment.across_mm(along, &sample.motion.velocity_mm_s, sample.program_s)
    } else {
        0.0
    };
    let rounding_mm = along.dot(&(whole[0] - driven[0])) - across_mm;
    (along.dot(&position_mm), along.component_mul(&slope_mm_s), Some(rounding_mm))
}
