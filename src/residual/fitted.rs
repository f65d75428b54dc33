//! Effects with everything that was estimated of them.

use super::beside::Beside;
use super::column::Column;
use super::element::Element;
use super::residuals::Residuals;
use crate::model::{Scale, Start};
use crate::solve::Matrix;

/// Effects with everything that was estimated of them.
///
/// The covariance of the amplitudes and of the numbers inside is [`inverse`](Self::inverse) times the variance
/// that chance gives an amplitude ([`Noise::long_run_mm2`](super::Noise)). It holds for a model that is linear
/// over that uncertainty, with noise that is the same all over the samples; what amplitudes of other effects
/// leave open is in it, what the model's own parameters leave open is too, since the columns count outside of
/// what the fits follow.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// The effects, the numbers inside where they were found.
    pub elements: Vec<Element>,
    /// Amplitudes of each element, run after run where each has its own, mm and rad.
    pub amplitudes: Vec<Vec<f64>>,
    /// By how much they lower the sum of squares, mm².
    pub gain_mm2: f64,
    /// Inverse of the normal matrix over all amplitudes and then all numbers inside (on the scale on which each
    /// is estimated), per mm².
    pub inverse: Matrix,
    /// Largest part of a column's square that lies outside of what the fits and accepted effects follow.
    pub share_outside: f64,
    /// Columns of the amplitudes, then those of the numbers inside.
    pub columns: Vec<Column>,
}

impl Fitted {
    /// Sum of the columns with their amplitudes, mm.
    pub fn sum(&self, residuals: &Residuals) -> Column {
        let mut sum = residuals.zeros();
        for (amplitude, column) in self.amplitudes.iter().flatten().zip(&self.columns) {
            sum.add(*amplitude, column);
        }
        sum
    }

    /// The effects outside of what the fits follow, mm.
    pub fn outside_of_fits(&self, residuals: &Residuals) -> Column {
        residuals.outside(&self.sum(residuals))
    }

    /// The effects outside of what the fits follow and of what has been accepted, mm.
    pub fn outside(&self, beside: &Beside) -> Column {
        beside.outside(&self.sum(beside.residuals))
    }

    /// What is left with the effects besides what has been accepted, mm.
    pub fn left_mm(&self, beside: &Beside) -> Column {
        let mut left = beside.left_mm.clone();
        left.add(-1.0, &self.outside(beside));
        left
    }

    /// By how much the sum of squares would rise without one of the elements if it were the only one, mm².
    pub fn part_mm2(&self, element: usize, residuals: &Residuals) -> f64 {
        let sum = self.part(element).sum(residuals);
        sum.product(&residuals.outside(&sum))
    }

    /// One of the elements alone, as it was fitted with the others.
    #[must_use]
    pub fn part(&self, element: usize) -> Self {
        let first = self.first_index(element);
        let own = &self.columns[first..first + self.amplitudes[element].len()];
        Self {
            elements: vec![self.elements[element].clone()],
            amplitudes: vec![self.amplitudes[element].clone()],
            columns: own.to_vec(),
            ..self.clone()
        }
    }

    /// Where the number inside of an element stands in `inverse`.
    pub fn inner_index(&self, element: usize) -> Option<usize> {
        self.elements[element].free()?;
        let amplitudes: usize = self.amplitudes.iter().map(Vec::len).sum();
        let before = self.elements[..element].iter().filter(|e| e.free().is_some()).count();
        Some(amplitudes + before)
    }

    /// Whether the number inside of each element that has one on a scale of logarithms is told, where noise has this long-run variance:
    /// to within a factor of `e`, a standard deviation. Backlash that builds up over a distance that may be anything is a reversal,
    /// and that is in the model. A time constant may be as long as it likes: a drift is a straight line then.
    pub fn tells_numbers(&self, long_run_mm2: f64) -> bool {
        let is_told = |element: usize| {
            let inner = self.elements[element].shape().and_then(|s| s.cause.inner(s.seat));
            let logarithmic = inner.is_some_and(|(inner, _)| {
                inner.scale == Some(Scale::Logarithm)
                    && !matches!(inner.start, Start::TimeConstants(..))
            });
            let Some(k) = self.inner_index(element).filter(|_| logarithmic) else { return true };
            long_run_mm2 * self.inverse[(k, k)] < 1.0
        };
        (0..self.elements.len()).all(is_told)
    }

    /// Where the amplitudes of an element begin in `inverse`.
    pub fn first_index(&self, element: usize) -> usize {
        self.amplitudes[..element].iter().map(Vec::len).sum()
    }
}
