//! The set `complete`: which terms a test can tell apart through its noise.

use super::input::{Options, RunInput};
use super::prediction::rehearsed_fit;
use super::preference::preference;
use crate::error::Result;
use crate::machine::{Machine, Mounting};
use crate::model::{self, COMPLETE, Coefficient, Model, SetUp};
use crate::solve::NoiseModel;

/// The order in which single terms are considered: those that `terms` names beside `complete` first,
/// without those that it leaves out by `-NAME`.
///
/// # Errors
/// A name beside `complete` that is a set's.
pub fn order_of(terms: &[String]) -> Result<Vec<String>> {
    let (out, named): (Vec<&String>, Vec<&String>) =
        terms.iter().filter(|name| *name != COMPLETE).partition(|name| name.starts_with('-'));
    let first: Vec<String> = named.into_iter().cloned().collect();
    let mut order = preference(&first)?;
    order.retain(|name| !out.iter().any(|out| out.strip_prefix('-') == Some(name)));
    Ok(order)
}

/// The terms that a list asks for, `complete` made explicit by what these runs, rehearsed or measured,
/// see through the stated noise. The runs are given back as they were.
///
/// A direction counts as seen as it does in the fit: see [`SEEN_UM`](super::SEEN_UM).
pub fn explicit_terms(
    terms: &[String],
    machine: &Machine,
    mountings: &[(String, Mounting)],
    runs: Vec<RunInput>,
    options: &Options,
) -> Result<(Vec<String>, Vec<RunInput>)> {
    if !terms.iter().any(|name| name == COMPLETE) {
        return Ok((terms.to_vec(), runs));
    }
    let (effects, terms): (Vec<String>, Vec<String>) =
        terms.iter().cloned().partition(|name| name.contains(':'));
    let order = order_of(&terms)?;
    let names: Vec<String> = mountings.iter().map(|(name, _)| name.clone()).collect();
    let balls = mountings.iter().map(|(_, mounting)| *mounting).collect();
    let model = Model::new(machine, balls, model::terms(&order, &names)?);
    let fit = rehearsed_fit(&model, runs, options, &NoiseModel::white(options.noise_mm))?;
    let rows = fit.rows()?;
    let parameters = model.parameters();
    let mut columns = Vec::new();
    for name in &order {
        columns.extend((0..parameters.len()).filter(|&k| parameters[k].bare_name() == *name));
    }
    let choice = rows.choose(&columns, &fit.references(&rows), fit.truncation(rows.rows()))?;
    let kept = choice.kept.iter().map(|&k| parameters[k].name.clone());
    let kept = kept.chain(effects).collect();
    Ok((kept, fit.runs))
}

/// How many of these names are coefficients, and how many set-up errors.
pub fn count(names: &[String]) -> (usize, usize) {
    let set_up = |name: &&String| name.split('@').next().is_some_and(|n| SetUp::parse(n).is_some());
    let coefficient = |name: &&String| Coefficient::parse(name).is_some();
    (names.iter().filter(coefficient).count(), names.iter().filter(set_up).count())
}
