//! What is there whatever its cause: curves of any shape over everything that effects may hang on.

use rayon::prelude::*;

use super::channel::{Channel, Place};
use super::noise::Noise;
use crate::model::{Empirical, place};

/// Knots of the first look, and of closer ones.
const KNOTS: [usize; 3] = [24, 48, 96];
/// Curves that get a closer look.
const CLOSELY: usize = 6;
/// More knots must explain more by this factor.
const FINER: f64 = 1.01;
/// Hats that the model nearly spans are kept from running away.
const RIDGE: f64 = 1e-4;

/// A curve keeps at least so many knots.
const FEWEST_KNOTS: usize = 6;
/// A knot stays that gains this many times what chance gives an amplitude.
const STRAIGHT: f64 = 4.0;

/// A curve over a channel.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub(super) empirical: Empirical,
    /// Gain less what its knots gain by chance, mm².
    pub(super) score_mm2: f64,
}

impl Curve {
    /// The curve without the knots that it does not need: between which it is straight, up to chance.
    ///
    /// A knot is gone when the curve there lies on the line between its neighbours, `w^T a = 0`; that costs
    /// `(w^T a)² / (w^T N^-1 w)` of the gain.
    pub(super) fn thinned(self, channels: &[Channel], noise: &Noise) -> Self {
        let place = |channel: &&Channel| {
            let Place { seat, variable, with_sense } = channel.place;
            (seat, variable, with_sense)
                == (self.empirical.seat, self.empirical.variable, self.empirical.with_sense)
        };
        let Some(channel) = channels.iter().find(place) else { return self };
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
        let chance = 2.0 * empirical.knots.len() as f64 * noise.long_run_mm2;
        Self { empirical, score_mm2: explained.gain_mm2 - chance }
    }
}

/// The curves that explain most, the best first.
pub(super) fn curves(channels: &[Channel], noise: &Noise) -> Vec<Curve> {
    let look = |channel: &Channel, knots: usize| -> Option<Curve> {
        let empirical = on_knots(channel, knots)?;
        let hats = hats(channel, &empirical);
        let explained = channel.explained(&hats, RIDGE)?;
        let chance = 2.0 * empirical.knots.len() as f64 * noise.long_run_mm2;
        Some(Curve { empirical, score_mm2: explained.gain_mm2 - chance })
    };
    let mut first: Vec<(usize, Curve)> = channels
        .par_iter()
        .enumerate()
        .filter_map(|(index, channel)| Some((index, look(channel, KNOTS[0])?)))
        .collect();
    let order = |a: &(usize, Curve), b: &(usize, Curve)| b.1.score_mm2.total_cmp(&a.1.score_mm2);
    first.sort_by(order);
    let closer: Vec<(usize, Curve)> = first
        .par_iter()
        .take(CLOSELY)
        .flat_map_iter(|(index, _)| KNOTS[1..].iter().map(|knots| (*index, *knots)))
        .filter_map(|(index, knots)| Some((index, look(&channels[index], knots)?)))
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

/// A curve with its knots so that every stretch between them is worth the same.
fn on_knots(channel: &Channel, count: usize) -> Option<Empirical> {
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
        seat: channel.place.seat,
        variable: channel.place.variable,
        with_sense: channel.place.with_sense,
        knots,
    })
}

/// The hats of a curve over the bins.
fn hats(channel: &Channel, curve: &Empirical) -> Vec<Vec<f64>> {
    let mut hats = vec![vec![0.0; channel.centers.len()]; curve.knots.len()];
    for (bin, center) in channel.centers.iter().enumerate() {
        let (first, share) = place(&curve.knots, *center);
        hats[first][bin] = 1.0 - share;
        hats[first + 1][bin] = share;
    }
    hats
}
