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
    pub(super) fn of(a: &Matrix) -> Result<Self> {
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
