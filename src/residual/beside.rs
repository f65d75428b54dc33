//! What is left beside effects that are taken for accepted.

use std::sync::OnceLock;

use super::column::Column;
use super::noise::Noise;
use super::residuals::Residuals;

/// A column of which less than this share of its square is left adds nothing but rounding.
const NOTHING_LEFT: f64 = 1e-7;

/// Residuals beside accepted effects. With `M = 1 - Q Q^T` for what the fits leave of a column and `x_k` combinations of the effects'
/// columns with `x_i · M x_k = 1` where `i = k` and 0 elsewhere,
///
/// ```text
/// u_k = M x_k,     c'' = M c - sum_k u_k (u_k · c),     e' = e - sum_k u_k (x_k · e)
/// ```
///
/// Where the fits hold a number to what is plausible of it, `M M` is not `M`: a square is always `c · M c`, by which the sum of
/// squares and of what is plausible falls, never `|M c|²`.
#[derive(Debug)]
pub struct Beside<'a> {
    /// The residuals.
    pub residuals: &'a Residuals,
    /// `u_k` of the accepted effects.
    pub span: Vec<Column>,
    /// What is left, mm, times the root of the weight.
    pub left_mm: Column,
    noise: OnceLock<Noise>,
}

impl Residuals {
    /// What is left beside effects with these columns.
    pub fn beside(&self, columns: &[Column]) -> Beside<'_> {
        let (span, left_mm) = (Vec::new(), self.model_mm.clone());
        let mut beside = Beside { residuals: self, span, left_mm, noise: OnceLock::new() };
        for column in columns {
            beside.accept(column);
        }
        beside
    }

    /// What the model alone leaves.
    pub fn alone(&self) -> Beside<'_> {
        self.beside(&[])
    }
}

impl Beside<'_> {
    /// The noise of what is left.
    pub fn noise(&self) -> &Noise {
        self.noise.get_or_init(|| Noise::of(self.residuals, &self.left_mm))
    }

    /// Sum of squares of what is left, mm².
    pub fn left_mm2(&self) -> f64 {
        self.left_mm.square()
    }

    /// A column outside of what the fits follow and of the accepted effects, `c''`.
    pub fn outside(&self, column: &Column) -> Column {
        let mut rest = self.residuals.outside(column);
        for unit in &self.span {
            rest.add(-unit.product(column), unit);
        }
        rest
    }

    /// Accepts a column, unless next to nothing of it is new.
    fn accept(&mut self, column: &Column) {
        let rest = self.outside(column);
        let square = column.product(&rest);
        if square > NOTHING_LEFT * column.square() {
            // What was accepted before is in none of what is left, so `x · e` is that of the column itself.
            let along = column.product(&self.left_mm) / square;
            self.left_mm.add(-along, &rest);
            self.span.push(rest.times(square.sqrt().recip()));
        }
    }
}
