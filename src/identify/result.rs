//! What an identification says.

use super::input::RunInput;
use super::residuals::Record;
use crate::model::Parameter;
use crate::solve::{Matrix, NoiseModel, NullDirection};

/// One estimated parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Name and unit.
    pub parameter: Parameter,
    /// The value, in its unit.
    pub value: f64,
    /// Standard deviation, in its unit.
    pub sigma: f64,
    /// How much of it the data determine: 1 all, 0 nothing, between: only together with others.
    pub observed: f64,
}

/// What came out.
#[derive(Debug)]
pub struct Identification {
    /// The parameters of the model, in its order.
    pub estimates: Vec<Estimate>,
    /// Correlation of the estimates.
    pub correlation: Matrix,
    /// Rank over the coefficients, by the noise.
    pub rank: usize,
    /// Condition number of the scaled columns over the observed directions.
    pub condition: f64,
    /// What is confounded, by index of parameter.
    pub null_directions: Vec<NullDirection>,
    /// The noise.
    pub noise: NoiseModel,
    /// The runs, their time maps refined.
    pub runs: Vec<RunInput>,
    /// One record for each sample of each run, in order.
    pub records: Vec<Vec<Record>>,
    /// Root mean square of the residuals of the samples that were used, mm.
    pub rms_mm: f64,
    /// Samples that were used.
    pub used: usize,
    /// Gauss-Newton steps.
    pub steps: usize,
    /// What speaks against the result, in sentences.
    pub cautions: Vec<String>,
}

impl Identification {
    /// The estimated values in the order of the model.
    pub fn values(&self) -> Vec<f64> {
        self.estimates.iter().map(|estimate| estimate.value).collect()
    }

    /// The estimate of a name.
    pub fn estimate(&self, name: &str) -> Option<&Estimate> {
        self.estimates.iter().find(|estimate| estimate.parameter.name == name)
    }
}
