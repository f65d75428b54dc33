//! Which effects there are: forward selection with replacement.
//!
//! At every step each cause of the library is tried on every seat, beside what has been accepted; the one
//! that explains most joins, and all are fitted anew. A curve of any shape over the same variables is tried
//! as well: where it explains much more than the best cause does, the best cause is the best of bad ones,
//! and the curve is taken instead.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::curves;
use super::data::{Data, dot};
use super::element::Element;
use super::joint::{self, Fitted};
use super::noise::Noise;
use super::screen::{Candidate, Screen};
use super::tidy::SHADOW;
use super::vibration;
use crate::model::{Component, Kind, Seat};

/// More effects than this are not looked for at once.
const MOST_EFFECTS: usize = 6;
/// Candidates that are looked at closely.
const CLOSELY: usize = 10;
/// And only those that explain at least this share of what the best one does.
const WORTH_A_LOOK: f64 = 0.4;
/// An effect must gain this many times what chance gives an amplitude: some seven sigma, for the search.
const BEYOND_CHANCE: f64 = 50.0;
/// And be this large against the noise of a reading, rms: of what is smaller too little shows to tell causes
/// from one another.
const WORTH_NAMING: f64 = 0.2;
/// A cause that explains less than this share of what a curve does is not named.
pub(super) const OF_A_CURVE: f64 = 0.95;
/// Two effects whose traces differ by less than this share of their squares are the same in these runs.
const SAME: f64 = 1e-3;
/// Effects whose difference is within so many of its standard deviations are not decided between.
const UNDECIDED_SIGMAS: f64 = 3.0;

/// A candidate after a closer look.
#[derive(Debug, Clone)]
pub(super) struct Tried {
    pub(super) fitted: Fitted,
    /// Gain less what its numbers gain by chance, mm².
    pub(super) score_mm2: f64,
}

/// Another explanation of the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Rival {
    /// What else it could be.
    pub element: Element,
    /// What it explains of what the named one does.
    pub share: f64,
    /// How far these runs tell them apart.
    pub told: Told,
}

/// Whether two explanations can be told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Told {
    /// They are the same in these runs, whatever the noise.
    Same,
    /// They differ by less than the noise does.
    Undecided,
    /// The other one explains less.
    Apart,
}

/// What was found.
#[derive(Debug)]
pub(super) struct Chosen {
    pub(super) fitted: Fitted,
    /// Other explanations of each element.
    pub(super) rivals: Vec<Vec<Rival>>,
}

/// The search, with what it looks at.
pub(super) struct Search<'a> {
    pub(super) data: &'a mut Data,
    pub(super) screen: &'a mut Screen,
    /// What was tried while nothing had been accepted.
    pub(super) first: Vec<Tried>,
}

impl Search<'_> {
    /// The effects that there are; `None` for none.
    pub(super) fn run(&mut self) -> Option<Chosen> {
        let mut fitted = self.forward(None, true, MOST_EFFECTS)?;
        fitted = self.tidied(fitted)?;
        let mut rivals = vec![Vec::new(); fitted.elements.len()];
        let mut index = 0;
        let mut replaced = 0;
        while index < fitted.elements.len() {
            let (better, others) = self.rivals(&fitted, index);
            match better {
                Some(better) if replaced < MOST_EFFECTS => {
                    fitted = better;
                    replaced += 1;
                    // What the others are may hang on it.
                    index = 0;
                    rivals = vec![Vec::new(); fitted.elements.len()];
                }
                _ => {
                    rivals[index] = others;
                    index += 1;
                }
            }
        }
        // Another explanation of one effect may be a makeshift beside the others.
        let stands = self.tidied(fitted.clone())?;
        if stands.elements != fitted.elements {
            fitted = stands;
            rivals = (0..fitted.elements.len()).map(|k| self.rivals(&fitted, k).1).collect();
        }
        self.accept(Some(&fitted));
        let fitted = self.by_size(fitted);
        Some(fitted).map(|(fitted, order)| Chosen {
            fitted,
            rivals: order.into_iter().map(|k| std::mem::take(&mut rivals[k])).collect(),
        })
    }

    /// The largest effect first.
    fn by_size(&mut self, fitted: Fitted) -> (Fitted, Vec<usize>) {
        let sizes: Vec<f64> = (0..fitted.elements.len())
            .map(|k| super::data::norm2(&fitted.part(k).effect(self.data)))
            .collect();
        let mut order: Vec<usize> = (0..sizes.len()).collect();
        order.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
        let elements = order.iter().map(|&k| fitted.elements[k].clone()).collect();
        let fitted = self.fit_all(elements).unwrap_or(fitted);
        (fitted, order)
    }

    /// Takes effects for accepted, or none.
    pub(super) fn accept(&mut self, fitted: Option<&Fitted>) {
        self.data.accept(fitted.map_or(&[], |fitted| &fitted.columns));
        self.screen.renew(self.data);
    }

    /// Fits effects together beside the model alone.
    pub(super) fn fit_all(&mut self, elements: Vec<Element>) -> Option<Fitted> {
        let span = std::mem::take(&mut self.data.span);
        let left = std::mem::take(&mut self.data.left_mm);
        self.data.accept(&[]);
        let fitted = joint::fit(self.data, elements);
        (self.data.span, self.data.left_mm) = (span, left);
        fitted
    }

    /// Adds what passes to what there is, up to so many effects.
    pub(super) fn forward(
        &mut self,
        from: Option<Fitted>,
        with_curves: bool,
        most: usize,
    ) -> Option<Fitted> {
        let mut chosen = from;
        self.accept(chosen.as_ref());
        while chosen.as_ref().map_or(0, |fitted| fitted.elements.len()) < most {
            let Some((next, score_mm2)) = self.next(chosen.as_ref(), with_curves) else { break };
            let curve = chosen.as_ref().map_or(0.0, |fitted| self.largest_curve(fitted));
            if score_mm2.sqrt() < SHADOW * curve {
                break;
            }
            let before = chosen.iter().flat_map(|fitted| fitted.elements.clone());
            let Some(all) = self.fit_all(before.chain(next).collect()) else { break };
            self.accept(Some(&all));
            chosen = Some(all);
        }
        chosen
    }

    /// What explains most beside what has been accepted, with its score, mm².
    pub(super) fn next(
        &mut self,
        chosen: Option<&Fitted>,
        with_curves: bool,
    ) -> Option<(Vec<Element>, f64)> {
        let noise = Noise::of(self.data);
        let least = threshold_mm2(self.data, &noise);
        let mut candidates = self.screen.candidates(self.data, least);
        if chosen.iter().flat_map(|fitted| &fitted.elements).any(Element::is_common_delay) {
            // Another delay that all slides have in common is a better estimate of the first one.
            candidates.retain(|candidate| !candidate.element.is_common_delay());
        }
        let mut best = closely(self.data, candidates, least);
        if let Some(first) = best.first_mut()
            && vibration::tune(self.data, &first.fitted.elements[0], &noise)
            && let Some(fitted) = joint::fit(self.data, first.fitted.elements.clone())
        {
            first.score_mm2 += fitted.gain_mm2 - first.fitted.gain_mm2;
            first.fitted = fitted;
        }
        if chosen.is_none() && self.first.is_empty() {
            self.first.clone_from(&best);
        }
        let best = best.into_iter().next().filter(|best| best.score_mm2 > least);
        let of_a_curve = |curve: &Tried| OF_A_CURVE * curve.score_mm2;
        let curve = with_curves
            .then(|| curves::best(self.data, &self.screen.channels, least, &|_| true))
            .flatten();
        let best = match (best, curve) {
            (Some(best), Some(curve)) if best.score_mm2 < of_a_curve(&curve) => curve,
            (Some(best), _) => best,
            (None, curve) => curve?,
        };
        Some((best.fitted.elements, best.score_mm2))
    }

    /// Gain less what the numbers gain by chance, mm².
    pub(super) fn score(&self, fitted: &Fitted) -> f64 {
        let noise = Noise::of(self.data);
        fitted.gain_mm2 - 2.0 * fitted.columns.len() as f64 * noise.long_run_mm2
    }

    /// What else an element could be; and all effects with a better one in its place, if there is one.
    fn rivals(&mut self, fitted: &Fitted, index: usize) -> (Option<Fitted>, Vec<Rival>) {
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

/// The most promising candidates fitted to the samples themselves, the best first; nothing where none
/// comes near what counts.
fn closely(data: &Data, candidates: Vec<Candidate>, least_mm2: f64) -> Vec<Tried> {
    let mut candidates = candidates;
    candidates.sort_by(|a, b| b.gain_mm2.total_cmp(&a.gain_mm2));
    let best = candidates.first().map_or(0.0, |c| c.gain_mm2);
    if best < 0.5 * least_mm2 {
        return Vec::new();
    }
    candidates.retain(|c| c.gain_mm2 > WORTH_A_LOOK * best);
    candidates.truncate(CLOSELY);
    let fitted: Vec<Fitted> = candidates
        .into_par_iter()
        .filter_map(|candidate| {
            let fitted = joint::fit(data, vec![candidate.element])?;
            (fitted.seen > super::screen::SEEN && fitted.elements[0].possible(data))
                .then_some(fitted)
        })
        .collect();
    let Some(best) = fitted.iter().max_by(|a, b| a.gain_mm2.total_cmp(&b.gain_mm2)) else {
        return Vec::new();
    };
    // What the best one explains is no noise.
    let by_chance_mm2 = 2.0 * Noise::of_left(data, &best.left_mm(data)).long_run_mm2;
    let score = |fitted: Fitted| {
        let score_mm2 = fitted.gain_mm2 - by_chance_mm2 * fitted.columns.len() as f64;
        Tried { fitted, score_mm2 }
    };
    let mut tried: Vec<Tried> = fitted.into_iter().map(score).collect();
    tried.sort_by(|a, b| b.score_mm2.total_cmp(&a.score_mm2));
    tried
}

/// The smallest score that counts, mm².
pub(super) fn threshold_mm2(data: &Data, noise: &Noise) -> f64 {
    let chance = BEYOND_CHANCE * noise.long_run_mm2;
    chance.max(WORTH_NAMING * WORTH_NAMING * noise.variance_mm2 * data.samples() as f64)
}
