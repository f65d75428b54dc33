//! Causes in the place of curves, where they explain as much.

use super::search::{NOT_LINEAR, Search};
use super::tidy::{described_over, score_mm2, smooth_over};
use crate::diagnose::seek::curves;
use crate::diagnose::thresholds::{INSTEAD_OF_A_CURVE, UNDECIDED_SIGMAS, threshold_mm2};
use crate::residual::{Element, Fitted};

impl Search<'_> {
    /// Causes in place of curves, where they explain as much.
    pub(crate) fn without_curves(&mut self, fitted: Fitted) -> Fitted {
        let mut best = fitted;
        let mut index = 0;
        while index < best.elements.len() {
            if best.elements[index].shape().is_some() {
                index += 1;
                continue;
            }
            let mut others = best.elements.clone();
            others.remove(index);
            let start = self.fit_others(others);
            let others_mm2 = start.as_ref().map_or(0.0, |others| others.gain_mm2);
            let most = best.elements.len() + 1;
            // The fit lets slides follow unlike in any case: their delays take no room from other causes.
            let causes = self.forward(start.clone(), false, most).and_then(|tried| {
                let delays = tried.elements.iter().filter(|e| e.is_delay()).count();
                self.forward(Some(tried), false, most + delays)
            });
            match causes {
                Some(causes) if self.stand_for_curve(&causes, &best, index, others_mm2) => {
                    (best, index) = (causes, 0);
                }
                causes => {
                    self.keep_nearly(start.as_ref(), causes, &best, others_mm2);
                    index += 1;
                }
            }
        }
        best
    }

    /// How much of what a curve explains beside the others causes in its place do.
    fn of_curve(&self, causes: &Fitted, with_curve: &Fitted, others_mm2: f64) -> f64 {
        let beside = self.beside(Some(causes));
        let of_curve_mm2 = |fitted: &Fitted| score_mm2(&beside, fitted) - others_mm2;
        of_curve_mm2(causes) / of_curve_mm2(with_curve)
    }

    /// Whether causes explain as much as the curve that is there without them.
    fn stand_for_curve(
        &self,
        causes: &Fitted,
        with_curve: &Fitted,
        index: usize,
        others_mm2: f64,
    ) -> bool {
        // That several come to the same as one curve does is a chance that they were chosen for.
        let several = causes.elements.len() > with_curve.elements.len();
        let least = if several { 1.0 } else { INSTEAD_OF_A_CURVE };
        self.of_curve(causes, with_curve, others_mm2) > least
            && !self.bends_less(causes, with_curve, index)
    }

    /// Keeps one cause that explains as much as a curve but for what is not linear: the first of those that were found in its place
    /// beside the others, and the first beside a slide that follows later than others as well, which any fit lets it.
    fn keep_nearly(
        &mut self,
        others: Option<&Fitted>,
        causes: Option<Fitted>,
        with_curve: &Fitted,
        others_mm2: f64,
    ) {
        let count = with_curve.elements.len();
        let late = self.with_delay(others);
        let late = late.and_then(|late| self.forward(Some(late), false, count + 1));
        for (tried, count) in [(causes, count), (late, count + 1)] {
            let first = tried.and_then(|tried| tried.elements.get(..count).map(<[_]>::to_vec));
            let Some(first) = first.and_then(|elements| self.fit_all(elements)) else { continue };
            let new = self.nearly.iter().all(|kept| kept.elements != first.elements);
            if new && self.of_curve(&first, with_curve, others_mm2) > 1.0 - NOT_LINEAR {
                self.nearly.push(first);
            }
        }
    }

    /// With the slide that follows later than others which explains most; `None` where none shows or one is there.
    fn with_delay(&self, fitted: Option<&Fitted>) -> Option<Fitted> {
        let elements = fitted.map_or_else(Vec::new, |fitted| fitted.elements.clone());
        if elements.iter().any(Element::is_delay) {
            return None;
        }
        let prospect = self.prospect(fitted);
        let candidates = self.candidates(&prospect, f64::INFINITY).into_iter();
        let delays = candidates.filter(|candidate| candidate.element.is_delay());
        let best = delays.max_by(|a, b| a.gain_mm2.total_cmp(&b.gain_mm2))?;
        let shows = best.gain_mm2 > threshold_mm2(&prospect.beside);
        shows.then(|| self.fit_all([elements, vec![best.element]].concat()))?
    }

    /// Whether causes that can be bent to any curve over what the curve runs over explain less than it does, by more than
    /// chance and the choice of its knots would, worth naming or not: then they are the best of what it is not.
    fn bends_less(&self, causes: &Fitted, with_curve: &Fitted, index: usize) -> bool {
        let over = described_over(&with_curve.elements[index]);
        if over.is_none() || !causes.elements.iter().any(|e| smooth_over(e) == over) {
            return false;
        }
        let beside = self.beside(Some(with_curve));
        let by_choice = curves::by_choice(with_curve.amplitudes[index].len());
        let counts_mm2 = (UNDECIDED_SIGMAS.powi(2) + by_choice) * beside.noise().long_run_mm2;
        score_mm2(&beside, causes) + counts_mm2 < score_mm2(&beside, with_curve)
    }
}
