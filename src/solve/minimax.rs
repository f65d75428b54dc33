//! The fit whose largest residual is the smallest: minimax, Chebyshev; of a circle the minimum zone.
//!
//! ```text
//! minimise h    with    |y_i - a_i x| <= h    for all rows i
//! ```
//!
//! A linear program. Its dual looks for weights `w` with `sum |w_i| = 1` and `sum w_i a_i = 0` that make `sum w_i y_i`
//! largest; any such weights prove that no `x` leaves less than that. A *reference* is a choice of one row more than there
//! are columns and of the signs of their residuals: it levels them, and the weights come with it. Each step takes the row with
//! the largest residual in and puts out that one which keeps the weights from changing sign (Stiefel's exchange, which is
//! the simplex method on the dual), until no row lies outside of the level. Then level and largest residual are equal, and
//! each proves the other.
//!
//! A step is one pass over the rows, and a dozen are enough for thousands of rows. Rows that are equal, or that lie so that a weight
//! vanishes, could let the exchange go round in a circle; ties are broken by the order of an infinitesimal change of the weights
//! (lexicographic rule), which cannot. Dependent columns are left out: their coefficient is 0.

use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, PartialPivLu};

use super::vector::dot;
use crate::error::Kind;
use crate::{Error, Result};

/// A column counts as dependent on those before it when this share of its length is left.
const DEPENDENT: f64 = 1e-12;
/// A row is outside when its residual is beyond the level by this share of the largest of least squares: some roundings.
const OUTSIDE: f64 = 1e-14;
/// What a row takes of another one in the reference is nothing below this; all are numbers around 1.
const NOTHING: f64 = 1e-11;
/// No fit takes so many steps; where rounding would go on for ever, the best so far stands, with its bound.
const MOST_STEPS: usize = 1000;

/// A minimax fit of `N` columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimax<const N: usize> {
    /// The coefficients.
    pub coefficients: [f64; N],
    /// The largest magnitude of a residual: half of the zone.
    pub deviation: f64,
    /// No coefficients leave less than this, proven by the reference.
    pub bound: f64,
    /// Rows that touch the zone, with their weights: `sum |w| = 1`, `sum w a = 0`, `sum w y = bound`.
    pub reference: Vec<(usize, f64)>,
    /// The coefficients of least squares.
    pub least_squares: [f64; N],
}

/// Fits `values` by the columns of `rows`.
///
/// # Errors
/// When there are no rows, not as many values, or numbers that are not finite.
pub fn minimax<const N: usize>(rows: &[[f64; N]], values: &[f64]) -> Result<Minimax<N>> {
    MinimaxRows::of(rows).fit(values)
}

/// Rows that are fitted to several values, one after the other.
#[derive(Debug, Clone)]
pub struct MinimaxRows<const N: usize> {
    columns: Orthonormal<N>,
    /// The orthogonal columns row by row, 0 behind the last.
    rows: Vec<[f64; N]>,
    /// Rows that are as independent as there are.
    independent: Vec<usize>,
    finite: bool,
}

impl<const N: usize> MinimaxRows<N> {
    /// What is the same for all values.
    pub fn of(rows: &[[f64; N]]) -> Self {
        let columns = Orthonormal::of(rows);
        let orthogonal = columns.rows();
        let independent = independent(&orthogonal, columns.of.len());
        let finite = rows.iter().flatten().all(|number| number.is_finite());
        Self { columns, rows: orthogonal, independent, finite }
    }

    /// The minimax fit of values.
    ///
    /// # Errors
    /// When there are no rows, not as many values, or numbers that are not finite.
    pub fn fit(&self, values: &[f64]) -> Result<Minimax<N>> {
        self.check(values)?;
        let (by_squares, left) = self.columns.least_squares(values);
        let scale = left.iter().fold(0.0, |most: f64, e| most.max(e.abs()));
        let exchange = Exchange { of: self, left: &left, outside: OUTSIDE * scale };
        let level = exchange.run();
        let both: Vec<f64> = by_squares.iter().zip(&level.change).map(|(a, b)| a + b).collect();
        Ok(Minimax {
            coefficients: self.columns.coefficients(&both),
            deviation: level.deviation,
            bound: level.bound,
            reference: level.reference,
            least_squares: self.columns.coefficients(&by_squares),
        })
    }

    /// The coefficients of least squares alone.
    ///
    /// # Errors
    /// When there are no rows, not as many values, or numbers that are not finite.
    pub fn by_squares(&self, values: &[f64]) -> Result<[f64; N]> {
        self.check(values)?;
        Ok(self.columns.coefficients(&self.columns.least_squares(values).0))
    }

    fn check(&self, values: &[f64]) -> Result<()> {
        let finite = self.finite && values.iter().all(|number| number.is_finite());
        let rows = self.rows.len();
        if rows == 0 || rows != values.len() || !finite {
            let what = format!("{rows} rows with {} finite values have no fit", values.len());
            return Err(Error::new(Kind::Undetermined, what));
        }
        Ok(())
    }
}

/// So many rows that are as independent as there are: each is the longest of what those before it have left.
fn independent<const N: usize>(rows: &[[f64; N]], count: usize) -> Vec<usize> {
    if rows.len() <= count {
        return Vec::new();
    }
    let mut left: Vec<[f64; N]> = rows.to_vec();
    let mut chosen: Vec<usize> = Vec::new();
    for _ in 0..count {
        let square = |row: &[f64; N]| dot(row, row);
        let longest = (0..left.len())
            .max_by(|a, b| square(&left[*a]).total_cmp(&square(&left[*b])).then(b.cmp(a)));
        let Some(longest) = longest else { break };
        chosen.push(longest);
        let length = square(&left[longest]).sqrt();
        let unit = left[longest].map(|x| x / length);
        for row in &mut left {
            let share = dot(row, &unit);
            row.iter_mut().zip(&unit).for_each(|(x, u)| *x -= share * u);
        }
    }
    chosen
}

/// The columns made orthogonal, each with a mean square of 1, so that nothing depends on how they were scaled.
#[derive(Debug, Clone)]
struct Orthonormal<const N: usize> {
    /// Orthogonal columns, without dependent ones.
    columns: Vec<Vec<f64>>,
    /// Which column each comes from.
    of: Vec<usize>,
    /// What of each orthogonal column (row) is in the column that another comes from.
    triangle: Vec<[f64; N]>,
}

impl<const N: usize> Orthonormal<N> {
    /// Gram and Schmidt, twice.
    fn of(rows: &[[f64; N]]) -> Self {
        let root = (rows.len() as f64).sqrt();
        let mut made = Self { columns: Vec::new(), of: Vec::new(), triangle: Vec::new() };
        for k in 0..N {
            let mut column: Vec<f64> = rows.iter().map(|row| row[k]).collect();
            let length = dot(&column, &column).sqrt();
            let mut taken = vec![0.0; made.columns.len()];
            for _ in 0..2 {
                for (q, taken) in made.columns.iter().zip(&mut taken) {
                    let share = dot(q, &column) / rows.len() as f64;
                    *taken += share;
                    column.iter_mut().zip(q).for_each(|(c, q)| *c -= share * q);
                }
            }
            let left = dot(&column, &column).sqrt();
            if left <= DEPENDENT * length {
                continue;
            }
            for c in &mut column {
                *c *= root / left;
            }
            let place = made.of.len();
            made.columns.push(column);
            made.of.push(k);
            made.triangle.push([0.0; N]);
            for (row, taken) in made.triangle.iter_mut().zip(taken) {
                row[place] = taken;
            }
            made.triangle[place][place] = left / root;
        }
        made
    }

    /// The orthogonal columns row by row, 0 behind the last.
    fn rows(&self) -> Vec<[f64; N]> {
        let count = self.columns.first().map_or(0, Vec::len);
        let at = |i: usize| std::array::from_fn(|k| self.columns.get(k).map_or(0.0, |c| c[i]));
        (0..count).map(at).collect()
    }

    /// Coefficients of the orthogonal columns, and what they leave.
    fn least_squares(&self, values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut left = values.to_vec();
        let mut shares = vec![0.0; self.columns.len()];
        for _ in 0..2 {
            for (q, sum) in self.columns.iter().zip(&mut shares) {
                let share = dot(q, &left) / values.len() as f64;
                *sum += share;
                left.iter_mut().zip(q).for_each(|(e, q)| *e -= share * q);
            }
        }
        (shares, left)
    }

    /// From coefficients of the orthogonal columns to those of the columns.
    fn coefficients(&self, shares: &[f64]) -> [f64; N] {
        let mut all = [0.0; N];
        for place in (0..self.of.len()).rev() {
            let row = &self.triangle[place];
            let later: f64 = (place + 1..self.of.len()).map(|k| row[k] * all[self.of[k]]).sum();
            all[self.of[place]] = (shares[place] - later) / row[place];
        }
        all
    }
}

/// How far the exchange came.
struct Level {
    /// Change of the coefficients of the orthogonal columns.
    change: Vec<f64>,
    deviation: f64,
    bound: f64,
    reference: Vec<(usize, f64)>,
}

/// The exchange on what least squares leave.
struct Exchange<'a, const N: usize> {
    of: &'a MinimaxRows<N>,
    left: &'a [f64],
    outside: f64,
}

impl<const N: usize> Exchange<'_, N> {
    fn run(&self) -> Level {
        let columns = self.of.columns.of.len();
        let mut best = Level {
            change: vec![0.0; columns],
            deviation: self.largest(&vec![0.0; columns]).1,
            bound: 0.0,
            reference: Vec::new(),
        };
        let Some(mut reference) = self.start() else { return best };
        let first = self.square(&reference);
        for _ in 0..MOST_STEPS {
            let square = self.square(&reference);
            let inverse = PartialPivLu::new(square.as_ref()).inverse();
            // Level and coefficients: every row of the reference has the level as its residual, with its sign.
            let levelled = |k: usize| -> f64 {
                let of = reference.iter().enumerate();
                of.map(|(i, (row, sign))| inverse[(i, k)] * sign * self.left[*row]).sum()
            };
            let level = levelled(0);
            let change: Vec<f64> = (1..=columns).map(levelled).collect();
            let (farthest, deviation) = self.largest(&change);
            if !deviation.is_finite() || !level.is_finite() {
                break;
            }
            if deviation < best.deviation {
                best.deviation = deviation;
                best.change.clone_from(&change);
            }
            if level > best.bound || best.reference.is_empty() {
                best.bound = level;
                let weights = reference.iter().enumerate();
                best.reference =
                    weights.map(|(k, (row, sign))| (*row, sign * inverse[(k, 0)])).collect();
            }
            if deviation <= level + self.outside {
                break;
            }
            let sign = self.residual(farthest, &change).signum();
            let Some(leaves) = self.leaving(&inverse, &first, (farthest, sign)) else { break };
            reference[leaves] = (farthest, sign);
        }
        best
    }

    /// Which row of the reference leaves for another one.
    fn leaving(&self, inverse: &Mat<f64>, first: &Mat<f64>, enters: (usize, f64)) -> Option<usize> {
        let size = inverse.nrows();
        let column = self.column(enters);
        let taken = |k: usize| -> f64 { (0..size).map(|i| inverse[(k, i)] * column[i]).sum() };
        // The weight, then how it changes with infinitesimal changes of each of the first weights.
        let order = |k: usize| -> Vec<f64> {
            let by_first = |m: usize| (0..size).map(|i| inverse[(k, i)] * first[(i, m)]).sum();
            std::iter::once(inverse[(k, 0)].max(0.0)).chain((0..size).map(by_first)).collect()
        };
        let mut least: Option<(usize, Vec<f64>)> = None;
        for k in (0..size).filter(|k| taken(*k) > NOTHING) {
            let share = taken(k);
            let ratios: Vec<f64> = order(k).into_iter().map(|number| number / share).collect();
            if least.as_ref().is_none_or(|(_, before)| is_before(&ratios, before)) {
                least = Some((k, ratios));
            }
        }
        least.map(|(k, _)| k)
    }

    /// A reference: rows that are as independent as there are, and one more, with the signs of the weights that balance them.
    fn start(&self) -> Option<Vec<(usize, f64)>> {
        let (rows, chosen) = (&self.of.rows, &self.of.independent);
        let columns = chosen.len();
        if columns < self.of.columns.of.len() {
            return None;
        }
        let others = (0..rows.len()).filter(|row| !chosen.contains(row));
        let another = others
            .max_by(|a, b| self.left[*a].abs().total_cmp(&self.left[*b].abs()).then(b.cmp(a)))?;
        // sum_k w_k a_k = - a_another
        let square = Mat::from_fn(columns, columns, |i, k| rows[chosen[k]][i]);
        let inverse = PartialPivLu::new(square.as_ref()).inverse();
        let weight = |k: usize| -> f64 {
            -(0..columns).map(|i| inverse[(k, i)] * rows[another][i]).sum::<f64>()
        };
        let mut weights: Vec<(usize, f64)> =
            chosen.iter().enumerate().map(|(k, row)| (*row, weight(k))).collect();
        weights.push((another, 1.0));
        let level: f64 = weights.iter().map(|(row, weight)| weight * self.left[*row]).sum();
        let turned = if level < 0.0 { -1.0 } else { 1.0 };
        Some(weights.into_iter().map(|(row, weight)| (row, (weight * turned).signum())).collect())
    }

    /// The row of the largest residual and its magnitude; of equal ones the first.
    fn largest(&self, change: &[f64]) -> (usize, f64) {
        let mut largest = (0, 0.0);
        for row in 0..self.left.len() {
            let magnitude = self.residual(row, change).abs();
            if magnitude > largest.1 {
                largest = (row, magnitude);
            }
        }
        largest
    }

    fn residual(&self, row: usize, change: &[f64]) -> f64 {
        self.left[row] - self.of.rows[row].iter().zip(change).map(|(a, x)| a * x).sum::<f64>()
    }

    /// A row of the reference as a column of the dual: that the weights add up to 1, then that they balance.
    fn column(&self, (row, sign): (usize, f64)) -> Vec<f64> {
        let row = &self.of.rows[row][..self.of.columns.of.len()];
        std::iter::once(1.0).chain(row.iter().map(|a| sign * a)).collect()
    }

    fn square(&self, reference: &[(usize, f64)]) -> Mat<f64> {
        let columns: Vec<Vec<f64>> = reference.iter().map(|row| self.column(*row)).collect();
        Mat::from_fn(columns.len(), columns.len(), |i, k| columns[k][i])
    }
}

/// Whether one list comes before another in lexicographic order; what differs by rounding is equal.
fn is_before(one: &[f64], other: &[f64]) -> bool {
    let differ = one.iter().zip(other).find(|(a, b)| (*a - *b).abs() > NOTHING * (1.0 + a.abs()));
    differ.is_some_and(|(a, b)| a < b)
}
