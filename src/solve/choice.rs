//! Which columns to keep: a rank-revealing choice in an order of preference.
//!
//! The columns are visited in the order of the caller. One is kept if the kept ones do not explain it:
//! with every column scaled to unit length and `Q` an orthonormal basis of the kept ones,
//! `|(1 - Q Q^T) a_k|` must stand above the truncation's floor, and so must the smallest singular value
//! of the kept columns with `a_k` among them. For an exact tolerance this is the greedy algorithm on the
//! matroid of independent columns: no other complete set has a column that the order prefers.

use super::matrix::norm;
use super::spectrum::Spectrum;
use super::spectrum::Truncation;
use super::triangle::Triangle;
use super::vector::dot;
use crate::Result;

/// Above this many times the floor, what is left of a column decides alone; below, the singular values.
const CLEARLY: f64 = 1e4;

/// Columns that were kept and columns that were not, each list in the order of the visit.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Choice {
    /// Independent of each other.
    pub kept: Vec<usize>,
    /// Explained by those that were kept before them.
    pub rejected: Vec<usize>,
}

impl Triangle {
    /// Visits columns in an order and keeps those that the kept ones do not explain; `references` as in
    /// [`Spectrum::with_references`], one for each column of the triangle. A truncation to a fixed rank
    /// keeps the first columns that are not exactly dependent, at most so many.
    pub fn choose(
        &self,
        order: &[usize],
        references: &[f64],
        truncation: Truncation,
    ) -> Result<Choice> {
        self.choose_scaled(order, &self.r().column_norms(), references, truncation)
    }

    /// The same with columns scaled by the norms that they had before something was taken out of them.
    pub(super) fn choose_scaled(
        &self,
        order: &[usize],
        norms: &[f64],
        references: &[f64],
        truncation: Truncation,
    ) -> Result<Choice> {
        let (floor, most) = match truncation {
            Truncation::Relative(tolerance) => (tolerance, usize::MAX),
            Truncation::Effect(floor) => (floor, usize::MAX),
            Truncation::Rank(rank) => (f64::EPSILON, rank),
        };
        let mut choice = Choice::default();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for &k in order {
            let mut column = self.r().column(k);
            let length = norms[k];
            let vanished = length <= super::spectrum::VANISHED * references[k];
            if vanished || choice.kept.len() == most {
                choice.rejected.push(k);
                continue;
            }
            for x in &mut column {
                *x /= length;
            }
            // Twice, because once leaves rounding of the size of what was taken off.
            for _ in 0..2 {
                for q in &basis {
                    let along = dot(q, &column);
                    column.iter_mut().zip(q).for_each(|(x, q)| *x -= along * q);
                }
            }
            let left = norm(column.iter().copied());
            let mut with = choice.kept.clone();
            with.push(k);
            let independent = left > floor
                && (left > CLEARLY * floor
                    || self.are_independent(&with, norms, references, truncation)?);
            if independent {
                for x in &mut column {
                    *x /= left;
                }
                basis.push(column);
                choice.kept = with;
            } else {
                choice.rejected.push(k);
            }
        }
        Ok(choice)
    }

    fn are_independent(
        &self,
        columns: &[usize],
        norms: &[f64],
        references: &[f64],
        truncation: Truncation,
    ) -> Result<bool> {
        let [norms, references] =
            [norms, references].map(|of| columns.iter().map(|&k| of[k]).collect::<Vec<_>>());
        let spectrum = Spectrum::with_norms(&self.select(columns)?, &norms, &references)?;
        Ok(spectrum.retained(truncation) == columns.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::Tsqr;

    /// Column 3 is column 0 plus column 1, column 4 vanishes, column 5 is column 2 up to `small`.
    fn triangle(small: f64) -> Triangle {
        let mut rows = Tsqr::new(6);
        for i in 0..400 {
            let wave = |k: usize| (0.37 * (i * (k + 1)) as f64).cos();
            let (a, b, c) = (wave(0), wave(1), wave(2));
            rows.push(&[a, b, c, a + b, 0.0, c + small * wave(5)], 0.0);
        }
        rows.finish().unwrap()
    }

    #[test]
    fn the_order_decides_which_of_a_group_stays() {
        let choose = |order: &[usize]| {
            triangle(0.0).choose(order, &[1.0; 6], Truncation::Relative(1e-10)).unwrap()
        };
        let forward = choose(&[0, 1, 2, 3, 4, 5]);
        assert_eq!((forward.kept, forward.rejected), (vec![0, 1, 2], vec![3, 4, 5]));
        let backward = choose(&[5, 4, 3, 2, 1, 0]);
        assert_eq!((backward.kept, backward.rejected), (vec![5, 3, 1], vec![4, 2, 0]));
    }

    #[test]
    fn an_effect_below_the_floor_is_no_independence() {
        let kept = |small: f64, floor: f64| {
            let truncation = Truncation::Effect(floor);
            let choice = triangle(small).choose(&[2, 5], &[1.0; 6], truncation).unwrap();
            choice.kept.len()
        };
        assert_eq!(kept(1e-4, 1e-6), 2);
        assert_eq!(kept(1e-4, 1e-3), 1);
        // What is left of the second column, 1.0e-4, is above this floor, the smaller singular value of
        // the two, 0.71e-4, is not.
        assert_eq!(kept(1e-4, 0.85e-4), 1);
        assert_eq!(kept(1e-4, 0.6e-4), 2);
    }

    #[test]
    fn a_rank_bounds_the_number() {
        let choice = triangle(0.0).choose(&[0, 1, 2], &[1.0; 6], Truncation::Rank(2)).unwrap();
        assert_eq!((choice.kept, choice.rejected), (vec![0, 1], vec![2]));
    }
}
