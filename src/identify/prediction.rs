//! How well a test will know its parameters, before it is run.
//!
//! **Rehearsal.** The programs of the test run on a perfect virtual machine, a perfect instrument writes
//! a log at the sample rate, and the log is aligned as every log is. What comes out is where each sample
//! will be taken and what the marks will tell of time. Nothing about it is a separate model of the test:
//! it is the way that the data will go.
//!
//! **Prediction.** The rows of the fit at these samples, with the stated noise, have the covariance
//!
//! `(J'J)^+ J' S J (J'J)^+`
//!
//! over coefficients and time maps together, with `S` the covariance of the noise (its correlation from
//! one reading to the next included); the fit states the same after a measurement, with the noise that
//! it has found.

use super::fit::Fit;
use super::input::{Options, RunInput};
use crate::align::{self, Part};
use crate::error::{Error, Kind, Result};
use crate::log;
use crate::machine::Machine;
use crate::model::{Model, Parameter};
use crate::nc::Program;
use crate::plan::{BallBar, NamedMounting};
use crate::simulate::{self, Pauses, Scenario};
use crate::solve::{self, Matrix, NoiseModel, NullDirection, Truncation, Tsqr};

/// What a pause's place in time is known to at the least before the fit, s; the fit does better.
const PAUSE_SIGMA_S: f64 = 0.02;
/// How long every operator's pause of a rehearsal is, s. The length does not matter to what is seen.
const PAUSE_S: f64 = 10.0;

/// The samples that a program will give, taken by a perfect instrument on a perfect machine.
///
/// # Errors
/// When the program does not engage the bar, or leaves its range.
pub fn rehearse(
    program: &Program,
    machine: &Machine,
    bar: &BallBar,
    index: usize,
    named: &NamedMounting,
) -> Result<RunInput> {
    let mounting = &named.mounting;
    let stops = program.stops();
    let pauses = Pauses::Fixed(vec![PAUSE_S; stops]);
    let scenario = Scenario { pauses, ..Scenario::perfect() };
    let run = simulate::run(machine, mounting, program, bar, &scenario)?;
    let log = log::read_bytes(run.csv().as_bytes(), &program.file, &log::Format::default())?;
    let rig = align::Rig { machine, mounting, bar };
    let mut alignment =
        align::align(&align::Run { log: &log, program, rig, feed_override: 1.0, driven: None })?;
    // A perfect machine hides where its pauses were; the fit of a real one finds them.
    let map = &mut alignment.time_map;
    let mut paused_s = 0.0;
    for leg in 0..map.offsets_s.len() {
        if leg > 0 && map.breaks()[leg - 1].operator {
            paused_s += PAUSE_S;
        }
        if map.offset_sigmas_s[leg].is_finite() {
            map.offsets_s[leg] = run.clock.start_s + paused_s;
            map.offset_sigmas_s[leg] = map.offset_sigmas_s[leg].min(PAUSE_SIGMA_S);
        }
    }
    map.rate = 0.0;
    Ok(RunInput::new(named.name.clone(), index, bar.length_mm, alignment))
}

/// The noise that a test file states: white, correlated (`correlated² · exp(-t / correlation)`), and the
/// steps of the reading, `resolution² / 12`; of a fast log that of the means that are looked at.
pub fn stated_noise(bar: &BallBar) -> NoiseModel {
    let (averaged, period_s) = align::averaged(bar.sample_rate_hz.recip());
    let white = bar.noise_mm.powi(2) - bar.correlated_mm.powi(2) + bar.resolution_mm.powi(2) / 12.0;
    let white = white / averaged as f64;
    let correlated = bar.correlated_mm.powi(2);
    // Until next to nothing of the correlation is left; an order beyond some hundred changes nothing.
    let lags = (10.0 * bar.correlation_s / period_s).ceil().min(200.0) as usize;
    let lags = if correlated > 0.0 { lags } else { 0 };
    let at = |lag: usize| {
        let white = if lag == 0 { white } else { 0.0 };
        white + correlated * (-(lag as f64) * period_s / bar.correlation_s).exp()
    };
    NoiseModel::of_autocovariances(&(0..=lags).map(at).collect::<Vec<f64>>())
}

/// What a test will know.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// The parameters of the model, in its order.
    pub parameters: Vec<Parameter>,
    /// Standard deviation of each, in its unit; read it with `observed`.
    pub sigmas: Vec<f64>,
    /// Their covariance.
    pub covariance: Matrix,
    /// How much of each the test determines: 1 all, 0 nothing, between: only together with others.
    pub observed: Vec<f64>,
    /// Rank over the parameters, by the noise.
    pub rank: usize,
    /// Condition number of the scaled columns over the observed directions.
    pub condition: f64,
    /// What is confounded, by index of parameter.
    pub null_directions: Vec<NullDirection>,
    /// Samples on arcs that the fit will use.
    pub samples: usize,
    /// The largest standard deviation of the time of one of them, s.
    pub worst_time_sigma_s: f64,
}

impl Prediction {
    /// Standard deviation of a parameter by name, in its unit; `None` where it is not among them or not
    /// determined by itself.
    pub fn sigma(&self, name: &str) -> Option<f64> {
        let k = self.parameters.iter().position(|p| p.name == name)?;
        (self.observed[k] > SEEN_ALONE).then_some(self.sigmas[k])
    }
}

/// A parameter is determined by itself if no more than rounding of it is not.
const SEEN_ALONE: f64 = 1.0 - 1e-6;

/// Predicts what rehearsed runs will know of the parameters of a model.
pub fn predict(
    model: &Model,
    runs: Vec<RunInput>,
    options: &Options,
    noise: &NoiseModel,
) -> Result<Prediction> {
    let mut fit = rehearsed_fit(model, runs, options, noise)?;
    let solution = fit.solve(&fit.rows()?)?;
    let covariance = solution.covariance_sandwich(&fit.filtered(noise)?)?;
    fit.state_times(&covariance);
    let covariance = covariance.shared;
    let solution = solution.shared();
    let used = || {
        let samples = fit.runs.iter().zip(&fit.state.apart);
        samples
            .flat_map(|(run, apart)| run.samples().iter().zip(apart))
            .filter(|(_, apart)| apart.is_none())
    };
    let mut null_directions = solution.spectrum().null_directions(solution.rank(), 0.02);
    null_directions.sort_by_key(|direction| direction.parts.first().map(|part| part.0));
    Ok(Prediction {
        parameters: model.parameters().to_vec(),
        sigmas: solve::standard_deviations(&covariance),
        covariance,
        observed: solution.observed_fraction(),
        rank: solution.rank(),
        condition: solution.spectrum().condition_of(solution.rank()),
        null_directions,
        samples: used().count(),
        worst_time_sigma_s: used().map(|(s, _)| s.time_sigma_s).fold(0.0, f64::max),
    })
}

/// What a test will know of parameters of which something is known beforehand.
///
/// With the prior `x_k = 0 ± prior_k` the estimate has the error covariance
/// `G J'SJ G + G P G`, `G = (J'J + P)^-1`, `P = diag(1 / prior_k²)` in units of the noise: the first part
/// comes from the noise, the second is what the test leaves as unknown as it was. Returned in this
/// order, in the units of the parameters, squared.
pub fn predict_with_prior(
    model: &Model,
    runs: Vec<RunInput>,
    options: &Options,
    noise: &NoiseModel,
    priors: &[f64],
) -> Result<[Matrix; 2]> {
    let mut fit = rehearsed_fit(model, runs, options, noise)?;
    // What is asked for is what faults of the machine leave open.
    fit.columns.as_planned = true;
    let mut prior = Tsqr::new(fit.columns.coefficients);
    for (column, &sigma) in priors.iter().enumerate() {
        prior.push_prior(column, 0.0, sigma);
    }
    let prior = prior.finish()?;
    let rows = fit.rows()?.with_known(&prior)?;
    // The priors leave no direction undetermined.
    let solution = rows.solve(&fit.references(&rows), Truncation::Relative(f64::EPSILON))?;
    let of_noise = solution.covariance_sandwich(&fit.filtered(noise)?)?.shared;
    Ok([of_noise, solution.shared().covariance_sandwich(&prior)])
}

pub(super) fn rehearsed_fit<'a>(
    model: &'a Model,
    runs: Vec<RunInput>,
    options: &'a Options,
    noise: &NoiseModel,
) -> Result<Fit<'a>> {
    let on_arcs =
        |run: &RunInput| run.samples().iter().any(|sample| matches!(sample.part, Part::Arc(_)));
    if let Some(run) = runs.iter().find(|run| !on_arcs(run)) {
        return Err(Error::new(
            Kind::Undetermined,
            format!("run `{}` gives no sample on an arc", run.name),
        )
        .hint("a program must drive the sphere with the bar in its range"));
    }
    let mut fit = Fit::of(model, runs, options);
    fit.state.sigma_mm = noise.sigma();
    // As a fit has it that is near.
    fit.state.bent = true;
    fit.foresee_times()?;
    Ok(fit)
}
