//! The joint fit of coefficients and time maps.

use super::columns::Columns;
use super::facets::Look;
use super::input::{Options, RunInput};
use super::result::Identification;
use super::state::{IMPLAUSIBLE, State, Taking, apart};
use super::{timing, words};
use crate::align::Part;
use crate::error::{Error, Kind, Result};
use crate::model::{Model, ParameterId};
use crate::solve::Loss;
use crate::solve::{self, Bordered, BorderedCovariance, BorderedSolution, Solution, Unknowns};

/// Readings that a fit needs where what is plausible determines the rest: those of a plane decide 16 numbers, and as many are
/// left for the noise.
const FEWEST_KNOWN: usize = 32;
/// Neither a clock nor a feed is farther off than this, as a share of 1: beyond, a step has gone astray.
const FARTHEST: f64 = 0.05;
/// Slides that follow later than this do not hold a circle, s.
const LONGEST_S: f64 = 0.1;

/// Identifies the parameters of a model from runs of one machine in one state.
///
/// # Errors
/// When the selection is rank-deficient and `minimum_norm` is off, with the combinations that cannot
/// be told apart; when there are fewer samples than parameters; when the fit does not converge. A fit
/// that converges and does not explain the log has [`Identification::cautions`].
pub fn identify(model: &Model, runs: Vec<RunInput>, options: &Options) -> Result<Identification> {
    let with = |runs: &[RunInput], taking: Taking| {
        let mut fit = Fit::of(model, runs.to_vec(), options);
        fit.check_enough()?;
        fit.state.taking = taking;
        let mut steps = 0;
        let outcome = fit.find(&mut steps)?;
        fit.weighed(outcome, steps)
    };
    let knows = model.parameters().iter().any(|parameter| parameter.plausible.is_some());
    // Where some readings do not settle, all may.
    let found = |runs: &[RunInput]| {
        if knows && stands_for_several(runs) {
            with(runs, Taking::OneForSeveral).or_else(|_| with(runs, Taking::Each))
        } else {
            with(runs, Taking::Each)
        }
    };
    // What the model does not have may be taken for a feed far from the truth, and a fit that runs after it never settles, or
    // rests where engagement and release do not allow.
    let free = found(&runs);
    let held = free.as_ref().map_or(Some(0.0), Identification::feeds_held);
    let Some(off) = held else { return free };
    let at_feed: Vec<RunInput> = runs.into_iter().map(|run| run.at_feed(off)).collect();
    found(&at_feed).or(free)
}

/// What a model leaves of runs, mm rms of a reading: sought with as few readings as tell it, and nothing else said.
///
/// # Errors
/// As for [`identify`].
pub(super) fn leaves_mm(model: &Model, runs: Vec<RunInput>, options: &Options) -> Result<f64> {
    let mut fit = Fit::of(model, runs, options);
    fit.check_enough()?;
    fit.state.taking = fit.state.seeks();
    fit.find(&mut 0)?;
    Ok(fit.state.sigma_mm)
}

/// The same as far as the smooth path tells, without the way to its chords: a first look, in a part of the time.
///
/// # Errors
/// As for [`identify`].
pub(super) fn leaves_roughly_mm(
    model: &Model,
    runs: Vec<RunInput>,
    options: &Options,
) -> Result<f64> {
    let mut fit = Fit::of(model, runs, options);
    fit.check_enough()?;
    fit.state.taking = fit.state.seeks();
    fit.runs.iter_mut().for_each(|run| run.alignment.look_up_means());
    fit.iterate(timing::Detail::Smooth)?;
    Ok(fit.state.sigma_mm)
}

/// Identifies runs from where an identification of them came to rest: with a model or readings that hardly differ from its own.
///
/// # Errors
/// As for [`identify`].
pub(super) fn identify_on(
    model: &Model,
    runs: Vec<RunInput>,
    from: &Identification,
    options: &Options,
) -> Result<Identification> {
    let mut fit = Fit::of(model, runs, options);
    fit.state.values = from.values();
    fit.state.sigma_mm = from.rms_mm.max(1e-3 * options.noise_mm);
    fit.state.correlated = (from.counts_mm / fit.state.sigma_mm).max(1.0);
    (fit.state.came_to_rest, fit.state.bent, fit.state.taking) = (true, true, fit.state.seeks());
    let outcome = fit.iterate(timing::Detail::Full)?;
    fit.weighed(outcome, 0)
}

/// A time constant after a step that its slope over some time asks for, s: what slides do that follow goes with its square,
/// and a slope is right as far as it was taken.
fn followed_s(following_s: f64, step_s: f64, over_s: f64) -> f64 {
    if step_s > over_s {
        (following_s.powi(2) + (2.0 * following_s + over_s) * step_s).sqrt()
    } else {
        following_s + step_s
    }
}

/// What is more than plausible is given so many times the room: the readings have shown that they know better.
const WIDER: f64 = 10.0;

/// Whether any reading of these runs stands for several while a fit is sought.
fn stands_for_several(runs: &[RunInput]) -> bool {
    runs.iter().any(|run| timing::standing_for(run.samples().len(), Taking::OneForSeveral).0 > 1)
}

/// The end of one round of Gauss-Newton.
pub(super) struct Outcome {
    pub(super) solution: BorderedSolution,
    pub(super) steps: usize,
}

/// Runs that a model is fitted to, and where the fit stands.
pub(super) struct Fit<'a> {
    pub(super) model: &'a Model<'a>,
    pub(super) options: &'a Options,
    pub(super) columns: Columns,
    pub(super) runs: Vec<RunInput>,
    pub(super) state: State,
}

impl<'a> Fit<'a> {
    /// A fit that has not begun: all parameters zero, the noise as stated.
    pub(super) fn of(model: &'a Model<'a>, runs: Vec<RunInput>, options: &'a Options) -> Self {
        let state = State {
            values: vec![0.0; model.parameters().len()],
            sigma_mm: options.noise_mm,
            correlated: 1.0,
            plausible: model.parameters().iter().map(|p| p.plausible).collect(),
            settled: true,
            came_to_rest: false,
            bent: false,
            taking: Taking::Each,
            at_once: vec![false; runs.len()],
            apart: apart(&runs, timing::Detail::Full.guard_s()),
            weights: None,
        };
        Self::at(model, runs, options, state)
    }

    /// A fit that stands somewhere.
    pub(super) fn at(
        model: &'a Model<'a>,
        runs: Vec<RunInput>,
        options: &'a Options,
        state: State,
    ) -> Self {
        let numbered = runs.into_iter().enumerate().map(|(number, run)| run.numbered(number));
        let runs: Vec<RunInput> = numbered.collect();
        let columns = Columns::new(model, &runs);
        Self { model, options, columns, runs, state }
    }

    fn check_enough(&self) -> Result<()> {
        let samples: usize = self
            .runs
            .iter()
            .flat_map(RunInput::samples)
            .filter(|s| matches!(s.part, Part::Arc(_)))
            .count();
        // What is plausible determines what the readings do not.
        let open = self.state.plausible.iter().filter(|plausible| plausible.is_none()).count();
        let least =
            if self.state.knows() { FEWEST_KNOWN.max(2 * open) } else { 2 * self.columns.total() };
        if samples > least {
            return Ok(());
        }
        Err(Error::new(
            Kind::Undetermined,
            format!(
                "{samples} samples on arcs cannot determine {} parameters",
                self.columns.total()
            ),
        )
        .hint("check that the log covers the program, or choose fewer terms"))
    }

    /// Comes to rest from where the alignment laid the readings.
    fn find(&mut self, steps: &mut usize) -> Result<Outcome> {
        if self.coarse_legs() { self.find_times(steps) } else { self.iterate(timing::Detail::Full) }
    }

    /// The end of a fit whose times are found: far-off readings weighed down, what is plausible weighed against the readings.
    fn weighed(mut self, mut outcome: Outcome, mut steps: usize) -> Result<Identification> {
        if self.options.loss != Loss::Off {
            for _ in 0..10 {
                self.reweigh();
                outcome = self.iterate(timing::Detail::Full)?;
                steps += outcome.steps;
                if outcome.steps <= 1 {
                    break;
                }
            }
        }
        if self.state.knows() {
            outcome = self.weigh_against_plausible(outcome)?;
        }
        steps += outcome.steps;
        self.finish(&outcome, steps)
    }

    /// Fits again with readings that count for as much as they do although neighbours err alike, and with what came
    /// out beyond what is plausible let go.
    fn weigh_against_plausible(&mut self, mut outcome: Outcome) -> Result<Outcome> {
        // The more is taken for noise the more is left, and the more noise there seems to be: it is never more than
        // readings left that counted for all they are.
        let (mut least, most_mm) = (f64::INFINITY, self.state.sigma_mm);
        self.state.bent = true;
        for round in 0..2 {
            least = least.min(self.correlated(&self.left_mm(), &outcome)?);
            self.state.correlated = least;
            if round == 0 {
                self.let_go();
            }
            // Times that were too uncertain for single chords may be told by now.
            self.find_facets(Look::Again);
            outcome = self.iterate_anew()?;
            self.state.sigma_mm = self.state.sigma_mm.min(most_mm);
        }
        let sought = std::mem::replace(&mut self.state.taking, Taking::Each);
        if sought == Taking::OneForSeveral && stands_for_several(&self.runs) {
            outcome = self.iterate_anew()?;
            self.state.sigma_mm = self.state.sigma_mm.min(most_mm);
        }
        Ok(outcome)
    }

    /// Comes to rest again where slides that were held at once may follow late after all.
    fn iterate_anew(&mut self) -> Result<Outcome> {
        self.state.at_once.fill(false);
        self.iterate(timing::Detail::Full)
    }

    /// Widens, once, what is plausible of what came out far beyond it: of an error that bends more than is plausible in
    /// one way, all ways to bend.
    fn let_go(&mut self) {
        let parameters = self.model.parameters();
        let of = |k: usize| match parameters[k].id {
            ParameterId::Local(local) => (Some((local.slide, local.component)), None),
            _ => (None, Some(k)),
        };
        let beyond = |k: &usize| {
            let sigma = self.state.plausible[*k].unwrap_or(f64::INFINITY);
            self.state.values[*k].abs() > IMPLAUSIBLE * sigma
        };
        let implausible: Vec<_> = (0..parameters.len()).filter(beyond).map(of).collect();
        for (k, plausible) in self.state.plausible.iter_mut().enumerate() {
            if implausible.contains(&of(k)) {
                *plausible = plausible.map(|sigma| WIDER * sigma);
            }
        }
    }

    pub(super) fn solve(&self, rows: &Bordered) -> Result<BorderedSolution> {
        rows.solve(&self.references(rows), self.truncation(rows.rows()))
    }

    /// Rows of the full detail.
    pub(super) fn rows(&self) -> Result<Bordered> {
        self.factor(timing::Detail::Full)
    }

    /// States the uncertainties of the times before a measurement: which samples take part hangs on the
    /// times, and how well the times are known on which samples take part.
    pub(super) fn foresee_times(&mut self) -> Result<()> {
        for _ in 0..2 {
            self.state.apart = apart(&self.runs, timing::Detail::Full.guard_s());
            let covariance = self.solve(&self.rows()?)?.covariance_unscaled();
            self.state_times(&covariance);
        }
        self.state.apart = apart(&self.runs, timing::Detail::Full.guard_s());
        Ok(())
    }

    /// Takes the uncertainties of the time maps from the covariance of all columns.
    pub(super) fn state_times(&mut self, covariance: &BorderedCovariance) {
        for (index, run) in self.runs.iter_mut().enumerate() {
            let own = &covariance.own[index];
            self.columns.state_uncertainty(index, &mut run.alignment.time_map, own);
            run.state_sigmas();
        }
    }

    /// Takes a step in coefficients and time maps.
    pub(super) fn apply(&mut self, step: &Unknowns, solution: &BorderedSolution) {
        let covariance = solution.covariance_unscaled();
        for (value, change) in self.state.values.iter_mut().zip(&step.shared) {
            *value += change;
        }
        for (index, run) in self.runs.iter_mut().enumerate() {
            let (map, step) = (&mut run.alignment.time_map, &step.own[index]);
            let clamped = |value: f64| value.clamp(-FARTHEST, FARTHEST);
            map.rate = clamped(map.rate + step[self.columns.rate(index)]);
            map.pace = clamped(map.pace + step[self.columns.pace(index)]);
            let was_s = map.following_s;
            let over_s = run.following_step_s;
            let following_s = followed_s(was_s, step[self.columns.following(index)], over_s);
            map.following_s =
                if self.state.at_once[index] { 0.0 } else { following_s.clamp(0.0, LONGEST_S) };
            // What a share of the time constant does grows with the square of that, too.
            let less =
                if map.following_s > was_s { (was_s / map.following_s).powi(2) } else { 1.0 };
            for (column, contrast) in self.columns.delays(index).zip(&self.columns.delays[index]) {
                let delays_s = map.delays_s + step[column] * contrast;
                map.delays_s = delays_s.map(|s| s.clamp(-LONGEST_S, LONGEST_S));
            }
            for (column, contrast) in self.columns.longer(index).zip(&self.columns.longer[index]) {
                let longer = map.longer + less * step[column] * contrast;
                map.longer = longer.map(|share| share.clamp(-timing::FARTHEST, timing::FARTHEST));
            }
            if let Some(cut) = self.columns.cut(index) {
                map.cut_mm += step[cut];
            }
            if let Some(column) = self.columns.rounded(index) {
                let own = &covariance.own[index];
                map.round_out(step[column], own[(column, column)].max(0.0).sqrt());
            }
            for (change_s, &leg) in step.iter().zip(&self.columns.legs[index]) {
                // No step beyond a few seconds: far from the truth the derivative is not to be trusted.
                map.offsets_s[leg] += change_s.clamp(-3.0, 3.0);
            }
            self.columns.state_uncertainty(index, map, &covariance.own[index]);
        }
        self.place_taken();
    }

    pub(super) fn refuse_deficient(&self, solution: &Solution) -> Result<()> {
        let missing = self.columns.coefficients - solution.rank();
        if missing == 0 || self.options.minimum_norm || self.state.knows() {
            return Ok(());
        }
        let parameters = self.model.parameters();
        let mut directions = solution.spectrum().null_directions(solution.rank(), 0.02);
        // In the order of the names: rounding must not decide the order of a message.
        directions.sort_by_key(|direction| direction.parts.first().map(|part| part.0));
        let sentences: Vec<String> = directions
            .iter()
            .map(|direction| format!("\n  {}", words::sentence(direction, parameters)))
            .collect();
        Err(Error::new(
            Kind::Undetermined,
            format!(
                "{missing} of the {} chosen parameters cannot be told from the others in these runs:{}",
                self.columns.coefficients,
                sentences.concat()
            ),
        )
        .hint(format!(
            "leave one of each group out, such as by adding `{}` to `terms`, or ask for the minimum norm (`minimum_norm = true`)",
            words::leave_out(&directions, parameters).join("`, `")
        )))
    }

    /// Robust weights from the present residuals.
    fn reweigh(&mut self) {
        let loss = self.options.loss;
        if loss == Loss::Off {
            return;
        }
        let left_mm = self.left_mm();
        let apart = self.state.apart.iter().flatten();
        let used = left_mm.iter().flatten().zip(apart).filter(|(_, apart)| apart.is_none());
        let Some(scale) = solve::robust_scale(&mut used.map(|(left, _)| *left).collect::<Vec<_>>())
        else {
            return;
        };
        let weigh = |left_mm: &f64| loss.weight(left_mm / scale);
        self.state.weights =
            Some(left_mm.iter().map(|run| run.iter().map(weigh).collect()).collect());
        self.state.sigma_mm = scale;
    }
}
