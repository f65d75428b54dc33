//! A tall least-squares problem folded into a triangle, row by row, in constant memory.
//!
//! ```text
//! [ R_old  c_old ]              [ R  c   ]
//! [ chunk  rhs   ]  =  Q        [ 0  rho ]      Q orthogonal, R upper triangular
//! ```
//!
//! Every 1024 rows the chunk is factored under the triangle of all rows before it, in the order in
//! which they came. Nothing runs side by side in here, so one machine gives the same bits on every run;
//! another processor may round differently, because the library picks its kernels at run time.
//!
//! `R^T R = J^T J`, yet `J^T J` is never formed: its rounding alone loses half of the digits.

use super::fold::{CHUNK, Fold};
use super::matrix::Matrix;
use super::triangle::Triangle;
use crate::{Error, Result};

/// Takes the rows of a least-squares problem and keeps only their triangle.
///
/// ```
/// use ballbar::solve::{Truncation, Tsqr, solve};
///
/// // A straight line through four points: e = 1 + 2 t.
/// let mut rows = Tsqr::new(2);
/// for t in [0.0, 1.0, 2.0, 3.0] {
///     rows.push(&[1.0, t], 1.0 + 2.0 * t);
/// }
/// let line = solve(&rows.finish()?, Truncation::Relative(1e-10))?;
/// assert!((line.x()[1] - 2.0).abs() < 1e-14);
/// # Ok::<(), ballbar::Error>(())
/// ```
pub struct Tsqr {
    columns: usize,
    /// The triangle so far and the chunk, both with the right-hand side as the last column.
    fold: Fold,
    filled: usize,
    rows: usize,
    /// Row and column of the first value that is not finite; the right-hand side is column `n`.
    not_finite: Option<(usize, usize)>,
}

impl Tsqr {
    /// The rows of a problem that has this triangle, to push more to.
    pub fn of(triangle: &Triangle) -> Self {
        let mut rows = Self::new(triangle.columns());
        rows.push_triangle(triangle);
        rows
    }

    /// An empty problem with `n` columns and a right-hand side.
    pub fn new(columns: usize) -> Self {
        Self { columns, fold: Fold::new(columns + 1), filled: 0, rows: 0, not_finite: None }
    }

    /// Number of columns `n`, without the right-hand side.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// How many rows were pushed so far.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Adds the equation `row . x = rhs`.
    ///
    /// To weigh it, divide both sides by its standard deviation first, or use
    /// [`push_weighted`](Self::push_weighted). A value that is not finite is reported by
    /// [`finish`](Self::finish), so that this stays free of branches in the caller.
    ///
    /// # Panics
    ///
    /// If `row` has not `n` elements.
    pub fn push(&mut self, row: &[f64], rhs: f64) {
        self.push_weighted(row, rhs, 1.0);
    }

    /// Adds the equation `factor * row . x = factor * rhs`.
    ///
    /// The factor is the square root of a statistical weight: `1 / sigma` for a row with the standard
    /// deviation `sigma`, `sqrt(w)` for a robust weight `w`.
    ///
    /// # Panics
    ///
    /// If `row` has not `n` elements.
    pub fn push_weighted(&mut self, row: &[f64], rhs: f64, factor: f64) {
        assert_eq!(row.len(), self.columns, "a row has one element for each column");
        // Zero times a number is zero unless the number is not finite: one sum tells for the row.
        let mut poison = 0.0;
        let values = row.iter().chain(std::iter::once(&rhs));
        for (element, value) in self.fold.row_mut(self.filled).zip(values) {
            *element = value * factor;
            poison += *element * 0.0;
        }
        if poison != 0.0 {
            self.note_not_finite();
        }
        self.filled += 1;
        self.rows += 1;
        if self.filled == CHUNK {
            self.fold();
        }
    }

    /// Adds what is known beforehand about one unknown: `x_column = value` with the standard deviation
    /// `sigma`, both in the unit of that unknown.
    ///
    /// This is the row `e_column / sigma`, so the other rows must be in units of their own noise. No
    /// prior is ever added unasked.
    ///
    /// # Panics
    ///
    /// If there is no such column.
    pub fn push_prior(&mut self, column: usize, value: f64, sigma: f64) {
        let mut row = vec![0.0; self.columns];
        row[column] = 1.0 / sigma;
        self.push(&row, value / sigma);
    }

    /// Adds all rows that a triangle stands for, as `n + 1` rows.
    ///
    /// Runs can so be folded side by side and then joined in their order, with the same bits every time.
    ///
    /// # Panics
    ///
    /// If the triangle has another number of columns.
    pub fn push_triangle(&mut self, triangle: &Triangle) {
        let rows = self.rows + triangle.rows;
        for i in 0..triangle.columns() {
            self.push(triangle.r.row(i), triangle.q_t_rhs[i]);
        }
        self.push(&vec![0.0; triangle.columns()], triangle.residual_norm);
        self.rows = rows;
    }

    /// The triangle of all rows pushed.
    ///
    /// Fewer rows than columns, or none, are no error: the rank tells.
    pub fn finish(mut self) -> Result<Triangle> {
        if let Some((row, column)) = self.not_finite {
            let what = if column == self.columns {
                format!("the right-hand side of row {row} is not a finite number")
            } else {
                format!("column {column} of row {row} is not a finite number")
            };
            return Err(Error::input(what));
        }
        self.fold();
        let n = self.columns;
        let r = &self.fold.r;
        if let Some(column) = (0..=n).find(|&k| (0..=k).any(|i| !r[(i, k)].is_finite())) {
            let what = format!("the squares of column {column} leave the range of numbers");
            return Err(
                Error::input(what).hint("choose a unit in which the values are closer to 1")
            );
        }
        Ok(Triangle {
            r: Matrix::from_fn(n, n, |i, k| r[(i, k)]),
            q_t_rhs: r.column(n)[..n].to_vec(),
            residual_norm: r[(n, n)].abs(),
            rows: self.rows,
        })
    }

    /// Folds the rows of the chunk into the triangle.
    fn fold(&mut self) {
        self.fold.fold(self.filled);
        self.filled = 0;
    }

    #[cold]
    fn note_not_finite(&mut self) {
        if self.not_finite.is_none() {
            let bad = self.fold.row_mut(self.filled).position(|x| !x.is_finite());
            // The last columns of the stride are padding, never looked at before a real one.
            self.not_finite = bad.map(|column| (self.rows, column));
        }
    }
}

impl Triangle {
    /// The triangle of the same rows with only the given columns, in the given order.
    ///
    /// It costs one `n x n` factorisation, not a pass over the data, so trying models is cheap.
    ///
    /// # Panics
    ///
    /// If a column does not exist.
    pub fn select(&self, columns: &[usize]) -> Result<Self> {
        let mut narrow = Tsqr::new(columns.len());
        let mut row = vec![0.0; columns.len()];
        for i in 0..self.columns() {
            for (value, &k) in row.iter_mut().zip(columns) {
                *value = self.r[(i, k)];
            }
            narrow.push(&row, self.q_t_rhs[i]);
        }
        row.fill(0.0);
        narrow.push(&row, self.residual_norm);
        let triangle = narrow.finish()?;
        Ok(Self { rows: self.rows, ..triangle })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Kind;

    const ROW: [f64; 3] = [1.0, 2.0, 3.0];

    fn element(i: usize, k: usize) -> f64 {
        (0.37 * (i * (k + 1)) as f64).cos()
    }

    fn fill(tsqr: &mut Tsqr, rows: std::ops::Range<usize>) {
        let n = tsqr.columns();
        for i in rows {
            let row: Vec<f64> = (0..n).map(|k| element(i, k)).collect();
            tsqr.push(&row, (i as f64).sin());
        }
    }

    /// Largest difference of `R^T R`, `R^T c` and `|e|^2`, relative to the norms of the columns.
    fn difference(triangle: &Triangle, rows: usize) -> f64 {
        let n = triangle.columns();
        let data = |i: usize, k: usize| {
            if k < n { element(i, k) } else { (i as f64).sin() }
        };
        let r = |i: usize, k: usize| match (i < n, k < n) {
            (true, true) => triangle.r[(i, k)],
            (true, false) => triangle.q_t_rhs[i],
            (false, true) => 0.0,
            (false, false) => triangle.residual_norm,
        };
        let product = |rows: usize, f: &dyn Fn(usize, usize) -> f64, k: usize, l: usize| {
            (0..rows).map(|i| f(i, k) * f(i, l)).sum::<f64>()
        };
        let mut worst = 0.0_f64;
        for k in 0..=n {
            for l in 0..=k {
                let expected = product(rows, &data, k, l);
                let size = (product(rows, &data, k, k) * product(rows, &data, l, l)).sqrt();
                let error = (product(n + 1, &r, k, l) - expected).abs() / size.max(1e-300);
                worst = worst.max(error);
            }
        }
        worst
    }

    #[test]
    fn triangle_stands_for_all_rows_at_every_chunk_boundary() {
        for rows in [1, 5, 12, 1023, 1024, 1025, 2048, 2049, 5000] {
            let mut tsqr = Tsqr::new(11);
            fill(&mut tsqr, 0..rows);
            let triangle = tsqr.finish().unwrap();
            assert_eq!(triangle.rows(), rows);
            assert!(difference(&triangle, rows) < 1e-13, "{rows} rows");
        }
    }

    #[test]
    fn triangles_join_in_order() {
        let mut whole = Tsqr::new(7);
        for range in [0..900, 900..3000, 3000..3001] {
            let mut part = Tsqr::new(7);
            fill(&mut part, range);
            whole.push_triangle(&part.finish().unwrap());
        }
        let triangle = whole.finish().unwrap();
        assert_eq!(triangle.rows(), 3001);
        assert!(difference(&triangle, 3001) < 1e-13);
    }

    #[test]
    fn selected_columns_are_those_of_a_narrow_problem() {
        let columns = [4, 0, 5];
        let (mut wide, mut narrow) = (Tsqr::new(6), Tsqr::new(3));
        fill(&mut wide, 0..1500);
        for i in 0..1500 {
            narrow.push(&columns.map(|k| element(i, k)), (i as f64).sin());
        }
        let (selected, narrow) =
            (wide.finish().unwrap().select(&columns).unwrap(), narrow.finish().unwrap());
        assert_eq!(selected.rows(), 1500);
        assert!((selected.residual_norm() - narrow.residual_norm()).abs() < 1e-12);
        for i in 0..3 {
            for k in 0..3 {
                // The sign of a row of R is free.
                let (a, b) = (selected.r[(i, k)].abs(), narrow.r[(i, k)].abs());
                assert!((a - b).abs() < 1e-12, "{i} {k}");
            }
        }
    }

    #[test]
    fn same_rows_give_the_same_bits() {
        let run = |padding: usize| {
            // Something else on the heap, so that the buffers come to lie elsewhere.
            let _elsewhere = vec![0_u8; padding];
            let mut tsqr = Tsqr::new(23);
            fill(&mut tsqr, 0..3000);
            let triangle = tsqr.finish().unwrap();
            let r = (0..23).flat_map(|i| triangle.r.row(i).to_vec());
            let all = r.chain(triangle.q_t_rhs.clone());
            all.chain([triangle.residual_norm]).map(f64::to_bits).collect::<Vec<_>>()
        };
        let first = run(0);
        for padding in [8, 24, 1000, 5000, 100_008] {
            assert_eq!(run(padding), first);
        }
    }

    #[test]
    fn what_is_not_a_number_is_refused_by_its_column() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut tsqr = Tsqr::new(3);
            tsqr.push(&ROW, 0.0);
            tsqr.push(&[1.0, bad, 3.0], 0.0);
            tsqr.push(&[bad, 1.0, 3.0], 0.0);
            let error = tsqr.finish().unwrap_err();
            assert_eq!(error.kind, Kind::Input);
            assert_eq!(error.what, "column 1 of row 1 is not a finite number");
        }
        let mut tsqr = Tsqr::new(3);
        tsqr.push(&ROW, f64::NAN);
        let error = tsqr.finish().unwrap_err();
        assert_eq!(error.what, "the right-hand side of row 0 is not a finite number");
        let mut tsqr = Tsqr::new(3);
        tsqr.push_prior(2, 0.0, 0.0);
        assert!(tsqr.finish().unwrap_err().what.starts_with("column 2 "));
    }

    #[test]
    fn squares_out_of_range_are_refused() {
        let mut tsqr = Tsqr::new(3);
        tsqr.push(&[1e200, 1.0, 3.0], 0.0);
        let error = tsqr.finish().unwrap_err();
        assert!(error.what.contains("column 0"), "{error}");
        assert!(error.hint.is_some());
    }

    #[test]
    fn no_rows_and_no_columns_are_no_error() {
        let empty = Tsqr::new(3).finish().unwrap();
        assert_eq!((empty.rows(), empty.columns()), (0, 3));
        let mut none = Tsqr::new(0);
        none.push(&[], 3.0);
        none.push(&[], 4.0);
        assert!((none.finish().unwrap().residual_norm() - 5.0).abs() < 1e-14);
    }
}
