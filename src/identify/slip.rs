//! Identification of runs in which the bar may have slipped.
//!
//! A step of the readings that the lines before and after it show is tried as one of the bar's length: it is taken out of
//! all readings after it, by as much as fits best. It is a slip if it makes the fit better beyond chance *and* comes out as
//! large as it is seen at its moment, *and* explains more than a ball that was knocked then: that steps by another amount in
//! every other direction of the bar.

use super::fit::{identify, identify_on};
use super::input::{Options, RunInput};
use super::linearised::{LinearSample, Linearised};
use super::record::Record;
use super::result::Identification;
use crate::align::Slip;
use crate::error::Result;
use crate::model::Model;
use crate::solve::{Cholesky, Matrix, dot};

/// A gain, in units of the noise, that the best of some thousand moments does not reach by chance: twice the logarithm of
/// their number, and 14 to spare for 1 in 1000.
const BEYOND_CHANCE: f64 = 30.0;
/// So much of a step the readings may have changed by in a gap that it fell into.
const IN_A_GAP: f64 = 0.25;
/// And by so many standard deviations where there was none.
const SIGMAS: f64 = 4.0;
/// What is added to the square of a step of a ball, as a share of that of a slip: one that the model spans stays small, and so does
/// one across a plane, which no reading sees.
const RIDGE: f64 = 1e-6;
/// So many readings either side of a step show what a fit leaves of it.
const NEXT_TO_IT: usize = 12;
/// The size is sought so often, at most: a wrong size of some micrometres moves the times.
const ROUNDS: usize = 4;
/// Until it moves by less than this part of what the lines show it to.
const CLOSER: f64 = 0.25;

/// Identifies the parameters of a model from runs, slips of the bar taken out.
///
/// # Errors
/// As [`identify`].
pub(super) fn identify_beside_slips(
    model: &Model,
    runs: Vec<RunInput>,
    options: &Options,
) -> Result<Identification> {
    let seen: Vec<(usize, Slip)> = runs
        .iter()
        .enumerate()
        .flat_map(|(index, run)| {
            run.alignment.steps_of_readings().into_iter().map(move |slip| (index, slip))
        })
        .collect();
    if seen.is_empty() {
        return identify(model, runs, options);
    }
    let mut runs = runs;
    let mut best = identify(model, runs.clone(), options);
    // The linear problem about the best fit, once one asks for it.
    let mut linear: Option<Linearised> = None;
    for (index, slip) in seen {
        if best.as_ref().is_ok_and(|plain| explains(plain, index, &slip)) {
            continue;
        }
        let without = |step_mm: f64| {
            let mut runs = runs.clone();
            let RunInput { name, mounting, nominal_mm, alignment, .. } = runs[index].clone();
            let alignment = alignment.without_step(Slip { step_mm, ..slip });
            runs[index] = RunInput::new(name, mounting, nominal_mm, alignment);
            runs
        };
        // What is none, such as a spike where a slide turns, leaves more without it where the readings lie already, in the linear
        // problem or on the way from there: no way is sought anew for that.
        if linear.is_none()
            && let Ok(plain) = &best
        {
            linear = Some(plain.linearised(model, options)?);
        }
        if linear.as_ref().is_some_and(|linear| leaves_more(linear, index, &slip)) {
            continue;
        }
        let worse = |plain: &Identification| {
            let runs = laid_as(plain, without(slip.step_mm));
            let there = identify_on(model, runs, plain, options);
            there.is_ok_and(|there| squares(&there) > squares(plain))
        };
        if best.as_ref().is_ok_and(worse) {
            continue;
        }
        let Ok(as_seen) = identify(model, without(slip.step_mm), options) else { continue };
        // Taken out as it is seen, a slip already leaves less.
        if best.as_ref().is_ok_and(|plain| squares(&as_seen) > squares(plain)) {
            continue;
        }
        let sized = sized(model, as_seen, index, &slip, &without, options)?;
        let Some((step_mm, fitted)) = sized else { continue };
        let farthest_mm = SIGMAS.mul_add(slip.sigma_mm, IN_A_GAP * slip.step_mm.abs());
        if (step_mm - slip.step_mm).abs() > farthest_mm {
            continue;
        }
        let better = best.as_ref().map_or(true, |plain| {
            squares(plain) - squares(&fitted) > BEYOND_CHANCE * fitted.noise.long_run_variance()
        });
        if better && !is_of_a_ball(&fitted, model, options, index, &Slip { step_mm, ..slip })? {
            runs = without(step_mm);
            best = Ok(fitted);
            linear = None;
        }
    }
    best
}

/// Sum of squares that a fit leaves, mm².
fn squares(of: &Identification) -> f64 {
    of.rms_mm.powi(2) * of.used as f64
}

/// Runs with their readings where a fit has laid them.
fn laid_as(fit: &Identification, mut runs: Vec<RunInput>) -> Vec<RunInput> {
    for (run, fitted) in runs.iter_mut().zip(&fit.runs) {
        run.alignment.time_map = fitted.alignment.time_map.clone();
        run.place();
    }
    runs
}

/// Whether more is left in the linear problem about a fit with a step taken out as it was seen: by `s² c P c - 2 s c R`, with the
/// letters of [`is_of_a_ball`].
fn leaves_more(linear: &Linearised, index: usize, slip: &Slip) -> bool {
    let column = stepped(linear, index, slip, &|_| 1.0);
    let own = dot(&column, &linear.basis.outside(&column));
    slip.step_mm * (slip.step_mm * own - 2.0 * dot(&column, &left_mm(linear))) >= 0.0
}

/// Whether a ball that moved at the moment of a slip explains more than the slip, which the readings of this fit are
/// without.
///
/// With `c` the column of the slip, `s` its size, `X` those of a step of the ball along X, Y and Z, `R` what the fit leaves
/// and `P` what it does not follow, the slip lowers the sum of squares further by `(c R)² / (c P c)`, and the ball in its place
///
/// `g (X P X)^-1 g - 2 s c R - s² c P c`, `g = X (R + s P c)`.
fn is_of_a_ball(
    fit: &Identification,
    model: &Model,
    options: &Options,
    index: usize,
    slip: &Slip,
) -> Result<bool> {
    let step_mm = slip.step_mm;
    let linear = fit.linearised(model, options)?;
    let left_mm = left_mm(&linear);
    let columns: [Vec<f64>; 4] = [None, Some(0), Some(1), Some(2)].map(|along: Option<usize>| {
        stepped(&linear, index, slip, &|of| along.map_or(1.0, |axis| of.situation.direction[axis]))
    });
    let outside = columns.each_ref().map(|column| linear.basis.outside(column));
    let [slipped, ball @ ..] = &columns;
    let (common, own) = (dot(slipped, &left_mm), dot(slipped, &outside[0]));
    let normal = Matrix::from_fn(3, 3, |i, k| {
        let ridge = if i == k { RIDGE * dot(slipped, slipped) } else { 0.0 };
        dot(&ball[i], &outside[1 + k]) + ridge
    });
    let Some(normal) = Cholesky::of(&normal) else { return Ok(false) };
    let of_ball = ball.each_ref().map(|x| dot(x, &left_mm) + step_mm * dot(x, &outside[0]));
    let by_ball_mm2 = dot(&normal.solve(&of_ball), &of_ball);
    let back_mm2 = 2.0 * step_mm * common + step_mm * step_mm * own;
    Ok(by_ball_mm2 - back_mm2 > common * common / own.max(f64::MIN_POSITIVE))
}

/// Whether a fit explains a step: what it leaves of the readings next to it that took part steps by less than half of it.
fn explains(fit: &Identification, index: usize, slip: &Slip) -> bool {
    let used: Vec<&Record> = fit.runs[index].used().collect();
    let after = used.partition_point(|record| record.sample.log_s < slip.log_s);
    let mean_mm = |side: &[&Record]| {
        side.iter().map(|record| record.residual_mm).sum::<f64>() / side.len().max(1) as f64
    };
    let before_mm = mean_mm(&used[after.saturating_sub(NEXT_TO_IT)..after]);
    let after_mm = mean_mm(&used[after..(after + NEXT_TO_IT).min(used.len())]);
    (after_mm - before_mm).abs() < 0.5 * slip.step_mm.abs()
}

/// What a linearised fit leaves, mm, times the root of the weight.
fn left_mm(linear: &Linearised) -> Vec<f64> {
    linear.samples.iter().map(|of| of.left_mm * of.root_weight).collect()
}

/// A column that is so much from the moment of a slip on.
fn stepped(
    linear: &Linearised,
    index: usize,
    slip: &Slip,
    by: &dyn Fn(&LinearSample) -> f64,
) -> Vec<f64> {
    let of_sample = |of: &LinearSample| {
        let after = of.run == index && of.log_s >= slip.log_s;
        if after { by(of) * of.root_weight } else { 0.0 }
    };
    linear.samples.iter().map(of_sample).collect()
}

/// The size of a step that leaves least, mm, and the fit with it taken out: from that with the step as it was seen, the least
/// of the linear problem, and of that again. `None` where none is reached.
fn sized(
    model: &Model,
    as_seen: Identification,
    index: usize,
    slip: &Slip,
    without: &dyn Fn(f64) -> Vec<RunInput>,
    options: &Options,
) -> Result<Option<(f64, Identification)>> {
    let (mut step_mm, mut fitted) = (slip.step_mm, as_seen);
    for _ in 0..ROUNDS {
        let linear = fitted.linearised(model, options)?;
        let column = stepped(&linear, index, slip, &|_| 1.0);
        let own = dot(&column, &linear.basis.outside(&column));
        let more_mm = dot(&column, &left_mm(&linear)) / own;
        if !more_mm.is_finite() {
            return Ok(None);
        }
        step_mm += more_mm;
        let runs = laid_as(&fitted, without(step_mm));
        let Ok(again) = identify_on(model, runs, &fitted, options) else { return Ok(None) };
        fitted = again;
        if more_mm.abs() < CLOSER * slip.sigma_mm {
            break;
        }
    }
    Ok(Some((step_mm, fitted)))
}
