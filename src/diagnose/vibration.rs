//! Lines in the spectrum of the residuals, and which frequencies they may be aliases of.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::data::Data;
use super::element::{Element, Owner};
use super::screen::Candidate;
use crate::machine::Axis;
use crate::model::{Ball, Form, Kind, Seat, SetUp, Shape};

/// Slower than this is no vibration, Hz.
const SLOWEST_HZ: f64 = 0.05;
/// Lines of one direction and one sample rate that are looked at closely.
const LINES: usize = 2;
/// Aliases up to so many times the sample rate.
const FOLDS: usize = 3;

/// What a run's residuals hold at every frequency.
struct Spectrum {
    /// Sample period, s.
    period_s: f64,
    /// Gain of a line, mm², one a bin of `resolution_hz`.
    gains_mm2: Vec<f64>,
    resolution_hz: f64,
}

impl Spectrum {
    /// The gain at a frequency, which may be above half the sample rate, mm².
    fn at(&self, frequency_hz: f64) -> f64 {
        let folds = frequency_hz * self.period_s;
        let inside = (folds - folds.round()).abs() / self.period_s;
        let bin = (inside / self.resolution_hz).round() as usize;
        let around = bin.saturating_sub(1)..=bin + 1;
        around.filter_map(|k| self.gains_mm2.get(k)).copied().fold(0.0, f64::max)
    }
}

/// The strongest lines of every direction, with the frequencies that they may be aliases of.
pub(super) fn candidates(data: &Data) -> Vec<Candidate> {
    let cause = Kind::Vibration.cause();
    let balls = Axis::ALL.map(|axis| Seat::Ball(SetUp { ball: Ball::Tool, axis }));
    let mut found = Vec::new();
    let mut planner = FftPlanner::new();
    for seat in balls.into_iter().chain([Seat::Bar]) {
        let spectra = spectra(data, seat, &mut planner);
        let mut lines: Vec<(f64, f64)> = Vec::new();
        for of in groups(&spectra) {
            lines.extend(strongest(&of));
        }
        let mut tried: Vec<Candidate> = Vec::new();
        for (line_hz, period_s) in lines {
            for fold in 0..=FOLDS {
                let of_fold = fold as f64 / period_s;
                for frequency_hz in [of_fold + line_hz, of_fold - line_hz] {
                    if frequency_hz < SLOWEST_HZ {
                        continue;
                    }
                    let gain_mm2 = spectra.iter().map(|s| s.at(frequency_hz)).sum();
                    let shape = Shape { cause, seat, inner: Some(frequency_hz) };
                    let element = Element { form: Form::Cause(shape), owner: Owner::EachRun };
                    tried.push(Candidate { element, gain_mm2 });
                }
            }
        }
        // The lowest of aliases that explain the same comes first.
        tried.sort_by(|a, b| b.gain_mm2.total_cmp(&a.gain_mm2));
        tried.truncate(LINES * 2);
        found.extend(tried);
    }
    found
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

/// Frequency (Hz) and sample period (s) of the strongest lines of a group.
fn strongest(group: &[&Spectrum]) -> Vec<(f64, f64)> {
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
    let of = |bin: usize| (bin as f64 * first.resolution_hz, first.period_s);
    lines.into_iter().take(LINES).map(of).collect()
}
