//! What was found, seen by itself: the effect with what is left around it.
//!
//! Over the variable that an effect hangs on, `y = sum s (e + c) / sum s²` in each bin, with `s` the sensitivity
//! of the length to the effect's seat, `c` the fitted effect and `e` what is left after all of them; the curve
//! is the fitted effect itself, the same way.

use serde::Serialize;

use super::feature::{Feature, shown_in};
use crate::model::{Seat, Variable};
use crate::residual::data::Data;
use crate::residual::element::{Element, Owner};
use crate::residual::joint::Fitted;

/// Bins over the variable.
const BINS: usize = 72;
/// A bin is shown if it weighs this much of the heaviest.
const WORTH_SHOWING: f64 = 0.02;
/// Later than this after a reversal nothing is shown, in decay times.
const DECAYS: f64 = 6.0;

/// A point of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// In the unit of the picture's variable.
    pub at: f64,
    /// The effect with what is left around it, in the unit of the picture.
    pub measured: f64,
    /// The effect as it was fitted, in the unit of the picture.
    pub fitted: f64,
    /// Standard deviation of `measured` by noise, in the unit of the picture.
    pub sigma: f64,
}

/// An effect over what it hangs on; a curve without a cause without what the model spans anyway.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Picture {
    /// What it hangs on, such as `position of X, within a period`.
    pub variable: String,
    /// The unit of that.
    pub variable_unit: &'static str,
    /// The unit of the values: `um` or `urad`.
    pub unit: &'static str,
    /// The points, ascending.
    pub points: Vec<Point>,
}

/// What an effect is shown over: the variable, a period within which it repeats, a place beyond which
/// nothing happens, and whether it turns with the sense of the slide.
struct Over {
    variable: Variable,
    period: Option<f64>,
    until: f64,
    with_sense: bool,
    seat: Seat,
}

fn over(element: &Element) -> Option<Over> {
    let plain = |variable: Variable, seat: Seat| Over {
        variable,
        period: None,
        until: f64::INFINITY,
        with_sense: false,
        seat,
    };
    if let Some(curve) = element.curve() {
        return Some(Over { with_sense: curve.with_sense, ..plain(curve.variable, curve.seat) });
    }
    let shape = element.shape()?;
    let slide = match shape.seat {
        Seat::Function(slide, _) | Seat::Slide(slide) => Some(slide),
        _ => None,
    };
    let seat = shape.seat;
    let inner = shape.inner.unwrap_or(f64::INFINITY);
    Some(match shape.cause.id {
        "cyclic" => Over { period: Some(inner), ..plain(Variable::Position(slide?), seat) },
        "servo" | "stick-slip" => plain(Variable::Velocity(slide?), seat),
        "reversal-spike" => Over {
            until: DECAYS * inner,
            with_sense: true,
            ..plain(Variable::SinceReversal(slide?), seat)
        },
        "pre-sliding" => Over {
            until: DECAYS * inner,
            with_sense: true,
            ..plain(Variable::WaySinceReversal(slide?), seat)
        },
        "growing-backlash" => Over { with_sense: true, ..plain(Variable::Position(slide?), seat) },
        "degree" => plain(Variable::Position(slide?), seat),
        "drift" | "knock" => plain(Variable::Elapsed, seat),
        _ => return None,
    })
}

/// The picture of one of the fitted effects; `None` of one that hangs on no single variable.
pub(crate) fn picture(
    data: &Data,
    fitted: &Fitted,
    element: usize,
    left_mm: &[Vec<f64>],
    long_run_mm2: f64,
) -> Option<Picture> {
    let of = &fitted.elements[element];
    let Over { variable, period, until, with_sense, seat } = over(of)?;
    let part = fitted.part(element);
    let (unit, factor) = shown_in(seat);
    let feature = Feature::of(of, &fitted.amplitudes[element]);
    // Place, sensitivity, effect, effect with what is left.
    let mut samples: Vec<[f64; 4]> = Vec::new();
    for (index, block) in data.blocks.iter().enumerate() {
        for (k, sample) in block.samples.iter().enumerate() {
            let elsewhere = match of.owner {
                Owner::One { repeat, run } => repeat != index || run != sample.run,
                _ => false,
            };
            let at = &sample.situation;
            let Some(value) = variable.value(&at.pose, &at.motion) else { continue };
            if elsewhere || value > until {
                continue;
            }
            let sense = match variable.slide() {
                Some(axis) if with_sense => at.pose.sense[axis.index()],
                _ => 1.0,
            };
            let s = sense * seat.sensitivity(at) * sample.root_weight;
            let columns = part.columns.iter().zip(part.amplitudes.iter().flatten());
            let effect: f64 =
                columns.map(|(c, a)| a * c[index].get(k).copied().unwrap_or(0.0)).sum();
            let place = period.map_or(value, |period| value.rem_euclid(period));
            samples.push([place, s, effect, effect + left_mm[index][k]]);
        }
    }
    let places = || samples.iter().map(|sample| sample[0]);
    let low = if period.is_some() { 0.0 } else { places().fold(f64::INFINITY, f64::min) };
    let high = period.unwrap_or_else(|| places().fold(f64::NEG_INFINITY, f64::max));
    if !(high - low).is_finite() || high <= low {
        return None;
    }
    let scale = BINS as f64 / (high - low);
    // Place, count, s², s · effect, s · measured.
    let mut sums = vec![[0.0; 5]; BINS];
    for [place, s, effect, measured] in samples {
        let sum = &mut sums[(((place - low) * scale) as usize).min(BINS - 1)];
        for (sum, add) in sum.iter_mut().zip([place, 1.0, s * s, s * effect, s * measured]) {
            *sum += add;
        }
    }
    let heaviest = sums.iter().map(|sum| sum[2]).fold(0.0, f64::max);
    let points = sums
        .into_iter()
        .filter(|sum| sum[1] > 0.0 && sum[2] > WORTH_SHOWING * heaviest)
        .map(|[place, count, weight, effect, measured]| {
            let at = place / count;
            let left = (measured / weight - effect / weight) * factor;
            let of_curve = feature.as_ref().map(|feature| feature.value(at));
            let fitted = of_curve.unwrap_or(effect / weight * factor);
            let sigma = (long_run_mm2 / weight).sqrt() * factor;
            Point { at, measured: left + fitted, fitted, sigma }
        })
        .collect();
    let within = if period.is_some() { ", within a period" } else { "" };
    Some(Picture {
        variable: format!("{variable}{within}"),
        variable_unit: variable.unit(),
        unit,
        points,
    })
}
