//! What the script of the report knows of the curves: angles, readings, effects, thinned, as compact JSON.

use nalgebra::Vector3;
use serde::Serialize;

use super::facts::Analysis;
use super::shown::Shown;
use super::traces::{OnCircle, Trace};
use crate::diagnose::EffectsAt;
use crate::error::{Error, Kind, Result};
use crate::report::draw::svg::thinned;

/// So many points of all curves, and of one at the most and at the least: the report stays small enough for a mail.
const POINTS: usize = 60_000;
const OF_A_CURVE: [usize; 2] = [40, 500];
/// Angles are told to a hundredth of a degree, deviations to a hundredth of a micrometre, directions to 1e-6.
const STEPS: f64 = 100.0;
const DIRECTION_STEPS: f64 = 1e6;

/// All of it.
#[derive(Serialize)]
struct Live<'a> {
    /// Names of the runs, in the order in which they are met.
    runs: Vec<&'a str>,
    /// The causes that were named: what they are, and what each leaves of the residual, um rms.
    causes: Vec<(&'a str, f64)>,
    /// What is left with all of them, um rms.
    left: f64,
    circles: Vec<Round<'a>>,
}

#[derive(Serialize)]
struct Round<'a> {
    name: &'a str,
    /// Centre, mm; directions of 0 and 90 degrees, times [`DIRECTION_STEPS`]; radius, mm.
    c: [f64; 3],
    u: [f64; 3],
    v: [f64; 3],
    r: f64,
    /// Whether it is a whole circle.
    w: bool,
    /// Curves without a gap.
    t: Vec<Curve>,
}

/// A curve; numbers are in [`STEPS`], each the difference to the one before it.
#[derive(Serialize)]
struct Curve {
    /// Number of its run.
    n: usize,
    /// Forward.
    f: bool,
    /// Of the first repeat.
    b: bool,
    /// Angles, degrees.
    a: Vec<i64>,
    /// Measured, um.
    m: Vec<i64>,
    /// Predicted, um.
    p: Vec<i64>,
    /// What each cause does, um.
    e: Vec<Vec<i64>>,
}

/// The data, as the text of a script element.
pub(super) fn json(analysis: &Analysis, shown: Shown, circles: &[OnCircle]) -> Result<String> {
    let traces = || circles.iter().flat_map(|circle| &circle.traces);
    let curves = traces().map(|trace| trace.breaks.len() + 1).sum::<usize>().max(1);
    let most = (POINTS / curves).clamp(OF_A_CURVE[0], OF_A_CURVE[1]);
    let mut runs: Vec<&str> = Vec::new();
    for trace in traces() {
        if !runs.contains(&trace.run_name.as_str()) {
            runs.push(&trace.run_name);
        }
    }
    let findings = || analysis.diagnosis.iter().flat_map(|of| &of.findings);
    let named: Vec<usize> =
        findings().enumerate().filter(|(_, of)| of.named).map(|(k, _)| k).collect();
    let causes = findings().filter(|of| of.named);
    let live = Live {
        causes: causes.map(|of| (of.title.as_str(), rounded(of.rms_mm * 1e3))).collect(),
        left: rounded(analysis.residual_rms_um().0),
        circles: circles
            .iter()
            .map(|circle| {
                let [u, v] = circle.circle.directions();
                let centre = analysis.test.mountings.get(circle.mounting);
                let curves = circle.traces.iter().flat_map(|trace| {
                    let effects = shown.effects.get(trace.repeat).map_or(&[][..], Vec::as_slice);
                    let n = runs.iter().position(|run| *run == trace.run_name).unwrap_or(0);
                    curves_of(trace, n, effects, &named, most)
                });
                Round {
                    name: &circle.name,
                    c: centre.map_or([0.0; 3], |of| of.coincidence_mm.map(rounded)),
                    u: direction(&u),
                    v: direction(&v),
                    r: circle.nominal_mm,
                    w: circle.whole(),
                    t: curves.collect(),
                }
            })
            .collect(),
        runs,
    };
    let text = serde_json::to_string(&live).map_err(|error| {
        Error::new(Kind::Output, format!("the curves of the report cannot be written: {error}"))
    })?;
    // No name can end the element that it stands in.
    Ok(text.replace('<', "\\u003c"))
}

fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3 + 0.0
}

fn direction(of: &Vector3<f64>) -> [f64; 3] {
    (*of).map(|c| (c * DIRECTION_STEPS).round() + 0.0).into()
}

fn curves_of(
    trace: &Trace,
    n: usize,
    effects: &[EffectsAt],
    named: &[usize],
    most: usize,
) -> Vec<Curve> {
    let first = effects.partition_point(|of| of.run < trace.run);
    let of_run = &effects[first..effects.partition_point(|of| of.run <= trace.run)];
    let ends = trace.breaks.iter().copied().chain([trace.angle_rad.len()]);
    let starts = [0].into_iter().chain(trace.breaks.iter().copied());
    let pieces = starts.zip(ends).filter(|(from, to)| to > from);
    pieces
        .map(|(from, to)| {
            let kept = thinned(&(from..to).collect::<Vec<_>>(), most);
            let of = |values: &[f64]| steps(kept.iter().map(|k| values[*k]));
            let effect = |cause: &usize| {
                steps(kept.iter().map(|k| 1e3 * nearest(of_run, trace.log_s[*k], *cause)))
            };
            Curve {
                n,
                f: trace.forward,
                b: trace.repeat == 0,
                a: steps(kept.iter().map(|k| trace.angle_rad[*k].to_degrees())),
                m: of(&trace.measured_um),
                p: of(&trace.predicted_um),
                e: if of_run.is_empty() { Vec::new() } else { named.iter().map(effect).collect() },
            }
        })
        .collect()
}

/// What a finding does to the reading that is nearest in time, mm: readings that no fit used have no number of their own.
fn nearest(of_run: &[EffectsAt], log_s: f64, finding: usize) -> f64 {
    let after = of_run.partition_point(|of| of.log_s < log_s);
    let around = [after.checked_sub(1), Some(after)].into_iter().flatten();
    let around = around.filter_map(|k| of_run.get(k));
    let far = |of: &&EffectsAt| (of.log_s - log_s).abs();
    let near = around.min_by(|a, b| far(a).total_cmp(&far(b)));
    near.and_then(|of| of.findings_mm.get(finding)).copied().unwrap_or(0.0)
}

/// Numbers in steps, each as the difference to the one before it.
fn steps(values: impl Iterator<Item = f64>) -> Vec<i64> {
    let mut before = 0;
    let step = |value: f64| {
        let now = (value * STEPS).round() as i64;
        now - std::mem::replace(&mut before, now)
    };
    values.map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_add_up_to_the_values() {
        let values = [1.234, -0.5, 359.99, 360.01];
        let told = steps(values.into_iter());
        let mut sum = 0;
        for (step, value) in told.iter().zip(values) {
            sum += step;
            assert!((sum as f64 / STEPS - value).abs() < 0.5001 / STEPS, "{told:?}");
        }
    }

    #[test]
    fn an_effect_is_that_of_the_nearest_reading() {
        let at = |log_s: f64, mm: f64| EffectsAt { run: 0, log_s, findings_mm: vec![0.0, mm] };
        let all = [at(1.0, 0.1), at(2.0, 0.2), at(4.0, 0.4)];
        for (log_s, mm) in [(0.0, 0.1), (1.4, 0.1), (1.6, 0.2), (3.1, 0.4), (9.0, 0.4)] {
            assert!((nearest(&all, log_s, 1) - mm).abs() < 1e-12, "{log_s}");
        }
        assert!(nearest(&[], 1.0, 1).abs() < 1e-12);
    }
}
