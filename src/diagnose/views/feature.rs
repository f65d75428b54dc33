//! Where a curve of any shape is largest, and how wide it is there.
//!
//! What the model spans anyway, a cubic over the position of a slide or a constant over anything else, is
//! in the knots by chance: it is taken off first, by a fit that heeds large values less and less.

use serde::Serialize;

use crate::model::{Seat, Variable, place};
use crate::residual::Element;
use crate::solve::{Cholesky, Matrix, median};

/// Fits of the trend; each heeds what stands out of the one before less.
const FITS: usize = 6;
/// What is beyond so many times the median magnitude is not heeded.
const OUTSTANDING: f64 = 3.0;

/// The largest part of a curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Feature {
    /// What the curve hangs on, such as `position of X`.
    pub variable: String,
    /// Unit of the variable.
    pub variable_unit: &'static str,
    /// Unit of the curve: `um` or `urad`.
    pub unit: &'static str,
    /// Where it is largest, midway between the places of half the height, in the unit of the variable.
    pub at: f64,
    /// How large it is there, with its sign, in the unit of the curve.
    pub height: f64,
    /// Width at half the height, in the unit of the variable.
    pub width: f64,
    /// The knots, in the unit of the variable.
    pub knots: Vec<f64>,
    /// The curve at the knots without its trend, in the unit of the curve.
    pub values: Vec<f64>,
}

/// The unit in which what acts on a seat is shown, and the factor that leads to it from mm or rad.
pub(super) fn shown_in(seat: Seat) -> (&'static str, f64) {
    match seat {
        Seat::Function(_, component) if component.is_angular() => ("urad", 1e6),
        _ => ("um", 1e3),
    }
}

impl Feature {
    /// Of an element that is a curve, with its amplitudes in mm or rad; `None` of any other.
    pub fn of(element: &Element, amplitudes: &[f64]) -> Option<Self> {
        let curve = element.curve()?;
        let knots = curve.knots.clone();
        if amplitudes.len() != knots.len() || knots.len() < 5 {
            return None;
        }
        let degree = match curve.variable {
            Variable::Position(_) if !curve.with_sense => 3,
            _ => 0,
        };
        let values = without_trend(&knots, amplitudes, degree)?;
        let largest = |a: &usize, b: &usize| values[*a].abs().total_cmp(&values[*b].abs());
        let top = (0..knots.len()).max_by(largest)?;
        let height = values[top];
        let left = half(&knots[..=top], &values[..=top], height, true);
        let right = half(&knots[top..], &values[top..], height, false);
        let (unit, factor) = shown_in(curve.seat);
        Some(Self {
            variable: curve.variable.to_string(),
            variable_unit: curve.variable.unit(),
            unit,
            at: 0.5 * (left + right),
            height: height * factor,
            width: right - left,
            knots,
            values: values.iter().map(|value| value * factor).collect(),
        })
    }

    /// The curve somewhere, in its unit.
    pub(super) fn value(&self, at: f64) -> f64 {
        let (first, share) = place(&self.knots, at);
        (1.0 - share) * self.values[first] + share * self.values[first + 1]
    }
}

/// Where a curve falls to half its height, going away from the end that has it.
fn half(knots: &[f64], values: &[f64], height: f64, leftwards: bool) -> f64 {
    let count = knots.len();
    let index = |step: usize| if leftwards { count - 1 - step } else { step };
    for step in 1..count {
        let (inner, outer) = (index(step - 1), index(step));
        let (a, b) = (values[inner] / height, values[outer] / height);
        if b < 0.5 {
            return knots[inner] + (a - 0.5) / (a - b) * (knots[outer] - knots[inner]);
        }
    }
    knots[index(count - 1)]
}

/// Values less a polynomial that heeds what stands out less and less.
fn without_trend(knots: &[f64], values: &[f64], degree: usize) -> Option<Vec<f64>> {
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    let terms = degree + 1;
    let power = |knot: f64, k: usize| {
        let scaled = 2.0 * (knot - first) / (last - first) - 1.0;
        scaled.powi(k as i32)
    };
    let mut weights = vec![1.0; knots.len()];
    let mut rest = values.to_vec();
    for _ in 0..FITS {
        let weighed = |f: &dyn Fn(usize) -> f64| -> f64 {
            weights.iter().enumerate().map(|(i, w)| w * f(i)).sum()
        };
        let normal = Matrix::from_fn(terms, terms, |j, k| {
            let sum = weighed(&|i| power(knots[i], j) * power(knots[i], k));
            if j == k { sum + 1e-9 * knots.len() as f64 } else { sum }
        });
        let common: Vec<f64> =
            (0..terms).map(|k| weighed(&|i| power(knots[i], k) * values[i])).collect();
        let trend = Cholesky::of(&normal)?.solve(&common);
        rest = (0..knots.len())
            .map(|i| {
                let fitted: f64 =
                    trend.iter().enumerate().map(|(k, t)| t * power(knots[i], k)).sum();
                values[i] - fitted
            })
            .collect();
        let usual = median(rest.iter().map(|r| r.abs()).collect())?;
        let limit = OUTSTANDING * usual.max(1e-12);
        weights = rest.iter().map(|r| (1.0 - (r / limit).powi(2)).max(0.0).powi(2)).collect();
    }
    Some(rest)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::machine::Axis;
    use crate::model::{Empirical, Form};
    use crate::residual::Owner;

    #[test]
    fn a_bump_is_found_on_any_cubic() {
        let knots: Vec<f64> = (0..61).map(|k| -150.0 + 5.0 * f64::from(k)).collect();
        let bump = |h: f64| 2e-3 * (-(h - 42.0).powi(2) / (2.0 * 9.0_f64.powi(2))).exp();
        let values: Vec<f64> =
            knots.iter().map(|h| bump(*h) + 0.01 + 3e-5 * h - 2e-9 * h.powi(3)).collect();
        let curve = Empirical {
            seat: Seat::parse("EXX").unwrap(),
            variable: Variable::Position(Axis::X),
            with_sense: false,
            knots,
        };
        let element = Element::new(Form::Empirical(curve), Owner::All);
        let feature = Feature::of(&element, &values).unwrap();
        assert!((feature.at - 42.0).abs() < 1.0, "{}", feature.at);
        assert!((feature.height / 2.0 - 1.0).abs() < 0.1, "{}", feature.height);
        // Full width at half the height of a normal curve is 2.355 of its sigma.
        assert!((feature.width / (2.355 * 9.0) - 1.0).abs() < 0.15, "{}", feature.width);
    }
}
