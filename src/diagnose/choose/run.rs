//! The search from its first candidate to what stands.

use super::found::{Chosen, Rival};
use super::search::{MOST_EFFECTS, Search};
use crate::identify::Campaign;
use crate::residual::{Fitted, Residuals};

/// The effects that there are; `None` for none.
pub(crate) fn chosen(residuals: &Residuals, campaign: &Campaign) -> Option<Chosen> {
    let mut search = Search::new(residuals, campaign);
    let fitted = search.forward(None, true, MOST_EFFECTS)?;
    search.named(fitted)
}

/// What a look about the extended model says of the effects that it was extended by.
pub(crate) enum Again {
    /// They stand, and nothing else does but, maybe, [these](Chosen::nearly).
    Same(Vec<Chosen>),
    /// These do instead; `None` for none.
    Other(Option<Chosen>),
}

/// Looks again: the search that chose the effects was linear about a model without them, whose numbers and times they had
/// moved.
pub(crate) fn again(residuals: &Residuals, campaign: &Campaign, chosen: &Chosen) -> Again {
    let mut search = Search::new(residuals, campaign);
    let Some(fitted) = search.fit_all(chosen.fitted.elements.clone()) else {
        return Again::Same(Vec::new());
    };
    let count = fitted.elements.len();
    let stands = search.beyond_chance(fitted);
    let dropped = stands.as_ref().is_none_or(|fitted| fitted.elements.len() < count);
    let stands = search.forward(stands, true, MOST_EFFECTS);
    let stands = match stands {
        Some(fitted) if !dropped && fitted.elements.len() == count => {
            // A cause that fell a little short of a curve there may explain as much here.
            let elements = fitted.elements.clone();
            let causes = search.without_curves(fitted);
            if causes.elements == elements {
                return Again::Same(search.nearly());
            }
            Some(causes)
        }
        stands => stands,
    };
    Again::Other(stands.and_then(|fitted| search.named(fitted)))
}

impl Search<'_> {
    /// What stands of some effects, each with what else it could be.
    fn named(&mut self, fitted: Fitted) -> Option<Chosen> {
        let firm = self.tidied(fitted)?;
        let mut fitted = firm.clone();
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
        // Another explanation of one effect may be a makeshift beside the others; where nothing stands of them with it, what
        // was there before does.
        let stands = self.tidied(fitted.clone()).unwrap_or(firm);
        if stands.elements != fitted.elements {
            fitted = stands;
            rivals = self.rivals_of_each(&fitted);
        }
        let (sorted, order) = self.by_size(fitted);
        let count = sorted.elements.len();
        let fitted = self.beyond_chance(sorted)?;
        let rivals = if fitted.elements.len() == count {
            order.into_iter().map(|k| std::mem::take(&mut rivals[k])).collect()
        } else {
            self.rivals_of_each(&fitted)
        };
        let described = fitted.elements.iter().any(|element| element.shape().is_none());
        let nearly = if described { self.nearly() } else { Vec::new() };
        Some(Chosen { fitted, rivals, nearly })
    }

    /// What explains as much as a curve but for what is not linear, with what else that could be.
    fn nearly(&mut self) -> Vec<Chosen> {
        let nearly = std::mem::take(&mut self.nearly).into_iter();
        let with_rivals = |fitted: Fitted| {
            let rivals = self.rivals_of_each(&fitted);
            Chosen { fitted, rivals, nearly: Vec::new() }
        };
        nearly.map(with_rivals).collect()
    }

    fn rivals_of_each(&self, fitted: &Fitted) -> Vec<Vec<Rival>> {
        (0..fitted.elements.len()).map(|k| self.rivals(fitted, k).1).collect()
    }

    /// The largest effect first.
    fn by_size(&self, fitted: Fitted) -> (Fitted, Vec<usize>) {
        let size_mm2 = |k| fitted.part_mm2(k, self.residuals());
        let sizes: Vec<f64> = (0..fitted.elements.len()).map(size_mm2).collect();
        let mut order: Vec<usize> = (0..sizes.len()).collect();
        order.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
        let elements = order.iter().map(|&k| fitted.elements[k].clone()).collect();
        let fitted = self.fit_all(elements).unwrap_or(fitted);
        (fitted, order)
    }
}
