//! The residual as spectra: over the position of each slide, and in time.
//!
//! With `F(k) = sum w e exp(-i k x)` and `W = sum w²`, the amplitude of a wave is `2 |F| / W`. The share of a
//! spectrum is that of its strongest line: found and measured in all other parts, and held against the part
//! that is left out.

use std::sync::Arc;

use rayon::prelude::*;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::sample::Shown;
use super::view::{Bin, Subject, View, ViewKind};
use crate::machine::Axis;
use crate::solve::median;

/// Bins of a position, and points of its transform.
const PLACES: usize = 2048;
const POINTS: usize = 2 * PLACES;
/// Waves that are longer than this part of the range are trends.
const LONGEST: f64 = 0.25;
/// The shortest wave that is shown, mm.
const SHORTEST_MM: f64 = 1.0;
/// The slowest line that is looked for, Hz.
const SLOWEST_HZ: f64 = 0.02;
/// Points of a spectrum that are shown.
const SHOWN: usize = 320;
/// Sample periods that differ by less than this share are one rate.
const SAME_RATE: f64 = 0.02;

type Wave = Complex<f64>;

/// Sums of one part: transforms before and after, the weight and how many samples.
struct Part {
    before: Vec<Wave>,
    after: Vec<Wave>,
    weight: f64,
    count: usize,
}

/// Spectra over the position of each slide, resolved along X, Y and Z; and one in time for each rate.
pub(crate) fn views(all: &[Shown], long_run_mm2: f64) -> Vec<View> {
    let pairs: Vec<(Axis, Axis)> =
        Axis::ALL.into_iter().flat_map(|of| Axis::ALL.map(|along| (of, along))).collect();
    let plan = FftPlanner::new().plan_fft_forward(POINTS);
    let mut views: Vec<View> = pairs
        .into_par_iter()
        .filter_map(|(of, along)| in_position(all, of, along, &plan, long_run_mm2))
        .collect();
    views.extend(in_time(all, long_run_mm2));
    views
}

fn in_position(
    all: &[Shown],
    of: Axis,
    along: Axis,
    plan: &Arc<dyn Fft<f64>>,
    long_run_mm2: f64,
) -> Option<View> {
    let places = || all.iter().map(|shown| shown.position_mm[of.index()]);
    let low = places().fold(f64::INFINITY, f64::min);
    let range_mm = places().fold(f64::NEG_INFINITY, f64::max) - low;
    if !range_mm.is_finite() || range_mm <= 1.0 {
        return None;
    }
    let folds = all.iter().map(|shown| shown.fold + 1).max()?;
    let blank = vec![Wave::new(0.0, 0.0); POINTS];
    let mut parts: Vec<Part> = (0..folds)
        .map(|_| Part { before: blank.clone(), after: blank.clone(), weight: 0.0, count: 0 })
        .collect();
    let scale = (PLACES - 1) as f64 / range_mm;
    for shown in all {
        let part = &mut parts[shown.fold];
        let place = ((shown.position_mm[of.index()] - low) * scale).round() as usize;
        let w = shown.direction[along.index()];
        part.before[place].re += w * shown.before_mm;
        part.after[place].re += w * shown.after_mm;
        part.weight += w * w;
        part.count += 1;
    }
    for part in &mut parts {
        plan.process(&mut part.before);
        plan.process(&mut part.after);
    }
    // Wave number of one point, per mm.
    let step = scale / POINTS as f64;
    let first = (1.0 / (LONGEST * range_mm) / step).ceil() as usize;
    let last = ((1.0 / SHORTEST_MM / step) as usize).min(POINTS / 2 - 1);
    let squares = |of: fn(&Shown) -> f64| all.iter().map(|s| of(s).powi(2)).sum::<f64>();
    let (gain_before, gain_after) = gains(&parts, first, last);
    let bins = shown(&[&parts], step, first, last, long_run_mm2);
    Some(View {
        subject: Subject::PositionSpectrum,
        variable: format!("spectrum over the position of {of}"),
        counted: format!("along {along}"),
        unit: "1/mm",
        kind: ViewKind::Spectrum,
        bins,
        share_before: gain_before / squares(|s| s.before_mm).max(f64::MIN_POSITIVE),
        share_after: gain_after / squares(|s| s.after_mm).max(f64::MIN_POSITIVE),
    })
}

/// What the strongest line of all other parts explains of each, mm².
fn gains(parts: &[Part], first: usize, last: usize) -> (f64, f64) {
    let of = |which: fn(&Part) -> &Vec<Wave>| -> f64 {
        let sum = |k: usize| parts.iter().map(|part| which(part)[k]).sum::<Wave>();
        let all: Vec<Wave> =
            (0..=last).map(|k| if k < first { Wave::default() } else { sum(k) }).collect();
        let weight: f64 = parts.iter().map(|part| part.weight).sum();
        let each = parts.iter().map(|part| {
            let (own, others) = (which(part), weight - part.weight);
            if others <= 1e-9 * weight {
                return 0.0;
            }
            let size = |k: &usize| (all[*k] - own[*k]).norm_sqr();
            let Some(k) = (first..=last).max_by(|a, b| size(a).total_cmp(&size(b))) else {
                return 0.0;
            };
            let wave = (all[k] - own[k]) * (2.0 / others);
            // `sum 2 w e m - w² m²`, with half the squares on either side of the wave.
            2.0 * (wave * own[k].conj()).re - 0.5 * wave.norm_sqr() * part.weight
        });
        each.sum()
    };
    (of(|part| &part.before), of(|part| &part.after))
}

/// Amplitudes of several runs, root mean square over them; of neighbouring points the largest.
fn shown(runs: &[&[Part]], step: f64, first: usize, last: usize, long_run_mm2: f64) -> Vec<Bin> {
    let amplitude = |k: usize, which: fn(&Part) -> &Vec<Wave>| -> f64 {
        let squares = runs.iter().map(|parts| {
            let sum: Wave = parts.iter().map(|part| which(part)[k]).sum();
            let weight: f64 = parts.iter().map(|part| part.weight).sum();
            (2.0 / weight.max(f64::MIN_POSITIVE)).powi(2) * sum.norm_sqr()
        });
        (squares.sum::<f64>() / runs.len().max(1) as f64).sqrt()
    };
    let weight: f64 = runs.iter().flat_map(|parts| parts.iter()).map(|part| part.weight).sum();
    let count = runs.iter().flat_map(|parts| parts.iter()).map(|part| part.count).sum();
    let sigma_mm = 2.0 * (long_run_mm2 * runs.len() as f64 / weight.max(1e-9)).sqrt();
    let points: Vec<usize> = (first..=last).collect();
    let each = points.len().div_ceil(SHOWN).max(1);
    let largest = |of: &[usize], which: fn(&Part) -> &Vec<Wave>| {
        of.iter()
            .map(|k| (amplitude(*k, which), *k))
            .fold((0.0, of[0]), |m, a| if a.0 > m.0 { a } else { m })
    };
    points
        .chunks(each)
        .map(|chunk| {
            let (before_mm, at) = largest(chunk, |part| &part.before);
            let (after_mm, _) = largest(chunk, |part| &part.after);
            Bin { center: at as f64 * step, before_mm, after_mm, sigma_mm, count }
        })
        .collect()
}

fn in_time(all: &[Shown], long_run_mm2: f64) -> Vec<View> {
    let runs: Vec<&[Shown]> = all.chunk_by(|a, b| a.run == b.run).collect();
    let mut rates: Vec<(f64, Vec<&[Shown]>)> = Vec::new();
    for run in runs {
        let Some(period_s) = period_s(run) else { continue };
        match rates.iter_mut().find(|(known, _)| (known / period_s - 1.0).abs() < SAME_RATE) {
            Some((_, of_rate)) => of_rate.push(run),
            None => rates.push((period_s, vec![run])),
        }
    }
    rates
        .into_iter()
        .filter_map(|(period_s, runs)| of_rate(&runs, period_s, long_run_mm2))
        .collect()
}

/// Median time between readings of a run, s.
fn period_s(run: &[Shown]) -> Option<f64> {
    let steps = run.windows(2).map(|pair| pair[1].elapsed_s - pair[0].elapsed_s).collect();
    median(steps).filter(|period_s| *period_s > 1e-6)
}

/// The spectrum of the runs of one sample rate; the two parts of each are stretches that take turns.
fn of_rate(runs: &[&[Shown]], period_s: f64, long_run_mm2: f64) -> Option<View> {
    let at = |run: &[Shown], shown: &Shown| {
        ((shown.elapsed_s - run[0].elapsed_s) / period_s).round().max(0.0) as usize
    };
    let longest = runs.iter().filter_map(|run| Some(at(run, run.last()?))).max()?;
    let points = (longest + 1).next_power_of_two() * 2;
    // A stretch is long against the slowest wave, and short against the run.
    let stretch = (longest / 16).max(1);
    let plan = FftPlanner::new().plan_fft_forward(points);
    let transformed: Vec<Vec<Part>> = runs
        .par_iter()
        .map(|run| {
            let blank = vec![Wave::new(0.0, 0.0); points];
            let mut parts: Vec<Part> = (0..2)
                .map(|_| Part {
                    before: blank.clone(),
                    after: blank.clone(),
                    weight: 0.0,
                    count: 0,
                })
                .collect();
            for shown in *run {
                let place = at(run, shown);
                let part = &mut parts[place / stretch % 2];
                part.before[place].re += shown.before_mm;
                part.after[place].re += shown.after_mm;
                part.weight += 1.0;
                part.count += 1;
            }
            for part in &mut parts {
                plan.process(&mut part.before);
                plan.process(&mut part.after);
            }
            parts
        })
        .collect();
    let step = 1.0 / (period_s * points as f64);
    let first = (SLOWEST_HZ / step).ceil() as usize;
    let last = points / 2 - 1;
    if first >= last {
        return None;
    }
    let mut gain = (0.0, 0.0);
    for parts in &transformed {
        let (before, after) = gains(parts, first, last);
        gain = (gain.0 + before, gain.1 + after);
    }
    let squares = |of: fn(&Shown) -> f64| {
        runs.iter().flat_map(|r| r.iter()).map(|s| of(s).powi(2)).sum::<f64>()
    };
    let parts: Vec<&[Part]> = transformed.iter().map(Vec::as_slice).collect();
    Some(View {
        subject: Subject::TimeSpectrum,
        variable: "spectrum in time".into(),
        counted: format!("read at {:.0} Hz", 1.0 / period_s),
        unit: "Hz",
        kind: ViewKind::Spectrum,
        bins: shown(&parts, step, first, last, long_run_mm2),
        share_before: gain.0 / squares(|s| s.before_mm).max(f64::MIN_POSITIVE),
        share_after: gain.1 / squares(|s| s.after_mm).max(f64::MIN_POSITIVE),
    })
}
