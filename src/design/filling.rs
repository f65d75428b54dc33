//! Arcs for chosen set-ups: begun from the best shares of time and greedily, then exchanged.

use rayon::prelude::*;

use super::problem::{Chosen, Problem, Step};
use crate::plan::Criterion;
use crate::solve::Matrix;

/// An exchange gains at least this part of the value.
const WORTH: f64 = 1e-3;

/// Arcs that were chosen so far.
#[derive(Debug, Clone)]
struct Filling {
    arcs: Vec<usize>,
    information: Matrix,
    left_s: f64,
}

/// Set-ups, and the arcs in them that are worth looking at.
struct Support<'a> {
    set_ups: &'a [usize],
    arcs: &'a [usize],
}

/// By what an arc is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Weight {
    Gain,
    GainASecond,
}

impl Problem {
    /// Arcs for some set-ups: of three beginnings the best, bettered until nothing betters it.
    ///
    /// `looks` bounds how many gains are looked at while arcs are exchanged.
    /// Only arcs that the best shares of time come near to take part: what tells much less a second
    /// there is in no good plan.
    pub(super) fn fill(&self, set_ups: &[usize], budget_s: f64, looks: usize) -> Chosen {
        let cost_s: f64 = set_ups.iter().map(|&s| self.set_up_s[s]).sum();
        let left_s = budget_s - cost_s;
        let relaxed = self.relaxed(set_ups, left_s);
        let support = Support { set_ups, arcs: &relaxed.support };
        let empty = Filling { arcs: Vec::new(), information: self.start(set_ups), left_s };
        // Whole arcs from the best shares of time, and the rest greedily.
        let mut of_shares = empty.clone();
        let mut shares = relaxed.seconds.clone();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        for (index, seconds) in shares {
            let arc_s = self.arcs[index].seconds;
            for _ in 0..(seconds / arc_s).round() as usize {
                if arc_s <= of_shares.left_s {
                    self.put(&mut of_shares, set_ups, index);
                }
            }
        }
        let beginnings = [
            self.filled_up(of_shares, &support, Weight::GainASecond),
            self.filled_up(empty.clone(), &support, Weight::GainASecond),
            self.filled_up(empty.clone(), &support, Weight::Gain),
        ];
        let mut beginnings: Vec<(f64, Filling)> = beginnings
            .into_iter()
            .map(|filling| (self.value_of(&filling, set_ups), filling))
            .collect();
        beginnings.sort_by(|a, b| a.0.total_cmp(&b.0));
        // A look at every point costs some times a look at their mean.
        let mut looks = if self.objective.criterion == Criterion::G { looks / 4 } else { looks };
        let (filling, value) = beginnings
            .into_iter()
            .map(|(_, filling)| self.bettered(filling, &support, &mut looks))
            .reduce(|best, next| if next.1 < best.1 { next } else { best })
            .unwrap_or((empty, f64::INFINITY));
        let arcs = filling.arcs;
        Chosen { set_ups: set_ups.to_vec(), arcs, value, bound: relaxed.bound }
    }

    fn value_of(&self, filling: &Filling, set_ups: &[usize]) -> f64 {
        self.step(set_ups, &filling.information).map_or(f64::INFINITY, |step| step.value)
    }

    /// Adds arcs, the heaviest first, until none fits.
    fn filled_up(&self, mut filling: Filling, support: &Support<'_>, weight: Weight) -> Filling {
        while support.arcs.iter().any(|&index| self.arcs[index].seconds <= filling.left_s) {
            let Some(step) = self.step(support.set_ups, &filling.information) else { break };
            let Some((index, _)) = self.best(&step, support, filling.left_s, weight) else { break };
            self.put(&mut filling, support.set_ups, index);
        }
        filling
    }

    /// Takes one arc out, or where that gains nothing two, and fills up again with the best arc first or
    /// with what tells most a second; until nothing is worth it, or `looks` have been spent.
    fn bettered(
        &self,
        mut filling: Filling,
        support: &Support<'_>,
        looks: &mut usize,
    ) -> (Filling, f64) {
        let mut value = self.value_of(&filling, support.set_ups);
        'again: loop {
            let count = filling.arcs.len();
            let alone = (0..count).map(|place| vec![place]);
            let pairs = (0..count).flat_map(|a| (0..a).map(move |b| vec![a, b]));
            for places in alone.chain(pairs) {
                if *looks == 0 {
                    break 'again;
                }
                let better = self.refilled(&filling, &places, support, value, looks);
                if let Some((next, next_value)) = better {
                    (filling, value) = (next, next_value);
                    continue 'again;
                }
            }
            break;
        }
        (filling, value)
    }

    /// The filling without the arcs at some places, the last place first, filled up again; if that is
    /// worth it.
    fn refilled(
        &self,
        filling: &Filling,
        places: &[usize],
        support: &Support<'_>,
        value: f64,
        looks: &mut usize,
    ) -> Option<(Filling, f64)> {
        let set_ups = support.set_ups;
        let mut without = filling.clone();
        for &place in places {
            let old = without.arcs.remove(place);
            without.left_s += self.arcs[old].seconds;
            self.add(&mut without.information, set_ups, old, -1.0);
        }
        let step = self.step(set_ups, &without.information)?;
        let firsts = [Weight::Gain, Weight::GainASecond]
            .map(|weight| self.best(&step, support, without.left_s, weight));
        *looks = looks.saturating_sub(support.arcs.len());
        for (k, first) in firsts.iter().enumerate() {
            let Some((index, gain)) = first else { continue };
            // The same arc again is no news.
            if k == 1 && *first == firsts[0] {
                continue;
            }
            let mut next = without.clone();
            self.put(&mut next, set_ups, *index);
            let alone = next.arcs.len();
            let next = self.filled_up(next, support, Weight::Gain);
            *looks = looks.saturating_sub((next.arcs.len() - alone) * support.arcs.len());
            let next_value = if next.arcs.len() == alone {
                step.value - gain
            } else {
                self.value_of(&next, set_ups)
            };
            if value - next_value > WORTH * value.abs() {
                return Some((next, next_value));
            }
        }
        None
    }

    fn put(&self, filling: &mut Filling, set_ups: &[usize], index: usize) {
        self.add(&mut filling.information, set_ups, index, 1.0);
        filling.left_s -= self.arcs[index].seconds;
        filling.arcs.push(index);
    }

    /// The arc with the largest gain, a second or in all, among those that fit into a time.
    fn best(
        &self,
        step: &Step,
        support: &Support<'_>,
        left_s: f64,
        weight: Weight,
    ) -> Option<(usize, f64)> {
        let gains: Vec<(usize, f64)> = support
            .arcs
            .par_iter()
            .filter(|&&index| self.arcs[index].seconds <= left_s)
            .map(|&index| (index, self.gain(step, support.set_ups, index)))
            .collect();
        let weight = |&(index, gain): &(usize, f64)| match weight {
            Weight::Gain => gain,
            Weight::GainASecond => gain / self.arcs[index].seconds,
        };
        let best = gains.iter().fold(None, |best: Option<&(usize, f64)>, next| match best {
            Some(best) if weight(best) >= weight(next) => Some(best),
            _ => Some(next),
        })?;
        (best.1 > 0.0).then_some(*best)
    }
}
