//! One step of the search: what explains most beside what is chosen already.
//!
//! At every step each cause of the library is tried on every seat; the one that explains most joins, and all
//! are fitted anew. A curve of any shape over the same variables is tried as well: where even the best cause
//! explains less than the curve does, it is the best of bad ones, and the curve is taken instead, until causes
//! together explain as much.

use rayon::prelude::*;

use crate::diagnose::seek::candidate::{Candidate, Tried};
use crate::diagnose::seek::screen::{Prospect, Screen};
use crate::diagnose::seek::{curves, vibration};
use crate::diagnose::thresholds::{
    LINEAR_MM, OF_A_CURVE, SHADOW, SHOWS, chosen_mm2, stands_mm2, threshold_mm2,
};
use crate::identify::Campaign;
use crate::residual::{self, Beside, Element, Fitted, Noise, Owner, Residuals, Tuning};

/// More effects than this are not looked for at once.
pub(crate) const MOST_EFFECTS: usize = 6;
/// Candidates that are looked at closely.
const CLOSELY: usize = 10;
/// And only those that explain at least this share of what the best one does.
const WORTH_A_LOOK: f64 = 0.4;
/// What is looked for about the model with the effects that are chosen, as a share of what they explain: a search is linear, and about
/// the model without them this much may be theirs. By trial: 10 % of their rms, of a ball that has moved by 0.18 mm four curves of 5 %.
pub(super) const NOT_LINEAR: f64 = 1e-2;
/// Nothing is looked at closely where the best candidate explains less than this share of what counts: the look
/// over bins is no worse than that.
const NEAR_WHAT_COUNTS: f64 = 0.5;

/// The search, with what it looks at.
pub(crate) struct Search<'a> {
    /// What the model alone leaves.
    alone: Beside<'a>,
    screen: Screen,
    /// How vibrations differ from run to run: all of them alike, and found once.
    tuning: Tuning,
    /// What was tried while nothing had been chosen.
    pub(crate) first: Vec<Tried>,
    /// Effects with causes in the place of a curve, which explain nearly as much.
    pub(super) nearly: Vec<Fitted>,
}

impl<'a> Search<'a> {
    pub(crate) fn new(residuals: &'a Residuals, campaign: &Campaign) -> Self {
        let alone = residuals.alone();
        let screen = Screen::new(&alone, campaign);
        Self { alone, screen, tuning: Tuning::default(), first: Vec::new(), nearly: Vec::new() }
    }

    pub(crate) fn residuals(&self) -> &'a Residuals {
        self.alone.residuals
    }

    /// What is left beside what has been chosen.
    pub(crate) fn beside(&self, chosen: Option<&Fitted>) -> Beside<'a> {
        self.residuals().beside(chosen.map_or(&[], |fitted| &fitted.columns))
    }

    /// All that effects may hang on, beside what has been chosen.
    pub(crate) fn prospect(&self, chosen: Option<&Fitted>) -> Prospect<'_> {
        self.screened(self.beside(chosen))
    }

    /// The same beside whatever has been accepted.
    pub(super) fn screened<'b>(&'b self, beside: Beside<'b>) -> Prospect<'b> {
        self.screen.beside(beside)
    }

    /// Fits effects together beside the model alone.
    pub(crate) fn fit_all(&self, mut elements: Vec<Element>) -> Option<Fitted> {
        for element in elements.iter_mut().filter(|element| element.owner == Owner::EachRun) {
            element.tuning.clone_from(&self.tuning);
        }
        residual::fit(&self.alone, elements)
    }

    /// The same; nothing where there are none.
    pub(crate) fn fit_others(&self, elements: Vec<Element>) -> Option<Fitted> {
        if elements.is_empty() { None } else { self.fit_all(elements) }
    }

    /// Adds what passes to what there is, up to so many effects.
    pub(crate) fn forward(
        &mut self,
        from: Option<Fitted>,
        with_curves: bool,
        most: usize,
    ) -> Option<Fitted> {
        let mut chosen = from;
        while chosen.as_ref().map_or(0, |fitted| fitted.elements.len()) < most {
            let room = most - chosen.as_ref().map_or(0, |fitted| fitted.elements.len());
            let Some((next, score_mm2)) = self.next(chosen.as_ref(), with_curves, room) else {
                break;
            };
            let curve = chosen.as_ref().map_or(0.0, |fitted| self.largest_curve(fitted));
            if score_mm2.sqrt() < SHADOW * curve || score_mm2 < self.not_linear_mm2(chosen.as_ref())
            {
                break;
            }
            let before = chosen.iter().flat_map(|fitted| fitted.elements.clone());
            let Some(all) = self.fit_all(before.chain(next).collect()) else { break };
            chosen = Some(all);
        }
        chosen
    }

    /// What gains less than this beside effects is looked for about the model with them: about one without them, whose numbers and
    /// times they have moved, it may be what is not linear of the effects themselves.
    fn not_linear_mm2(&self, chosen: Option<&Fitted>) -> f64 {
        let gain_mm2 = chosen.map_or(0.0, |fitted| fitted.gain_mm2);
        if self.residuals().held { 0.0 } else { NOT_LINEAR * gain_mm2 }
    }

    /// What explains most beside what has been chosen, with its score, mm²: no more effects than there is room for.
    pub(crate) fn next(
        &mut self,
        chosen: Option<&Fitted>,
        with_curves: bool,
        room: usize,
    ) -> Option<(Vec<Element>, f64)> {
        let prospect = self.screen.beside(self.beside(chosen));
        let beside = &prospect.beside;
        let least = threshold_mm2(beside);
        let mut candidates = prospect.candidates(&self.tuning, least);
        if chosen.iter().flat_map(|fitted| &fitted.elements).any(Element::is_common_delay) {
            // Another delay that all slides have in common is a better estimate of the first one.
            candidates.retain(|candidate| !candidate.element.is_common_delay());
        }
        let mut best = closely(beside, candidates.clone(), least);
        if let Some(first) = best.first_mut()
            && let Some(lower) = vibration::lowest(beside, &first.fitted)
        {
            first.score_mm2 += lower.gain_mm2 - first.fitted.gain_mm2;
            first.fitted = lower;
        }
        let mut tuning = None;
        if let Some(first) = best.first_mut().filter(|_| !self.tuning.differs())
            && let Some(found) = vibration::tuned(beside, &first.fitted.elements[0])
        {
            let tuned = Element { tuning: found.clone(), ..first.fitted.elements[0].clone() };
            if let Some(fitted) = residual::fit(beside, vec![tuned]) {
                first.score_mm2 += fitted.gain_mm2 - first.fitted.gain_mm2;
                first.fitted = fitted;
            }
            tuning = Some(found);
        }
        let first = best.clone();
        let is_no_chance = |best: &Tried| {
            best.score_mm2 > least || best.score_mm2 > chosen_beside_mm2(beside, best)
        };
        let best = best.into_iter().next().filter(is_no_chance);
        let pair = if room < 2 { None } else { there_and_back(&prospect, least) };
        let pair = pair.filter(is_no_chance);
        let best_mm2 = best.as_ref().map_or(0.0, |best| best.score_mm2);
        let pair = pair.filter(|pair| pair.score_mm2 > best_mm2);
        let pair = match (&best, pair) {
            (None, None) if room > 1 => {
                self.two_at_once(chosen, &prospect, first.clone(), candidates)
            }
            (_, pair) => pair,
        };
        let curve = with_curves.then(|| match &pair {
            // What two moves explain is no noise: beside that a curve may show what they only come near.
            Some(pair) => {
                let noise = Noise::of(beside.residuals, &pair.fitted.left_mm(beside));
                let curves = curves::over_each(beside, &prospect.looks, &noise, &|_| true);
                curves.into_iter().max_by(|a, b| a.score_mm2.total_cmp(&b.score_mm2))
            }
            None => curves::best(beside, &prospect.looks, least, &|_| true),
        });
        let (best, curve) = (pair.or(best), curve.flatten());
        if let Some(tuning) = tuning {
            self.tuning = tuning;
        }
        if chosen.is_none() && self.first.is_empty() {
            self.first = first;
        }
        let best = match (best, curve) {
            (Some(best), Some(curve)) if falls_short(beside, &best, &curve) => curve,
            (Some(best), _) => best,
            (None, curve) => curve?,
        };
        Some((best.fitted.elements, best.score_mm2))
    }

    /// What else explains something in some prospect, however little; what takes long to look for only where it
    /// may explain `least_mm2`.
    pub(crate) fn all_in(&self, prospect: &Prospect, least_mm2: f64) -> Vec<Tried> {
        closely(&prospect.beside, self.candidates(prospect, least_mm2), 0.0)
    }

    /// What may explain something in some prospect; what takes long to look for only where it may explain `least_mm2`.
    pub(super) fn candidates(&self, prospect: &Prospect, least_mm2: f64) -> Vec<Candidate> {
        prospect.candidates(&self.tuning, least_mm2)
    }

    /// Root of the sum of squares of the largest curve, mm; 0 where there is none.
    pub(crate) fn largest_curve(&self, fitted: &Fitted) -> f64 {
        let curves = (0..fitted.elements.len()).filter(|k| fitted.elements[*k].shape().is_none());
        curves.map(|k| fitted.part_mm2(k, self.residuals()).sqrt()).fold(0.0, f64::max)
    }
}

/// What it must gain by what is left beside it.
fn chosen_beside_mm2(beside: &Beside, tried: &Tried) -> f64 {
    let left_mm = tried.fitted.left_mm(beside);
    let noise = Noise::of(beside.residuals, &left_mm);
    chosen_mm2(beside.residuals, &noise, left_mm.square())
}

/// Whether a cause explains less than a curve does: of one that bends to any bump, by any more than what counts beside the
/// curve; of the others, whose edges a curve cannot follow, by much.
fn falls_short(beside: &Beside, cause: &Tried, curve: &Tried) -> bool {
    let bends = cause.fitted.elements.iter().any(Element::makes_any_curve);
    let counts_mm2 = || {
        let left_mm = curve.fitted.left_mm(beside);
        let noise = Noise::of(beside.residuals, &left_mm);
        let by_choice_mm2 = curves::by_choice(curve.fitted.columns.len()) * noise.long_run_mm2;
        stands_mm2(beside.residuals, &noise, left_mm.square()) + by_choice_mm2
    };
    cause.score_mm2 < OF_A_CURVE * curve.score_mm2
        || (bends && cause.score_mm2 + counts_mm2() < curve.score_mm2)
}

/// The most promising candidates fitted to the samples themselves, the best first; nothing where none
/// comes near what counts.
pub(super) fn closely(
    beside: &Beside,
    mut candidates: Vec<Candidate>,
    least_mm2: f64,
) -> Vec<Tried> {
    candidates.sort_by(|a, b| told(b.gain_mm2).total_cmp(&told(a.gain_mm2)));
    let best = candidates.first().map_or(0.0, |c| c.gain_mm2);
    if best < NEAR_WHAT_COUNTS * least_mm2 {
        return Vec::new();
    }
    candidates.retain(|c| c.gain_mm2 > WORTH_A_LOOK * best);
    candidates.truncate(CLOSELY);
    let fitted: Vec<Fitted> = candidates
        .into_par_iter()
        .filter_map(|candidate| {
            let fitted = residual::fit(beside, vec![candidate.element])?;
            let credible = shows(&fitted, beside) && fitted.elements[0].possible(beside.residuals);
            credible.then_some(fitted)
        })
        .collect();
    let Some(best) = fitted.iter().max_by(|a, b| a.gain_mm2.total_cmp(&b.gain_mm2)) else {
        return Vec::new();
    };
    // What the best one explains is no noise.
    let noise = Noise::of(beside.residuals, &best.left_mm(beside));
    let score = |fitted: Fitted| {
        let score_mm2 = fitted.gain_mm2 - noise.by_chance_mm2(fitted.columns.len());
        Tried { fitted, score_mm2 }
    };
    let is_told = |fitted: &Fitted| fitted.tells_numbers(noise.long_run_mm2);
    let mut tried: Vec<Tried> = fitted.into_iter().filter(is_told).map(score).collect();
    tried.sort_by(|a, b| told(b.score_mm2).total_cmp(&told(a.score_mm2)));
    tried
}

/// Two moves of a ball at once, of which neither shows by itself. For the second one the score is less by what counts: where one effect
/// explains as much, that one is told.
fn there_and_back(prospect: &Prospect, least_mm2: f64) -> Option<Tried> {
    let (beside, fitted) = (&prospect.beside, prospect.there_and_back(least_mm2)?);
    let noise = Noise::of(beside.residuals, &fitted.left_mm(beside));
    let by_chance_mm2 = noise.by_chance_mm2(fitted.columns.len());
    let score_mm2 = fitted.gain_mm2 - by_chance_mm2 - least_mm2;
    shows(&fitted, beside).then_some(Tried { fitted, score_mm2 })
}

/// Whether enough of an effect is seen, for as far as it would move readings.
pub(super) fn shows(fitted: &Fitted, beside: &Beside) -> bool {
    let moves = fitted.sum(beside.residuals);
    let farthest_mm = moves.iter().flatten().fold(0.0_f64, |most, mm| most.max(mm.abs()));
    let share = fitted.share_outside;
    share > SHOWS && farthest_mm < LINEAR_MM * share.sqrt()
}

/// A gain to seven digits. On seats that no reading tells apart an effect gains the same but for rounding, which is not to say
/// which of them stands for all: the first in the library does.
fn told(gain_mm2: f64) -> f64 {
    f64::from_bits(gain_mm2.to_bits() & !0xfff_ffff)
}
