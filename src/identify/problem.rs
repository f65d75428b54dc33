//! The least squares that a fit came to rest at, for others to solve: residuals, their derivatives, and whose noise they have.
//!
//! Unknowns are the parameters of the model, through the exact chain, and what each run has for itself (offsets of legs, rates,
//! how the control drove), by their derivatives where the fit came to rest: beyond a vertex of the path nothing else is defined.
//! Samples, weights and noise are those of the fit. Residuals are in units of their standard deviations.

use super::fit::Fit;
use super::input::Options;
use super::result::Identification;
use super::timing::Detail;
use crate::align::Sample;
use crate::error::{Error, Kind, Result};
use crate::model::Model;
use crate::solve::{self, Truncation, Tsqr, dot};

/// A step that moves all unknowns together by less than this part of a standard deviation is none: rounding of the lengths leaves a tenth of that.
const AT_REST: f64 = 1e-7;
/// Five are usual; where offsets of the balls across the bar are hardly seen, each step is a share of the one before.
const MOST_STEPS: usize = 200;

/// One unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// Its name: that of a parameter, or a run's with what it is.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Where the fit came to rest.
    pub value: f64,
}

/// What a residual is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// A reading, on this stretch of neighbouring readings: their noise is correlated inside of a stretch alone.
    Reading(usize),
    /// The times of a run: an engagement, a standstill, the clock.
    Time,
    /// What is plausible of an unknown.
    Plausible,
}

/// A reading that takes part.
#[derive(Debug, Clone)]
struct Reading {
    run: usize,
    sample: Sample,
    /// Length of the bar with what the fit takes the control to cut off chords, mm.
    nominal_mm: f64,
    /// Change of the computed deviation with what the run has for itself, mm per unit.
    own: Vec<f64>,
    /// Root of the weight over the standard deviation, 1/mm.
    factor: f64,
}

/// A row about what a run has for itself, in units of its standard deviation.
#[derive(Debug, Clone)]
struct OwnRow {
    run: usize,
    by: Vec<f64>,
    rest: f64,
}

/// The least squares of a fit at rest.
#[derive(Debug, Clone)]
pub struct Problem {
    unknowns: Vec<Unknown>,
    about: Vec<About>,
    /// Index of the mounting of each run.
    mountings: Vec<usize>,
    /// Number of the parameters of the model.
    parameters: usize,
    /// First unknown of each run.
    first: Vec<usize>,
    readings: Vec<Reading>,
    own: Vec<OwnRow>,
    /// Parameter, and the standard deviation of what it plausibly is.
    plausible: Vec<(usize, f64)>,
    bent: bool,
}

impl Identification {
    /// The least squares that this fit came to rest at; the model and the options are those of the fit.
    pub fn problem(&self, model: &Model, options: &Options) -> Problem {
        let mut fit = self.at_rest(model, options, self.counts_mm);
        fit.hold_lags();
        let mut problem = Problem {
            unknowns: Vec::new(),
            about: Vec::new(),
            mountings: fit.runs.iter().map(|run| run.mounting).collect(),
            parameters: fit.columns.coefficients,
            first: Vec::new(),
            readings: Vec::new(),
            own: Vec::new(),
            plausible: Vec::new(),
            bent: fit.state.bent,
        };
        for (parameter, value) in model.parameters().iter().zip(&fit.state.values) {
            let (name, unit) = (parameter.name.clone(), parameter.unit);
            problem.unknowns.push(Unknown { name, unit, value: *value });
        }
        let mut stretches = 0;
        for index in 0..fit.runs.len() {
            problem.first.push(problem.unknowns.len());
            problem.unknowns.extend(own_unknowns(&fit, index));
            stretches = problem.take_readings(&fit, index, stretches);
        }
        for index in 0..fit.runs.len() {
            problem.take_own(&fit, index);
        }
        let plausible = fit.state.plausible.iter().enumerate();
        problem.plausible = plausible.filter_map(|(k, sigma)| Some((k, (*sigma)?))).collect();
        problem.about.extend(problem.plausible.iter().map(|_| About::Plausible));
        problem
    }
}

impl Problem {
    /// The unknowns: the parameters of the model, then what each run has for itself.
    pub fn unknowns(&self) -> &[Unknown] {
        &self.unknowns
    }

    /// What the residuals are about, in their order: readings first.
    pub fn about(&self) -> &[About] {
        &self.about
    }

    /// Standard deviations that the readings counted with, mm, in their order.
    pub fn reading_sigmas_mm(&self) -> Vec<f64> {
        self.readings.iter().map(|reading| reading.factor.recip()).collect()
    }

    /// The residuals at these values of the unknowns, observed minus computed in standard deviations. The model is that of the fit.
    pub fn residuals(&self, model: &Model, values: &[f64]) -> Vec<f64> {
        let (parameters, _) = values.split_at(self.parameters);
        let mut residuals = Vec::with_capacity(self.about.len());
        for reading in &self.readings {
            let (sample, run) = (&reading.sample, reading.run);
            let length_mm =
                model.length_mm(parameters, &sample.pose, &sample.motion, self.mountings[run]);
            let computed_mm = length_mm - reading.nominal_mm;
            let left_mm = sample.deviation_mm - computed_mm - self.moved(run, &reading.own, values);
            residuals.push(reading.factor * left_mm);
        }
        for row in &self.own {
            residuals.push(row.rest - self.moved(row.run, &row.by, values));
        }
        residuals.extend(self.plausible.iter().map(|(k, sigma)| -values[*k] / sigma));
        residuals
    }

    /// The derivatives of the residuals (rows) by the unknowns (columns) at these values, row after row.
    pub fn jacobian(&self, model: &Model, values: &[f64]) -> Vec<f64> {
        let (parameters, _) = values.split_at(self.parameters);
        let mut jacobian = vec![0.0; self.about.len() * self.unknowns.len()];
        let mut rows = jacobian.chunks_exact_mut(self.unknowns.len().max(1));
        for (reading, row) in self.readings.iter().zip(&mut rows) {
            let (sample, mounting) = (&reading.sample, self.mountings[reading.run]);
            let (pose, motion) = (&sample.pose, &sample.motion);
            let situation = if self.bent {
                let errors = model.errors(parameters, pose, motion, mounting);
                model.situation_bent(&errors, pose, motion, mounting)
            } else {
                model.situation(pose, motion, mounting)
            };
            model.row(&situation, &mut row[..self.parameters]);
            let first = self.first[reading.run];
            row[first..first + reading.own.len()].copy_from_slice(&reading.own);
            for value in row {
                *value *= -reading.factor;
            }
        }
        for (own, row) in self.own.iter().zip(&mut rows) {
            let first = self.first[own.run];
            row[first..].iter_mut().zip(&own.by).for_each(|(to, by)| *to = -by);
        }
        for ((k, sigma), row) in self.plausible.iter().zip(&mut rows) {
            row[*k] = -sigma.recip();
        }
        jacobian
    }

    /// Gauss-Newton from these values to where nothing is left to gain.
    ///
    /// # Errors
    /// Where it does not come to rest: far away, or where the rows do not determine all unknowns.
    pub fn solve(&self, model: &Model, values: &[f64]) -> Result<Vec<f64>> {
        let count = self.unknowns.len();
        let mut values = values.to_vec();
        for _ in 0..MOST_STEPS {
            let mut rows = Tsqr::new(count);
            let jacobian = self.jacobian(model, &values);
            for (row, residual) in jacobian.chunks_exact(count).zip(self.residuals(model, &values))
            {
                rows.push(row, -residual);
            }
            let solution = solve::solve(&rows.finish()?, Truncation::Relative(f64::EPSILON))?;
            values.iter_mut().zip(solution.x()).for_each(|(value, step)| *value += step);
            let change = jacobian.chunks_exact(count).map(|row| dot(row, solution.x()).powi(2));
            if change.sum::<f64>().sqrt() < AT_REST {
                return Ok(values);
            }
        }
        Err(Error::new(
            Kind::Undetermined,
            format!("the least squares do not come to rest within {MOST_STEPS} steps"),
        )
        .hint("begin nearer to where the fit came to rest, or choose fewer terms"))
    }

    /// What a row about a run says of how far its own unknowns are from where the fit came to rest.
    fn moved(&self, run: usize, by: &[f64], values: &[f64]) -> f64 {
        let first = self.first[run];
        let own = first..first + by.len();
        let steps = values[own.clone()].iter().zip(&self.unknowns[own]);
        let steps: Vec<f64> = steps.map(|(value, unknown)| value - unknown.value).collect();
        dot(by, &steps)
    }

    /// Takes the readings of a run; returns the number of stretches so far.
    fn take_readings(&mut self, fit: &Fit, index: usize, mut stretches: usize) -> usize {
        let run = &fit.runs[index];
        let own = fit.columns.own(index);
        for stretch in fit.segments(index) {
            fit.each_row(index, &stretch.collect::<Vec<_>>(), Detail::Full, |k, row, _| {
                self.about.push(About::Reading(stretches));
                self.readings.push(Reading {
                    run: index,
                    sample: run.samples()[k],
                    nominal_mm: run.nominal_mm - run.alignment.time_map.cut_mm,
                    own: row[..own].to_vec(),
                    factor: fit.weight(index, k).sqrt() / fit.state.counts_mm(),
                });
            });
            stretches += 1;
        }
        stretches
    }

    /// Takes what is known of the times of a run, and what is plausible of how it was driven.
    fn take_own(&mut self, fit: &Fit, index: usize) {
        let own = fit.columns.own(index);
        let mut row = vec![0.0; own + self.parameters];
        fit.each_time_row(&mut row, index, |row, rest, sigma| {
            let by = row[..own].iter().map(|value| value / sigma).collect();
            self.own.push(OwnRow { run: index, by, rest: rest / sigma });
            self.about.push(About::Time);
        });
        for (column, value, sigma) in fit.driven(index) {
            let mut by = vec![0.0; own];
            by[column] = sigma.recip();
            self.own.push(OwnRow { run: index, by, rest: -value / sigma });
            self.about.push(About::Plausible);
        }
    }
}

/// What a run has for itself, in the order of its columns, as the fit has it.
fn own_unknowns(fit: &Fit, index: usize) -> Vec<Unknown> {
    let run = &fit.runs[index];
    let (columns, map) = (&fit.columns, &run.alignment.time_map);
    let mut unknowns = Vec::with_capacity(columns.own(index));
    let mut push = |what: String, unit: &'static str, value: f64| {
        unknowns.push(Unknown { name: format!("{}: {what}", run.name), unit, value });
    };
    for &leg in &columns.legs[index] {
        push(format!("offset of leg {}", leg + 1), "s", map.offsets_s[leg]);
    }
    push("clock rate".to_owned(), "s/s", map.rate);
    push("pace".to_owned(), "s/s", map.pace);
    push("following".to_owned(), "s", map.following_s);
    for (k, contrast) in columns.delays[index].iter().enumerate() {
        push(format!("delay {}", k + 1), "s", map.delays_s.dot(contrast));
    }
    for (k, contrast) in columns.longer[index].iter().enumerate() {
        push(format!("time constant {}", k + 1), "1", map.longer.dot(contrast));
    }
    if columns.cut(index).is_some() {
        push("cut".to_owned(), "mm", map.cut_mm);
    }
    if columns.rounded(index).is_some() {
        push("rounded".to_owned(), "1", map.rounded);
    }
    unknowns
}
