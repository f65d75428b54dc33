//! The search from its first candidate to what stands.

use super::found::Chosen;
use super::search::{MOST_EFFECTS, Search};
use crate::residual::data::norm2;
use crate::residual::joint::Fitted;

impl Search<'_> {
    /// The effects that there are; `None` for none.
    pub(crate) fn run(&mut self) -> Option<Chosen> {
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
        let sizes: Vec<f64> =
            (0..fitted.elements.len()).map(|k| norm2(&fitted.part(k).effect(self.data))).collect();
        let mut order: Vec<usize> = (0..sizes.len()).collect();
        order.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
        let elements = order.iter().map(|&k| fitted.elements[k].clone()).collect();
        let fitted = self.fit_all(elements).unwrap_or(fitted);
        (fitted, order)
    }
}
