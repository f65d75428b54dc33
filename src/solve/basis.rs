//! What a fit follows of anything: orthonormal directions at its samples.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use super::widest::{add_to_sums, less_rows};

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
///
/// Its numbers are held to seven digits, sums are of sixteen: of a column `c` it leaves what is right to `1e-7 |c|`, and
/// it is the largest thing that a search holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    rank: usize,
    /// Row after row.
    rows: Vec<f32>,
}

/// So many rows are multiplied at once.
const AT_ONCE: usize = 512;

impl Basis {
    /// A basis of so many columns, so far without a row; room for so many is made.
    pub fn with_room(rank: usize, samples: usize) -> Self {
        Self { rank, rows: Vec::with_capacity(rank * samples) }
    }

    /// Adds the part that a further sample has of every column.
    ///
    /// # Panics
    /// If it is not one number a column.
    pub fn push(&mut self, row: &[f64]) {
        assert_eq!(row.len(), self.rank, "one number a column");
        self.rows.extend(row.iter().map(|q| *q as f32));
    }

    /// How many columns.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// One row: the sample's part of every column.
    pub fn row(&self, sample: usize) -> impl Iterator<Item = f64> {
        self.rows[sample * self.rank..][..self.rank].iter().map(|q| f64::from(*q))
    }

    /// A sample's part of one column.
    pub fn at(&self, sample: usize, column: usize) -> f64 {
        f64::from(self.rows[sample * self.rank + column])
    }

    /// Adds each row, in order, which comes with the number of a sum and a factor, to that sum; sums of [`rank`](Self::rank) numbers
    /// lie one after the other.
    ///
    /// # Panics
    /// If there is no such sum.
    pub fn add_to_sums(&self, places: impl Iterator<Item = (usize, f64)>, sums: &mut [f64]) {
        add_to_sums(self.rank, &self.rows, places, sums);
    }

    /// `Q^T c` of several columns in one pass over the rows; an empty column is zero.
    pub fn along(&self, columns: &[&[f64]]) -> Vec<Vec<f64>> {
        let full: Vec<usize> = (0..columns.len()).filter(|k| !columns[*k].is_empty()).collect();
        let mut along = vec![vec![0.0; self.rank]; columns.len()];
        if full.is_empty() || self.rank == 0 {
            return along;
        }
        let mut product = Mat::zeros(self.rank, full.len());
        let (mut wide, mut of): (Vec<f64>, Vec<f64>) = Default::default();
        for (block, rows) in self.rows.chunks(AT_ONCE * self.rank).enumerate() {
            let (first, count) = (block * AT_ONCE, rows.len() / self.rank);
            wide.clear();
            wide.extend(rows.iter().map(|q| f64::from(*q)));
            of.clear();
            of.extend(full.iter().flat_map(|k| &columns[*k][first..first + count]));
            let rows = MatRef::from_column_major_slice(&wide, self.rank, count);
            let of = MatRef::from_column_major_slice(&of, count, full.len());
            matmul(product.as_mut(), Accum::Add, rows, of, 1.0, Par::Seq);
        }
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
        less_rows(column, &self.rows, &along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What seven digits leave.
    const DIGITS: f64 = 1e-6;

    /// The constant and the slope over five samples.
    fn line() -> Basis {
        let (one, slope) = (0.2_f64.sqrt(), 0.1_f64.sqrt());
        let mut line = Basis::with_room(2, 5);
        (-2..=2).for_each(|k| line.push(&[one, slope * f64::from(k)]));
        line
    }

    #[test]
    fn a_line_is_followed_and_what_is_across_is_left() {
        let basis = line();
        assert!(basis.outside(&[1.0, 2.0, 3.0, 4.0, 5.0]).iter().all(|c| c.abs() < DIGITS));
        // A parabola less its mean lies outside of any line.
        let across = [2.0, -1.0, -2.0, -1.0, 2.0];
        for (left, c) in basis.outside(&across).iter().zip(across) {
            assert!((left - c).abs() < DIGITS);
        }
        let along = basis.along(&[&across, &[], &[1.0; 5]]);
        assert!(along[0].iter().all(|a| a.abs() < DIGITS) && along[1] == [0.0, 0.0]);
        assert!((along[2][0] - 5.0_f64.sqrt()).abs() < DIGITS, "the length of the constant");
    }

    #[test]
    fn no_directions_follow_nothing() {
        let none = Basis::with_room(0, 0);
        assert_eq!(none.outside(&[1.0, 2.0]), [1.0, 2.0]);
        assert!(line().outside(&[]).is_empty());
    }
}
