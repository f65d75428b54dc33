//! Lines in the spectrum of the residuals, and which frequencies they may be aliases of.

use rayon::prelude::*;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::candidate::Candidate;
use crate::diagnose::thresholds::TUNED;
use crate::model::{Cause, Form, Inner, Seat, Shape, Start};
use crate::residual::{self, Beside, Element, Fitted, Noise, Owner, Sample, Tuning};
use crate::solve::median;

/// Slower than this is no vibration, Hz.
const SLOWEST_HZ: f64 = 0.05;
/// Lines of one direction and one sample rate that are looked at closely.
const LINES: usize = 2;
/// Lines, with their aliases, that are fitted.
const CLOSELY: usize = 4;
/// Aliases up to so many times the sample rate.
const FOLDS: usize = 3;

/// A frequency may differ by this share from run to run.
const FARTHEST: f64 = 5e-4;
/// It is tried in steps of so many turns over a run, and in so many either way at most.
const TURN: f64 = 0.1;
const MOST_STEPS: f64 = 300.0;

/// What a run's residuals hold at every frequency.
struct Spectrum {
    /// Sample period, s.
    period_s: f64,
    /// Gain of a line, mm², one a bin of `resolution_hz`.
    gains_mm2: Vec<f64>,
    resolution_hz: f64,
}

/// The strongest lines of every direction, with the frequencies that they may be aliases of; none where no
/// line explains half of `least_mm2`.
///
/// Between the sample rates of several runs, and by the differences of their clocks, aliases can be told
/// apart: each is tried on the samples themselves.
pub(crate) fn candidates(
    cause: &'static Cause,
    beside: &Beside,
    tuning: &Tuning,
    least_mm2: f64,
) -> Vec<Candidate> {
    let seats = cause.seats();
    let mut planner = FftPlanner::new();
    let spectra: Vec<Vec<Spectrum>> =
        seats.iter().map(|seat| spectra(beside, *seat, &mut planner)).collect();
    let mut lines: Vec<(Seat, f64, f64, f64)> = Vec::new();
    for (seat, spectra) in seats.iter().zip(&spectra) {
        for group in groups(spectra) {
            for (line_hz, period_s, gain_mm2) in strongest(&group) {
                lines.push((*seat, line_hz, period_s, gain_mm2));
            }
        }
    }
    let most = lines.iter().map(|line| line.3).fold(0.0, f64::max);
    lines.retain(|line| line.3 > 0.5 * most && line.3 > 0.5 * least_mm2);
    let tried: Vec<(Seat, f64)> = lines
        .into_iter()
        .flat_map(|(seat, line_hz, period_s, _)| {
            (0..=FOLDS).flat_map(move |fold| {
                let of_fold = fold as f64 / period_s;
                [(seat, of_fold + line_hz), (seat, of_fold - line_hz)]
            })
        })
        .filter(|(_, frequency_hz)| *frequency_hz > SLOWEST_HZ)
        .collect();
    let mut found: Vec<Candidate> = tried
        .into_par_iter()
        .filter_map(|(seat, about_hz)| {
            let (hz, gain_mm2) = nearby(beside, tuning, seat, about_hz);
            let shape = Shape { cause, seat, inner: Some(hz) };
            let tuning = tuning.clone();
            let of_each = Element::new(Form::Cause(shape), Owner::EachRun);
            let element = Element { tuning, ..of_each };
            // Aliases gain the same but for rounding. Those that means have nothing of must not take the place of one that they have.
            let possible = element.possible(beside.residuals);
            possible.then_some(Candidate { element, gain_mm2 })
        })
        .collect();
    found.sort_by(|a, b| b.gain_mm2.total_cmp(&a.gain_mm2));
    found.truncate(CLOSELY);
    found
}

/// A vibration of the lowest frequency that the readings do not tell from this one: by a clock that reads every 0.1 s
/// exactly, 2.3 Hz and 27.7 Hz are one. `None` where that is itself, or it is no vibration.
pub(crate) fn lowest(beside: &Beside, fitted: &Fitted) -> Option<Fitted> {
    let element = fitted.elements.first().filter(|element| is_line(element))?;
    let shape = element.shape()?;
    let frequency_hz = shape.inner?;
    let mut lower_hz: Vec<f64> = periods_s(beside)
        .into_iter()
        .flat_map(|period_s| (1..=2 * FOLDS).map(move |fold| fold as f64 / period_s))
        .map(|of_fold| (frequency_hz - of_fold).abs())
        .filter(|hz| *hz > SLOWEST_HZ && *hz < frequency_hz)
        .collect();
    lower_hz.sort_by(f64::total_cmp);
    let told_mm2 = TUNED * Noise::of(beside.residuals, &fitted.left_mm(beside)).long_run_mm2;
    lower_hz.into_iter().find_map(|about_hz| {
        let (hz, _) = nearby(beside, &element.tuning, shape.seat, about_hz);
        let form = Form::Cause(Shape { inner: Some(hz), ..*shape });
        let lower = residual::fit(beside, vec![Element { form, ..element.clone() }])?;
        let possible = lower.elements[0].possible(beside.residuals);
        (possible && lower.gain_mm2 > fitted.gain_mm2 - told_mm2).then_some(lower)
    })
}

/// Whether it is a line in the spectrum.
fn is_line(element: &Element) -> bool {
    let inner = element.shape().and_then(|shape| shape.law().inner());
    matches!(inner, Some(Inner { start: Start::Lines, .. }))
}

/// How far apart readings are, s, of each sample rate.
fn periods_s(beside: &Beside) -> Vec<f64> {
    let repeats = beside.residuals.repeats.iter();
    let runs = repeats.flat_map(|of| of.runs.iter().map(|run| &of.samples[run.samples.clone()]));
    let mut periods_s: Vec<f64> = runs.filter_map(period_s).collect();
    periods_s.sort_by(f64::total_cmp);
    periods_s.dedup_by(|a, b| same_period(*a, *b));
    periods_s
}

/// Whether two distances of samples are of one sample rate.
fn same_period(one_s: f64, other_s: f64) -> bool {
    (one_s / other_s - 1.0).abs() < 0.01
}

/// The frequency near another one (Hz) that explains most, and what that is, mm².
fn nearby(beside: &Beside, tuning: &Tuning, seat: Seat, about_hz: f64) -> (f64, f64) {
    let step_hz = 0.25 / beside.residuals.longest_s();
    let near = (-4..=4).map(|k| about_hz + f64::from(k) * step_hz);
    let gains = near.map(|hz| (hz, coherent_mm2(beside, tuning, seat, hz)));
    gains.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((about_hz, 0.0))
}

/// What a line of one frequency explains with a phase of its own in every run, mm², where nothing of it is
/// spanned.
fn coherent_mm2(beside: &Beside, tuning: &Tuning, seat: Seat, frequency_hz: f64) -> f64 {
    let runs = beside.residuals.runs();
    runs.map(|(repeat, run)| {
        in_run_mm2(beside, repeat, run, seat, frequency_hz * tuning.factor(repeat, run))
    })
    .sum()
}

/// The same in one run.
fn in_run_mm2(beside: &Beside, repeat: usize, run: usize, seat: Seat, frequency_hz: f64) -> f64 {
    let left_mm = &beside.left_mm[repeat];
    let of = &beside.residuals.repeats[repeat];
    let run = &of.runs[run].samples;
    let (mut s, mut c, mut squares) = (0.0, 0.0, 0.0);
    for (sample, left) in of.samples[run.clone()].iter().zip(&left_mm[run.clone()]) {
        let worth = seat.sensitivity(&sample.situation) * sample.root_weight;
        let turns = frequency_hz * sample.elapsed_s();
        let (sine, cosine) = (std::f64::consts::TAU * turns.fract()).sin_cos();
        s += worth * sine * left;
        c += worth * cosine * left;
        squares += worth * worth;
    }
    (s * s + c * c) / (0.5 * squares).max(f64::MIN_POSITIVE)
}

/// How the frequency of a vibration differs from run to run; `None` where it does not.
///
/// The source is no clock, and two clocks are no clock either.
pub(crate) fn tuned(beside: &Beside, element: &Element) -> Option<Tuning> {
    let shape = element.shape().filter(|_| is_line(element))?;
    let frequency_hz = shape.inner?;
    let step = TURN / (frequency_hz * beside.residuals.longest_s());
    let steps = (FARTHEST / step).ceil().min(MOST_STEPS) as i32;
    let in_run = |repeat: usize, run: usize| {
        let gain = |factor: f64| in_run_mm2(beside, repeat, run, shape.seat, frequency_hz * factor);
        let each = (-steps..=steps).map(|k| 1.0 + f64::from(k) * step);
        let (factor, best_mm2) =
            each.map(|factor| (factor, gain(factor))).max_by(|a, b| a.1.total_cmp(&b.1))?;
        let worth_it = best_mm2 - gain(1.0) > TUNED * beside.noise().long_run_mm2;
        worth_it.then_some(factor)
    };
    let factors: Vec<Vec<Option<f64>>> = (0..beside.residuals.repeats.len())
        .into_par_iter()
        .map(|repeat| {
            let runs = 0..beside.residuals.repeats[repeat].runs.len();
            runs.into_par_iter().map(|run| in_run(repeat, run)).collect()
        })
        .collect();
    let differs = factors.iter().flatten().any(Option::is_some);
    let of_runs = |runs: Vec<Option<f64>>| runs.into_iter().map(|f| f.unwrap_or(1.0)).collect();
    differs.then(|| Tuning::of(factors.into_iter().map(of_runs).collect()))
}

/// One spectrum a run.
fn spectra(beside: &Beside, seat: Seat, planner: &mut FftPlanner<f64>) -> Vec<Spectrum> {
    let mut spectra = Vec::new();
    for (repeat, left_mm) in beside.residuals.repeats.iter().zip(beside.left_mm.iter()) {
        for run in repeat.runs.iter().map(|run| &run.samples) {
            let samples = &repeat.samples[run.clone()];
            let Some(period_s) = period_s(samples) else { continue };
            let first_s = samples[0].elapsed_s();
            let place = |elapsed_s: f64| ((elapsed_s - first_s) / period_s).round() as usize;
            let last = samples.last().map_or(0, |s| place(s.elapsed_s()));
            let length = (2 * (last + 1)).next_power_of_two();
            let mut signal = vec![Complex::new(0.0, 0.0); length];
            let mut squares = 0.0;
            for (sample, left) in samples.iter().zip(&left_mm[run.clone()]) {
                let worth = seat.sensitivity(&sample.situation) * sample.root_weight;
                signal[place(sample.elapsed_s()).min(length - 1)].re += worth * left;
                squares += worth * worth;
            }
            planner.plan_fft_forward(length).process(&mut signal);
            // Sine and cosine have half the square each.
            let half = (0.5 * squares).max(f64::MIN_POSITIVE);
            spectra.push(Spectrum {
                period_s,
                gains_mm2: signal[..=length / 2].iter().map(|f| f.norm_sqr() / half).collect(),
                resolution_hz: (length as f64 * period_s).recip(),
            });
        }
    }
    spectra
}

/// The usual distance of samples, s.
fn period_s(samples: &[Sample]) -> Option<f64> {
    let steps = samples.windows(2).map(|pair| pair[1].elapsed_s() - pair[0].elapsed_s()).collect();
    median(steps).filter(|step_s| *step_s > 0.0)
}

/// Spectra of the same sample rate.
fn groups(spectra: &[Spectrum]) -> Vec<Vec<&Spectrum>> {
    let mut groups: Vec<Vec<&Spectrum>> = Vec::new();
    for spectrum in spectra {
        let same = |group: &&mut Vec<&Spectrum>| {
            same_period(group[0].period_s, spectrum.period_s)
                && group[0].gains_mm2.len() == spectrum.gains_mm2.len()
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(spectrum),
            None => groups.push(vec![spectrum]),
        }
    }
    groups
}

/// Frequency (Hz), sample period (s) and gain (mm²) of the strongest lines of a group.
fn strongest(group: &[&Spectrum]) -> Vec<(f64, f64, f64)> {
    let first = group[0];
    let total = |bin: usize| group.iter().map(|s| s.gains_mm2[bin]).sum::<f64>();
    let slowest = (SLOWEST_HZ / first.resolution_hz).ceil() as usize;
    let mut bins: Vec<(usize, f64)> =
        (slowest.max(1)..first.gains_mm2.len()).map(|bin| (bin, total(bin))).collect();
    bins.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut lines: Vec<usize> = Vec::new();
    for (bin, _) in bins.into_iter().take(50) {
        // Zero padding spreads a line over four bins.
        if lines.iter().all(|line| line.abs_diff(bin) > 8) {
            lines.push(bin);
        }
    }
    let of = |bin: usize| (bin as f64 * first.resolution_hz, first.period_s, total(bin));
    lines.into_iter().take(LINES).map(of).collect()
}
