//! Two effects at once, of which neither shows by itself.
//!
//! What one effect leaves of the other hangs together for as long as no noise does, and next to that neither is more than chance.
//! Next to both only noise is left, and each has to be more than chance by that.

use super::search::{Search, closely, shows};
use crate::diagnose::seek::candidate::{Candidate, Tried};
use crate::diagnose::seek::screen::Prospect;
use crate::diagnose::thresholds::{SAME, chosen_mm2, stands_mm2, threshold_mm2};
use crate::residual::{self, Beside, Column, Fitted, Noise};

impl Search<'_> {
    /// The two effects that explain most together beside what has been chosen: the second is looked for beside each that comes
    /// near being the best one by itself, of those that were tried, or of the candidates where none of them came near what counts.
    pub(super) fn two_at_once(
        &self,
        chosen: Option<&Fitted>,
        prospect: &Prospect,
        tried: Vec<Tried>,
        candidates: Vec<Candidate>,
    ) -> Option<Tried> {
        let beside = &prospect.beside;
        let least_mm2 = least_mm2(beside);
        let mut firsts =
            if tried.is_empty() { closely(beside, candidates, least_mm2) } else { tried };
        firsts.retain(|first| first.fitted.gain_mm2 > least_mm2);
        // On seats that no reading tells apart it is one effect.
        firsts.dedup_by(|b, a| b.fitted.gain_mm2 > (1.0 - SAME) * a.fitted.gain_mm2);
        let both = firsts.iter().filter_map(|first| self.beside_first(chosen, prospect, first));
        both.max_by(|a, b| a.score_mm2.total_cmp(&b.score_mm2))
    }

    /// An effect with the one that explains most beside it; `None` where one of them is no more than chance beside the other.
    fn beside_first(
        &self,
        chosen: Option<&Fitted>,
        prospect: &Prospect,
        first: &Tried,
    ) -> Option<Tried> {
        let beside = &prospect.beside;
        let accepted = chosen.map_or(&[][..], |chosen| &chosen.columns);
        let columns: Vec<Column> = accepted.iter().chain(&first.fitted.columns).cloned().collect();
        let next_to_it = self.screened(self.residuals().beside(&columns));
        let candidates = self.candidates(&next_to_it, threshold_mm2(&next_to_it.beside));
        let second = closely(&next_to_it.beside, candidates, least_mm2(&next_to_it.beside));
        let [first, second] = [first, second.first()?].map(|tried| &tried.fitted.elements);
        let fitted = residual::fit(beside, first.iter().chain(second).cloned().collect())?;
        let credible = shows(&fitted, beside)
            && fitted.elements.iter().all(|element| element.possible(beside.residuals));
        let left_mm = fitted.left_mm(beside);
        let noise = Noise::of(beside.residuals, &left_mm);
        let least_mm2 = chosen_mm2(beside.residuals, &noise, left_mm.square());
        let counts = |one: &[_]| {
            let alone = residual::fit(beside, one.to_vec());
            alone.is_some_and(|alone| fitted.gain_mm2 - alone.gain_mm2 > least_mm2)
        };
        let (one, other) = fitted.elements.split_at(first.len());
        let score_mm2 = fitted.gain_mm2 - noise.by_chance_mm2(fitted.columns.len());
        (credible && counts(one) && counts(other)).then_some(Tried { fitted, score_mm2 })
    }
}

/// What does not gain this does not count although nothing but what neighbours differ by were noise, mm².
fn least_mm2(beside: &Beside) -> f64 {
    let noise = beside.noise();
    let least = Noise { long_run_mm2: noise.neighbours_mm2, ..*noise };
    stands_mm2(beside.residuals, &least, beside.left_mm2())
}
