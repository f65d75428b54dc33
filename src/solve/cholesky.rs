//! Small symmetric matrices: factors, inverses, and factors of low rank.
//!
//! A search over test plans factors matrices of some twenty rows a hundred thousand times; a library's
//! call, with its workspace, costs more than the factorisation at that size.

use super::matrix::Matrix;
use super::vector::dot;

/// `A = L L^T` of a symmetric positive definite matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Cholesky {
    l: Matrix,
}

impl Cholesky {
    /// Factors a matrix, of which the lower triangle is read; `None` if it is not positive definite.
    pub fn of(a: &Matrix) -> Option<Self> {
        let n = a.rows();
        let mut l = Matrix::zeros(n, n);
        for i in 0..n {
            for k in 0..=i {
                let left = a[(i, k)] - dot(&l.row(i)[..k], &l.row(k)[..k]);
                if i == k {
                    // Written so that what is not a number ends here, too.
                    let positive = left > 0.0;
                    if !positive {
                        return None;
                    }
                    l[(i, i)] = left.sqrt();
                } else {
                    l[(i, k)] = left / l[(k, k)];
                }
            }
        }
        Some(Self { l })
    }

    /// `ln det A`.
    pub fn log_determinant(&self) -> f64 {
        2.0 * self.l.diagonal().into_iter().map(f64::ln).sum::<f64>()
    }

    /// `L^-1 B`, in place.
    ///
    /// # Panics
    ///
    /// If `B` has another number of rows.
    pub fn half_solve(&self, b: &mut Matrix) {
        assert_eq!(self.l.rows(), b.rows(), "shapes of a triangular solution");
        for i in 0..b.rows() {
            for k in 0..i {
                let factor = self.l[(i, k)];
                let (above, row) = b.two_rows_mut(k, i);
                for (x, y) in row.iter_mut().zip(above) {
                    *x -= factor * *y;
                }
            }
            let pivot = self.l[(i, i)].recip();
            for x in b.row_mut(i) {
                *x *= pivot;
            }
        }
    }

    /// `A^-1 b`.
    ///
    /// # Panics
    ///
    /// If `b` has another length.
    #[must_use]
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let n = self.l.rows();
        assert_eq!(n, b.len(), "shapes of a solution");
        let mut x = b.to_vec();
        for i in 0..n {
            x[i] = (x[i] - dot(&self.l.row(i)[..i], &x[..i])) / self.l[(i, i)];
        }
        for i in (0..n).rev() {
            let after: f64 = (i + 1..n).map(|k| self.l[(k, i)] * x[k]).sum();
            x[i] = (x[i] - after) / self.l[(i, i)];
        }
        x
    }

    /// `A^-1`, symmetric to the last bit.
    #[must_use]
    pub fn inverse(&self) -> Matrix {
        let mut half = Matrix::identity(self.l.rows());
        self.half_solve(&mut half);
        half.transposed().times_own_transpose()
    }
}

/// `F` with as few rows as `F^T F = A` needs, up to what `floor` leaves on the diagonal; `A` is
/// symmetric and has no negative eigenvalue beyond rounding. Pivots are taken largest first.
#[must_use]
pub fn low_rank_factor(a: &Matrix, floor: f64) -> Matrix {
    let n = a.rows();
    let mut left = a.diagonal();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    while rows.len() < n {
        let (pivot, &largest) = match left.iter().enumerate().max_by(|x, y| x.1.total_cmp(y.1)) {
            Some(found) if *found.1 > floor => found,
            _ => break,
        };
        let root = largest.sqrt();
        let mut row: Vec<f64> = a.row(pivot).to_vec();
        for before in &rows {
            let factor = before[pivot];
            for (x, y) in row.iter_mut().zip(before) {
                *x -= factor * y;
            }
        }
        for (x, left) in row.iter_mut().zip(&mut left) {
            *x /= root;
            *left -= *x * *x;
        }
        left[pivot] = 0.0;
        rows.push(row);
    }
    Matrix::from_fn(rows.len(), n, |i, k| rows[i][k])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gram(rows: usize, n: usize) -> Matrix {
        let b = Matrix::from_fn(n, rows, |k, i| (0.37 * (i * (k + 1)) as f64 + 0.1).cos());
        b.times_own_transpose()
    }

    #[test]
    fn the_inverse_times_the_matrix_is_the_identity() {
        let a = gram(40, 7);
        let factor = Cholesky::of(&a).unwrap();
        let one = factor.inverse().times(&a);
        for i in 0..7 {
            for k in 0..7 {
                assert!((one[(i, k)] - f64::from(i == k)).abs() < 1e-12);
            }
        }
        let triangle = Matrix::from_fn(2, 2, |i, k| [[4.0, 2.0], [2.0, 3.0]][i][k]);
        let log = Cholesky::of(&triangle).unwrap().log_determinant();
        assert!((log - 8.0_f64.ln()).abs() < 1e-15);
        assert!(Cholesky::of(&Matrix::from_fn(2, 2, |_, _| 1.0)).is_none());
        assert!(Cholesky::of(&Matrix::from_fn(1, 1, |_, _| f64::NAN)).is_none());
    }

    #[test]
    fn a_factor_has_as_many_rows_as_the_rank() {
        let a = gram(3, 9);
        let factor = low_rank_factor(&a, 1e-12);
        assert_eq!(factor.rows(), 3);
        let again = factor.transposed().times_own_transpose();
        for i in 0..9 {
            for k in 0..9 {
                assert!((again[(i, k)] - a[(i, k)]).abs() < 1e-12);
            }
        }
    }
}
