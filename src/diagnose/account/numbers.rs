//! The numbers of a finding with their uncertainty.

use serde::Serialize;

use crate::model::{AMPLITUDE, Effect, Inner, ORDER, PHASE, RUN, Start, Variable};
use crate::residual::{Fitted, Owner, Residuals};

/// A number of a finding, as it is written.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Number {
    /// Its name with its unit, such as `amplitude_um`; of several amplitudes with its number.
    pub name: String,
    /// The same in words, without the unit: `amplitude 2`, `time constant`.
    #[serde(skip)]
    pub what: String,
    /// Its unit as it is read, such as `mm/min`; empty of a plain number.
    #[serde(skip)]
    pub unit: &'static str,
    /// Its value in that unit.
    pub value: f64,
    /// Its standard deviation in that unit; `None` where it is not estimated.
    pub sigma: Option<f64>,
}

/// The effects of an element and their numbers; `long_run_mm2` is what an amplitude of one gains by chance.
///
/// Where an operator's pause hides when the program began, the moment of a knock is as uncertain, and a drift
/// that seems to begin by `dt` earlier has its amplitude larger by `exp(dt / time constant)`: set-up errors take
/// what is constant. What runs tell of their beginnings is by how much they differ: an operator who always starts the log just before
/// the program makes all of them late alike.
///
/// Of an effect that differs from run to run, the amplitude is the root mean square over the runs, and it
/// has no phase.
pub(crate) fn told(
    residuals: &Residuals,
    fitted: &Fitted,
    element: usize,
    long_run_mm2: f64,
) -> (Vec<Effect>, Vec<Number>) {
    let Some(shape) = fitted.elements[element].shape() else { return (Vec::new(), Vec::new()) };
    let amplitudes = &fitted.amplitudes[element];
    let own = shape.amplitudes();
    let first = fitted.first_index(element);
    let covariance = |i: usize, k: usize| long_run_mm2 * fitted.inverse[(first + i, first + k)];
    let runs = amplitudes.len() / own;
    let mean_square = |part: usize| {
        let of_part = amplitudes.iter().skip(part).step_by(own);
        of_part.map(|a| a * a).sum::<f64>() / runs as f64
    };
    let each_run = fitted.elements[element].owner == Owner::EachRun;
    let effects = if each_run && own == 2 {
        let size = (mean_square(0) + mean_square(1)).sqrt();
        shape.effects(&[size, 0.0])
    } else {
        shape.effects(&amplitudes[..own])
    };
    let effects: Vec<Effect> = match fitted.elements[element].owner {
        Owner::One { repeat, run } => {
            let at = residuals.runs().position(|place| place == (repeat, run)).unwrap_or(0);
            let number = (at + 1) as f64;
            effects.into_iter().map(|effect| effect.with(RUN, number)).collect()
        }
        _ => effects,
    };
    let inner_sigma = fitted
        .inner_index(element)
        .map(|k| (long_run_mm2 * fitted.inverse[(k, k)]).sqrt())
        .and_then(|sigma| fitted.elements[element].inner_sigma(sigma));
    let began_s = began_sigma_s(residuals, fitted.elements[element].owner);
    let inner = shape.cause.inner(shape.seat).map(|(inner, _)| inner);
    let began_share = match (inner, shape.inner) {
        (Some(Inner { start: Start::TimeConstants(..), .. }), Some(constant_s)) => {
            began_s / constant_s
        }
        _ => 0.0,
    };
    let mut numbers = Vec::new();
    for (part, effect) in effects.iter().enumerate() {
        for ((written, value), key) in effect.written().into_iter().zip(effect.cause.keys) {
            let sigma = match (inner.filter(|inner| inner.key == key.name), key.name) {
                // It lies between two readings, whenever the program began.
                (Some(Inner { start: Start::Moments, .. }), _) => {
                    let of = shape.dependence().map(|of| of.variable);
                    (of == Some(Variable::Elapsed)).then_some(began_s)
                }
                (Some(_), _) => inner_sigma,
                (None, PHASE) if !each_run => {
                    let square = amplitudes[0].powi(2) + amplitudes[1].powi(2);
                    Some(wave(amplitudes, &covariance, true).sqrt() / square)
                }
                (None, PHASE | ORDER | RUN) => None,
                // A wave: sine and cosine.
                (None, _) if own == 2 => {
                    let size = amplitudes[0].hypot(amplitudes[1]);
                    let over_runs = (runs as f64).sqrt();
                    Some(wave(amplitudes, &covariance, false).sqrt() / size / over_runs)
                }
                (None, _) => {
                    Some(covariance(part, part).sqrt().hypot(began_share * amplitudes[part]))
                }
            };
            let several = effects.len() > 1;
            if (each_run && key.name == PHASE) || (several && key.name != AMPLITUDE) {
                continue;
            }
            let which = if several { format!(" {}", part + 1) } else { String::new() };
            let unit = key.unit(effect.seat);
            numbers.push(Number {
                name: written + &which,
                what: key.name.replace('_', " ") + &which,
                unit: unit.symbol,
                value,
                sigma: sigma.map(|sigma| sigma / unit.si),
            });
        }
    }
    (effects, numbers)
}

/// Standard deviation of when the programs of an effect's runs began, root mean square, s.
fn began_sigma_s(residuals: &Residuals, owner: Owner) -> f64 {
    let runs: Vec<f64> = match owner {
        Owner::One { repeat, run } => vec![residuals.repeats[repeat].runs[run].began_sigma_s],
        _ => residuals
            .repeats
            .iter()
            .flat_map(|repeat| &repeat.runs)
            .map(|run| run.began_sigma_s)
            .collect(),
    };
    (runs.iter().map(|sigma_s| sigma_s * sigma_s).sum::<f64>() / runs.len().max(1) as f64).sqrt()
}

/// Variance of `s ds + c dc`, or of `s dc - c ds`.
fn wave(amplitudes: &[f64], covariance: &dyn Fn(usize, usize) -> f64, across: bool) -> f64 {
    let (s, c) = (amplitudes[0], amplitudes[1]);
    let (along_s, along_c) = if across { (-c, s) } else { (s, c) };
    let variance = along_s * along_s * covariance(0, 0)
        + along_c * along_c * covariance(1, 1)
        + 2.0 * along_s * along_c * covariance(0, 1);
    variance.max(0.0)
}
