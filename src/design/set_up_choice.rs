//! Which set-ups: by what they tell if all their arcs share the time.

use rayon::prelude::*;

use super::information::SET_UPS;
use super::problem::{Problem, add_information};
use crate::solve::{Cholesky, Matrix};

/// So many choices of set-ups are looked at one by one; of more, the best is built up step by step.
const MOST_CHOICES: usize = 600;

impl Problem {
    /// Choices of set-ups, the most promising first.
    pub(super) fn choices(&self, budget_s: f64) -> Vec<Vec<usize>> {
        let count = self.set_up_s.len();
        let shared: Vec<Option<Matrix>> =
            (0..count).into_par_iter().map(|set_up| self.shared(set_up)).collect();
        let value = |set_ups: &[usize]| -> f64 {
            let cost_s: f64 = set_ups.iter().map(|&s| self.set_up_s[s]).sum();
            let each_s = (budget_s - cost_s) / set_ups.len() as f64;
            if each_s <= 0.0 {
                return f64::INFINITY;
            }
            let mut information = self.known.clone();
            for &set_up in set_ups {
                let Some(of_second) = &shared[set_up] else { return f64::INFINITY };
                for i in 0..self.coefficients {
                    for (sum, x) in information.row_mut(i).iter_mut().zip(of_second.row(i)) {
                        *sum += each_s * x;
                    }
                }
            }
            Cholesky::of(&information)
                .map_or(f64::INFINITY, |f| self.objective.value(&f.inverse(), self.coefficients))
        };
        let most = self.most_set_ups.min(count);
        let mut sets: Vec<Vec<usize>> = vec![Vec::new()];
        let mut all: Vec<Vec<usize>> = Vec::new();
        for _ in 0..most {
            let longer: Vec<Vec<usize>> = sets
                .iter()
                .flat_map(|set| {
                    let first = set.last().map_or(0, |last| last + 1);
                    (first..count).map(move |next| [set.as_slice(), &[next]].concat())
                })
                .collect();
            all.extend(longer.iter().cloned());
            sets = longer;
            if all.len() > MOST_CHOICES {
                all = self.built_up(most, &value);
                break;
            }
        }
        let mut valued: Vec<(f64, Vec<usize>)> =
            all.into_par_iter().map(|set| (value(&set), set)).collect();
        valued.retain(|(value, _)| value.is_finite());
        valued.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        valued.into_iter().map(|(_, set)| set).collect()
    }

    /// From every pair of set-ups the best third, the best fourth and so on.
    fn built_up(&self, most: usize, value: &(dyn Fn(&[usize]) -> f64 + Sync)) -> Vec<Vec<usize>> {
        let count = self.set_up_s.len();
        let mut all: Vec<Vec<usize>> = (0..count).map(|first| vec![first]).collect();
        let mut sets = all.clone();
        for _ in 1..most {
            sets = sets
                .par_iter()
                .filter_map(|set| {
                    let others = (0..count).filter(|next| !set.contains(next));
                    let mut longer: Vec<(f64, Vec<usize>)> = others
                        .map(|next| {
                            let mut set = [set.as_slice(), &[next]].concat();
                            set.sort_unstable();
                            (value(&set), set)
                        })
                        .collect();
                    longer.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
                    longer.into_iter().next().map(|(_, set)| set)
                })
                .collect();
            sets.sort();
            sets.dedup();
            all.extend(sets.iter().cloned());
        }
        all
    }

    /// What a set-up tells a second about the coefficients, its own errors unknown, if all its arcs share
    /// the time evenly; `None` without arcs.
    fn shared(&self, set_up: usize) -> Option<Matrix> {
        let n = self.coefficients;
        let mut information = Matrix::zeros(n + SET_UPS, n + SET_UPS);
        let mut seconds = 0.0;
        for arc in self.arcs.iter().filter(|arc| arc.set_up == set_up) {
            add_information(&mut information, &arc.factor, 1.0);
            seconds += arc.seconds;
        }
        if seconds == 0.0 {
            return None;
        }
        // The Schur complement of the set-up errors.
        let corner = Matrix::from_fn(SET_UPS, SET_UPS, |i, k| {
            information[(n + i, n + k)] + if i == k { 1.0 } else { 0.0 }
        });
        let mut half = Matrix::from_fn(SET_UPS, n, |i, k| information[(n + i, k)]);
        Cholesky::of(&corner)?.half_solve(&mut half);
        let taken = half.transposed().times_own_transpose();
        Some(Matrix::from_fn(n, n, |i, k| (information[(i, k)] - taken[(i, k)]) / seconds))
    }
}
