//! The best shares of time: the same problem with arcs of any length, which is convex.
//!
//! With `w_i` seconds on arc `i` of `t_i` seconds, `M = M_0 + sum (w_i / t_i) F_i^T F_i` and `C = M^-1`,
//! the criterion falls by
//!
//! `g_i = -df/dw_i = trace(Z_i Q Z_i^T) / t_i`,  `Z_i = F_i C` over the coefficients,
//!
//! a second, with `Q = W` for A, `C^-1` of the coefficients for D, and for G the sum of
//! `J^T J (v / f)^3 / N` over the points. Shares are multiplied by the root of `g_i` over its mean until
//! they settle (Silvey, Titterington and Torsney 1978). At any shares, by convexity, no plan of the same
//! time is better than
//!
//! `f - T max g + sum w g`.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::information::SET_UPS;
use super::problem::{POWER, Problem, add_information, power_mean, trace_of_product, variance};
use crate::plan::Criterion;
use crate::solve::{Cholesky, Matrix};

/// Rounds at the most.
const ROUNDS: usize = 80;
/// After these rounds, shares below this part of an even one are dropped.
const FIRST_ROUNDS: usize = 8;
const DROPPED: f64 = 0.1;
/// Arcs that tell this part of what the best tells a second are worth looking at ...
const NEAR: f64 = 0.7;
/// ... and so many of them at the most,
const SUPPORT: usize = 120;
/// of which so many a set-up are short ones, for what is left of the time.
const SHORT: usize = 12;

/// Shares of time, and what no plan can do better than.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Relaxed {
    /// Indices of arcs, each with its seconds.
    pub(super) seconds: Vec<(usize, f64)>,
    /// Indices of arcs that a good plan may have, in order.
    pub(super) support: Vec<usize>,
    /// The criterion is not below this for any plan of the same set-ups and time; minus infinity where
    /// nothing is known.
    pub(super) bound: f64,
}

impl Problem {
    /// The best shares of a time, s, over the arcs of some set-ups.
    pub(super) fn relaxed(&self, set_ups: &[usize], time_s: f64) -> Relaxed {
        let all: Vec<usize> =
            (0..self.arcs.len()).filter(|&k| set_ups.contains(&self.arcs[k].set_up)).collect();
        let gram = |&index: &usize| {
            let factor = self.arcs[index].factor.transposed();
            (index, factor.times_own_transpose())
        };
        let grams: BTreeMap<usize, Matrix> = all.par_iter().map(gram).collect();
        let even_s = time_s / all.len().max(1) as f64;
        let mut seconds: Vec<(usize, f64)> = all.iter().map(|&index| (index, even_s)).collect();
        for round in 0..ROUNDS {
            let Some((_, slopes)) = self.slopes(set_ups, &seconds, &seconds, &grams) else { break };
            let mean: f64 =
                slopes.iter().zip(&seconds).map(|(g, (_, w))| g * w).sum::<f64>() / time_s;
            for ((_, w), g) in seconds.iter_mut().zip(&slopes) {
                *w *= (g / mean).max(0.0).sqrt();
            }
            if round >= FIRST_ROUNDS {
                seconds.retain(|(_, w)| *w > DROPPED * even_s);
            }
            let sum: f64 = seconds.iter().map(|(_, w)| w).sum();
            for (_, w) in &mut seconds {
                *w *= time_s / sum;
            }
        }
        let everywhere: Vec<(usize, f64)> = all.iter().map(|&index| (index, 0.0)).collect();
        let Some((value, slopes)) = self.slopes(set_ups, &seconds, &everywhere, &grams) else {
            let support = everywhere.iter().map(|(index, _)| *index).collect();
            return Relaxed { seconds, support, bound: f64::NEG_INFINITY };
        };
        let slope = |index: &usize| {
            let place = everywhere.binary_search_by(|(other, _)| other.cmp(index));
            place.map_or(0.0, |place| slopes[place])
        };
        let most = slopes.iter().copied().fold(0.0, f64::max);
        let of_shares: f64 = seconds.iter().map(|(index, w)| w * slope(index)).sum();
        let mut support: Vec<usize> = Vec::new();
        for &set_up in set_ups {
            let of_set_up = everywhere.iter().map(|(index, _)| *index);
            let mut near: Vec<usize> = of_set_up
                .filter(|index| self.arcs[*index].set_up == set_up && slope(index) > NEAR * most)
                .collect();
            near.sort_by(|a, b| slope(b).total_cmp(&slope(a)).then(a.cmp(b)));
            near.truncate(SUPPORT / set_ups.len());
            support.extend(near);
            let mut short: Vec<usize> =
                all.iter().copied().filter(|k| self.arcs[*k].set_up == set_up).collect();
            short.sort_by(|&a, &b| self.arcs[a].seconds.total_cmp(&self.arcs[b].seconds));
            short.truncate(2 * SHORT);
            short.sort_by(|a, b| slope(b).total_cmp(&slope(a)).then(a.cmp(b)));
            support.extend(short.into_iter().take(SHORT));
        }
        support.extend(seconds.iter().map(|(index, _)| *index));
        support.sort_unstable();
        support.dedup();
        Relaxed { seconds, support, bound: value - most * time_s + of_shares }
    }

    /// `Q`, over the coefficients: the criterion changes by `trace(Q dC)`; and the criterion.
    fn slope_of_covariance(&self, corner: &Matrix) -> Option<(f64, Matrix)> {
        let n = self.coefficients;
        let value = self.objective.value(corner, n);
        let q = match self.objective.criterion {
            Criterion::A => self.objective.mean_square.clone(),
            Criterion::D => self.objective.inverse_of_wanted(corner)?,
            Criterion::G => {
                let points = &self.objective.points;
                let variances: Vec<f64> = points.iter().map(|j| variance(j, corner)).collect();
                let f = power_mean(&variances);
                let mut q = Matrix::zeros(n, n);
                for (j, v) in points.iter().zip(&variances) {
                    add_information(&mut q, j, (v / f).powi(POWER - 1) / points.len() as f64);
                }
                q
            }
        };
        Some((value, q))
    }

    /// The criterion for shares of time, and its fall a second for each of the arcs `of`; `grams` are
    /// `F^T F` of all arcs of the set-ups.
    fn slopes(
        &self,
        set_ups: &[usize],
        seconds: &[(usize, f64)],
        of: &[(usize, f64)],
        grams: &BTreeMap<usize, Matrix>,
    ) -> Option<(f64, Vec<f64>)> {
        let n = self.coefficients;
        let mut information = self.start(set_ups);
        for &(index, w) in seconds {
            let weight = w / self.arcs[index].seconds;
            let columns = self.columns(set_ups, self.arcs[index].set_up);
            let gram = &grams[&index];
            for (i, &row) in columns.iter().enumerate() {
                // The coefficients stand together, the set-up errors behind them.
                let (to, from) = (information.row_mut(row), gram.row(i));
                for (sum, x) in to[..n].iter_mut().zip(from) {
                    *sum += weight * x;
                }
                for (sum, x) in to[columns[n]..].iter_mut().zip(&from[n..]) {
                    *sum += weight * x;
                }
            }
        }
        let c = Cholesky::of(&information)?.inverse();
        let corner = Matrix::from_fn(n, n, |i, k| c[(i, k)]);
        let (value, q) = self.slope_of_covariance(&corner)?;
        // For each set-up `S = C Q C^T`, so that an arc's slope is `trace(F^T F S)`.
        let of_set_up: Vec<Matrix> = set_ups
            .iter()
            .map(|&set_up| {
                let columns = self.columns(set_ups, set_up);
                let c = Matrix::from_fn(n + SET_UPS, n, |i, k| c[(columns[i], k)]);
                c.times(&q).times(&c.transposed())
            })
            .collect();
        let slopes = of.iter().map(|&(index, _)| {
            let arc = &self.arcs[index];
            let slot = set_ups.iter().position(|&s| s == arc.set_up).unwrap_or(0);
            trace_of_product(&grams[&index], &of_set_up[slot]) / arc.seconds
        });
        Some((value, slopes.collect()))
    }
}
