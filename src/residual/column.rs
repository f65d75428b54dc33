//! A number for each sample of each repeat.

use std::ops::{Deref, DerefMut};

use crate::solve::dot;

/// One number for each sample, repeat after repeat; empty in the repeats where all are zero.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Column(Vec<Vec<f64>>);

impl Column {
    /// Nothing in any of so many repeats.
    pub fn empty(repeats: usize) -> Self {
        Self(vec![Vec::new(); repeats])
    }

    /// `a · b` over the repeats where both are.
    pub fn product(&self, other: &Self) -> f64 {
        self.0.iter().zip(&other.0).map(|(a, b)| dot(a, b)).sum()
    }

    /// The sum of squares, in the order of the samples.
    pub fn square(&self) -> f64 {
        self.0.iter().flatten().map(|c| c * c).sum()
    }

    /// Adds so much of another one, in the repeats where both are.
    pub fn add(&mut self, amount: f64, other: &Self) {
        for (to, of) in self.0.iter_mut().zip(&other.0) {
            to.iter_mut().zip(of).for_each(|(to, of)| *to += amount * of);
        }
    }

    /// The same, times a number.
    #[must_use]
    pub fn times(mut self, factor: f64) -> Self {
        self.0.iter_mut().flatten().for_each(|value| *value *= factor);
        self
    }
}

impl Deref for Column {
    type Target = [Vec<f64>];

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for Column {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl From<Vec<Vec<f64>>> for Column {
    fn from(repeats: Vec<Vec<f64>>) -> Self {
        Self(repeats)
    }
}

impl FromIterator<Vec<f64>> for Column {
    fn from_iter<I: IntoIterator<Item = Vec<f64>>>(repeats: I) -> Self {
        Self(repeats.into_iter().collect())
    }
}
