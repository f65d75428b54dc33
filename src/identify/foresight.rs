//! What a test will know of what people ask, before it is run.

use super::asked::{Answer, Known, answers};
use super::input::{Options, RunInput};
use super::place;
use super::prediction::rehearsed_fit;
use crate::error::Result;
use crate::machine::Machine;
use crate::model::{LOCAL, Model};
use crate::plan::Test;
use crate::solve::NoiseModel;

/// What rehearsed runs of a test will know of a machine without errors, at the place of the test: values of zero with
/// both uncertainties, and the faults that would look the same.
///
/// # Errors
/// When a run gives no sample on an arc.
pub fn foresee(
    test: &Test,
    machine: &Machine,
    runs: Vec<RunInput>,
    options: &Options,
    noise: &NoiseModel,
) -> Result<Vec<Answer>> {
    let Some(frame) = place::of(test, machine, runs.iter()) else { return Ok(Vec::new()) };
    let names: Vec<String> = test.mountings().iter().map(|m| m.name.clone()).collect();
    let mountings = test.mountings().iter().map(|m| m.mounting).collect();
    let terms = place::terms(&[LOCAL.to_owned()], Some(&frame), machine, &names)?;
    let model = Model::new(machine, mountings, terms);
    let mut fit = rehearsed_fit(&model, runs, options, noise)?;
    fit.state.correlated = (noise.long_run_variance().sqrt() / noise.sigma()).max(1.0);
    let solution = fit.consider_lags()?;
    let covariance = solution.covariance_sandwich(&fit.filtered(noise)?)?.shared;
    let left_open = fit.known(&solution).left_open;
    let values = vec![0.0; fit.columns.coefficients];
    let left_open = left_open.as_ref();
    let known = Known {
        values: &values,
        covariance: &covariance,
        left_open,
        unexplained: 0,
        effects: None,
    };
    Ok(answers(&model, &frame, &known))
}
