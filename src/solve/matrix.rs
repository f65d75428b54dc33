//! A small dense matrix, for what has one row a coefficient, never one row a sample.
//!
//! The other rooms exchange covariances and bases in this type, so that none of them has to know the
//! linear algebra library. Tall matrices do not exist here: they pass row by row through
//! [`Tsqr`](super::Tsqr).

use std::ops::{Index, IndexMut};

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, MatMut, MatRef, Par};

use super::vector::dot;
use super::widest::add_rows;

/// A dense matrix of `f64`, stored row after row.
///
/// The unit of an element is the business of whoever made it.
#[derive(Debug, PartialEq, Default)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    data: Vec<f64>,
}

impl Clone for Matrix {
    fn clone(&self) -> Self {
        Self { rows: self.rows, columns: self.columns, data: self.data.clone() }
    }

    /// In the room that it has.
    fn clone_from(&mut self, other: &Self) {
        (self.rows, self.columns) = (other.rows, other.columns);
        self.data.clone_from(&other.data);
    }
}

impl Matrix {
    /// The zero matrix, `rows x columns`.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, data: vec![0.0; rows * columns] }
    }

    /// The identity, `n x n`.
    pub fn identity(n: usize) -> Self {
        Self::from_fn(n, n, |i, k| if i == k { 1.0 } else { 0.0 })
    }

    /// The matrix with the elements `element(i, k)`.
    pub fn from_fn(
        rows: usize,
        columns: usize,
        mut element: impl FnMut(usize, usize) -> f64,
    ) -> Self {
        let mut data = Vec::with_capacity(rows * columns);
        for i in 0..rows {
            for k in 0..columns {
                data.push(element(i, k));
            }
        }
        Self { rows, columns, data }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// `to += sum_k factor * values[k] * row_k`.
    pub fn add_rows(&self, factor: f64, values: &[f64], to: &mut [f64]) {
        add_rows(factor, values, &self.data, to);
    }

    /// Row `i` as a slice.
    ///
    /// # Panics
    ///
    /// If there is no row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        &self.data[i * self.columns..(i + 1) * self.columns]
    }

    /// Row `i` as a slice that can be written.
    ///
    /// # Panics
    ///
    /// If there is no row `i`.
    pub fn row_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.data[i * self.columns..(i + 1) * self.columns]
    }

    /// Row `i` to read and row `k`, which comes after it, to write.
    pub(super) fn two_rows_mut(&mut self, i: usize, k: usize) -> (&[f64], &mut [f64]) {
        let (before, from) = self.data.split_at_mut(k * self.columns);
        (&before[i * self.columns..(i + 1) * self.columns], &mut from[..self.columns])
    }

    /// A copy of column `k`.
    ///
    /// # Panics
    ///
    /// If there is no column `k`.
    pub fn column(&self, k: usize) -> Vec<f64> {
        (0..self.rows).map(|i| self[(i, k)]).collect()
    }

    /// The diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.rows.min(self.columns)).map(|i| self[(i, i)]).collect()
    }

    /// `A^T`.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, k| self[(k, i)])
    }

    /// `A B`.
    ///
    /// # Panics
    ///
    /// If `A` has another number of columns than `B` has rows.
    #[must_use]
    pub fn times(&self, b: &Self) -> Self {
        assert_eq!(self.columns, b.rows, "shapes of a matrix product");
        let mut product = Self::zeros(self.rows, b.columns);
        for i in 0..self.rows {
            for (j, &a) in self.row(i).iter().enumerate() {
                for (out, &b) in product.row_mut(i).iter_mut().zip(b.row(j)) {
                    *out += a * b;
                }
            }
        }
        product
    }

    /// `A A^T`, symmetric to the last bit.
    #[must_use]
    pub fn times_own_transpose(&self) -> Self {
        let mut product = Self::zeros(self.rows, self.rows);
        let a = MatRef::from_row_major_slice(&self.data, self.rows, self.columns);
        triangular::matmul(
            MatMut::from_row_major_slice_mut(&mut product.data, self.rows, self.rows),
            BlockStructure::TriangularLower,
            Accum::Replace,
            a,
            BlockStructure::Rectangular,
            a.transpose(),
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        for i in 0..self.rows {
            for k in 0..i {
                product[(k, i)] = product[(i, k)];
            }
        }
        product
    }

    /// `A x`.
    ///
    /// # Panics
    ///
    /// If `x` has not one element a column.
    pub fn times_vector(&self, x: &[f64]) -> Vec<f64> {
        assert_eq!(self.columns, x.len(), "shapes of a matrix-vector product");
        (0..self.rows).map(|i| dot(self.row(i), x)).collect()
    }

    /// The Frobenius norm of every column, computed without overflow or underflow of the squares.
    pub fn column_norms(&self) -> Vec<f64> {
        (0..self.columns).map(|k| norm((0..self.rows).map(|i| self[(i, k)]))).collect()
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    fn index(&self, (i, k): (usize, usize)) -> &f64 {
        &self.data[i * self.columns + k]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (i, k): (usize, usize)) -> &mut f64 {
        &mut self.data[i * self.columns + k]
    }
}

/// The Euclidean norm, scaled by the largest element so that no square leaves the range of `f64`.
pub(super) fn norm(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = values.clone().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * values.map(|x| (x / largest).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_agree_with_each_other() {
        let a = Matrix::from_fn(3, 2, |i, k| (i * 2 + k) as f64);
        assert_eq!(a.times(&a.transposed()), a.times_own_transpose());
        assert_eq!(a.times(&Matrix::identity(2)), a);
        assert_eq!(
            a.times_vector(&[1.0, -1.0]),
            a.times(&Matrix::from_fn(2, 1, |i, _| 1.0 - 2.0 * i as f64)).column(0)
        );
        assert_eq!(a.diagonal(), [0.0, 3.0]);
    }

    #[test]
    fn norms_keep_their_range() {
        assert!((norm([3e200, 4e200].into_iter()) - 5e200).abs() < 1e186);
        assert!((norm([3e-200, 4e-200].into_iter()) - 5e-200).abs() < 1e-214);
        assert!(norm([0.0, 0.0].into_iter()).abs() < f64::MIN_POSITIVE);
    }
}
