//! What models cost that are held against each other.

use crate::residual::Beside;

/// What is left of readings, and what the numbers of effects cost (Schwarz 1978): `S + k v ln n` with `n = S / v` that are
/// independent.
pub(crate) struct Price {
    samples: f64,
    long_run_mm2: f64,
    of_a_number_mm2: f64,
}

impl Price {
    /// Beside the effects of one model: of as many readings, however many take part in another.
    pub(crate) fn of(beside: &Beside) -> Self {
        let long_run_mm2 = beside.noise().long_run_mm2;
        let pieces = (beside.left_mm2() / long_run_mm2).max(1.0);
        let samples = beside.residuals.samples() as f64;
        Self { samples, long_run_mm2, of_a_number_mm2: long_run_mm2 * pieces.ln() }
    }

    /// What a model with so many numbers costs with each at its price.
    pub(crate) fn of_mm2(&self, left_mm: f64, numbers: usize) -> f64 {
        self.with_numbers_mm2(left_mm, numbers, self.of_a_number_mm2)
    }

    /// What it costs where chance gives each number what it gains.
    pub(crate) fn by_chance_mm2(&self, left_mm: f64, numbers: usize) -> f64 {
        self.with_numbers_mm2(left_mm, numbers, self.long_run_mm2)
    }

    fn with_numbers_mm2(&self, left_mm: f64, numbers: usize, of_a_number_mm2: f64) -> f64 {
        self.samples * left_mm.powi(2) + numbers as f64 * of_a_number_mm2
    }
}
