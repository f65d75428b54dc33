//! What is there whatever its cause: curves of any shape over everything that effects may hang on.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::candidate::Tried;
use super::channel::Look;
use crate::diagnose::thresholds::STRAIGHT;
use crate::model::{Empirical, Form, place};
use crate::residual::{self, Beside, Element, Fitted, Noise, Owner};

/// Knots of the first look, and of closer ones.
const KNOTS: [usize; 3] = [24, 48, 96];
/// Curves that get a closer look.
const CLOSELY: usize = 6;
/// And of these so many a fit to the samples, if they explain at least this share of what the best one does.
const FITTED: usize = 4;
const WORTH_A_FIT: f64 = 0.8;
/// More knots must explain more by this factor.
const FINER: f64 = 1.01;
/// Hats that the model nearly spans are kept from running away.
const RIDGE: f64 = 1e-4;

/// A curve keeps at least so many knots.
const FEWEST_KNOTS: usize = 6;

/// A curve over a channel.
#[derive(Debug, Clone)]
struct Curve {
    empirical: Empirical,
    /// Gain less what its knots gain by chance, mm²: of the bins.
    score_mm2: f64,
}

impl Curve {
    fn fitted(&self, beside: &Beside) -> Option<Fitted> {
        let form = Form::Empirical(self.empirical.clone());
        residual::fit(beside, vec![Element::new(form, Owner::All)])
    }

    /// The curve without the knots that it does not need: between which it is straight, up to chance.
    ///
    /// A knot is gone when the curve there lies on the line between its neighbours, `w^T a = 0`; that costs
    /// `(w^T a)² / (w^T N^-1 w)` of the gain.
    fn thinned(self, channel: &Look, noise: &Noise) -> Self {
        let mut empirical = self.empirical.clone();
        while empirical.knots.len() > FEWEST_KNOTS {
            let Some(explained) = channel.explained(&hats(channel, &empirical), RIDGE) else {
                break;
            };
            let inverse = explained.cholesky.inverse();
            let knots = &empirical.knots;
            let mut losses: Vec<(usize, f64)> = (1..knots.len() - 1)
                .map(|k| {
                    let share = (knots[k] - knots[k - 1]) / (knots[k + 1] - knots[k - 1]);
                    let weights = [share - 1.0, 1.0, -share];
                    let a = &explained.amplitudes[k - 1..=k + 1];
                    let aside: f64 = weights.iter().zip(a).map(|(w, a)| w * a).sum();
                    let variance: f64 = (0..3)
                        .flat_map(|i| (0..3).map(move |j| (i, j)))
                        .map(|(i, j)| weights[i] * weights[j] * inverse[(k - 1 + i, k - 1 + j)])
                        .sum();
                    (k, aside * aside / variance.max(f64::MIN_POSITIVE))
                })
                .filter(|(_, loss_mm2)| *loss_mm2 < STRAIGHT * noise.long_run_mm2)
                .collect();
            losses.sort_by(|a, b| a.1.total_cmp(&b.1));
            // What a knot costs hangs on its neighbours: of two side by side only one at a time.
            let mut gone: Vec<usize> = Vec::new();
            let most = (losses.len() / 2).max(1);
            for (k, _) in losses {
                if gone.len() < most && gone.iter().all(|other| other.abs_diff(k) > 1) {
                    gone.push(k);
                }
            }
            if gone.is_empty() {
                break;
            }
            let kept = (0..knots.len()).filter(|k| !gone.contains(k));
            empirical.knots = kept.map(|k| knots[k]).collect();
        }
        let Some(explained) = channel.explained(&hats(channel, &empirical), RIDGE) else {
            return self;
        };
        let chance = noise.by_chance_mm2(empirical.knots.len());
        Self { empirical, score_mm2: explained.gain_mm2 - chance }
    }
}

/// What so many knots gain by being the best of all choices of so many, over what an amplitude gains by chance: twice the logarithm
/// of the number of choices, among the knots of the closest look.
pub(crate) fn by_choice(knots: usize) -> f64 {
    let all = KNOTS[KNOTS.len() - 1];
    let chosen = knots.min(all - knots.min(all));
    2.0 * (1..=chosen).map(|k| ((all - chosen + k) as f64 / k as f64).ln()).sum::<f64>()
}

/// The curve that explains most of what is left, fitted to the samples themselves, with as many knots as it
/// needs; `None` where none of those that are wanted explains `least_mm2`.
pub(crate) fn best(
    beside: &Beside,
    channels: &[Look],
    least_mm2: f64,
    wanted: &(dyn Fn(&Empirical) -> bool + Sync),
) -> Option<Tried> {
    let mut close = curves(channels, beside.noise());
    close.retain(|curve| curve.score_mm2 > least_mm2 && wanted(&curve.empirical));
    let first_mm2 = close.first()?.score_mm2;
    close.retain(|curve| curve.score_mm2 > WORTH_A_FIT * first_mm2);
    close.truncate(FITTED);
    let fitted =
        close.into_par_iter().filter_map(|curve| Some((curve.fitted(beside)?, curve.empirical)));
    let fitted: Vec<(Fitted, Empirical)> = fitted.collect();
    let (fitted, curve) =
        fitted.into_iter().max_by(|a, b| a.0.gain_mm2.total_cmp(&b.0.gain_mm2))?;
    // What the curve explains is no noise: beside that, more knots may show more.
    let after = Noise::of(beside.residuals, &fitted.left_mm(beside));
    let best = as_fine_as_needed(beside, channels, &curve, &after)?;
    (best.score_mm2 > least_mm2).then_some(best)
}

/// The best curve over each variable that is wanted, of those that explain nearly as much as the best of all; `noise` is what
/// is left beside everything.
pub(crate) fn over_each(
    beside: &Beside,
    channels: &[Look],
    noise: &Noise,
    wanted: &(dyn Fn(&Empirical) -> bool + Sync),
) -> Vec<Tried> {
    let mut close = curves(channels, noise);
    close.retain(|curve| wanted(&curve.empirical));
    let first_mm2 = close.first().map_or(0.0, |curve| curve.score_mm2);
    let mut over = BTreeSet::new();
    close.retain(|Curve { empirical, score_mm2 }| {
        *score_mm2 > WORTH_A_FIT * first_mm2
            && over.insert((empirical.variable, empirical.with_sense))
    });
    let fitted = close.into_par_iter();
    fitted
        .filter_map(|curve| as_fine_as_needed(beside, channels, &curve.empirical, noise))
        .collect()
}

/// A curve over the same with as many knots as show something beside this noise, fitted to the samples.
fn as_fine_as_needed(
    beside: &Beside,
    channels: &[Look],
    curve: &Empirical,
    noise: &Noise,
) -> Option<Tried> {
    let channel = channels.iter().find(|channel| curve.dependence() == channel.of)?;
    let looks = KNOTS.iter().filter_map(|knots| look(channel, *knots, noise));
    let finest = looks.max_by(|a, b| a.score_mm2.total_cmp(&b.score_mm2))?;
    let fitted = finest.thinned(channel, noise).fitted(beside)?;
    let score_mm2 = fitted.gain_mm2 - noise.by_chance_mm2(fitted.columns.len());
    Some(Tried { fitted, score_mm2 })
}

/// What the best curve explains at the first look, mm².
pub(crate) fn most_mm2(channels: &[Look], noise: &Noise) -> f64 {
    let looks: Vec<f64> = channels
        .par_iter()
        .filter_map(|channel| Some(look(channel, KNOTS[0], noise)?.score_mm2))
        .collect();
    looks.into_iter().fold(0.0, f64::max)
}

/// The curves that explain most, the best first.
fn curves(channels: &[Look], noise: &Noise) -> Vec<Curve> {
    let mut first: Vec<(usize, Curve)> = channels
        .par_iter()
        .enumerate()
        .filter_map(|(index, channel)| Some((index, look(channel, KNOTS[0], noise)?)))
        .collect();
    let order = |a: &(usize, Curve), b: &(usize, Curve)| b.1.score_mm2.total_cmp(&a.1.score_mm2);
    first.sort_by(order);
    let closer: Vec<(usize, Curve)> = first
        .par_iter()
        .take(CLOSELY)
        .flat_map_iter(|(index, _)| KNOTS[1..].iter().map(|knots| (*index, *knots)))
        .filter_map(|(index, knots)| Some((index, look(&channels[index], knots, noise)?)))
        .collect();
    for (index, curve) in closer {
        // More knots only where they show more.
        if let Some(known) = first.iter_mut().find(|known| known.0 == index)
            && curve.score_mm2 > FINER * known.1.score_mm2
        {
            known.1 = curve;
        }
    }
    first.sort_by(order);
    first.into_iter().map(|(_, curve)| curve).collect()
}

/// A curve with so many knots over the bins of a channel.
fn look(channel: &Look, knots: usize, noise: &Noise) -> Option<Curve> {
    let empirical = on_knots(channel, knots)?;
    let hats = hats(channel, &empirical);
    let explained = channel.explained(&hats, RIDGE)?;
    let chance = noise.by_chance_mm2(empirical.knots.len());
    Some(Curve { empirical, score_mm2: explained.gain_mm2 - chance })
}

/// A curve with its knots so that every stretch between them is worth the same.
fn on_knots(channel: &Look, count: usize) -> Option<Empirical> {
    let squares = channel.squares();
    let total: f64 = squares.iter().sum();
    let mut knots: Vec<f64> = Vec::new();
    let mut sum = 0.0;
    for (center, square) in channel.centers.iter().zip(&squares) {
        let next = knots.len() as f64 / (count - 1) as f64 * total;
        let apart = knots.last().is_none_or(|last| *center > *last);
        if *square > 0.0 && sum + 0.5 * square >= next && apart {
            knots.push(*center);
        }
        sum += square;
    }
    let last = channel.centers.iter().zip(&squares).rev().find(|(_, s)| **s > 0.0)?.0;
    if knots.last().is_some_and(|knot| knot < last) {
        knots.push(*last);
    }
    (knots.len() > 3).then_some(Empirical {
        seat: channel.of.seat,
        variable: channel.of.variable,
        with_sense: channel.of.with_sense,
        knots,
    })
}

/// The hats of a curve over the bins.
fn hats(channel: &Look, curve: &Empirical) -> Vec<Vec<f64>> {
    let mut hats = vec![vec![0.0; channel.centers.len()]; curve.knots.len()];
    for (bin, center) in channel.centers.iter().enumerate() {
        let (first, share) = place(&curve.knots, *center);
        hats[first][bin] = 1.0 - share;
        hats[first + 1][bin] = share;
    }
    hats
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_counted() {
        assert!(by_choice(0).abs() < 1e-12);
        // 96, 96 * 95 / 2, and all of them in one way.
        assert!((by_choice(1) - 2.0 * 96_f64.ln()).abs() < 1e-9);
        assert!((by_choice(2) - 2.0 * 4560_f64.ln()).abs() < 1e-9);
        assert!((by_choice(94) - by_choice(2)).abs() < 1e-9);
        assert!(by_choice(97).abs() < 1e-12);
    }
}
