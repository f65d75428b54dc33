//! What else an effect could be.

use std::cmp::Ordering;

use super::found::{Rival, Told};
use super::search::{Search, closely};
use crate::diagnose::thresholds::threshold_mm2;
use crate::model::{Component, Kind, Seat};
use crate::residual::data::dot;
use crate::residual::element::Element;
use crate::residual::joint::{self, Fitted};
use crate::residual::noise::Noise;

/// Two effects whose traces differ by less than this share of their squares are the same in these runs.
const SAME: f64 = 1e-3;
/// Effects whose difference is within so many of its standard deviations are not decided between.
const UNDECIDED_SIGMAS: f64 = 3.0;

impl Search<'_> {
    /// What else an element could be; and all effects with a better one in its place, if there is one.
    pub(crate) fn rivals(&mut self, fitted: &Fitted, index: usize) -> (Option<Fitted>, Vec<Rival>) {
        let element = fitted.elements[index].clone();
        if element.shape().is_none() {
            return (None, Vec::new());
        }
        self.accept(Some(fitted));
        let noise = Noise::of(self.data);
        let mut others = fitted.elements.clone();
        others.remove(index);
        let others = if others.is_empty() { None } else { self.fit_all(others) };
        self.accept(others.as_ref());
        let Some(own) = joint::fit(self.data, vec![element.clone()]) else {
            return (None, Vec::new());
        };
        let trace = own.outside(self.data);
        let square: f64 = trace.iter().map(|c| dot(c, c)).sum();
        let tried = match others {
            None if !self.first.is_empty() => self.first.clone(),
            _ => {
                let least = threshold_mm2(self.data, &noise);
                closely(self.data, self.screen.candidates(self.data, least), 0.0)
            }
        };
        let mut rivals = Vec::new();
        let mut better: Option<(Element, f64)> = None;
        for other in tried {
            let rival = &other.fitted.elements[0];
            if alike(rival, &element) {
                continue;
            }
            let other_trace = other.fitted.outside(self.data);
            let apart: f64 = trace
                .iter()
                .zip(&other_trace)
                .flat_map(|(a, b)| a.iter().zip(b))
                .map(|(a, b)| (a - b).powi(2))
                .sum();
            // Eleven amplitudes explain more than one does by chance.
            let by_chance = |of: &Fitted| 2.0 * of.columns.len() as f64 * noise.long_run_mm2;
            let less_mm2 =
                own.gain_mm2 - by_chance(&own) - other.fitted.gain_mm2 + by_chance(&other.fitted);
            let doubt_mm2 = UNDECIDED_SIGMAS * 2.0 * (noise.long_run_mm2 * apart).sqrt();
            let told = if apart < SAME * square {
                Told::Same
            } else if less_mm2.abs() < doubt_mm2 {
                Told::Undecided
            } else {
                Told::Apart
            };
            let preferred = match told {
                Told::Same | Told::Undecided => simpler(rival, &element) == Ordering::Less,
                Told::Apart => less_mm2 < 0.0,
            };
            // Of what hardly differs, the one that is named first, and never back again.
            if preferred && better.as_ref().is_none_or(|(b, _)| simpler(rival, b) == Ordering::Less)
            {
                better = Some((rival.clone(), other.fitted.gain_mm2));
            }
            let share = other.fitted.gain_mm2 / own.gain_mm2;
            rivals.push(Rival { element: rival.clone(), share, told });
        }
        let better = better.and_then(|(instead, _)| {
            let mut elements = fitted.elements.clone();
            elements[index] = instead;
            self.fit_all(elements)
        });
        (better, rivals)
    }
}

/// The same cause on the same seat; of periods only those that are one after the closer look.
fn alike(a: &Element, b: &Element) -> bool {
    let (Some(a), Some(b)) = (a.shape(), b.shape()) else { return false };
    let near = match (a.inner, b.inner) {
        (Some(x), Some(y)) => (x / y - 1.0).abs() < 0.02 || a.cause.kind == Kind::Drift,
        _ => true,
    };
    a.cause.kind == b.cause.kind && a.seat == b.seat && near
}

/// Which of two explanations that do equally well is named first.
fn simpler(a: &Element, b: &Element) -> Ordering {
    let rank = |element: &Element| {
        let Some(shape) = element.shape() else { return (true, usize::MAX, 0, 0) };
        // Eleven amplitudes explain more than one does.
        let many = shape.amplitudes() > 2;
        let cause = shape.cause.kind as usize;
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
