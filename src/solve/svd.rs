//! The library's singular value decomposition, checked.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::svd::{self, ComputeSvdVectors};
use faer::{Mat, Par};

use super::matrix::Matrix;
use super::matrix::norm;
use crate::error::Kind;
use crate::{Error, Result};

/// How far the squared singular values may sum up to something else than the squared Frobenius norm,
/// relative to it.
const FROBENIUS_TOLERANCE: f64 = 1e-10;

/// `A = U S V^T` of a square matrix.
pub(super) struct Decomposition {
    pub(super) singular_values: Vec<f64>,
    pub(super) u: Matrix,
    pub(super) v: Matrix,
}

impl Decomposition {
    /// Decomposes a matrix from this side or, where the iteration does not end, from the other. Finite matrices with
    /// many equal singular values, such as unknowns that only priors see, now and then make the library's go in circles.
    ///
    /// # Errors
    /// When neither ends, or numbers are not finite.
    pub(super) fn of(a: &Matrix) -> Result<Self> {
        Self::from_this_side(a).or_else(|error| Self::from_other_side(a).map_err(|_| error))
    }

    /// `A^T = V S U^T`.
    fn from_other_side(a: &Matrix) -> Result<Self> {
        let n = a.columns();
        let transposed = Matrix::from_fn(n, n, |i, k| a[(k, i)]);
        let Self { singular_values, u, v } = Self::from_this_side(&transposed)?;
        Ok(Self { singular_values, u: v, v: u })
    }

    fn from_this_side(a: &Matrix) -> Result<Self> {
        let n = a.columns();
        let failed = |why: &str| {
            Error::new(
                Kind::Undetermined,
                format!("the singular values of {n} columns cannot be computed: {why}"),
            )
        };
        let matrix = Mat::from_fn(n, n, |i, k| a[(i, k)]);
        let (mut u, mut v) = (Mat::zeros(n, n), Mat::zeros(n, n));
        let mut s = faer::diag::Diag::zeros(n);
        let thin = ComputeSvdVectors::Thin;
        let mut scratch = MemBuffer::new(svd::svd_scratch::<f64>(
            n,
            n,
            thin,
            thin,
            Par::Seq,
            faer::Spec::default(),
        ));
        svd::svd(
            matrix.as_ref(),
            s.as_mut(),
            Some(u.as_mut()),
            Some(v.as_mut()),
            Par::Seq,
            MemStack::new(&mut scratch),
            faer::Spec::default(),
        )
        .map_err(|_| failed("no convergence"))?;
        let singular_values: Vec<f64> = (0..n).map(|i| s[i]).collect();

        // Free of charge, and it catches every decomposition that went wrong without saying so.
        let of_values = norm(singular_values.iter().copied());
        let of_matrix = norm((0..n).flat_map(|i| a.row(i).iter().copied()));
        let agree = (of_values - of_matrix).abs() <= FROBENIUS_TOLERANCE / 2.0 * of_matrix;
        if !agree {
            return Err(failed("their squares do not sum to the squares of the matrix"));
        }
        Ok(Self {
            singular_values,
            u: Matrix::from_fn(n, n, |i, k| u[(i, k)]),
            v: Matrix::from_fn(n, n, |i, k| v[(i, k)]),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    /// The triangle of a fit (three planes, what is plausible as rows) that the library's iteration does not
    /// decompose; bits, each row from its diagonal on.
    const UNDECIDED: &[u8] = include_bytes!("../../tests/data/undecided-svd.txt.gz");

    #[test]
    fn a_matrix_on_which_the_iteration_does_not_end_is_decomposed_from_its_other_side() {
        let mut text = String::new();
        flate2::read::GzDecoder::new(UNDECIDED).read_to_string(&mut text).unwrap();
        let bits = |word: &str| f64::from_bits(u64::from_str_radix(word, 16).unwrap());
        let rows: Vec<Vec<f64>> =
            text.lines().map(|line| line.split(' ').map(bits).collect()).collect();
        let n = rows.len();
        let a = Matrix::from_fn(n, n, |i, k| if k < i { 0.0 } else { rows[i][k - i] });
        for decomposition in [Decomposition::of(&a), Decomposition::from_other_side(&a)] {
            let Decomposition { singular_values, u, v } = decomposition.unwrap();
            for i in 0..n {
                for k in 0..n {
                    let again: f64 =
                        (0..n).map(|j| u[(i, j)] * singular_values[j] * v[(k, j)]).sum();
                    assert!((again - a[(i, k)]).abs() < 1e-13, "{i} {k}: {again} of {}", a[(i, k)]);
                }
            }
        }
    }
}
