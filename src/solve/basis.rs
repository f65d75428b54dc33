//! What a fit follows of anything: orthonormal directions at its samples.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use super::vector::dot;

/// Orthonormal columns `Q` (`m x r`): all that a fit of `r` directions to `m` samples can follow.
///
/// Of a further column `c` the fit follows `Q Q^T c`, and leaves
///
/// ```text
/// c' = c - Q Q^T c
/// ```
///
/// `Q` may lack rows that the fit had besides its samples (priors, marks of time): then its columns are
/// shorter than 1 over the samples alone, and the fit follows that much less.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    rank: usize,
    /// Row after row.
    rows: Vec<f64>,
}

impl Basis {
    /// A basis of so many columns with its rows one after the other.
    ///
    /// # Panics
    /// If the numbers are no whole rows.
    pub fn new(rank: usize, rows: Vec<f64>) -> Self {
        assert!(rows.len().is_multiple_of(rank.max(1)), "whole rows of {rank}");
        Self { rank, rows }
    }

    /// How many columns.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// One row: the sample's part of every column.
    pub fn row(&self, sample: usize) -> &[f64] {
        &self.rows[sample * self.rank..(sample + 1) * self.rank]
    }

    /// `Q^T c` of several columns in one pass over the rows; an empty column is zero.
    pub fn along(&self, columns: &[&[f64]]) -> Vec<Vec<f64>> {
        let count = self.rows.len() / self.rank.max(1);
        let full: Vec<usize> = (0..columns.len()).filter(|k| !columns[*k].is_empty()).collect();
        let mut along = vec![vec![0.0; self.rank]; columns.len()];
        if full.is_empty() || self.rank == 0 {
            return along;
        }
        let rows = MatRef::from_row_major_slice(&self.rows, count, self.rank);
        let of = Mat::from_fn(count, full.len(), |i, k| columns[full[k]][i]);
        let mut product = Mat::zeros(self.rank, full.len());
        matmul(product.as_mut(), Accum::Replace, rows.transpose(), of, 1.0, Par::Seq);
        for (k, column) in full.into_iter().enumerate() {
            along[column].iter_mut().enumerate().for_each(|(row, to)| *to = product[(row, k)]);
        }
        along
    }

    /// `c' = c - Q Q^T c`; nothing of an empty column.
    pub fn outside(&self, column: &[f64]) -> Vec<f64> {
        if self.rank == 0 || column.is_empty() {
            return column.to_vec();
        }
        let along = self.along(&[column]).remove(0);
        let rows = self.rows.chunks_exact(self.rank);
        column.iter().zip(rows).map(|(c, row)| c - dot(row, &along)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The constant and the slope over five samples.
    fn line() -> Basis {
        let (one, slope) = (0.2_f64.sqrt(), 0.1_f64.sqrt());
        Basis::new(2, (-2..=2).flat_map(|k| [one, slope * f64::from(k)]).collect())
    }

    #[test]
    fn a_line_is_followed_and_what_is_across_is_left() {
        let basis = line();
        assert!(basis.outside(&[1.0, 2.0, 3.0, 4.0, 5.0]).iter().all(|c| c.abs() < 1e-14));
        // A parabola less its mean lies outside of any line.
        let across = [2.0, -1.0, -2.0, -1.0, 2.0];
        for (left, c) in basis.outside(&across).iter().zip(across) {
            assert!((left - c).abs() < 1e-14);
        }
        let along = basis.along(&[&across, &[], &[1.0; 5]]);
        assert!(along[0].iter().all(|a| a.abs() < 1e-14) && along[1] == [0.0, 0.0]);
        assert!((along[2][0] - 5.0_f64.sqrt()).abs() < 1e-14, "the length of the constant");
    }

    #[test]
    fn no_directions_follow_nothing() {
        let none = Basis::new(0, Vec::new());
        assert_eq!(none.outside(&[1.0, 2.0]), [1.0, 2.0]);
        assert!(line().outside(&[]).is_empty());
    }
}
