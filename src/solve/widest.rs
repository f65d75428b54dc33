//! Rows added to sums in the widest vectors that the processor has, found at run time: what is compiled for any processor has two
//! numbers in a vector where this one has four or eight.
//!
//! A product is rounded before it is added, and each sum takes its rows one after the other, so bits are those of any processor.

#![allow(clippy::inline_always)] // what a kernel calls has its vectors only as a part of it

use pulp::{Arch, Simd, WithSimd};

use super::vector::{LANES, across};

/// `to += sum_k factor * values[k] * row_k` of rows that lie one after the other, each as long as `to`.
pub fn add_rows(factor: f64, values: &[f64], rows: &[f64], to: &mut [f64]) {
    Arch::new().dispatch(AddRows { factor, values, rows, to });
}

/// Adds each row, which comes with the number of a sum and a factor, to that sum; rows and sums of so many numbers lie one after the
/// other.
pub(super) fn add_to_sums(
    width: usize,
    rows: &[f32],
    places: impl Iterator<Item = (usize, f64)>,
    sums: &mut [f64],
) {
    if width > 0 {
        Arch::new().dispatch(AddToSums { width, rows, places, sums });
    }
}

/// What a column leaves of its part along directions whose rows lie one after the other: `c - Q a`.
pub(super) fn less_rows(column: &[f64], rows: &[f32], along: &[f64]) -> Vec<f64> {
    Arch::new().dispatch(LessRows { column, rows, along })
}

/// See [`add_rows`].
struct AddRows<'a> {
    factor: f64,
    values: &'a [f64],
    rows: &'a [f64],
    to: &'a mut [f64],
}

impl WithSimd for AddRows<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { factor, values, rows, to } = self;
        if to.is_empty() {
            return;
        }
        let rows = values.iter().zip(rows.chunks_exact(to.len()));
        for (value, row) in rows.filter(|(value, _)| **value != 0.0) {
            let times = factor * value;
            to.iter_mut().zip(row).for_each(|(to, of)| *to += times * of);
        }
    }
}

/// See [`add_to_sums`].
struct AddToSums<'a, I> {
    width: usize,
    rows: &'a [f32],
    places: I,
    sums: &'a mut [f64],
}

impl<I: Iterator<Item = (usize, f64)>> WithSimd for AddToSums<'_, I> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { width, rows, places, sums } = self;
        for (row, (place, factor)) in rows.chunks_exact(width).zip(places) {
            let sum = &mut sums[place * width..][..width];
            sum.iter_mut().zip(row).for_each(|(sum, of)| *sum += factor * f64::from(*of));
        }
    }
}

/// See [`less_rows`].
struct LessRows<'a> {
    column: &'a [f64],
    rows: &'a [f32],
    along: &'a [f64],
}

impl WithSimd for LessRows<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<f64> {
        let Self { column, rows, along } = self;
        let rows = rows.chunks_exact(along.len());
        column.iter().zip(rows).map(|(c, row)| c - product(row, along)).collect()
    }
}

/// As [`dot`](super::dot) sums, of numbers of seven digits and of sixteen.
#[inline(always)]
fn product(a: &[f32], b: &[f64]) -> f64 {
    let (eights_a, rest_a) = a.as_chunks::<LANES>();
    let (eights_b, rest_b) = b.as_chunks::<LANES>();
    let rest = rest_a.iter().zip(rest_b).map(|(a, b)| f64::from(*a) * b).sum::<f64>();
    let lanes = eights_a.iter().zip(eights_b).fold([0.0; LANES], |lanes, (a, b)| {
        std::array::from_fn(|k| lanes[k] + f64::from(a[k]) * b[k])
    });
    across(lanes) + rest
}

#[cfg(test)]
mod tests {
    use super::super::dot;
    use super::*;

    #[test]
    fn rows_are_added_one_after_the_other() {
        let rows: Vec<f64> = (0..3 * 13).map(|k| 1.0 / f64::from(k + 1)).collect();
        let values = [0.3, 0.0, -1.7];
        let mut to = vec![0.1; 13];
        add_rows(1.1, &values, &rows, &mut to);
        for (c, to) in to.iter().enumerate() {
            let sum = 0.1 + 1.1 * 0.3 * rows[c] + 1.1 * -1.7 * rows[26 + c];
            assert_eq!(to.to_bits(), sum.to_bits(), "column {c}");
        }
        add_rows(1.0, &values, &[], &mut []);
    }

    #[test]
    fn each_row_comes_to_its_sum() {
        let rows: Vec<f32> = (0..4 * 11).map(|k| 1.0 / (k as f32 + 1.0)).collect();
        let mut sums = vec![0.0; 2 * 11];
        let places = [(1, 0.7), (0, 1.0), (1, -0.2), (1, 3.0)];
        add_to_sums(11, &rows, places.into_iter(), &mut sums);
        for c in 0..11 {
            let of = |k: usize| f64::from(rows[k * 11 + c]);
            assert_eq!(sums[c].to_bits(), of(1).to_bits());
            let sum = 0.7 * of(0) + -0.2 * of(2) + 3.0 * of(3);
            assert_eq!(sums[11 + c].to_bits(), sum.to_bits(), "column {c}");
        }
        add_to_sums(0, &[], std::iter::empty(), &mut []);
    }

    #[test]
    fn a_row_is_taken_off_as_a_product_is_summed() {
        for width in [1, 7, 8, 9, 29] {
            let rows: Vec<f32> = (0..2 * width).map(|k| 1.0 / (k as f32 + 1.0)).collect();
            let along: Vec<f64> = (0..width).map(|k| 1.0 / (k as f64 + 3.0)).collect();
            let left = less_rows(&[2.0, -1.0], &rows, &along);
            for (row, (left, c)) in rows.chunks(width).zip(left.iter().zip([2.0, -1.0])) {
                let row: Vec<f64> = row.iter().map(|q| f64::from(*q)).collect();
                assert_eq!(left.to_bits(), (c - dot(&row, &along)).to_bits(), "{width} columns");
            }
        }
    }
}
