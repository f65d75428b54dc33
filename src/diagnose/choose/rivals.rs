//! What else an effect could be.

use std::cmp::Ordering;

use super::found::{Rival, Separation};
use super::search::Search;
use crate::diagnose::thresholds::{ONE_NUMBER, SAME, UNDECIDED_SIGMAS, threshold_mm2};
use crate::model::{Component, Inner, Law, Seat, Start};
use crate::residual::{self, Column, Element, Fitted, Noise};

impl Search<'_> {
    /// What else an element could be; and all effects with a better one in its place, if there is one.
    pub(crate) fn rivals(&self, fitted: &Fitted, index: usize) -> (Option<Fitted>, Vec<Rival>) {
        let element = &fitted.elements[index];
        if element.shape().is_none() {
            return (None, Vec::new());
        }
        let all = self.beside(Some(fitted));
        let mut others = fitted.elements.clone();
        others.remove(index);
        let others = self.fit_others(others);
        let prospect = self.prospect(others.as_ref());
        let Some(own) = residual::fit(&prospect.beside, vec![element.clone()]) else {
            return (None, Vec::new());
        };
        let tried = match others {
            None if !self.first.is_empty() => self.first.clone(),
            _ => self.all_in(&prospect, threshold_mm2(&all)),
        };
        let duel = Duel { noise: all.noise(), trace: own.outside(&prospect.beside), own: &own };
        let mut rivals = Vec::new();
        let mut better: Option<Element> = None;
        for other in tried {
            let rival = &other.fitted.elements[0];
            if alike(rival, element) {
                continue;
            }
            let trace = other.fitted.outside(&prospect.beside);
            let less_mm2 = duel.less_mm2(&other.fitted);
            let separation = duel.separation(&trace, less_mm2);
            let preferred = match separation {
                Separation::Same | Separation::Undecided => {
                    simpler(rival, element) == Ordering::Less
                }
                Separation::Apart => less_mm2 < 0.0,
            };
            // Of what hardly differs, the one that is named first, and never back again.
            if preferred && better.as_ref().is_none_or(|b| simpler(rival, b) == Ordering::Less) {
                better = Some(rival.clone());
            }
            let share = other.fitted.gain_mm2 / own.gain_mm2;
            rivals.push(Rival { element: rival.clone(), share, separation });
        }
        let better = better.and_then(|instead| {
            let mut elements = fitted.elements.clone();
            elements[index] = instead;
            self.fit_all(elements)
        });
        (better, rivals)
    }
}

/// One explanation held against others.
struct Duel<'a> {
    noise: &'a Noise,
    own: &'a Fitted,
    /// What it does outside of everything else.
    trace: Column,
}

impl Duel<'_> {
    /// By how much another one explains less, mm², each less what its numbers explain by chance: eleven
    /// amplitudes explain more than one does.
    fn less_mm2(&self, other: &Fitted) -> f64 {
        let by_chance = |of: &Fitted| self.noise.by_chance_mm2(of.columns.len());
        self.own.gain_mm2 - by_chance(self.own) - other.gain_mm2 + by_chance(other)
    }

    /// Whether these runs tell another one apart, which explains so much less: with traces `t` and `t'` the
    /// difference of the gains has the standard deviation `2 sqrt(v) |t - t'|`.
    fn separation(&self, trace: &Column, less_mm2: f64) -> Separation {
        let mut apart = self.trace.clone();
        apart.add(-1.0, trace);
        let apart_mm2 = apart.square();
        let doubt_mm2 = UNDECIDED_SIGMAS * 2.0 * (self.noise.long_run_mm2 * apart_mm2).sqrt();
        if apart_mm2 < SAME * self.trace.product(&self.trace) {
            Separation::Same
        } else if less_mm2.abs() < doubt_mm2 {
            Separation::Undecided
        } else {
            Separation::Apart
        }
    }
}

/// The same cause on the same seat; of periods only those that are one after the closer look.
fn alike(a: &Element, b: &Element) -> bool {
    let (Some(a), Some(b)) = (a.shape(), b.shape()) else { return false };
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
        let Some(shape) = element.shape() else { return (true, usize::MAX, 0, 0) };
        // Eleven amplitudes explain more than one does.
        let many = shape.amplitudes() > 2;
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
        (many, cause, seat, component)
    };
    rank(a).cmp(&rank(b))
}
