//! The numbers of a finding with their uncertainty.

use super::element::Owner;
use super::joint::Fitted;
use super::result::Number;
use crate::model::{AMPLITUDE, Effect, Shape};

/// The effects of an element and their numbers; `long_run_mm2` is what an amplitude of one gains by chance.
///
/// Of an effect that differs from run to run, the amplitude is the root mean square over the runs, and it
/// has no phase.
pub(super) fn told(
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
    let inner_sigma = fitted
        .inner_index(element)
        .map(|k| (long_run_mm2 * fitted.inverse[(k, k)]).sqrt())
        .and_then(|sigma| fitted.elements[element].inner_sigma(sigma));
    let mut numbers = Vec::new();
    for (part, effect) in effects.iter().enumerate() {
        for ((name, value), key) in effect.written().into_iter().zip(effect.cause.keys) {
            let si = if key.name == AMPLITUDE { effect.seat.amplitude_unit().1 } else { key.si };
            let sigma = if Some(key.name) == Shape::inner_key(shape.cause, shape.seat) {
                inner_sigma
            } else {
                match (key.name, own) {
                    // A wave: sine and cosine.
                    ("phase_rad", 2) if !each_run => {
                        let square = amplitudes[0].powi(2) + amplitudes[1].powi(2);
                        Some(wave(amplitudes, &covariance, true).sqrt() / square)
                    }
                    ("order" | "run" | "phase_rad", _) => None,
                    (_, 2) => {
                        let size = amplitudes[0].hypot(amplitudes[1]);
                        let over_runs = (runs as f64).sqrt();
                        Some(wave(amplitudes, &covariance, false).sqrt() / size / over_runs)
                    }
                    _ => Some(covariance(part, part).sqrt()),
                }
            };
            if each_run && key.name == "phase_rad" {
                continue;
            }
            let several = effects.len() > 1;
            let name = if several { format!("{name} {}", part + 1) } else { name };
            if several && key.name != AMPLITUDE {
                continue;
            }
            numbers.push(Number { name, value, sigma: sigma.map(|sigma| sigma / si) });
        }
    }
    (effects, numbers)
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
