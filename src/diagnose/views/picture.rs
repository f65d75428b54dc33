//! What was found, seen by itself: the effect with what is left around it.
//!
//! Over the variable that an effect hangs on, `y = sum s (e + c) / sum s²` in each bin, with `s` the sensitivity
//! of the length to the effect's seat, `c` the fitted effect and `e` what is left after all of them; the curve
//! is the fitted effect itself, the same way.

use serde::Serialize;

use super::feature::{Feature, shown_in};
use crate::model::{Dependence, Law, Variable};
use crate::residual::{Column, Element, Fitted, Owner, Residuals};

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
    of: Dependence,
    period: Option<f64>,
    until: f64,
}

fn over(element: &Element) -> Option<Over> {
    let everywhere = |of: Dependence| Over { of, period: None, until: f64::INFINITY };
    if let Some(curve) = element.curve() {
        return Some(everywhere(curve.dependence()));
    }
    let shape = element.shape()?;
    let of = shape.dependence()?;
    let reversal =
        matches!(of.variable, Variable::SinceReversal(_) | Variable::WaySinceReversal(_));
    match (shape.law(), shape.inner) {
        // Another phase in every run: there is no one picture.
        (Law::Wave(..), _) if element.owner == Owner::EachRun => None,
        (Law::Wave(..), period) => Some(Over { period, ..everywhere(of) }),
        (_, Some(inner)) if reversal => Some(Over { until: DECAYS * inner, ..everywhere(of) }),
        _ => Some(everywhere(of)),
    }
}

/// A sample where an effect acts.
struct Placed {
    place: f64,
    /// What one of the effect does to the length there.
    weight: f64,
    fitted_mm: f64,
    /// The effect with what is left.
    measured_mm: f64,
}

/// Sums over a bin.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    place: f64,
    count: f64,
    weight: f64,
    fitted: f64,
    measured: f64,
}

impl Sums {
    fn add(&mut self, sample: &Placed) {
        self.place += sample.place;
        self.count += 1.0;
        self.weight += sample.weight * sample.weight;
        self.fitted += sample.weight * sample.fitted_mm;
        self.measured += sample.weight * sample.measured_mm;
    }
}

/// The picture of one of the fitted effects; `None` of one that hangs on no single variable.
pub(crate) fn picture(
    residuals: &Residuals,
    fitted: &Fitted,
    element: usize,
    left_mm: &Column,
    long_run_mm2: f64,
) -> Option<Picture> {
    let element_of = &fitted.elements[element];
    let Over { of, period, until } = over(element_of)?;
    let part = fitted.part(element);
    let (unit, factor) = shown_in(of.seat);
    let feature = Feature::of(element_of, &fitted.amplitudes[element]);
    let effect_mm = part.sum(residuals);
    let mut samples: Vec<Placed> = Vec::new();
    for (index, repeat) in residuals.repeats.iter().enumerate() {
        for (k, sample) in repeat.samples.iter().enumerate() {
            let elsewhere = match element_of.owner {
                Owner::One { repeat, run } => repeat != index || run != sample.run,
                _ => false,
            };
            let Some((value, factor)) = of.at(&sample.situation) else { continue };
            if elsewhere || value > until {
                continue;
            }
            let fitted_mm = effect_mm[index][k];
            samples.push(Placed {
                place: period.map_or(value, |period| value.rem_euclid(period)),
                weight: factor * sample.root_weight,
                fitted_mm,
                measured_mm: fitted_mm + left_mm[index][k],
            });
        }
    }
    let places = || samples.iter().map(|sample| sample.place);
    let low = if period.is_some() { 0.0 } else { places().fold(f64::INFINITY, f64::min) };
    let high = period.unwrap_or_else(|| places().fold(f64::NEG_INFINITY, f64::max));
    if !(high - low).is_finite() || high <= low {
        return None;
    }
    let scale = BINS as f64 / (high - low);
    let mut sums = vec![Sums::default(); BINS];
    for sample in samples {
        let bin = (((sample.place - low) * scale) as usize).min(BINS - 1);
        sums[bin].add(&sample);
    }
    let heaviest = sums.iter().map(|sum| sum.weight).fold(0.0, f64::max);
    let points = sums
        .into_iter()
        .filter(|sum| sum.count > 0.0 && sum.weight > WORTH_SHOWING * heaviest)
        .map(|sum| {
            let at = sum.place / sum.count;
            let left = (sum.measured / sum.weight - sum.fitted / sum.weight) * factor;
            let of_curve = feature.as_ref().map(|feature| feature.value(at));
            let fitted = of_curve.unwrap_or(sum.fitted / sum.weight * factor);
            let sigma = (long_run_mm2 / sum.weight).sqrt() * factor;
            Point { at, measured: left + fitted, fitted, sigma }
        })
        .collect();
    let variable = of.variable;
    let within = if period.is_some() { ", within a period" } else { "" };
    Some(Picture {
        variable: format!("{variable}{within}"),
        variable_unit: variable.unit(),
        unit,
        points,
    })
}
