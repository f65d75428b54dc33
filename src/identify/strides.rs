//! How far the steps of a fit go.

/// How much of its step each parameter takes.
///
/// A time that steps over a vertex of the path comes back with the next step, and so for ever: every time its step
/// turns round it takes half of it, and in the same direction more again.
pub(super) struct Strides {
    coefficients: usize,
    shares: Vec<f64>,
    before: Vec<f64>,
}

impl Strides {
    pub(super) fn new(coefficients: usize, total: usize) -> Self {
        Self { coefficients, shares: vec![1.0; total], before: vec![0.0; total] }
    }

    /// What is taken of a step.
    pub(super) fn taken(&mut self, step: &[f64]) -> Vec<f64> {
        let times = self.shares.iter_mut().zip(step).zip(&self.before).skip(self.coefficients);
        for ((share, step), before) in times {
            *share = if step * before < 0.0 { 0.5 * *share } else { (1.5 * *share).min(1.0) };
        }
        self.before = step.to_vec();
        step.iter().zip(&self.shares).map(|(step, share)| step * share).collect()
    }
}
