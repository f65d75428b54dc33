//! The gain, measured on whole runs that took no part in the fit of the effects.
//!
//! For each repeat the effects are fitted to all others, numbers inside and amplitudes. In the repeat they
//! are held; only the model's own parameters and the times are fitted to it, as they always are. What is
//! each run's own (the phase of a vibration, a knock) nothing else can foretell, nor what the others see no more
//! of than noise (a step at a moment that they do not reach), nor a curve over values that they do not drive (velocities of
//! another feed): there the amplitudes are the repeat's own.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;
use serde::{Serialize, Serializer};

use super::foretold::{LeftOut, left_out};
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
    /// Whether the other repeats have all that the curves among them are over; where not, `after` is with what the run itself
    /// has of them.
    pub foretold: bool,
    /// What does not repeat from run to run, mm; `None` where no other run drove its program, or where an effect is each
    /// run's own.
    #[serde(rename = "floor_um", serialize_with = "um_if_any")]
    pub floor_mm: Option<f64>,
    /// `(before² - after²) / (before² - floor²)`, from 0 to 1, the floor what all effects together leave where it is not
    /// known; `None` where nothing was there to explain, or where the run took part in the fit.
    pub explained: Option<f64>,
}

// The signature is that of `serialize_with`.
#[allow(clippy::ref_option)]
fn um_if_any<S: Serializer>(mm: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    mm.map(|mm| mm * 1e3).serialize(serializer)
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
#[derive(Debug, Clone, Copy, PartialEq)]
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

/// The gain on every run, on every arc, and of every effect.
pub(crate) struct Gains {
    pub(crate) runs: Vec<RunGain>,
    pub(crate) arcs: Vec<ArcGain>,
    /// The effect that does least beside the others, if it makes runs that took no part worse, or all together do.
    pub(crate) harmful: Option<usize>,
}

/// The gain on every run; `before` is what the model alone leaves, `fitted_mm` what all effects together do.
pub(crate) fn by_run(
    before: &Residuals,
    alone: &Beside,
    fitted_mm: &Column,
    all: Option<&Fitted>,
) -> Gains {
    let residuals = alone.residuals;
    let repeats = residuals.repeats.len();
    let foretold: Vec<Option<LeftOut>> = (0..repeats)
        .into_par_iter()
        .map(|index| {
            let out: Vec<bool> = (0..repeats).map(|k| k == index).collect();
            all.filter(|_| repeats > 1).and_then(|all| left_out(alone, all, &out))
        })
        .collect();
    // With one repeat there is nothing to foretell from: what the fit itself leaves.
    let left = |index: usize| foretold[index].as_ref().map_or(fitted_mm, |out| &out.left_mm);
    let after_mm: Column = (0..repeats).map(|index| left(index)[index].clone()).collect();
    // What is each run's own repeats in none.
    let own = all.is_some_and(|all| all.elements.iter().any(|e| e.owner != Owner::All));
    let shared = shared(before);
    let was_by_arc = by_arc(before, &before.model_mm);
    let is_by_arc = by_arc(residuals, &after_mm);
    let (mut runs, mut arcs) = (Vec::new(), Vec::new());
    for (index, (was, is)) in before.repeats.iter().zip(&residuals.repeats).enumerate() {
        for (number, (of, run)) in was.runs.iter().zip(&is.runs).enumerate() {
            let mean = |column: &Column, samples: &Range<usize>| {
                let of_run = &column[index][samples.clone()];
                dot(of_run, of_run) / samples.len().max(1) as f64
            };
            let was_mm2 = mean(&before.model_mm, &of.samples);
            let (is_mm2, left_mm2) = (mean(&after_mm, &run.samples), mean(fitted_mm, &run.samples));
            // What is finer than the readings repeats, but not at the same readings.
            let floor_mm2 = match shared[of.program] {
                Some(structure) if !own => {
                    Some(left_mm2.min(was_mm2 - structure.variance_mm2.max(0.0)).max(0.0))
                }
                _ => all.is_none().then_some(left_mm2),
            };
            let least_mm2 = floor_mm2.unwrap_or(left_mm2);
            let own_curve = foretold[index].as_ref().is_some_and(|out| !out.curves);
            let there_mm2 = was_mm2 - least_mm2;
            let of_run = is_by_arc.range((index, number, 0)..(index, number + 1, 0));
            for (place, is) in of_run.filter(|_| !own_curve) {
                let Some(was) = was_by_arc.get(place) else { continue };
                let mean_mm2 = was.sum_mm2 / was.samples;
                arcs.push(ArcGain {
                    gained_mm2: mean_mm2 * is.samples - is.sum_mm2,
                    there_mm2: (mean_mm2 - least_mm2) * is.samples,
                });
            }
            let something = there_mm2 > NOTHING * was_mm2;
            let foretold = (foretold[index].is_some() || all.is_none()) && !own_curve;
            let share = || ((was_mm2 - is_mm2) / there_mm2).clamp(0.0, 1.0);
            runs.push(RunGain {
                run: run.name.clone(),
                samples: run.samples.len(),
                before_mm: was_mm2.sqrt(),
                after_mm: is_mm2.sqrt(),
                foretold,
                floor_mm: floor_mm2.map(f64::sqrt),
                explained: (foretold && something).then(share),
            });
        }
    }
    if foretold.iter().any(Option::is_none) {
        arcs.clear();
    }
    let effects = all.map_or(0, |all| all.elements.len());
    let gained_mm2 = |k: usize| -> f64 {
        let of = |out: &LeftOut| out.gained_mm2[k];
        if repeats > 1 { foretold.iter().flatten().map(of).sum() } else { f64::INFINITY }
    };
    let least = (0..effects).min_by(|a, b| gained_mm2(*a).total_cmp(&gained_mm2(*b)));
    let mean_mm2 = |of: &Residuals, column: &Column| column.square() / of.samples().max(1) as f64;
    let worse = mean_mm2(residuals, &after_mm) >= mean_mm2(before, &before.model_mm);
    let harmful = least.filter(|k| worse || gained_mm2(*k) <= 0.0);
    Gains { runs, arcs, harmful }
}

/// Sum of squares on one arc of one run.
#[derive(Debug, Clone, Copy, Default)]
struct OnArc {
    sum_mm2: f64,
    samples: f64,
}

/// Sums of squares by repeat, run and section of its program.
fn by_arc(residuals: &Residuals, left_mm: &Column) -> BTreeMap<(usize, usize, usize), OnArc> {
    let mut arcs: BTreeMap<_, OnArc> = BTreeMap::new();
    for (index, repeat) in residuals.repeats.iter().enumerate() {
        for (sample, left_mm) in repeat.samples.iter().zip(&left_mm[index]) {
            let arc = arcs.entry((index, sample.run, sample.section)).or_default();
            arc.sum_mm2 += left_mm * left_mm;
            arc.samples += 1.0;
        }
    }
    arcs
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
    let shares = |ends: [f64; 2]| ends.map(|end| end.clamp(0.0, 1.0));
    // Where all that was there is on one arc, the others say nothing of the share.
    let finite = |interval: &[f64; 2]| interval.iter().all(|end| end.is_finite());
    Some(Explained { share: share.min(1.0), interval: interval.filter(finite).map(shares) })
}

/// The gain on the runs of each program, from those of all others; `without` is what the model alone leaves.
pub(crate) fn by_program(without: &Residuals, alone: &Beside, all: &Fitted) -> Vec<ProgramGain> {
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
        let LeftOut { left_mm: left, .. } =
            left_out(alone, all, &out).filter(|left_out| left_out.curves)?;
        let (mut before, mut after) = (0.0, 0.0);
        let (mut samples_before, mut samples) = (0.0_f64, 0.0_f64);
        let mut runs = Vec::new();
        let mut fastest = 0.0_f64;
        for (index, repeat) in residuals.repeats.iter().enumerate().filter(|(k, _)| out[*k]) {
            let (was, is) = (&without.model_mm[index], &left[index]);
            before += dot(was, was);
            after += dot(is, is);
            samples_before += was.len() as f64;
            samples += is.len() as f64;
            runs.extend(repeat.runs.iter().map(|run| run.name.clone()));
            let speeds = repeat.samples.iter().map(|s| s.situation.motion.velocity_mm_s.norm());
            fastest = speeds.fold(fastest, f64::max);
        }
        Some(ProgramGain {
            runs,
            feed_mm_min: (60.0 * fastest).round(),
            before_mm: (before / samples_before.max(1.0)).sqrt(),
            after_mm: (after / samples.max(1.0)).sqrt(),
        })
    });
    gains.flatten().collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::machine::Axis;
    use crate::model::{Component, Empirical, Form, Seat, Variable};
    use crate::residual::Element;
    use crate::residual::bench::{element, residuals, white};

    /// A step at a moment that the second repeat does not reach: it foretells nothing of it, and says nothing against it.
    #[test]
    fn a_repeat_that_does_not_see_an_effect_says_nothing_against_it() {
        let mut noise = residuals(2, white(3, 1.5e-4));
        for sample in &mut noise.repeats[1].samples {
            sample.situation.motion.elapsed_s -= 1000.0;
            sample.situation.motion.program_s -= 1000.0;
        }
        let step = element("repeated-step:on=EXt,moment_s=60");
        let column = noise.outside(&step.columns(&noise)[0]);
        let with = noise.plus(&column.times(0.01));
        let alone = with.alone();
        let fitted = residual::fit(&alone, vec![step]).unwrap();
        let gains = by_run(&with, &alone, &fitted.left_mm(&alone), Some(&fitted));
        assert_eq!(gains.harmful, None);
        let [seeing, other] = &gains.runs[..] else { panic!("{:?}", gains.runs) };
        assert!(seeing.after_mm < 0.1 * seeing.before_mm, "{seeing:?}");
        assert!((other.after_mm - other.before_mm).abs() < 1e-3 * other.before_mm, "{other:?}");
    }

    /// A curve over velocities of which the first repeat drives half: of the other half it foretells nothing.
    #[test]
    fn a_repeat_at_another_feed_says_nothing_against_a_curve() {
        let mut noise = residuals(2, white(3, 1.5e-4));
        let fastest_mm_s = noise.fastest_mm_s[0];
        for sample in &mut noise.repeats[1].samples {
            sample.situation.motion.velocity_mm_s *= 2.0;
        }
        let knots: Vec<f64> = (-4..=4).map(|k| 0.5 * f64::from(k) * fastest_mm_s).collect();
        let curve = Element::new(
            Form::Empirical(Empirical {
                seat: Seat::Function(Axis::X, Component::Y),
                variable: Variable::Velocity(Axis::X),
                with_sense: true,
                knots: knots.clone(),
            }),
            Owner::All,
        );
        let mut effect = noise.zeros();
        for (knot, column) in knots.iter().zip(curve.columns(&noise)) {
            effect.add(0.01 * (knot / fastest_mm_s).powi(2), &column);
        }
        let effect = noise.outside(&effect);
        let with = noise.plus(&effect);
        let alone = with.alone();
        let fitted = residual::fit(&alone, vec![curve]).unwrap();
        let gains = by_run(&with, &alone, &fitted.left_mm(&alone), Some(&fitted));
        assert_eq!(gains.harmful, None);
        for run in &gains.runs {
            assert!(run.after_mm < 0.1 * run.before_mm, "{run:?}");
        }
        // Nor is it said that it does.
        let told: Vec<bool> = gains.runs.iter().map(|run| run.foretold).collect();
        assert_eq!(told, [true, false]);
        let explained = gains.runs.iter().map(|run| run.explained.is_some());
        assert_eq!(explained.collect::<Vec<_>>(), told);
    }

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
