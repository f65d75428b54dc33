//! Singular values of the scaled columns: what the data see, how well, and what they cannot see.
//!
//! ```text
//! J = A D,   D = diag(d_1 .. d_n),   d_k = |column k of J|,   A = U S V^T
//! ```
//!
//! The columns of `A` have unit length, so a singular value is a pure number (times the unit of a row):
//! how much of a row's worth of effect is left when the coefficients move along that direction. Without
//! the scaling it would depend on whether an angle is given in radians or in arc seconds.

use super::matrix::Matrix;
use super::matrix::norm;
use super::null_space::{NullDirection, sparse_basis};
use super::svd::Decomposition;
use super::triangle::Triangle;
use super::vector::dot;
use crate::Result;

/// Which singular directions a solution keeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Truncation {
    /// Those whose singular value is above this part of the largest one.
    Relative(f64),
    /// Those whose singular value is above this number, in the unit of the rows: the effect of the unit
    /// direction in scaled coefficients.
    Effect(f64),
    /// At most this many, the strongest first.
    Rank(usize),
}

/// A column shorter than this part of its reference has vanished: only rounding is left in it.
pub const VANISHED: f64 = 1e-13;

/// The singular value decomposition of the scaled triangle, together with the right-hand side.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    pub(super) scales: Vec<f64>,
    pub(super) singular_values: Vec<f64>,
    pub(super) v: Matrix,
    pub(super) u_t_rhs: Vec<f64>,
    pub(super) residual_norm: f64,
    pub(super) rows: usize,
}

impl Spectrum {
    /// Decomposes a triangle; a column has vanished if its norm is at most [`VANISHED`] times the norm
    /// of the *longest column*.
    ///
    /// A vanished column stays exactly zero and is never blown up to unit length. The rule is right
    /// when the units of the columns are within a dozen orders of each other; otherwise, use
    /// [`with_references`](Self::with_references).
    pub fn of(triangle: &Triangle) -> Result<Self> {
        let longest = triangle.r.column_norms().into_iter().fold(0.0_f64, f64::max);
        Self::with_references(triangle, &vec![longest; triangle.columns()])
    }

    /// Decomposes a triangle; column `k` has vanished if its norm is at most [`VANISHED`] times
    /// `references[k]`.
    ///
    /// The reference is the norm that the column would have if nothing in it cancelled, in the unit of
    /// the column: the size of the numbers that were subtracted from each other.
    ///
    /// # Panics
    ///
    /// If there is not one reference a column.
    pub fn with_references(triangle: &Triangle, references: &[f64]) -> Result<Self> {
        Self::with_norms(triangle, &triangle.r.column_norms(), references)
    }

    /// The same with columns scaled by the norms that they had before something was taken out of them.
    pub(super) fn with_norms(
        triangle: &Triangle,
        norms: &[f64],
        references: &[f64],
    ) -> Result<Self> {
        let n = triangle.columns();
        assert_eq!(references.len(), n, "one reference for each column");
        let scale = |(norm, reference): (&f64, &f64)| {
            if *norm <= VANISHED * reference { 0.0 } else { *norm }
        };
        let scales: Vec<f64> = norms.iter().zip(references).map(scale).collect();
        let scaled = Matrix::from_fn(n, n, |i, k| match scales[k] {
            0.0 => 0.0,
            scale => triangle.r[(i, k)] / scale,
        });
        let decomposition = Decomposition::of(&scaled)?;
        Ok(Self {
            u_t_rhs: decomposition.u.transposed().times_vector(&triangle.q_t_rhs),
            scales,
            singular_values: decomposition.singular_values,
            v: decomposition.v,
            residual_norm: triangle.residual_norm,
            rows: triangle.rows,
        })
    }

    /// Number of columns `n`.
    pub fn columns(&self) -> usize {
        self.scales.len()
    }

    /// `d_k`, the norms of the columns, in the units of the columns; 0 for a vanished one.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// All `n` singular values of the scaled columns, descending.
    pub fn singular_values(&self) -> &[f64] {
        &self.singular_values
    }

    /// `V`, `n x n`, orthogonal: column `i` is the direction of singular value `i` in scaled
    /// coefficients `z_k = d_k x_k`.
    pub fn right_singular_vectors(&self) -> &Matrix {
        &self.v
    }

    /// How many singular values are above `relative_tolerance` times the largest one.
    pub fn rank(&self, relative_tolerance: f64) -> usize {
        self.retained(Truncation::Relative(relative_tolerance))
    }

    /// How many singular directions a truncation keeps. A singular value of zero is never kept.
    pub fn retained(&self, truncation: Truncation) -> usize {
        let largest = self.singular_values.first().copied().unwrap_or(0.0);
        let above =
            |floor: f64| self.singular_values.iter().take_while(|&&s| s > floor.max(0.0)).count();
        match truncation {
            Truncation::Relative(tolerance) => above(tolerance * largest),
            Truncation::Effect(floor) => above(floor),
            Truncation::Rank(rank) => above(0.0).min(rank),
        }
    }

    /// The condition number `s_1 / s_r` of the scaled columns that have not vanished; infinite if they
    /// depend on each other exactly, 1 if there are none.
    ///
    /// Beyond some 1e15 its digits are those of rounding.
    pub fn condition(&self) -> f64 {
        let columns = self.scales.iter().filter(|&&scale| scale > 0.0).count();
        self.condition_of(columns)
    }

    /// The condition number `s_1 / s_rank` of the retained directions; 1 if none is retained.
    ///
    /// # Panics
    ///
    /// If the rank exceeds the number of columns.
    pub fn condition_of(&self, rank: usize) -> f64 {
        match rank {
            0 => 1.0,
            _ => self.singular_values[0] / self.singular_values[rank - 1],
        }
    }

    /// For every column, how much of it the first `rank` directions determine: the squared norm of the
    /// projection of the unit vector `e_k` on them, in scaled coefficients.
    ///
    /// 1 means that the data determine the coefficient by itself, 0 that they do not see it, and a
    /// number between that they see it only mixed with others. The sum over all columns is `rank`.
    pub fn observed_fraction(&self, rank: usize) -> Vec<f64> {
        let retained = |k| &self.v.row(k)[..rank];
        (0..self.columns()).map(|k| dot(retained(k), retained(k)).min(1.0)).collect()
    }

    /// An orthonormal basis of the directions that are not retained, `n x (n - rank)`, in scaled
    /// coefficients `z_k = d_k x_k`. A vanished column counts as `z_k = x_k`.
    pub fn null_space(&self, rank: usize) -> Matrix {
        let n = self.columns();
        Matrix::from_fn(n, n - rank, |i, k| self.v[(i, rank + k)])
    }

    /// The same null space in few words: directions with as few parts as could be found, the shortest
    /// first.
    ///
    /// Parts smaller than `drop` times the largest part of their direction, in scaled coefficients, are
    /// left out; 1e-6 suits exact dependences, 1e-2 those that only noise hides.
    pub fn null_directions(&self, rank: usize, drop: f64) -> Vec<NullDirection> {
        sparse_basis(&self.null_space(rank), drop).into_iter().map(|z| self.direction(&z)).collect()
    }

    /// A direction in scaled coefficients, told in the units of the coefficients.
    fn direction(&self, z: &[f64]) -> NullDirection {
        let mut order: Vec<usize> = (0..z.len()).filter(|&k| z[k] != 0.0).collect();
        order.sort_by(|&a, &b| z[b].abs().total_cmp(&z[a].abs()).then(a.cmp(&b)));
        let unscaled = |k: usize| match self.scales[k] {
            0.0 => z[k],
            scale => z[k] / scale,
        };
        let unit = order.first().map_or(1.0, |&k| unscaled(k));
        let along = self.v.transposed().times_vector(z);
        let stretched = along.iter().zip(&self.singular_values).map(|(c, s)| c * s);
        NullDirection {
            parts: order.iter().map(|&k| (k, unscaled(k) / unit)).collect(),
            effect: norm(stretched) / unit.abs(),
        }
    }
}

impl Triangle {
    /// The condition number `s_1 / s_n` of the columns as they are, units and all; infinite if they
    /// depend on each other exactly, 1 without columns.
    ///
    /// Nearly always it tells more about the choice of units than about the data. See
    /// [`Spectrum::condition`] for the number that does not.
    pub fn condition(&self) -> Result<f64> {
        let s = Decomposition::of(&self.r)?.singular_values;
        Ok(match (s.first(), s.last()) {
            (Some(first), Some(last)) => first / last,
            _ => 1.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::Tsqr;

    fn spectrum(rows: usize, n: usize, element: impl Fn(usize, usize) -> f64) -> Spectrum {
        let mut tsqr = Tsqr::new(n);
        for i in 0..rows {
            let row: Vec<f64> = (0..n).map(|k| element(i, k)).collect();
            tsqr.push(&row, 1.0);
        }
        Spectrum::of(&tsqr.finish().unwrap()).unwrap()
    }

    /// Shapes on which another library's decomposition is silently wrong.
    #[test]
    fn matrices_of_ones_have_one_singular_value() {
        for rows in 2..=30 {
            for n in 2..=30 {
                let all = spectrum(rows, n, |_, _| 1.0);
                let largest = (n as f64).sqrt();
                assert!((all.singular_values()[0] - largest).abs() < 1e-13 * largest);
                assert!(all.singular_values()[1] < 1e-14 * largest, "{rows} x {n}");
                assert_eq!(all.rank(1e-10), 1);
                for k in 0..n {
                    assert!((all.scales()[k] - (rows as f64).sqrt()).abs() < 1e-13);
                    let fraction = all.observed_fraction(1)[k];
                    assert!((fraction - 1.0 / n as f64).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn exact_dependences_lower_the_rank_one_by_one() {
        let wave = |i: usize, k: usize| (0.37 * (i * (k + 1)) as f64).cos();
        for dependent in 0..6 {
            let all = spectrum(4000, 12, |i, k| match k {
                _ if k < 12 - dependent => wave(i, k),
                _ => wave(i, k - 6) + 1e3 * wave(i, 0) - wave(i, k - 5),
            });
            assert_eq!(all.rank(1e-10), 12 - dependent);
            assert_eq!(all.retained(Truncation::Rank(3)), 3);
            let sum: f64 = all.observed_fraction(12 - dependent).iter().sum();
            assert!((sum - (12 - dependent) as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn units_change_the_raw_condition_only() {
        let wave = |i: usize, k: usize| (0.37 * (i * (k + 1)) as f64).cos();
        let units = [1.0, 1e5, 1e-4];
        let triangle = |scaled: bool| {
            let mut tsqr = Tsqr::new(3);
            for i in 0..500 {
                let row = [0, 1, 2].map(|k| wave(i, k) * if scaled { units[k] } else { 1.0 });
                tsqr.push(&row, 0.0);
            }
            tsqr.finish().unwrap()
        };
        let (plain, scaled) = (triangle(false), triangle(true));
        assert!(plain.condition().unwrap() < 2.0 && scaled.condition().unwrap() > 1e8);
        let condition = |t: &Triangle| Spectrum::of(t).unwrap().condition();
        assert!((condition(&plain) - condition(&scaled)).abs() < 1e-12);
    }

    #[test]
    fn a_column_of_rounding_stays_zero() {
        let element = |i: usize, k: usize| match k {
            0 => i as f64,
            1 => 1e-13 * (i as f64).sin(),
            _ => 1.0,
        };
        let all = spectrum(100, 3, element);
        assert!(all.scales()[1].abs() < f64::MIN_POSITIVE);
        assert_eq!(all.rank(1e-10), 2);
        assert!(all.observed_fraction(2)[1] < 1e-15);
        assert!(all.condition() < 10.0);
        let directions = all.null_directions(2, 1e-6);
        assert_eq!(directions.len(), 1);
        assert_eq!(directions[0].parts, [(1, 1.0)]);

        // The same column counts if its reference says that it is meant to be as small as that.
        let mut tsqr = Tsqr::new(3);
        for i in 0..100 {
            tsqr.push(&[0, 1, 2].map(|k| element(i, k)), 0.0);
        }
        let triangle = tsqr.finish().unwrap();
        let small = Spectrum::with_references(&triangle, &[1.0, 1e-12, 1.0]).unwrap();
        assert_eq!(small.rank(1e-10), 3);
    }

    #[test]
    fn confounded_groups_are_told_apart_in_their_units() {
        let wave = |i: usize, k: usize| (0.37 * (i * (k + 1)) as f64).cos();
        // 0 and 5 are opposite; 6 is 2 x column 1 + 300 x column 2; 3, 4, 7 are seen by themselves.
        let all = spectrum(3000, 8, |i, k| match k {
            5 => -wave(i, 0),
            6 => 2.0 * wave(i, 1) + 300.0 * wave(i, 2),
            _ => wave(i, k),
        });
        let rank = all.rank(1e-10);
        assert_eq!(rank, 6);
        let directions = all.null_directions(rank, 1e-6);
        let told = |direction: &NullDirection, expected: &[(usize, f64)]| {
            direction.parts.len() == expected.len()
                && expected.iter().all(|&(k, x)| {
                    let mut parts = direction.parts.iter();
                    parts.any(|p| p.0 == k && (p.1 / x - 1.0).abs() < 1e-9)
                })
        };
        assert!(told(&directions[0], &[(0, 1.0), (5, 1.0)]), "{directions:?}");
        let group = [(6, 1.0), (1, -2.0), (2, -300.0)];
        let second = &directions[1];
        let unit = second.parts.iter().find(|p| p.0 == 6).unwrap().1;
        let group = group.map(|(k, x)| (k, x * unit));
        assert!(told(second, &group), "{directions:?}");
        assert!(directions.iter().all(|d| d.effect < 1e-9));
    }

    #[test]
    fn no_columns_are_no_error() {
        let all = spectrum(4, 0, |_, _| 0.0);
        assert_eq!((all.columns(), all.rank(1e-10)), (0, 0));
        assert!((all.condition() - 1.0).abs() < 1e-15);
        assert!(all.null_directions(0, 1e-6).is_empty());
    }
}
