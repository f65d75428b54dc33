//! What a reader should know before he believes the numbers.

use std::collections::BTreeSet;

use super::facts::{Analysis, RepeatResult};
use super::place::{self, PlaceResult};
use super::run_facts::RunResult;
use crate::identify::CHANGED;
use crate::report::text::numbers::{fixed, many};
use crate::report::text::words::list;

/// A deviation is remarkable above this many times the stated sigma.
const REMARKABLE: f64 = 3.0;
/// Residuals are remarkable above this many times the stated noise.
const NOISY: f64 = 1.5;
/// A parameter of which less than this is determined hangs on others.
pub(in crate::report) const DETERMINED: f64 = 0.99;

/// The cautions of an analysis, the gravest first.
pub(super) fn of(analysis: &Analysis) -> Vec<String> {
    let mut all = Vec::new();
    if analysis.is_local() {
        all.extend(unexplained(analysis));
        all.extend(changed_answers(analysis));
        all.extend(analysis.at_the_place.iter().filter_map(PlaceResult::caution));
    } else {
        all.extend(deficient(analysis));
        all.extend(unexplained(analysis));
        all.extend(changed_terms(analysis));
    }
    all.extend(apart(analysis));
    all.extend(analysis.runs().filter_map(|run| timing(run, analysis)));
    all.extend(feed(analysis));
    all.extend(rejected(analysis));
    if !analysis.is_local() {
        all.extend(close_pairs(analysis));
    }
    all.extend(pauses(analysis));
    if analysis.repeats.len() == 1 {
        all.push(
            "Only one repeat: the repeatability of the machine and its set-up is unknown.".into(),
        );
    }
    all
}

fn deficient(analysis: &Analysis) -> Option<String> {
    let worst = analysis.repeats.iter().min_by_key(|repeat| repeat.rank)?;
    if worst.rank == worst.parameter_count {
        return None;
    }
    let weak = analysis.over_repeats.iter().filter(|mean| mean.observed < DETERMINED);
    Some(format!(
        "{} of {} directions are not observable. The values of {} are the smallest of many that fit equally well: they are no properties of the machine, and no sigma is shown for them.",
        worst.parameter_count - worst.rank,
        worst.parameter_count,
        list(weak.map(|mean| mean.name.as_str()))
    ))
}

fn unexplained(analysis: &Analysis) -> Option<String> {
    let worst = analysis.repeats.iter().map(|r| r.residual_rms_um).fold(0.0, f64::max);
    let bar = &analysis.ball_bar;
    // Readings to the nearest step are off by any part of half of one.
    let with_steps_um = bar.noise_um.hypot(bar.resolution_um / 12.0_f64.sqrt());
    (worst > NOISY * with_steps_um).then(|| {
        let stated = format!("the stated noise of {} um", fixed(bar.noise_um, 3));
        let (expected_um, expected) = if bar.resolution_um > bar.noise_um {
            let [with, steps] = [fixed(with_steps_um, 3), fixed(bar.resolution_um, 1)];
            (with_steps_um, format!("the {with} um that {stated} and steps of {steps} um make"))
        } else {
            (bar.noise_um, stated)
        };
        format!(
            "Residuals of up to {} um rms are {} times {expected}: the model does not explain all that the bar reads. The sigmas do not include this.",
            fixed(worst, 3),
            fixed(worst / expected_um, 1)
        )
    })
}

/// Repeats that have no circle in common are hardly repeats.
fn apart(analysis: &Analysis) -> Option<String> {
    let circles = |repeat: &RepeatResult| -> BTreeSet<(String, String)> {
        let of_run = |run: &RunResult| {
            let arcs = run.arcs.iter().filter(|arc| !arc.transit);
            arcs.map(|arc| (run.mounting.clone(), arc.circle.clone())).collect::<Vec<_>>()
        };
        repeat.runs.iter().flat_map(of_run).collect()
    };
    let first = analysis.repeats.first()?;
    let of_first = circles(first);
    let other = analysis.repeats.iter().find(|other| circles(other).is_disjoint(&of_first))?;
    let name = |of: &RepeatResult| of.runs.first().map_or(String::new(), |run| run.name.clone());
    Some(format!(
        "{} and {} have no circle in common, and each was identified by itself. Are they of one test, write the same `repeat` into their `[[run]]`s: together they tell more.",
        name(first),
        name(other)
    ))
}

/// What changed between the repeats by more than so many times what is stated, with that ratio for each.
fn changed<'a>(
    ratios: impl Iterator<Item = (&'a str, f64)>,
    beyond: f64,
    stated: &str,
) -> Option<String> {
    let moved: Vec<(&str, f64)> = ratios.filter(|(_, ratio)| *ratio > beyond).collect();
    let largest = moved.iter().map(|(_, ratio)| *ratio).fold(0.0, f64::max);
    (!moved.is_empty()).then(|| {
        format!(
            "Between the repeats {} changed by more than {} times {stated}, {} times at most: the machine or its set-up changed, or an effect is not in the model.",
            list(moved.iter().map(|(name, _)| *name)),
            fixed(beyond, 0),
            fixed(largest, 0)
        )
    })
}

fn changed_terms(analysis: &Analysis) -> Option<String> {
    let ratio = |deviation: Option<f64>, sigma: Option<f64>| match (deviation, sigma) {
        (Some(deviation), Some(sigma)) if sigma > 0.0 => deviation / sigma,
        _ => 0.0,
    };
    let means = analysis.over_repeats.iter();
    let ratios = means.map(|mean| (mean.name.as_str(), ratio(mean.deviation, mean.sigma)));
    changed(ratios, REMARKABLE, "the stated sigma")
}

fn changed_answers(analysis: &Analysis) -> Option<String> {
    let (seen, _) = place::seen(&analysis.at_the_place);
    let ratios = seen.into_iter().filter_map(|of| Some((of.quantity.as_str(), of.over_noise?)));
    changed(ratios, CHANGED, "their noise")
}

fn timing(run: &RunResult, analysis: &Analysis) -> Option<String> {
    let tolerance = analysis.ball_bar.clock_tolerance_ppm;
    if run.clock_rate_ppm.abs() > tolerance {
        return Some(format!(
            "{}: the clocks differ by {} ppm, more than the {} ppm that the test file allows.",
            run.name,
            fixed(run.clock_rate_ppm, 1),
            fixed(tolerance, 0)
        ));
    }
    let worst = run.worst_time_sigma_ms.unwrap_or(f64::INFINITY);
    (worst > 20.0).then(|| {
        let told = run.worst_time_sigma_ms.map_or("unknown".into(), |s| format!("{} ms", fixed(s, 1)));
        format!("{}: the uncertainty of the sample times is {told}: facets of the path cannot be distinguished.", run.name)
    })
}

fn feed(analysis: &Analysis) -> Vec<String> {
    analysis
        .runs()
        .filter_map(|run| {
            let sigma = run.feed_override.excess_sigma_percent?;
            let differs = run.feed_override.excess_percent.abs() > REMARKABLE * sigma;
            differs.then(|| format!(
                "{}: by the log the feed differed by {} % +- {} % from the stated {} %. The program times follow the log.",
                run.name,
                fixed(run.feed_override.excess_percent, 3),
                fixed(sigma, 3),
                fixed(run.feed_override.stated_percent, 0)
            ))
        })
        .collect()
}

fn rejected(analysis: &Analysis) -> Option<String> {
    let (rejected, used) = analysis
        .repeats
        .iter()
        .fold((0, 0), |sum, r| (sum.0 + r.samples.rejected, sum.1 + r.samples.used));
    (rejected * 100 > used).then(|| {
        format!(
            "{} of {} were rejected: more than a few lost readings.",
            many(rejected, "sample"),
            used + rejected
        )
    })
}

fn close_pairs(analysis: &Analysis) -> Option<String> {
    let pairs = &analysis.repeats.first()?.correlations;
    let told: Vec<String> = pairs
        .iter()
        .take(4)
        .map(|pair| format!("{} and {} ({})", pair.first, pair.second, fixed(pair.correlation, 3)))
        .collect();
    (!told.is_empty()).then(|| {
        let more = if pairs.len() > told.len() {
            format!(", and {} more", pairs.len() - told.len())
        } else {
            String::new()
        };
        format!(
            "These estimates are correlated and must be read together: {}{more}.",
            told.join(", ")
        )
    })
}

fn pauses(analysis: &Analysis) -> Option<String> {
    // A pause before the bar engages has no samples before it; that is how a test begins, not a loss.
    let unknown = analysis
        .runs()
        .flat_map(|run| run.pauses.iter().map(move |pause| (run, pause)))
        .filter(|(run, pause)| {
            let first = run.marks.first().map_or(0.0, |mark| mark.program_s);
            let last = run.marks.iter().map(|mark| mark.program_s).fold(first, f64::max);
            pause.length_s.is_none() && (first..=last).contains(&pause.program_s)
        })
        .count();
    (unknown > 0).then(|| {
        format!("{} between arcs cannot be read from the logs.", many(unknown, "operator's pause"))
    })
}
