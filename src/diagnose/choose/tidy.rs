//! What does not stand beside the rest: causes that only mend others, and what gains no more than chance.

use super::search::Search;
use crate::diagnose::seek::curves;
use crate::diagnose::thresholds::{FIGHTING, LINEAR_MM, OF_A_CURVE, SHADOW, stands_beside_mm2};
use crate::machine::Axis;
use crate::model::{Empirical, Form, Law, Variable};
use crate::residual::{Beside, Element, Fitted, Owner, Residuals};

/// Two waves of one slide may be its screw and its scale; so many are a Fourier series, and that is any curve.
const A_SERIES: usize = 3;

/// The weakest of some effects, by its index, where it does not stand beside the others; and these fitted without it.
pub(crate) fn fallen(
    residuals: &Residuals,
    fitted: &Fitted,
    fit: &dyn Fn(Vec<Element>) -> Option<Fitted>,
) -> Option<(usize, Option<Fitted>)> {
    let beside = residuals.beside(&fitted.columns);
    let (least_mm2, noise) = (stands_beside_mm2(&beside), beside.noise_alone());
    let without = |k: usize| {
        let mut others = fitted.elements.clone();
        others.remove(k);
        let rest = if others.is_empty() { None } else { fit(others) };
        let gained = rest.as_ref().map_or(0.0, |rest| rest.gain_mm2);
        // A spike that is over before the first reading after it may be as high as it likes: nobody saw it. What a drift comes to
        // after years nobody has to see.
        let share = fitted.elements[k].reached(residuals);
        let seen = fitted.amplitudes[k].iter().all(|amplitude| share * amplitude.abs() < LINEAR_MM);
        let own_mm2 = (fitted.gain_mm2 - gained).min(fitted.part_mm2(k, residuals));
        let own_mm2 = if seen { own_mm2 } else { 0.0 };
        // Thirty amplitudes of a vibration gain thirty times as much by chance as one does.
        let inside = usize::from(fitted.elements[k].free().is_some());
        let by_choice = match fitted.elements[k].form {
            Form::Empirical(_) => curves::by_choice(fitted.amplitudes[k].len()),
            Form::Cause(_) => 0.0,
        };
        let by_chance_mm2 = noise.by_chance_mm2(fitted.amplitudes[k].len() + inside)
            + by_choice * noise.long_run_mm2;
        (k, own_mm2 - by_chance_mm2, rest)
    };
    let weakest = (0..fitted.elements.len()).map(without);
    let (index, own_mm2, rest) = weakest.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (own_mm2 < least_mm2).then_some((index, rest))
}

impl Search<'_> {
    /// The effects that stand.
    pub(crate) fn tidied(&mut self, fitted: Fitted) -> Option<Fitted> {
        let fitted = self.without_curves(fitted);
        let fitted = self.without_makeshifts(fitted);
        // A curve that has joined may leave more beside itself that only mends it.
        let fitted = self.without_makeshifts(fitted);
        let fitted = self.without_shadows(fitted)?;
        self.beyond_chance(fitted)
    }

    /// Without what gains no more than chance, or too little to be named, now that the others stand beside it: an effect
    /// may have been the best of its step and nothing after the next ones. The least goes first.
    pub(crate) fn beyond_chance(&self, fitted: Fitted) -> Option<Fitted> {
        let mut fitted = fitted;
        while let Some((_, rest)) = fallen(self.residuals(), &fitted, &|all| self.fit_all(all)) {
            fitted = rest?;
        }
        Some(fitted)
    }

    /// The smallest gain that stands beside all of these.
    fn stands_mm2(&self, fitted: &Fitted) -> f64 {
        stands_beside_mm2(&self.beside(Some(fitted)))
    }

    /// A curve in place of several smooth causes over one variable that together do no better than it, and of
    /// any beside a curve over it: waves and powers can be piled up to any bump, and frictions to any
    /// friction.
    fn without_makeshifts(&self, fitted: Fitted) -> Fitted {
        let mut best = fitted;
        let variables = Axis::ALL.map(|axis| [Variable::Position(axis), Variable::Velocity(axis)]);
        for over in variables.into_iter().flatten() {
            let described = best.elements.iter().any(|e| described_over(e) == Some(over));
            // Over a position so is a roundness, a smooth function of all three.
            let of_position = matches!(over, Variable::Position(_));
            let makeshift = |e: &Element| smooth_over(e) == Some(over) || (of_position && round(e));
            let smooth = best.elements.iter().filter(|e| makeshift(e)).count();
            if smooth + usize::from(described) < 2 || smooth == 0 {
                continue;
            }
            let kept: Vec<Element> = best
                .elements
                .iter()
                .filter(|e| !makeshift(e) && described_over(e) != Some(over))
                .cloned()
                .collect();
            let start = self.fit_others(kept);
            let prospect = self.prospect(start.as_ref());
            let wanted = |curve: &Empirical| !curve.with_sense && curve.variable == over;
            let found = if smooth + usize::from(described) < A_SERIES {
                curves::best(&prospect.beside, &prospect.looks, 0.0, &wanted)
            } else {
                // As fine as shows beside all that they explain, which is no noise.
                let noise = self.beside(Some(&best)).noise_alone();
                curves::over_each(&prospect.beside, &prospect.looks, &noise, &wanted).pop()
            };
            let Some(curve) = found else { continue };
            let before = start.iter().flat_map(|fitted| fitted.elements.clone());
            let elements = before.chain(curve.fitted.elements).collect();
            let Some(instead) = self.fit_all(elements) else { continue };
            let beside = self.beside(Some(&instead));
            let kept_mm2 = start.as_ref().map_or(0.0, |kept| kept.gain_mm2);
            let of_smooth_mm2 = |fitted: &Fitted| score_mm2(&beside, fitted) - kept_mm2;
            if of_smooth_mm2(&instead) > OF_A_CURVE * of_smooth_mm2(&best) {
                best = instead;
            }
        }
        best
    }

    /// Without the causes that are small beside a curve: what a curve leaves of an effect that nobody knows
    /// is no cause. Nor are those that are much larger than what all together explain: they fight others. Moves of one ball in one run
    /// are as large as they are together: there and back either may be ten times that.
    fn without_shadows(&self, fitted: Fitted) -> Option<Fitted> {
        let size = |k: usize| {
            let of = &fitted.elements;
            let with = (0..of.len()).filter(|other| *other == k || same_ball(&of[*other], &of[k]));
            let mut sum = self.residuals().zeros();
            with.for_each(|other| sum.add(1.0, &fitted.part(other).sum(self.residuals())));
            sum.product(&self.residuals().outside(&sum)).sqrt()
        };
        let largest = self.largest_curve(&fitted);
        let most = FIGHTING * fitted.gain_mm2.max(0.0).sqrt();
        let least = self.stands_mm2(&fitted).sqrt();
        let credible = |k: usize| size(k) > least.max(SHADOW * largest) && size(k) < most;
        let kept: Vec<Element> = (0..fitted.elements.len())
            .filter(|k| fitted.elements[*k].shape().is_none() || credible(*k))
            .map(|k| fitted.elements[k].clone())
            .collect();
        if kept.len() == fitted.elements.len() || kept.is_empty() {
            return Some(fitted);
        }
        self.fit_all(kept)
    }
}

/// Whether both are moves of one ball in one run.
fn same_ball(one: &Element, other: &Element) -> bool {
    let moves = |element: &Element| {
        let shape = element.shape()?;
        let of_run = matches!(element.owner, Owner::One { .. });
        of_run.then_some((shape.cause, shape.seat, element.owner))
    };
    moves(one).is_some_and(|one| moves(other) == Some(one))
}

/// Gain less what the numbers gain by chance, mm², by the noise beside some effects.
pub(super) fn score_mm2(beside: &Beside, fitted: &Fitted) -> f64 {
    fitted.gain_mm2 - beside.noise().by_chance_mm2(fitted.columns.len())
}

/// The variable over which a cause is smooth: of such causes several make any curve.
pub(super) fn smooth_over(element: &Element) -> Option<Variable> {
    let shape = element.shape().filter(|_| element.makes_any_curve())?;
    shape.dependence().map(|of| of.variable)
}

/// Whether it is a smooth function of the direction, and so of all positions.
fn round(element: &Element) -> bool {
    element.shape().is_some_and(|shape| matches!(shape.law(), Law::Harmonics(_)))
}

/// What a curve runs over, either way alike.
pub(super) fn described_over(element: &Element) -> Option<Variable> {
    match &element.form {
        Form::Empirical(curve) if !curve.with_sense => Some(curve.variable),
        _ => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::residual::bench::{element, residuals, white};
    use crate::residual::{Owner, fit};

    const NOISE_MM: f64 = 1.5e-4;
    /// From one reading to the next, a tenth of a second later.
    const CORRELATION: f64 = 0.9;
    const LONG_RUN: f64 = (1.0 + CORRELATION) / (1.0 - CORRELATION);

    /// Whether a vibration that is put into fifteen runs, to gain so many times what chance gives an amplitude, falls.
    fn falls(owner: Owner, gains: f64) -> bool {
        let (mut draw, mut state) = (white(21, 1.0), 0.0);
        let noise = residuals(15, move || {
            state = CORRELATION * state + (1.0 - CORRELATION.powi(2)).sqrt() * draw();
            NOISE_MM * state
        });
        let vibration = Element { owner, ..element("vibration:on=bar,frequency_hz=0.13") };
        // The sine of every run.
        let mut sines = noise.zeros();
        vibration.columns(&noise).iter().step_by(2).for_each(|sine| sines.add(1.0, sine));
        let square = noise.outside(&sines).square();
        let amplitude_mm = (gains * LONG_RUN * NOISE_MM * NOISE_MM / square).sqrt();
        let with = noise.plus(&sines.times(amplitude_mm));
        let fitted = fit(&with.alone(), vec![vibration]).unwrap();
        fallen(&with, &fitted, &|all| fit(&with.alone(), all)).is_some()
    }

    #[test]
    fn what_many_amplitudes_gain_by_chance_does_not_stand() {
        // Thirty amplitudes gain thirty more by chance; two do not.
        assert!(!falls(Owner::All, 90.0));
        assert!(falls(Owner::EachRun, 45.0));
        assert!(!falls(Owner::EachRun, 150.0));
    }

    /// As good as a straight line: what it would come to after weeks is more than a bar can read.
    #[test]
    fn a_drift_that_has_hardly_begun_stands() {
        let noise = residuals(3, white(5, NOISE_MM));
        let drift = element("drift:on=EYt,time_constant_s=1e6");
        let mut line = noise.zeros();
        line.add(2.0 * LINEAR_MM, &drift.columns(&noise)[0]);
        let with = noise.plus(&line);
        let fitted = fit(&with.alone(), vec![drift]).unwrap();
        assert!(fitted.amplitudes[0][0] > LINEAR_MM, "{:?}", fitted.amplitudes);
        assert!(fallen(&with, &fitted, &|all| fit(&with.alone(), all)).is_none());
    }
}
