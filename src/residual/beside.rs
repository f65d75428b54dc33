//! What is left beside effects that are taken for accepted.

use std::sync::OnceLock;

use super::column::Column;
use super::noise::Noise;
use super::residuals::Residuals;

/// A column of which less than this share of its square is left adds nothing but rounding.
const NOTHING_LEFT: f64 = 1e-7;

/// Residuals beside accepted effects: with `X` their columns outside of what the fits follow, made
/// orthonormal, `e' = e - X X^T e`.
#[derive(Debug)]
pub struct Beside<'a> {
    /// The residuals.
    pub residuals: &'a Residuals,
    /// Orthonormal columns of the accepted effects, outside of what the fits follow.
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
            beside.span.extend(beside.unit(column));
        }
        for unit in &beside.span {
            let along = unit.product(&beside.left_mm);
            beside.left_mm.add(-along, unit);
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

    /// A column outside of what the fits follow, without its part in the accepted effects.
    pub fn outside(&self, outside_of_fits: Column) -> Column {
        let mut rest = outside_of_fits;
        for unit in &self.span {
            let along = unit.product(&rest);
            rest.add(-along, unit);
        }
        rest
    }

    /// The direction that a column adds to what is accepted; `None` where next to nothing is new.
    fn unit(&self, column: &Column) -> Option<Column> {
        // Twice: once leaves the rounding of the first time.
        let rest = self.outside(self.outside(self.residuals.outside(column)));
        let square = rest.square();
        (square > NOTHING_LEFT * column.square()).then(|| rest.times(square.sqrt().recip()))
    }
}
