//! The fit of several effects at once, beside everything that the model and accepted effects follow.
//!
//! With the columns `c_j` of the effects outside of what the fits follow, the amplitudes solve
//!
//! ```text
//! N a = r,     N_ij = c'_i · c'_j,     r_i = c'_i · e
//! ```
//!
//! and gain `a · r` of the sum of squares. The numbers inside (a period, a time constant) follow by
//! Gauss-Newton with the derivative of the fitted effect as a further column: variable projection in the
//! approximation of Kaufman, "A variable projection method for solving separable nonlinear least squares
//! problems" (BIT 15, 1975), which drops the part of the derivative that lies in the span of the columns.

use super::began::{Began, Beginning};
use super::beside::Beside;
use super::column::Column;
use super::element::Element;
use super::fitted::Fitted;
use super::residuals::Residuals;
use super::system::System;
use crate::solve::{Cholesky, Matrix, dot};

/// Steps of Gauss-Newton; a good start takes three.
const MOST_STEPS: usize = 12;
/// A step that lowers the sum of squares by less than this share of the gain is the last,
const SETTLED: f64 = 1e-4;
/// if it is less than this share of what noise is in one sample too. Chance gains at least the whole of that by each number, so a
/// number is within a third of its deviation; of a large effect a ten-thousandth of the gain can be ten deviations.
const OF_CHANCE: f64 = 0.1;
/// Steps that do not help are halved until they are shorter than this.
const SHORTEST: f64 = 0.1;

/// Fits effects beside what has been accepted; the numbers inside start from where they are.
///
/// `None` where the effects cannot be told from what is followed already, or from each other.
pub fn fit(beside: &Beside, elements: Vec<Element>) -> Option<Fitted> {
    fit_to(beside, elements, &vec![true; beside.residuals.repeats.len()])
}

/// The same with some of the repeats alone.
pub fn fit_to(beside: &Beside, elements: Vec<Element>, repeats: &[bool]) -> Option<Fitted> {
    let mut elements = elements;
    let mut best: Option<Fitted> = None;
    let mut shorter = 1.0;
    let negligible_mm2 = OF_CHANCE * beside.noise().neighbours_mm2;
    let mut began = Began::new(beside, repeats);
    for _ in 0..MOST_STEPS {
        let (mut system, counts) = system(beside, &elements, repeats);
        let linear = system.columns.len();
        let (normal, common) = system.part(linear);
        let amplitudes = Cholesky::of(&normal)?.solve(common);
        let explained_mm2 = dot(&amplitudes, common);
        let amplitudes = split(&amplitudes, &counts);
        let gain_mm2 = explained_mm2 - began.cost_mm2(&elements, &amplitudes, &system);
        if let Some(best) = best.as_ref().filter(|best| gain_mm2 <= best.gain_mm2) {
            shorter *= 0.5;
            if shorter < SHORTEST {
                break;
            }
            elements = half_way(&elements, &best.elements, &began);
            continue;
        }
        let least_mm2 = negligible_mm2.min(SETTLED * gain_mm2);
        let settled = best.as_ref().is_some_and(|best| gain_mm2 - best.gain_mm2 < least_mm2);
        let share_outside = system.share_outside();
        system.push(beside, inside(beside, &elements, &amplitudes, &system.columns), usize::MAX);
        let own = system.columns.len();
        let beginnings = began.beginnings(&elements, &amplitudes, &system);
        let held = beginnings.iter().map(|of| (of.column.clone(), of.weight));
        let (held, weights): (Vec<Column>, Vec<f64>) = held.unzip();
        system.push_held(beside, held, &weights);
        let (normal, common) = system.part(system.columns.len());
        let mut common = common.to_vec();
        let pulls = beginnings.iter().map(Beginning::pull);
        common[own..].iter_mut().zip(pulls).for_each(|(common, pull)| *common += pull);
        let cholesky = Cholesky::of(&normal)?;
        let step = cholesky.solve(&common);
        let all = cholesky.inverse();
        // What the beginnings leave open of the others is in it.
        let inverse = Matrix::from_fn(own, own, |i, k| all[(i, k)]);
        let next = stepped(&elements, &step[linear..own], shorter);
        let next = began.stepped(next, &beginnings, &step[own..], shorter);
        let mut columns = system.columns;
        columns.truncate(own);
        best = Some(Fitted { elements, amplitudes, gain_mm2, inverse, share_outside, columns });
        if settled || step.len() == linear {
            break;
        }
        elements = next;
    }
    best
}

/// Derivatives of the fitted effects with respect to the number inside of each that has one.
fn inside(
    beside: &Beside,
    elements: &[Element],
    amplitudes: &[Vec<f64>],
    columns: &[Column],
) -> Vec<Column> {
    let mut first = 0;
    let mut inside = Vec::new();
    for (element, own) in elements.iter().zip(amplitudes) {
        if element.free().is_some() {
            let columns = &columns[first..first + own.len()];
            inside.push(derivative(beside.residuals, element, own, columns));
        }
        first += own.len();
    }
    inside
}

/// The columns of all elements, empty in the repeats that take no part; and how many each has.
fn system(beside: &Beside, elements: &[Element], repeats: &[bool]) -> (System, Vec<usize>) {
    let mut of_elements: Vec<Vec<Column>> =
        elements.iter().map(|e| e.columns(beside.residuals)).collect();
    for column in of_elements.iter_mut().flatten() {
        let out = column.iter_mut().zip(repeats).filter(|(_, takes_part)| !**takes_part);
        out.for_each(|(of_repeat, _)| of_repeat.clear());
    }
    let counts = of_elements.iter().map(Vec::len).collect();
    let mut system = System::default();
    for (element, columns) in elements.iter().zip(of_elements) {
        system.push_element(beside, element, columns);
    }
    (system, counts)
}

/// Values one after the other, so many to each.
fn split(values: &[f64], counts: &[usize]) -> Vec<Vec<f64>> {
    let mut rest = values.iter().copied();
    counts.iter().map(|count| rest.by_ref().take(*count).collect()).collect()
}

/// Elements with the numbers inside half the way back to the best.
fn half_way(now: &[Element], best: &[Element], began: &Began) -> Vec<Element> {
    let back = |(now, best): (&Element, &Element)| match (now.free(), best.free()) {
        (Some(free), Some(at)) => {
            let earlier = began.half_way(&now.earlier, &best.earlier);
            Element { earlier, ..best.with_free(0.5 * (free + at)) }
        }
        _ => best.clone(),
    };
    now.iter().zip(best).map(back).collect()
}

/// Elements with the numbers inside one step on, one step for each that has one.
fn stepped(elements: &[Element], steps: &[f64], shorter: f64) -> Vec<Element> {
    let mut steps = steps.iter();
    let on = |element: &Element| match (element.free(), element.free().and_then(|_| steps.next())) {
        (Some(at), Some(step)) => {
            let longest = element.long_step();
            element.with_free(at + (shorter * step).clamp(-longest, longest))
        }
        _ => element.clone(),
    };
    elements.iter().map(on).collect()
}

/// Derivative of a fitted effect with respect to the number inside.
fn derivative(
    residuals: &Residuals,
    element: &Element,
    amplitudes: &[f64],
    columns: &[Column],
) -> Column {
    let at = element.free().unwrap_or(0.0);
    let step = element.small_step();
    let beside = element.with_free(at + step).columns(residuals);
    let mut sum = Column::empty(residuals.repeats.len());
    for ((amplitude, after), before) in amplitudes.iter().zip(&beside).zip(columns) {
        for (sum, (after, before)) in sum.iter_mut().zip(after.iter().zip(before.iter())) {
            if before.is_empty() {
                continue;
            }
            sum.resize(after.len(), 0.0);
            for (s, (a, b)) in sum.iter_mut().zip(after.iter().zip(before)) {
                *s += amplitude * (a - b) / step;
            }
        }
    }
    sum
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::bench::{element, residuals, white};
    use super::*;

    /// A ball that moves by a millimetre within some seconds: a set-up error follows nearly all of that, and what is left tells how far.
    #[test]
    fn a_large_drift_that_the_model_follows_has_its_amplitude() {
        const NOISE_MM: f64 = 1.5e-4;
        const DRIFT_MM: f64 = 1.0;
        let noise = residuals(1, white(3, NOISE_MM));
        let element = element("drift:on=EXt,time_constant_s=1");
        let mut drift = noise.zeros();
        drift.add(DRIFT_MM, &element.columns(&noise)[0]);
        let fitted = fit(&noise.plus(&drift).alone(), vec![element]).unwrap();
        let sigma_mm = NOISE_MM * fitted.inverse[(0, 0)].sqrt();
        let off = (fitted.amplitudes[0][0] - DRIFT_MM) / sigma_mm;
        assert!(fitted.share_outside < 0.02, "{}", fitted.share_outside);
        assert!(sigma_mm < 2e-4 && off.abs() < 3.0, "{off} sigma of {sigma_mm} mm");
    }

    /// What counts when a fit comes to rest is what chance would explain, not a share of what a large effect does.
    #[test]
    fn the_number_inside_of_a_large_effect_is_found_to_its_sigma() {
        const NOISE_MM: f64 = 1.5e-4;
        const DRIFT_MM: f64 = 0.3;
        let noise = residuals(1, white(3, NOISE_MM));
        let mut drift = noise.zeros();
        let truth = element("drift:on=EXt,time_constant_s=800");
        drift.add(DRIFT_MM, &truth.columns(&noise)[0]);
        let start = element("drift:on=EXt,time_constant_s=1000");
        let fitted = fit(&noise.plus(&drift).alone(), vec![start]).unwrap();
        let inner = fitted.inner_index(0).unwrap();
        let sigma = NOISE_MM * fitted.inverse[(inner, inner)].sqrt();
        let found = fitted.elements[0].free().unwrap();
        let off = (found - truth.free().unwrap()) / sigma;
        assert!(off.abs() < 2.0, "{off} sigma of {sigma}, {found}");
    }

    /// Every cause with a number inside, against central differences with another step.
    #[test]
    fn the_derivative_is_that_of_the_fitted_effect() {
        let residuals = residuals(1, || 0.0);
        for (term, amplitudes) in [
            ("cyclic:on=EXX,period_mm=10", [0.8, -0.3]),
            ("vibration:on=bar,frequency_hz=0.7", [0.4, 0.9]),
            ("drift:on=EXt,time_constant_s=600", [1.0, 0.0]),
            ("drift:on=EYt,time_constant_s=120", [1.0, 0.0]),
            ("stick-slip:on=Y,speed_mm_min=60", [1.0, 0.0]),
        ] {
            let element = element(term);
            let columns = element.columns(&residuals);
            let own = &amplitudes[..columns.len()];
            let derivative = derivative(&residuals, &element, own, &columns);
            let at = element.free().unwrap();
            let step = 0.1 * element.small_step();
            let mut expected = residuals.zeros();
            for (sign, free) in [(1.0, at + step), (-1.0, at - step)] {
                let beside = element.with_free(free).columns(&residuals);
                for (amplitude, column) in own.iter().zip(&beside) {
                    expected.add(sign * amplitude / (2.0 * step), column);
                }
            }
            let mut apart = derivative.clone();
            apart.add(-1.0, &expected);
            // The one-sided difference is off by half a step times the second derivative.
            let share = (apart.square() / expected.square().max(1e-30)).sqrt();
            assert!(share < 0.02, "{term}: {share}");
        }
    }
}
