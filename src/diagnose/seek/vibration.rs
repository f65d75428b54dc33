//! Lines in the spectrum of the residuals, and which frequencies they may be aliases of.

use rayon::prelude::*;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::candidate::Candidate;
use crate::machine::Axis;
use crate::model::{Ball, Form, Kind, Seat, SetUp, Shape};
use crate::residual::data::Data;
use crate::residual::element::{Element, Owner};
use crate::residual::noise::Noise;

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
/// Another frequency in one run gains at least so many times what chance gives an amplitude.
const TUNED: f64 = 20.0;

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
pub(crate) fn candidates(data: &Data, least_mm2: f64) -> Vec<Candidate> {
    let cause = Kind::Vibration.cause();
    let balls = Axis::ALL.map(|axis| Seat::Ball(SetUp { ball: Ball::Tool, axis }));
    let seats: Vec<Seat> = balls.into_iter().chain([Seat::Bar]).collect();
    let mut planner = FftPlanner::new();
    let spectra: Vec<Vec<Spectrum>> =
        seats.iter().map(|seat| spectra(data, *seat, &mut planner)).collect();
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
        .map(|(seat, about_hz)| {
            let step_hz = 0.25 / data.longest_s();
            let near = (-4..=4).map(|k| about_hz + f64::from(k) * step_hz);
            let gains = near.map(|hz| (hz, coherent_mm2(data, seat, hz)));
            let best = gains.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((about_hz, 0.0));
            let shape = Shape { cause, seat, inner: Some(best.0) };
            let element = Element { form: Form::Cause(shape), owner: Owner::EachRun };
            Candidate { element, gain_mm2: best.1 }
        })
        .collect();
    found.sort_by(|a, b| b.gain_mm2.total_cmp(&a.gain_mm2));
    found.truncate(CLOSELY);
    found
}

/// What a line of one frequency explains with a phase of its own in every run, mm², where nothing of it is
/// spanned.
fn coherent_mm2(data: &Data, seat: Seat, frequency_hz: f64) -> f64 {
    let runs = data.blocks.iter().enumerate().flat_map(|(b, block)| {
        (0..block.runs.len()).map(move |run| in_run_mm2(data, b, run, seat, frequency_hz))
    });
    runs.sum()
}

/// The same in one run.
fn in_run_mm2(data: &Data, block: usize, run: usize, seat: Seat, frequency_hz: f64) -> f64 {
    let left_mm = &data.left_mm[block];
    let block = &data.blocks[block];
    let frequency_hz = frequency_hz * block.tuned[run];
    let run = &block.runs[run];
    let (mut s, mut c, mut squares) = (0.0, 0.0, 0.0);
    for (sample, left) in block.samples[run.clone()].iter().zip(&left_mm[run.clone()]) {
        let worth = seat.sensitivity(&sample.situation) * sample.root_weight;
        let turns = frequency_hz * sample.situation.motion.elapsed_s;
        let (sine, cosine) = (std::f64::consts::TAU * turns.fract()).sin_cos();
        s += worth * sine * left;
        c += worth * cosine * left;
        squares += worth * worth;
    }
    (s * s + c * c) / (0.5 * squares).max(f64::MIN_POSITIVE)
}

/// Lets the frequency of a vibration differ from run to run; whether it does.
///
/// The source is no clock, and two clocks are no clock either. All vibrations are tuned alike: once.
pub(crate) fn tune(data: &mut Data, element: &Element, noise: &Noise) -> bool {
    let Some(shape) = element.shape().filter(|shape| shape.cause.kind == Kind::Vibration) else {
        return false;
    };
    let Some(frequency_hz) = shape.inner.filter(|_| !data.tuned) else { return false };
    let step = TURN / (frequency_hz * data.longest_s());
    let steps = (FARTHEST / step).ceil().min(MOST_STEPS) as i32;
    let all: Vec<(usize, usize)> = data
        .blocks
        .iter()
        .enumerate()
        .flat_map(|(b, block)| (0..block.runs.len()).map(move |run| (b, run)))
        .collect();
    let found: Vec<(usize, usize, f64)> = all
        .into_par_iter()
        .filter_map(|(b, run)| {
            let gain = |tuned: f64| in_run_mm2(data, b, run, shape.seat, frequency_hz * tuned);
            let each = (-steps..=steps).map(|k| 1.0 + f64::from(k) * step);
            let (tuned, best_mm2) =
                each.map(|tuned| (tuned, gain(tuned))).max_by(|a, b| a.1.total_cmp(&b.1))?;
            let worth_it = best_mm2 - gain(1.0) > TUNED * noise.long_run_mm2;
            worth_it.then_some((b, run, tuned))
        })
        .collect();
    for (b, run, tuned) in &found {
        data.blocks[*b].tuned[*run] = *tuned;
    }
    data.tuned = !found.is_empty();
    data.tuned
}

/// One spectrum a run.
fn spectra(data: &Data, seat: Seat, planner: &mut FftPlanner<f64>) -> Vec<Spectrum> {
    let mut spectra = Vec::new();
    for (block, left_mm) in data.blocks.iter().zip(&data.left_mm) {
        for run in &block.runs {
            let samples = &block.samples[run.clone()];
            let Some(period_s) = period_s(samples.iter().map(|s| s.situation.motion.elapsed_s))
            else {
                continue;
            };
            let first_s = samples[0].situation.motion.elapsed_s;
            let place = |elapsed_s: f64| ((elapsed_s - first_s) / period_s).round() as usize;
            let last = samples.last().map_or(0, |s| place(s.situation.motion.elapsed_s));
            let length = (2 * (last + 1)).next_power_of_two();
            let mut signal = vec![Complex::new(0.0, 0.0); length];
            let mut squares = 0.0;
            for (sample, left) in samples.iter().zip(&left_mm[run.clone()]) {
                let worth = seat.sensitivity(&sample.situation) * sample.root_weight;
                signal[place(sample.situation.motion.elapsed_s).min(length - 1)].re += worth * left;
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
fn period_s(times_s: impl Iterator<Item = f64>) -> Option<f64> {
    let times_s: Vec<f64> = times_s.collect();
    let mut steps: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().filter(|step| *step > 0.0)
}

/// Spectra of the same sample rate.
fn groups(spectra: &[Spectrum]) -> Vec<Vec<&Spectrum>> {
    let mut groups: Vec<Vec<&Spectrum>> = Vec::new();
    for spectrum in spectra {
        let same = |group: &&mut Vec<&Spectrum>| {
            (group[0].period_s / spectrum.period_s - 1.0).abs() < 0.01
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
