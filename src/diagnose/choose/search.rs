//! Which effects there are: forward selection with replacement.
//!
//! At every step each cause of the library is tried on every seat, beside what has been accepted; the one
//! that explains most joins, and all are fitted anew. A curve of any shape over the same variables is tried
//! as well: where it explains much more than the best cause does, the best cause is the best of bad ones,
//! and the curve is taken instead.

use rayon::prelude::*;

use crate::diagnose::seek::candidate::{Candidate, Tried};
use crate::diagnose::seek::curves;
use crate::diagnose::seek::screen::Screen;
use crate::diagnose::seek::vibration;
use crate::diagnose::thresholds::{OF_A_CURVE, SEEN, SHADOW, threshold_mm2};
use crate::residual::data::{Data, norm2};
use crate::residual::element::Element;
use crate::residual::joint::{self, Fitted};
use crate::residual::noise::Noise;

/// More effects than this are not looked for at once.
pub(crate) const MOST_EFFECTS: usize = 6;
/// Candidates that are looked at closely.
const CLOSELY: usize = 10;
/// And only those that explain at least this share of what the best one does.
const WORTH_A_LOOK: f64 = 0.4;

/// The search, with what it looks at.
pub(crate) struct Search<'a> {
    pub(crate) data: &'a mut Data,
    pub(crate) screen: &'a mut Screen,
    /// What was tried while nothing had been accepted.
    pub(crate) first: Vec<Tried>,
}

impl Search<'_> {
    /// Takes effects for accepted, or none.
    pub(crate) fn accept(&mut self, fitted: Option<&Fitted>) {
        self.data.accept(fitted.map_or(&[], |fitted| &fitted.columns));
        self.screen.renew(self.data);
    }

    /// Fits effects together beside the model alone.
    pub(crate) fn fit_all(&mut self, elements: Vec<Element>) -> Option<Fitted> {
        let span = std::mem::take(&mut self.data.span);
        let left = std::mem::take(&mut self.data.left_mm);
        self.data.accept(&[]);
        let fitted = joint::fit(self.data, elements);
        (self.data.span, self.data.left_mm) = (span, left);
        fitted
    }

    /// Adds what passes to what there is, up to so many effects.
    pub(crate) fn forward(
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
    pub(crate) fn next(
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

    /// Root of the sum of squares of the largest curve, mm; 0 where there is none.
    pub(crate) fn largest_curve(&self, fitted: &Fitted) -> f64 {
        let curves = (0..fitted.elements.len()).filter(|k| fitted.elements[*k].shape().is_none());
        curves.map(|k| norm2(&fitted.part(k).effect(self.data)).sqrt()).fold(0.0, f64::max)
    }

    /// Gain less what the numbers gain by chance, mm².
    pub(crate) fn score(&self, fitted: &Fitted) -> f64 {
        let noise = Noise::of(self.data);
        fitted.gain_mm2 - 2.0 * fitted.columns.len() as f64 * noise.long_run_mm2
    }
}

/// The most promising candidates fitted to the samples themselves, the best first; nothing where none
/// comes near what counts.
pub(crate) fn closely(data: &Data, candidates: Vec<Candidate>, least_mm2: f64) -> Vec<Tried> {
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
            (fitted.seen > SEEN && fitted.elements[0].possible(data)).then_some(fitted)
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
