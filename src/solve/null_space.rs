//! Null directions with few parts, so that a confounded group can be told in words.
//!
//! A singular vector of a null space mixes every confounded group with every other. The same space has
//! bases whose vectors are mostly zeros: "`EXX0` and `EXw`, one up and the other down". Elimination finds
//! one, and exchanging pivots as the simplex method does makes it shorter for as long as that works. The
//! sparsest basis of all is a hard combinatorial problem; this one is short, not proven shortest.

use super::matrix::Matrix;

/// An exchange may not divide by less than this part of the row's largest element: digits would be lost.
const STABLE: f64 = 0.05;

/// A direction in which the coefficients can move without being noticed.
#[derive(Debug, Clone, PartialEq)]
pub struct NullDirection {
    /// Column and change, in the unit of the column. The parts come in the order of their effects on
    /// the rows, and the first, which has the largest, is 1.
    pub parts: Vec<(usize, f64)>,
    /// `|J x|` for the change `x` that the parts tell, over all rows: what is noticed of it after all.
    /// Zero up to rounding and dropped parts if the dependence is exact.
    pub effect: f64,
}

/// Short vectors that span the same space as the orthonormal columns of `basis`, the shortest first.
///
/// In every vector the largest element is 1 in magnitude and elements below `drop` are zero.
pub(super) fn sparse_basis(basis: &Matrix, drop: f64) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = (0..basis.columns()).map(|k| basis.column(k)).collect();
    let mut pivots = eliminate(&mut rows);
    while exchange_one(&mut rows, &mut pivots, drop) {}
    for row in &mut rows {
        let largest = largest(row);
        for x in row.iter_mut() {
            *x = if x.abs() < drop * largest { 0.0 } else { *x / largest };
        }
    }
    let first = |row: &[f64]| row.iter().position(|&x| x != 0.0);
    rows.sort_by_key(|row| (count(row, drop), first(row)));
    rows
}

/// Brings the rows to reduced echelon form and returns their pivots.
///
/// The pivot is taken from the column with the most left in it, which keeps the divisors large.
fn eliminate(rows: &mut [Vec<f64>]) -> Vec<usize> {
    let columns = rows.first().map_or(0, Vec::len);
    let mut pivots = Vec::with_capacity(rows.len());
    for step in 0..rows.len() {
        let left = |k: usize| rows[step..].iter().map(|row| row[k] * row[k]).sum::<f64>();
        let column = (0..columns)
            .filter(|k| !pivots.contains(k))
            .max_by(|&a, &b| left(a).total_cmp(&left(b)).then(b.cmp(&a)))
            .unwrap_or(0);
        let row = (step..rows.len())
            .max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))
            .unwrap_or(step);
        rows.swap(step, row);
        clear(rows, step, column);
        pivots.push(column);
    }
    pivots
}

/// Makes `rows[row][column]` one and the rest of the column zero.
fn clear(rows: &mut [Vec<f64>], row: usize, column: usize) {
    let mut pivot_row = std::mem::take(&mut rows[row]);
    let divisor = pivot_row[column];
    for x in &mut pivot_row {
        *x /= divisor;
    }
    pivot_row[column] = 1.0;
    for other in rows.iter_mut().filter(|other| !other.is_empty()) {
        subtract(other, &pivot_row, column);
    }
    rows[row] = pivot_row;
}

/// Takes the pivot row, with 1 in `column`, off another row so that its element there becomes zero.
fn subtract(row: &mut [f64], pivot_row: &[f64], column: usize) {
    let factor = row[column];
    for (x, p) in row.iter_mut().zip(pivot_row) {
        *x -= factor * p;
    }
    row[column] = 0.0;
}

/// Exchanges the pivot that saves the most parts. Returns whether any saved some.
fn exchange_one(rows: &mut [Vec<f64>], pivots: &mut [usize], drop: f64) -> bool {
    let counts: Vec<usize> = rows.iter().map(|row| count(row, drop)).collect();
    let mut best: Option<(usize, usize, usize)> = None;
    for i in 0..rows.len() {
        let floor = STABLE.max(drop) * largest(&rows[i]);
        for column in 0..rows[i].len() {
            if column == pivots[i] || rows[i][column].abs() < floor {
                continue;
            }
            let divisor = rows[i][column];
            let pivot_row: Vec<f64> = rows[i].iter().map(|x| x / divisor).collect();
            let (mut before, mut after) = (0, 0);
            for (j, row) in rows.iter().enumerate() {
                if j == i || row[column] == 0.0 {
                    continue;
                }
                let mut row = row.clone();
                subtract(&mut row, &pivot_row, column);
                before += counts[j];
                after += count(&row, drop);
            }
            let saved = before.saturating_sub(after);
            if saved > best.map_or(0, |(_, _, saved)| saved) {
                best = Some((i, column, saved));
            }
        }
    }
    if let Some((row, column, _)) = best {
        clear(rows, row, column);
        pivots[row] = column;
    }
    best.is_some()
}

fn largest(row: &[f64]) -> f64 {
    row.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

fn count(row: &[f64], drop: f64) -> usize {
    let floor = drop * largest(row);
    row.iter().filter(|x| **x != 0.0 && x.abs() >= floor).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rotates sparse vectors into a dense orthonormal basis by Gram-Schmidt and expects them back.
    fn round_trip(sparse: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let n = sparse[0].len();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for i in 0..sparse.len() {
            // Every start vector is a mixture of all of them.
            let mut v: Vec<f64> = (0..n)
                .map(|k| {
                    let weight = |j: usize| (((i + 2) * (i + j + 1)) as f64 * 1.3).sin();
                    (0..sparse.len()).map(|j| weight(j) * sparse[j][k]).sum()
                })
                .collect();
            for _ in 0..2 {
                for b in &basis {
                    let along: f64 = b.iter().zip(&v).map(|(b, v)| b * v).sum();
                    v.iter_mut().zip(b).for_each(|(v, b)| *v -= along * b);
                }
            }
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            basis.push(v.into_iter().map(|x| x / length).collect());
        }
        let dense = Matrix::from_fn(n, basis.len(), |i, k| basis[k][i]);
        sparse_basis(&dense, 1e-9)
    }

    #[test]
    fn sparse_vectors_are_found_again() {
        let vector = |parts: &[(usize, f64)]| {
            let mut v = vec![0.0; 14];
            for &(k, x) in parts {
                v[k] = x;
            }
            v
        };
        let sparse = vec![
            vector(&[(3, 1.0)]),
            vector(&[(0, 1.0), (5, -1.0)]),
            vector(&[(1, 1.0), (2, -0.5), (6, 0.25)]),
            vector(&[(5, 1.0), (7, 0.7), (8, 0.3), (9, 0.9)]),
            vector(&[(9, 0.8), (10, 1.0), (11, -0.6), (12, 0.4)]),
        ];
        let found = round_trip(&sparse);
        let count = |v: &[f64]| v.iter().filter(|x| **x != 0.0).count();
        let counts: Vec<usize> = found.iter().map(|v| count(v)).collect();
        assert_eq!(counts, [1, 2, 3, 4, 4], "{found:?}");
        for v in &found {
            let size = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!((size - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn an_empty_null_space_has_no_directions() {
        assert!(sparse_basis(&Matrix::zeros(5, 0), 1e-6).is_empty());
    }
}
