//! One chunk of rows folded under a triangle by Householder reflections.
//!
//! Column `j` is cleared by `I - tau_j h_j h_j^T` with `h_j = [e_j; v_j]`: because `R` is already a
//! triangle, a reflection touches only row `j` of it and the rows of the chunk. A few reflections at a
//! time are gathered as `I - H T H^T` (Schreiber and Van Loan, 1989): a column right of them is then read once
//! for all their products, and once to take them off, while it stays in the first-level cache.
//!
//! Products and sums run in the widest vectors that the processor has, found at run time: what is compiled for any
//! processor would have two numbers in a vector where this one has four, and no fused multiplication.
//!
//! The library's own QR is not used here: what is left of a column below `16 m` roundings of its norm
//! (`4e-12` for a chunk of 1024 rows) it leaves where it is and takes the column for dependent. On
//! dependent columns, which are the rule here, `R^T R` was then wrong by up to `5e-13` of the norms of
//! its two columns; this way it is right to a few `1e-15`.

#![allow(clippy::inline_always)] // what a kernel calls has its vectors only as a part of it
#![allow(clippy::needless_range_loop)] // nine slices of one length, one index

use pulp::{Arch, Simd, WithSimd};

use super::matrix::Matrix;

/// Rows of a chunk: with a hundred columns it stays in the second-level cache.
pub(super) const CHUNK: usize = 1024;

/// Distance of two columns in memory. Not a power of two, else the elements of a row would all compete
/// for the same lines of the cache.
const STRIDE: usize = CHUNK + 8;

/// Bytes to which the first column, and so every column, is aligned.
const ALIGNMENT: usize = 64;

/// Reflections gathered before the columns to their right are updated: as many sums as a processor adds to at once.
const PANEL: usize = 8;

/// The factor `T` of a panel of reflections, upper triangular.
type PanelFactor = [[f64; PANEL]; PANEL];

/// A triangle and the chunk of rows below it.
pub(super) struct Fold {
    /// `width x width`, upper triangular.
    pub(super) r: Matrix,
    /// The chunk, column after column, from `origin` on.
    chunk: Vec<f64>,
    /// Columns begin where a line of the cache does.
    origin: usize,
}

impl Fold {
    pub(super) fn new(width: usize) -> Self {
        let chunk = vec![0.0_f64; width * STRIDE + ALIGNMENT / size_of::<f64>()];
        let origin = chunk.as_ptr().align_offset(ALIGNMENT);
        Self { r: Matrix::zeros(width, width), chunk, origin }
    }

    /// The elements of row `i` of the chunk.
    pub(super) fn row_mut(&mut self, i: usize) -> impl Iterator<Item = &mut f64> {
        self.chunk[self.origin + i..].iter_mut().step_by(STRIDE)
    }

    /// Folds the first `rows` rows of the chunk into the triangle; what is left in them is of no use.
    pub(super) fn fold(&mut self, rows: usize) {
        Arch::new().dispatch(Folding { fold: self, rows });
    }
}

/// A chunk that is being folded.
struct Folding<'a> {
    fold: &'a mut Fold,
    rows: usize,
}

impl WithSimd for Folding<'_> {
    type Output = ();

    // What is called from here is compiled for the vectors of `S` only where it becomes a part of this.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { fold, rows } = self;
        let width = fold.r.columns();
        let chunk = &mut fold.chunk[fold.origin..][..width * STRIDE];
        for start in (0..width).step_by(PANEL) {
            let end = (start + PANEL).min(width);
            let (panel, right) = chunk[start * STRIDE..].split_at_mut((end - start) * STRIDE);
            let t = reflect(simd, &mut fold.r, panel, start, rows);
            update_right(simd, &mut fold.r, panel, right, start, &t, rows);
        }
    }
}

/// Clears the columns of a panel, of which `start` is the first, and leaves the vectors `v` in their place.
#[inline(always)]
fn reflect<S: Simd>(
    simd: S,
    r: &mut Matrix,
    panel: &mut [f64],
    start: usize,
    rows: usize,
) -> PanelFactor {
    let mut t = [[0.0; PANEL]; PANEL];
    let size = panel.len() / STRIDE;
    for local in 0..size {
        let j = start + local;
        let (left, right) = panel.split_at_mut((local + 1) * STRIDE);
        let (earlier, v) = left.split_at_mut(local * STRIDE);
        let v = &mut v[..rows];
        let alpha = r[(j, j)];
        let tail = sum_of_products(simd, v, v);
        if tail == 0.0 {
            // Nothing to clear. Squares that underflow are taken for zero, and then are zero.
            v.fill(0.0);
            continue;
        }
        let beta = -(alpha * alpha + tail).sqrt().copysign(alpha);
        let tau = (beta - alpha) / beta;
        // Dividing, because the reciprocal of a tiny number overflows.
        for x in v.iter_mut() {
            *x /= alpha - beta;
        }
        r[(j, j)] = beta;
        for (column, k) in right.chunks_exact_mut(STRIDE).zip(j + 1..) {
            let column = &mut column[..rows];
            let w = tau * (r[(j, k)] + sum_of_products(simd, v, column));
            r[(j, k)] -= w;
            add_multiple(simd, column, -w, v);
        }
        // T grows by the column -tau T (H^T h_j). The e_j are orthogonal, so only the v count.
        let mut overlap = [0.0; PANEL];
        for (overlap, column) in overlap.iter_mut().zip(earlier.chunks_exact(STRIDE)) {
            *overlap = sum_of_products(simd, &column[..rows], v);
        }
        for (i, row) in t.iter_mut().enumerate().take(local) {
            row[local] = -tau * (i..local).map(|l| row[l] * overlap[l]).sum::<f64>();
        }
        t[local][local] = tau;
    }
    t
}

/// Applies the reflections of a panel, of which column `start` is the first, to all columns right of it:
/// `C - H T^T (H^T C)`.
#[inline(always)]
fn update_right<S: Simd>(
    simd: S,
    r: &mut Matrix,
    panel: &[f64],
    right: &mut [f64],
    start: usize,
    t: &PanelFactor,
    rows: usize,
) {
    let size = panel.len() / STRIDE;
    // Columns that a last panel lacks are read from its first one, and count for nothing.
    let mut v = [&panel[..rows]; PANEL];
    for (v, column) in v.iter_mut().zip(panel.chunks_exact(STRIDE)) {
        *v = &column[..rows];
    }
    for (column, k) in right.chunks_exact_mut(STRIDE).zip(start + size..) {
        let column = &mut column[..rows];
        let mut w = products(simd, &v, column);
        for (i, w) in w.iter_mut().enumerate() {
            *w = if i < size { *w + r[(start + i, k)] } else { 0.0 };
        }
        // T^T is lower triangular: from below, so that every element is still there when needed.
        for i in (0..size).rev() {
            w[i] = (0..=i).map(|l| t[l][i] * w[l]).sum();
            r[(start + i, k)] -= w[i];
        }
        take_off(simd, column, &v, &w);
    }
}

/// `a . b`, in four sums of a vector each, which do not wait for each other.
#[inline(always)]
fn sum_of_products<S: Simd>(simd: S, a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (S::as_simd_f64s(a), S::as_simd_f64s(b));
    let ((a4, a), (b4, b)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let zero = simd.splat_f64s(0.0);
    let (mut s0, mut s1, mut s2, mut s3) = (zero, zero, zero, zero);
    for (a, b) in a4.iter().zip(b4) {
        s0 = simd.mul_add_e_f64s(a[0], b[0], s0);
        s1 = simd.mul_add_e_f64s(a[1], b[1], s1);
        s2 = simd.mul_add_e_f64s(a[2], b[2], s2);
        s3 = simd.mul_add_e_f64s(a[3], b[3], s3);
    }
    for (a, b) in a.iter().zip(b) {
        s0 = simd.mul_add_e_f64s(*a, *b, s0);
    }
    let sum = simd.add_f64s(simd.add_f64s(s0, s1), simd.add_f64s(s2, s3));
    let mut all = simd.reduce_sum_f64s(sum);
    for (a, b) in a_rest.iter().zip(b_rest) {
        all += a * b;
    }
    all
}

/// `to + factor * of`.
#[inline(always)]
fn add_multiple<S: Simd>(simd: S, to: &mut [f64], factor: f64, of: &[f64]) {
    let ((to, to_rest), (of, of_rest)) = (S::as_mut_simd_f64s(to), S::as_simd_f64s(of));
    let factors = simd.splat_f64s(factor);
    for (to, of) in to.iter_mut().zip(of) {
        *to = simd.mul_add_e_f64s(factors, *of, *to);
    }
    for (to, of) in to_rest.iter_mut().zip(of_rest) {
        *to += factor * of;
    }
}

/// The products of a column with all vectors of a panel, each the sum of a vector. Eight sums are as many as do not wait for
/// each other; they are written out because in an array they would lie in memory.
#[inline(always)]
fn products<S: Simd>(simd: S, v: &[&[f64]; PANEL], column: &[f64]) -> [f64; PANEL] {
    let (c, c_rest) = S::as_simd_f64s(column);
    let count = c.len();
    let v0 = &S::as_simd_f64s(v[0]).0[..count];
    let v1 = &S::as_simd_f64s(v[1]).0[..count];
    let v2 = &S::as_simd_f64s(v[2]).0[..count];
    let v3 = &S::as_simd_f64s(v[3]).0[..count];
    let v4 = &S::as_simd_f64s(v[4]).0[..count];
    let v5 = &S::as_simd_f64s(v[5]).0[..count];
    let v6 = &S::as_simd_f64s(v[6]).0[..count];
    let v7 = &S::as_simd_f64s(v[7]).0[..count];
    let zero = simd.splat_f64s(0.0);
    let (mut s0, mut s1, mut s2, mut s3) = (zero, zero, zero, zero);
    let (mut s4, mut s5, mut s6, mut s7) = (zero, zero, zero, zero);
    for i in 0..count {
        let c = c[i];
        s0 = simd.mul_add_e_f64s(v0[i], c, s0);
        s1 = simd.mul_add_e_f64s(v1[i], c, s1);
        s2 = simd.mul_add_e_f64s(v2[i], c, s2);
        s3 = simd.mul_add_e_f64s(v3[i], c, s3);
        s4 = simd.mul_add_e_f64s(v4[i], c, s4);
        s5 = simd.mul_add_e_f64s(v5[i], c, s5);
        s6 = simd.mul_add_e_f64s(v6[i], c, s6);
        s7 = simd.mul_add_e_f64s(v7[i], c, s7);
    }
    let mut products = [
        simd.reduce_sum_f64s(s0),
        simd.reduce_sum_f64s(s1),
        simd.reduce_sum_f64s(s2),
        simd.reduce_sum_f64s(s3),
        simd.reduce_sum_f64s(s4),
        simd.reduce_sum_f64s(s5),
        simd.reduce_sum_f64s(s6),
        simd.reduce_sum_f64s(s7),
    ];
    let done = column.len() - c_rest.len();
    for (product, v) in products.iter_mut().zip(v) {
        for (v, c) in v[done..].iter().zip(c_rest) {
            *product += v * c;
        }
    }
    products
}

/// Takes `w` times the vectors of a panel off a column.
#[inline(always)]
fn take_off<S: Simd>(simd: S, column: &mut [f64], v: &[&[f64]; PANEL], w: &[f64; PANEL]) {
    let rows = column.len();
    let (c, c_rest) = S::as_mut_simd_f64s(column);
    let (count, done) = (c.len(), rows - c_rest.len());
    let (v0, w0) = (&S::as_simd_f64s(v[0]).0[..count], simd.splat_f64s(-w[0]));
    let (v1, w1) = (&S::as_simd_f64s(v[1]).0[..count], simd.splat_f64s(-w[1]));
    let (v2, w2) = (&S::as_simd_f64s(v[2]).0[..count], simd.splat_f64s(-w[2]));
    let (v3, w3) = (&S::as_simd_f64s(v[3]).0[..count], simd.splat_f64s(-w[3]));
    let (v4, w4) = (&S::as_simd_f64s(v[4]).0[..count], simd.splat_f64s(-w[4]));
    let (v5, w5) = (&S::as_simd_f64s(v[5]).0[..count], simd.splat_f64s(-w[5]));
    let (v6, w6) = (&S::as_simd_f64s(v[6]).0[..count], simd.splat_f64s(-w[6]));
    let (v7, w7) = (&S::as_simd_f64s(v[7]).0[..count], simd.splat_f64s(-w[7]));
    for i in 0..count {
        // Two chains: the processor begins the next numbers while these wait for one another.
        let mut even = simd.mul_add_e_f64s(v0[i], w0, c[i]);
        let mut odd = simd.mul_f64s(v1[i], w1);
        even = simd.mul_add_e_f64s(v2[i], w2, even);
        odd = simd.mul_add_e_f64s(v3[i], w3, odd);
        even = simd.mul_add_e_f64s(v4[i], w4, even);
        odd = simd.mul_add_e_f64s(v5[i], w5, odd);
        even = simd.mul_add_e_f64s(v6[i], w6, even);
        odd = simd.mul_add_e_f64s(v7[i], w7, odd);
        c[i] = simd.add_f64s(even, odd);
    }
    for (i, c) in c_rest.iter_mut().enumerate() {
        for (v, w) in v.iter().zip(w) {
            *c -= v[done + i] * w;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// Reflections in panels and one at a time give the same triangle, zero rows or not.
    #[test]
    fn panels_agree_with_single_reflections() {
        let width = 2 * PANEL + 3;
        let rows = 50;
        let element = |i: usize, k: usize| (0.37 * (i * (k + 2)) as f64).cos();
        let mut fold = Fold::new(width);
        let mut plain = Matrix::zeros(width, width);
        for round in 0..3 {
            let mut chunk = Matrix::from_fn(rows, width, |i, k| element(i + round * rows, k));
            for i in 0..rows {
                for (out, &value) in fold.row_mut(i).zip(chunk.row(i)) {
                    *out = value;
                }
            }
            fold.fold(rows);
            for j in 0..width {
                let v = chunk.column(j);
                let tail = dot(&v, &v);
                let alpha = plain[(j, j)];
                let beta = -(alpha * alpha + tail).sqrt().copysign(alpha);
                for k in j + 1..width {
                    // (I - tau h h^T) c, with h = [alpha - beta; v] and tau = 2 / |h|^2.
                    let head = alpha - beta;
                    let product = head * plain[(j, k)] + dot(&v, &chunk.column(k));
                    let w = 2.0 * product / (head * head + tail);
                    plain[(j, k)] -= w * head;
                    for i in 0..rows {
                        chunk[(i, k)] -= w * v[i];
                    }
                }
                plain[(j, j)] = beta;
            }
        }
        for j in 0..width {
            for k in 0..width {
                assert!((fold.r[(j, k)] - plain[(j, k)]).abs() < 1e-13, "{j} {k}");
            }
        }
    }

    #[test]
    fn nothing_to_clear_leaves_the_triangle_alone() {
        let mut fold = Fold::new(3);
        fold.r = Matrix::from_fn(3, 3, |i, k| if i <= k { -1.0 } else { 0.0 });
        let before = fold.r.clone();
        fold.fold(0);
        fold.fold(CHUNK);
        assert_eq!(fold.r, before);
    }
}
