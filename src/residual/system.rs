//! Columns with their products: what they explain of residuals, beside what is accepted.

use rayon::prelude::*;

use super::beside::Beside;
use super::column::Column;
use super::element::Element;
use super::residuals::Residuals;
use crate::solve::{Cholesky, Matrix, dot};

/// What is added to the diagonal, as a share of a column's square: amplitudes that the model spans stay small instead of running
/// away, far above what rounding leaves of a difference of squares (1e-13). Of the others it changes nothing as long as it costs less
/// than chance gains: a ball that drifts by 100 um, of which the fits follow all but a hundredth, has a square of 4e8 times the noise
/// of a single amplitude, and a millionth of that made its time constant a fifth too long, five of its deviations.
const RIDGE: f64 = 1e-9;

/// No amplitude of many, of an honest ball or curve, is larger, mm or rad: what the readings decide is not touched by this,
/// and what they do not, such as an order of a ball's roundness that is zero on every circle that was driven, stays small.
const PLAUSIBLE: f64 = 0.03;

/// An amplitude, or those of sine and cosine, are decided or not; of more some are.
const DECIDED_AT_ONCE: usize = 2;

/// Columns with their products.
#[derive(Debug, Default)]
pub struct System {
    pub(super) columns: Vec<Column>,
    anywhere: Anywhere,
    /// Products with the accepted columns.
    accepted: Vec<Vec<f64>>,
    normal: Matrix,
    common: Vec<f64>,
}

/// What holds of columns whatever is accepted: with it, columns that are made anew tell at once what they explain.
#[derive(Debug, Default)]
pub struct Anywhere {
    /// `Q^T c` of each column in each repeat.
    along: Vec<Vec<Vec<f64>>>,
    /// Products of the columns as they are, row after row of the lower triangle.
    products: Vec<Vec<f64>>,
    /// What is added to the diagonal of each column because its amplitude is plausible, mm² by its unit squared.
    priors: Vec<f64>,
}

impl System {
    /// The columns of an element, beside what is accepted.
    pub fn of(beside: &Beside, element: &Element) -> Self {
        let mut system = Self::default();
        system.push_element(beside, element, element.columns(beside.residuals));
        system
    }

    /// The largest part of a column's square that lies outside of what the fits and accepted effects follow.
    pub fn share_outside(&self) -> f64 {
        let share =
            |k: usize| self.normal[(k, k)] / self.anywhere.products[k][k].max(f64::MIN_POSITIVE);
        (0..self.columns.len()).map(share).fold(0.0, f64::max)
    }

    /// What holds of the columns whatever is accepted, without them: each takes as much memory as there are samples.
    pub fn into_anywhere(self) -> Anywhere {
        self.anywhere
    }

    /// Adds the columns of an element. Of one with many amplitudes the readings may decide a few; the others are held by
    /// what is plausible.
    pub(super) fn push_element(&mut self, beside: &Beside, of: &Element, columns: Vec<Column>) {
        if columns.len() > DECIDED_AT_ONCE {
            // Neighbours, because what is left as a whole may hold the very effect.
            let prior = beside.noise().neighbours_mm2 / (PLAUSIBLE * PLAUSIBLE);
            let priors = &mut self.anywhere.priors;
            priors.resize(self.columns.len(), 0.0);
            priors.resize(self.columns.len() + columns.len(), prior);
        }
        self.push(beside, columns, of.reach());
    }

    /// Adds the columns of numbers that are held: the square of each weighs so much beside the sum of squares.
    pub(super) fn push_held(&mut self, beside: &Beside, columns: Vec<Column>, weights: &[f64]) {
        self.push(beside, columns, usize::MAX);
        let priors = self.anywhere.priors.iter_mut().rev().zip(weights.iter().rev());
        priors.for_each(|(prior, weight)| *prior = *weight);
    }

    /// Adds columns; those of them that are farther than this from each other have no sample in common.
    pub(super) fn push(&mut self, beside: &Beside, columns: Vec<Column>, reach: usize) {
        let first = self.columns.len();
        let along = along(beside.residuals, &columns);
        for (column, along) in columns.into_iter().zip(along) {
            self.anywhere.along.push(along);
            self.accepted.push(beside.span.iter().map(|unit| unit.product(&column)).collect());
            self.common.push(column.product(&beside.left_mm));
            self.columns.push(column);
        }
        let n = self.columns.len();
        let mut normal = Matrix::zeros(n, n);
        for i in 0..n {
            if i >= first {
                let product = |k: usize| {
                    let apart = k >= first && i - k > reach;
                    if apart { 0.0 } else { self.columns[i].product(&self.columns[k]) }
                };
                self.anywhere.products.push((0..=i).map(product).collect());
            }
            for k in 0..=i {
                normal[(i, k)] = if i < first {
                    self.normal[(i, k)]
                } else {
                    let accepted = dot(&self.accepted[i], &self.accepted[k]);
                    self.anywhere.outside(i, k) - accepted
                };
                normal[(k, i)] = normal[(i, k)];
            }
        }
        self.normal = normal;
        self.anywhere.priors.resize(n, 0.0);
    }

    /// Normal matrix and right-hand side of the first so many columns.
    pub(super) fn part(&self, keep: usize) -> (Matrix, &[f64]) {
        let normal = Matrix::from_fn(keep, keep, |i, k| {
            match self.normal[(i, k)] {
                // What nothing tells, such as the phase of a run that takes no part, stays zero.
                0.0 if i == k && self.anywhere.ridge(k) <= 0.0 => 1.0,
                value if i == k => value + self.anywhere.ridge(k),
                value => value,
            }
        });
        (normal, &self.common[..keep])
    }
}

impl Anywhere {
    /// What the columns explain beside what is accepted now, mm², wherever the numbers inside are; `None`
    /// where they cannot be told from what is followed already, or from each other.
    pub fn gain_mm2(&self, columns: &[Column], beside: &Beside) -> Option<f64> {
        let n = columns.len();
        let accepted: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| beside.span.iter().map(|unit| unit.product(column)).collect())
            .collect();
        let alone = Matrix::from_fn(n, n, |i, k| {
            let ridge = if i == k { self.ridge(k) } else { 0.0 };
            self.outside(i.max(k), i.min(k)) + ridge - dot(&accepted[i], &accepted[k])
        });
        let common: Vec<f64> =
            columns.iter().map(|column| column.product(&beside.left_mm)).collect();
        Some(dot(&Cholesky::of(&alone)?.solve(&common), &common))
    }

    /// What the fits do not follow of the product of two columns, the later one first.
    fn outside(&self, i: usize, k: usize) -> f64 {
        let followed = self.along[i].iter().zip(&self.along[k]).map(|(a, b)| dot(a, b));
        self.products[i][k] - followed.sum::<f64>()
    }

    /// What is added to the diagonal.
    fn ridge(&self, k: usize) -> f64 {
        RIDGE * self.products[k][k] + self.priors[k]
    }
}

/// `Q^T c` of columns, each repeat after repeat, in one pass.
fn along(residuals: &Residuals, columns: &[Column]) -> Vec<Vec<Vec<f64>>> {
    let by_repeat: Vec<Vec<Vec<f64>>> = residuals
        .repeats
        .par_iter()
        .enumerate()
        .map(|(index, repeat)| {
            let of_repeat: Vec<&[f64]> = columns.iter().map(|c| c[index].as_slice()).collect();
            repeat.basis.along(&of_repeat)
        })
        .collect();
    (0..columns.len()).map(|k| by_repeat.iter().map(|repeat| repeat[k].clone()).collect()).collect()
}
