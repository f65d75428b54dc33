//! The gain, measured on whole runs that took no part in the fit of the effects.
//!
//! For each repeat the effects are fitted to all others, numbers inside and amplitudes. In the repeat they
//! are held; only the model's own parameters and the times are fitted to it, as they always are. What is
//! each run's own (the phase of a vibration, a knock) nothing else can foretell: there the amplitude is
//! the repeat's own.

use rayon::prelude::*;
use serde::Serialize;

use crate::diagnose::thresholds::NOTHING;
use crate::residual::{self, Beside, Column, Fitted, Owner, Residuals, Structure};
use crate::solve::dot;
use crate::written::um;

/// Standard deviations on either side of a 95 % interval of a normal variable.
const NORMAL_95: f64 = 1.96;

/// Root mean squares of one run that took no part in the fit of the effects.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunGain {
    /// Name of the run.
    pub run: String,
    /// Samples.
    pub samples: usize,
    /// Without the effects, mm.
    #[serde(rename = "before_um", serialize_with = "um")]
    pub before_mm: f64,
    /// With the effects as the other repeats have them, mm.
    #[serde(rename = "after_um", serialize_with = "um")]
    pub after_mm: f64,
    /// What does not repeat from run to run, mm; what all effects together leave where nothing repeats.
    #[serde(rename = "floor_um", serialize_with = "um")]
    pub floor_mm: f64,
    /// `(before² - after²) / (before² - floor²)`; `None` where nothing was there to explain.
    pub explained: Option<f64>,
}

/// The effects as runs of the other programs have them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProgramGain {
    /// Runs that took no part: all of one program.
    pub runs: Vec<String>,
    /// The largest feed in their arcs, mm/min.
    pub feed_mm_min: f64,
    /// Without the effects, mm.
    #[serde(rename = "before_um", serialize_with = "um")]
    pub before_mm: f64,
    /// With the effects as the runs of all other programs have them, mm.
    #[serde(rename = "after_um", serialize_with = "um")]
    pub after_mm: f64,
}

/// The gain on one arc of one run, over all its samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ArcGain {
    /// Sum of squares before less that after, mm².
    gained_mm2: f64,
    /// Sum of squares before less what does not repeat, mm².
    there_mm2: f64,
}

/// Share of what was there that is explained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Explained {
    pub(crate) share: f64,
    /// Its 95 % interval; `None` of a single arc, which cannot be left out.
    pub(crate) interval: Option<[f64; 2]>,
}

/// What the effects leave in the repeats that are `out`: they took no part. Nothing of the others; `None`
/// where the effects cannot be fitted to the others.
fn left_out(alone: &Beside, all: &Fitted, out: &[bool]) -> Option<Column> {
    let residuals = alone.residuals;
    let within: Vec<bool> = out.iter().map(|out| !out).collect();
    let fitted = residual::fit_to(alone, all.elements.clone(), &within)?;
    let mut effect = residuals.zeros();
    for (index, element) in fitted.elements.iter().enumerate() {
        let foretold = element.owner == Owner::All;
        let amplitudes = if foretold { &fitted.amplitudes[index] } else { &all.amplitudes[index] };
        let element = if foretold { element } else { &all.elements[index] };
        for (amplitude, column) in amplitudes.iter().zip(element.columns(residuals)) {
            effect.add(*amplitude, &column);
        }
    }
    for (of_repeat, out) in effect.iter_mut().zip(out) {
        if !out {
            of_repeat.clear();
        }
    }
    let effect = residuals.outside(&effect);
    let pairs = residuals.model_mm.iter().zip(effect.iter());
    Some(pairs.map(|(e, c)| e.iter().zip(c).map(|(e, c)| e - c).collect()).collect())
}

/// The gain on every run, and on every arc; `fitted_mm` is what all effects together leave.
pub(crate) fn by_run(
    alone: &Beside,
    fitted_mm: &Column,
    all: Option<&Fitted>,
) -> (Vec<RunGain>, Vec<ArcGain>) {
    let residuals = alone.residuals;
    let repeats = residuals.repeats.len();
    let after: Vec<Vec<f64>> = (0..repeats)
        .into_par_iter()
        .map(|index| {
            let out: Vec<bool> = (0..repeats).map(|k| k == index).collect();
            let left = all.filter(|_| repeats > 1).and_then(|all| left_out(alone, all, &out));
            // With one repeat there is nothing to foretell from: what the fit itself leaves.
            left.map_or_else(|| fitted_mm[index].clone(), |left| left[index].clone())
        })
        .collect();
    let own = all.is_some_and(|all| all.elements.iter().any(|e| e.owner != Owner::All));
    let shared = shared(residuals);
    let before = &residuals.model_mm;
    let mut gains = Vec::new();
    let mut arcs = vec![ArcGain::default(); residuals.arcs];
    for (index, repeat) in residuals.repeats.iter().enumerate() {
        for run in &repeat.runs {
            let range = run.samples.clone();
            let samples = range.len().max(1) as f64;
            let mean =
                |values: &[f64]| dot(&values[range.clone()], &values[range.clone()]) / samples;
            let was = mean(&before[index]);
            let is = mean(&after[index]);
            let left = mean(&fitted_mm[index]);
            let floor = match shared[run.program] {
                // What is finer than the readings repeats, but not at the same readings.
                Some(structure) if !own => left.min(was - structure.variance_mm2.max(0.0)),
                _ => left,
            };
            let there = was - floor;
            for k in range.clone() {
                let arc = &mut arcs[repeat.samples[k].arc];
                let (b, a) = (before[index][k].powi(2), after[index][k].powi(2));
                arc.gained_mm2 = arc.gained_mm2 + b - a;
                arc.there_mm2 = arc.there_mm2 + b - floor;
            }
            gains.push(RunGain {
                run: run.name.clone(),
                samples: range.len(),
                before_mm: was.sqrt(),
                after_mm: is.sqrt(),
                floor_mm: floor.max(0.0).sqrt(),
                explained: (there > NOTHING * was).then(|| (was - is) / there),
            });
        }
    }
    (gains, arcs)
}

/// What the runs of each program share of what the model leaves.
fn shared(residuals: &Residuals) -> Vec<Option<Structure>> {
    let of_runs = residuals.repeats.iter().flat_map(|repeat| &repeat.runs);
    let programs = of_runs.map(|run| run.program + 1).max().unwrap_or(0);
    let of = |program| residual::structure(residuals, &residuals.model_mm, |p| p == program);
    (0..programs).into_par_iter().map(of).collect()
}

/// Share of what was there that is explained, over all arcs, with its 95 % interval by leaving out one arc
/// after the other (jackknife).
pub(crate) fn explained(arcs: &[ArcGain]) -> Option<Explained> {
    let gain: f64 = arcs.iter().map(|arc| arc.gained_mm2).sum();
    let there: f64 = arcs.iter().map(|arc| arc.there_mm2).sum();
    if there <= 0.0 || gain <= 0.0 {
        return None;
    }
    let share = gain / there;
    let interval = (arcs.len() > 1).then(|| {
        let count = arcs.len() as f64;
        let without = arcs.iter().map(|arc| (gain - arc.gained_mm2) / (there - arc.there_mm2));
        let squares: f64 = without.map(|w| (w - share).powi(2)).sum();
        let aside = NORMAL_95 * ((count - 1.0) / count * squares).sqrt();
        [share - aside, share + aside]
    });
    // Where all that was there is on one arc, the others say nothing of the share.
    let finite = |interval: &[f64; 2]| interval.iter().all(|end| end.is_finite());
    Some(Explained { share, interval: interval.filter(finite) })
}

/// The gain on the runs of each program, from those of all others.
pub(crate) fn by_program(alone: &Beside, all: &Fitted) -> Vec<ProgramGain> {
    let residuals = alone.residuals;
    let driven: Vec<Vec<usize>> = residuals
        .repeats
        .iter()
        .map(|repeat| repeat.runs.iter().map(|run| run.program).collect())
        .collect();
    let mut programs = driven.clone();
    programs.sort();
    programs.dedup();
    if programs.len() < 2 {
        return Vec::new();
    }
    let gains = programs.iter().map(|program| {
        let out: Vec<bool> = driven.iter().map(|of_repeat| of_repeat == program).collect();
        let left = left_out(alone, all, &out)?;
        let (mut before, mut after, mut samples) = (0.0, 0.0, 0.0_f64);
        let mut runs = Vec::new();
        let mut fastest = 0.0_f64;
        for (index, repeat) in residuals.repeats.iter().enumerate().filter(|(k, _)| out[*k]) {
            let (was, is) = (&residuals.model_mm[index], &left[index]);
            before += dot(was, was);
            after += dot(is, is);
            samples += is.len() as f64;
            runs.extend(repeat.runs.iter().map(|run| run.name.clone()));
            let speeds = repeat.samples.iter().map(|s| s.situation.motion.velocity_mm_s.norm());
            fastest = speeds.fold(fastest, f64::max);
        }
        Some(ProgramGain {
            runs,
            feed_mm_min: (60.0 * fastest).round(),
            before_mm: (before / samples.max(1.0)).sqrt(),
            after_mm: (after / samples.max(1.0)).sqrt(),
        })
    });
    gains.flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arcs(gains: &[(f64, f64)]) -> Vec<ArcGain> {
        gains.iter().map(|&(gained_mm2, there_mm2)| ArcGain { gained_mm2, there_mm2 }).collect()
    }

    #[test]
    fn the_interval_is_the_scatter_of_the_arcs() {
        // Every arc explained to 90 %: nothing scatters.
        let all = explained(&arcs(&[(0.9, 1.0), (1.8, 2.0), (2.7, 3.0)]));
        let [low, high] = all.and_then(|all| all.interval).unwrap_or_default();
        assert!((low - 0.9).abs() < 1e-12 && (high - 0.9).abs() < 1e-12, "{low} {high}");
        // Equal arcs: the jackknife is the standard error of their mean.
        let all = explained(&arcs(&[(0.8, 1.0), (1.0, 1.0), (0.9, 1.0), (0.7, 1.0)]));
        let [low, high] = all.and_then(|all| all.interval).unwrap_or_default();
        let sigma = (0.05_f64 / 3.0 / 4.0).sqrt();
        assert!((low - (0.85 - 1.96 * sigma)).abs() < 1e-12, "{low}");
        assert!((high - (0.85 + 1.96 * sigma)).abs() < 1e-12, "{high}");
    }

    #[test]
    fn a_single_arc_has_a_share_and_no_interval() {
        let one = explained(&arcs(&[(0.9, 1.0)]));
        assert_eq!(one, Some(Explained { share: 0.9, interval: None }));
        // All that was there on one of two arcs.
        let one = explained(&arcs(&[(0.9, 1.0), (0.0, 0.0)]));
        assert_eq!(one, Some(Explained { share: 0.9, interval: None }));
        assert_eq!(explained(&[]), None);
    }
}
