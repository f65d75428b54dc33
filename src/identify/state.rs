//! Where a fit stands.

use super::input::RunInput;
use super::record::Apart;

/// Where a fit stands.
#[derive(Debug, Clone)]
pub(super) struct State {
    /// The parameters of the model, in their units.
    pub(super) values: Vec<f64>,
    /// Standard deviation of a reading, mm.
    pub(super) sigma_mm: f64,
    /// Why each sample of each run takes no part; `None` where it does.
    pub(super) apart: Vec<Vec<Option<Apart>>>,
    /// Robust weights, one for each sample of each run; `None` for all 1.
    pub(super) weights: Option<Vec<Vec<f64>>>,
}

/// Why each sample of each run takes no part; `guard_s` is kept from every reversal at the least.
pub(super) fn apart(runs: &[RunInput], guard_s: f64) -> Vec<Vec<Option<Apart>>> {
    let of_run = |run: &RunInput| {
        let reversals_s = run.alignment.trajectory.reversals_s();
        run.samples().iter().map(|sample| Apart::of(sample, &reversals_s, guard_s)).collect()
    };
    runs.iter().map(of_run).collect()
}
