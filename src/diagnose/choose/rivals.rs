//! What else an effect could be.

use std::cmp::Ordering;

use super::found::{Rival, Separation};
use super::search::Search;
use crate::diagnose::seek::curves;
use crate::diagnose::thresholds::{ONE_NUMBER, SAME, UNDECIDED_SIGMAS, threshold_mm2};
use crate::model::{Component, Form, Inner, Law, Seat, Start};
use crate::residual::{self, Beside, Column, Element, Fitted, Noise};

impl Search<'_> {
    /// What else an element could be; and all effects with a better one in its place, if there is one.
    pub(crate) fn rivals(&self, fitted: &Fitted, index: usize) -> (Option<Fitted>, Vec<Rival>) {
        let element = &fitted.elements[index];
        let all = self.beside(Some(fitted));
        let mut others = fitted.elements.clone();
        others.remove(index);
        let others = self.fit_others(others);
        let prospect = self.prospect(others.as_ref());
        let Some(own) = residual::fit(&prospect.beside, vec![element.clone()]) else {
            return (None, Vec::new());
        };
        let tried = match others {
            _ if element.shape().is_none() => {
                curves::over_each(&prospect.beside, &prospect.looks, all.noise(), &|_| true)
            }
            None if !self.first.is_empty() => self.first.clone(),
            _ => self.all_in(&prospect, threshold_mm2(&all)),
        };
        let noise = all.noise();
        let pieces = (all.left_mm2() / noise.long_run_mm2).max(1.0);
        let duel = Duel { noise, pieces, own: &own, beside: &prospect.beside };
        let mut rivals = Vec::new();
        let mut better: Option<Fitted> = None;
        for other in tried {
            let rival = &other.fitted.elements[0];
            if alike(rival, element) {
                continue;
            }
            let less_mm2 = duel.less_mm2(&other.fitted);
            let separation = duel.separation(&other.fitted, less_mm2);
            let first = duel.named_first(&other.fitted, &own);
            let preferred = match separation {
                Separation::Same | Separation::Undecided => first,
                Separation::Apart => less_mm2 < 0.0,
            };
            let share = other.fitted.gain_mm2 / own.gain_mm2;
            rivals.push(Rival { element: rival.clone(), share, separation });
            // Of what hardly differs, the one that is named first, and never back again.
            if preferred && better.as_ref().is_none_or(|b| duel.named_first(&other.fitted, b)) {
                better = Some(other.fitted);
            }
        }
        let better = better.and_then(|instead| {
            let mut elements = fitted.elements.clone();
            elements.splice(index..=index, instead.elements);
            self.fit_all(elements)
        });
        (better, rivals)
    }
}

/// One explanation held against others.
struct Duel<'a> {
    noise: &'a Noise,
    /// How many readings would say as much if they were independent.
    pieces: f64,
    own: &'a Fitted,
    /// Everything else.
    beside: &'a Beside<'a>,
}

impl Duel<'_> {
    /// By how much another one explains less, mm², each less what its numbers explain by chance: eleven
    /// amplitudes explain more than one does.
    fn less_mm2(&self, other: &Fitted) -> f64 {
        let by_chance = |of: &Fitted| self.noise.by_chance_mm2(of.columns.len());
        self.own.gain_mm2 - by_chance(self.own) - other.gain_mm2 + by_chance(other)
    }

    /// Which of two explanations that do equally well is named first. Of causes that is a question of what
    /// people know; of curves, see [`Self::likelier`].
    fn named_first(&self, one: &Fitted, other: &Fitted) -> bool {
        let (a, b) = (&one.elements[0], &other.elements[0]);
        match a.curve().and(b.curve()) {
            Some(_) => self.likelier(one, other),
            None => simpler(a, b) == Ordering::Less,
        }
    }

    /// Whether the readings make one curve likelier than another, with a law for its numbers as wide as all of
    /// them: `gain - k v ln n`, `n` what is independent of the readings (Schwarz 1978). Where knots, and not
    /// noise, are what the gains differ by, the one that needs fewer: a curve by direction takes the shape of
    /// another variable's with many.
    fn likelier(&self, one: &Fitted, other: &Fitted) -> bool {
        let (a, b) = (one.columns.len(), other.columns.len());
        if (one.gain_mm2 - other.gain_mm2).abs() < SAME * one.gain_mm2.max(other.gain_mm2) && a != b
        {
            return a < b;
        }
        let price_mm2 = self.noise.long_run_mm2 * self.pieces.ln();
        one.gain_mm2 - a as f64 * price_mm2 > other.gain_mm2 - b as f64 * price_mm2
    }

    /// Whether these runs tell another one apart, which explains so much less: with `t` and `t'` what they do at the samples the
    /// difference of the gains has the standard deviation `2 sqrt(v) |t - t'|`, where `|t|² = t · t''` is what a [`Beside`] leaves.
    /// Of curves a part of the gain is what their knots make of it.
    fn separation(&self, other: &Fitted, less_mm2: f64) -> Separation {
        let square_mm2 = |column: &Column| column.product(&self.beside.outside(column));
        let own = self.own.sum(self.beside.residuals);
        let mut apart = own.clone();
        apart.add(-1.0, &other.sum(self.beside.residuals));
        let apart_mm2 = square_mm2(&apart);
        let curves = self.own.elements[0].curve().and(other.elements[0].curve());
        let by_knots_mm2 = curves.map_or(0.0, |_| SAME * self.own.gain_mm2);
        let by_noise_mm2 = UNDECIDED_SIGMAS * 2.0 * (self.noise.long_run_mm2 * apart_mm2).sqrt();
        let doubt_mm2 = by_noise_mm2.max(by_knots_mm2);
        if apart_mm2 < SAME * square_mm2(&own) {
            Separation::Same
        } else if less_mm2.abs() < doubt_mm2 {
            Separation::Undecided
        } else {
            Separation::Apart
        }
    }
}

/// The same cause on the same seat; of periods only those that are one after the closer look. Of curves all over the
/// same variable: which error function it is that hangs on it, the best of them says.
fn alike(a: &Element, b: &Element) -> bool {
    let (a, b) = match (&a.form, &b.form) {
        (Form::Cause(a), Form::Cause(b)) => (a, b),
        (Form::Empirical(a), Form::Empirical(b)) => {
            return a.variable == b.variable && a.with_sense == b.with_sense;
        }
        _ => return false,
    };
    // Long time constants are one straight line.
    let straight = matches!(a.law().inner(), Some(Inner { start: Start::TimeConstants(..), .. }));
    // Another delay that all slides share is another estimate of the first one.
    let shared = matches!(a.law(), Law::Corner(_));
    let near = match (a.inner, b.inner) {
        (Some(x), Some(y)) => (x / y - 1.0).abs() < ONE_NUMBER || straight || shared,
        _ => true,
    };
    a.cause == b.cause && a.seat == b.seat && near
}

/// Which of two explanations that do equally well is named first.
fn simpler(a: &Element, b: &Element) -> Ordering {
    let rank = |element: &Element| {
        let Some(shape) = element.shape() else { return (2, usize::MAX, 0, 0) };
        let group = match shape.law().inner() {
            // A vibration that keeps step with the slides is a coincidence.
            Some(Inner { start: Start::Lines, .. }) => 2,
            // Eleven amplitudes explain more than one does.
            _ if shape.amplitudes() > 2 => 1,
            _ => 0,
        };
        let cause = shape.cause.rank();
        let seat = match shape.seat {
            Seat::Function(slide, component) if component as usize == slide.index() => 0,
            Seat::Function(_, component) if !component.is_angular() => 1,
            Seat::Function(..) => 2,
            _ => 0,
        };
        let component = match shape.seat {
            Seat::Function(_, component) => component as usize,
            _ => Component::X as usize,
        };
        (group, cause, seat, component)
    };
    rank(a).cmp(&rank(b))
}
