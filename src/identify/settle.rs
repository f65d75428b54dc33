//! Gauss-Newton: the steps of a fit until it comes to rest.

use super::fit::{Fit, Outcome};
use super::timing;
use crate::align::TimeMap;
use crate::error::{Error, Kind, Result};
use crate::solve::{Bordered, BorderedSolution, Unknowns};

/// Most Gauss-Newton steps, halvings among them; ten are usual.
const MOST_STEPS: usize = 40;
/// A step is the last that moves all parameters together by less than this part of a standard deviation, the root of what
/// it should lower the sum of squares by, in units of the noise; or that lowered it by no more. Of a hundred parameters
/// the noise moves them together by ten.
const NEGLIGIBLE: f64 = 0.3;
/// A fit whose last step still changes the computed readings by less than this part of what is left of them is a result
/// all the same: vertices of a path that is driven otherwise than planned keep its times from settling for good.
const NEARLY: f64 = 0.05;
/// A step that makes the sum of squares more is halved; near its end, so often: vertices and reversals, which have no
/// slope, leave nothing to gain there.
const MOST_HALVINGS: i32 = 2;
/// And anywhere: where a sixtieth of a step leads up, none leads down.
const NO_WAY_DOWN: i32 = 6;
/// The sum of squares may rise, but not above what it was so many steps ago: chords have valleys of their own, and the
/// way out of one leads over its edge.
const LATELY: usize = 5;
/// After so many steps only down: a time that goes to and fro over a vertex of the path would do so for ever.
const DOWNHILL_AFTER: usize = MOST_STEPS / 2;
/// And after so many where the fit has come to rest before and only counts its readings otherwise: it is in the right valley.
const DOWNHILL_AGAIN_AFTER: usize = LATELY;
/// Where readings are chosen anew sums of squares do not compare, but no choice makes so many times more of what is left of one: such a
/// step has taken readings over a reversal, and is halved like others. By trial: where none has, what is left grows by a sixth at most.
const ASTRAY: f64 = 2.0;
/// A place that is tried is given up where the linear problem leaves this much more there than it should while its readings are chosen.
const HOPELESS: f64 = 1.05;
/// And then a fit is at rest whose sum of squares the last steps together lowered by less than this, in units of the noise:
/// what the noise moves a single parameter by.
pub(super) const HARDLY: f64 = 1.0;
/// As long as a step moves any time by this much, s, the samples that take part are chosen anew, and warily: a control
/// may do everything this much later than planned, and a sample on the wrong side of a reversal pulls its time there.
const MOVES_S: f64 = 0.005;
/// What is kept from reversals until then, s.
const WARY_S: f64 = 0.05;
/// Steps in which the noise is found.
const FINDING_STEPS: usize = 2;
/// And in which samples are chosen anew in any case.
const CHOOSING_STEPS: usize = 3;

/// The least that may come to be left, of what the last two steps left: it falls ever more slowly, and what so many steps like the
/// last would not do, none will. While readings are chosen steps do not compare.
fn coming(earlier: f64, now: f64, choosing: bool) -> f64 {
    if choosing { now / HOPELESS } else { now - LATELY as f64 * (earlier - now).max(0.0) }
}

/// Where a fit stood before a step.
struct Stand {
    /// Root of the mean square of what was left of a reading there, mm.
    left_mm: f64,
    /// The step from there.
    step: Unknowns,
    /// The solution that it comes from.
    solution: BorderedSolution,
    /// What is left of a reading after it, in units of the assumed noise.
    scatter: f64,
    /// Whether the step changes the computed readings by little of that.
    near: bool,
    values: Vec<f64>,
    maps: Vec<TimeMap>,
}

impl Fit<'_> {
    /// Gauss-Newton until the change is negligible.
    pub(super) fn iterate(&mut self, detail: timing::Detail) -> Result<Outcome> {
        self.iterate_below(detail, f64::INFINITY)
    }

    /// The same where more than this left, mm rms, is of no use.
    ///
    /// # Errors
    /// Where it does not settle, or comes to leave more.
    pub(super) fn iterate_below(
        &mut self,
        detail: timing::Detail,
        most_mm: f64,
    ) -> Result<Outcome> {
        let mut guard_s = detail.guard_s();
        let outcome = self.descend(detail, most_mm, &mut guard_s)?;
        self.place_others(guard_s);
        Ok(outcome)
    }

    /// The steps themselves. Only readings that take part are laid anew after each; what was kept from reversals in the end, s, is
    /// told.
    fn descend(
        &mut self,
        detail: timing::Detail,
        most_mm: f64,
        guard_s: &mut f64,
    ) -> Result<Outcome> {
        let downhill_after = if self.state.bent { DOWNHILL_AGAIN_AFTER } else { DOWNHILL_AFTER };
        let mut kept: Option<Stand> = None;
        // And whether no part of a step leads down.
        let (mut halvings, mut stuck) = (0, false);
        // So much of a step leads down, where only down counts: among vertices the way down is shorter than the slope says.
        let mut part = 1.0_f64;
        let mut before: Option<Unknowns> = None;
        // What was left of a reading lately, mm.
        let mut lately_mm: Vec<f64> = Vec::new();
        let mut last_scatter = f64::INFINITY;
        let mut chosen_s = Vec::new();
        // So far the times may move before samples are chosen anew.
        let mut held_s = detail.guard_s();
        let mut wary = detail == timing::Detail::Full && !self.state.came_to_rest;
        for steps in 1..=MOST_STEPS {
            // Chosen while the times still move, then held: a sample that comes and goes at a reversal would keep the fit
            // from settling. One that has gone over a reversal is on the wrong side of it, and does not come back.
            let moved_s = self.moved_s(&chosen_s);
            let choosing = wary || steps <= CHOOSING_STEPS || moved_s > held_s;
            let mut compares = true;
            if choosing {
                let was_wary = wary;
                let came_to_rest = wary && (stuck || steps > FINDING_STEPS && moved_s < MOVES_S);
                self.state.came_to_rest |= came_to_rest;
                wary = wary && !came_to_rest && steps < downhill_after;
                // Times that hardly anything tells go to and fro for ever: what is kept from reversals is then so much that they may.
                let restless = steps > downhill_after;
                *guard_s = self.guard_s(detail, wary || restless);
                held_s = if restless { *guard_s } else { detail.guard_s() };
                self.choose(*guard_s, wary || came_to_rest || steps <= CHOOSING_STEPS);
                // Chosen by another rule they are other readings.
                compares = was_wary == wary && steps > CHOOSING_STEPS;
                chosen_s = self.times_s();
            }
            let rows = self.factor(detail)?;
            let count = self.counted(&rows);
            let counts_mm = self.state.counts_mm();
            let left_mm = counts_mm * rows.rhs_norm() / count.sqrt();
            // Of as many readings as take part now: some may have been left out since.
            let above = |earlier_mm: f64| {
                count * (earlier_mm.powi(2) - left_mm.powi(2)) / counts_mm.powi(2)
            };
            let negligible = (NEGLIGIBLE * self.state.correlated).powi(2);
            let remembered = if steps > downhill_after { 1 } else { LATELY };
            let highest_mm = lately_mm.iter().rev().take(remembered).copied().fold(0.0, f64::max);
            let worse = if compares {
                -above(highest_mm) > negligible
            } else {
                kept.as_ref().is_some_and(|stand| left_mm > ASTRAY * stand.left_mm)
            };
            if !compares {
                lately_mm.clear();
                kept = kept.filter(|_| worse);
            }
            // What the last step lowered the sum of squares by.
            let gained = kept.as_ref().map(|stand| above(stand.left_mm));
            if let Some(stand) = kept.take_if(|_| worse) {
                if self.less_far(&stand, &mut halvings) {
                    lately_mm.resize(lately_mm.len().max(1), stand.left_mm);
                    kept = Some(stand);
                } else if wary {
                    (halvings, stuck) = (0, true);
                } else {
                    return Ok(self.settled(stand, steps));
                }
                continue;
            }
            let solution = self.solve(&rows)?;
            self.refuse_deficient(solution.shared())?;
            // While the times still move, nobody knows.
            if detail == timing::Detail::Full && !choosing && self.stop_at_once(solution.unknowns())
            {
                kept = None;
                continue;
            }
            let solution = self.held_within_bounds(&rows, solution)?;
            if steps > downhill_after {
                part *= 0.5_f64.powi(halvings);
            }
            let step = solution.unknowns().times(part);
            // Rows are in units of the assumed noise: their rms corrects it.
            let scatter = self.state.correlated * solution.shared().residual_norm() / count.sqrt();
            let coming = coming(std::mem::replace(&mut last_scatter, scatter), scatter, choosing);
            if steps > FINDING_STEPS && self.state.sigma_mm * coming > most_mm {
                return Err(Error::new(Kind::Undetermined, "more is left than elsewhere"));
            }
            let before_lately = lately_mm.len().checked_sub(LATELY).map(|k| lately_mm[k]);
            let rests = steps > downhill_after
                && before_lately.is_some_and(|earlier| above(earlier) < HARDLY);
            let gains_nothing =
                rests || !choosing && gained.is_some_and(|g| g.abs() < negligible) && halvings == 0;
            halvings = 0;
            let [near, enough] = comes_near(detail, rows.change(&step), scatter, count);
            // To and fro, over a vertex or from one choice of samples to the next, is told by the steps themselves.
            let back = before.is_some_and(|last| takes_back(&rows, &last, &step));
            let step = step.times(if back { 0.5 } else { 1.0 });
            before = Some(step.clone());
            let stand = self.stand(left_mm, step, solution, scatter, near);
            self.apply(&stand.step, &stand.solution);
            if !wary && (gains_nothing || enough) {
                return Ok(self.settled(stand, steps));
            }
            // The smooth fit only has to come near, and a fit that still moves by a little of the noise is
            // a result.
            if steps == MOST_STEPS && near {
                return Ok(self.hardly_settled(stand, detail));
            }
            self.find_noise(steps, stand.scatter);
            lately_mm.push(stand.left_mm);
            kept = Some(stand);
        }
        // The last steps may have been halved.
        let Some(stand) = kept.filter(|stand| stand.near) else { return Err(unsettled()) };
        self.stand_at(&stand);
        Ok(self.hardly_settled(stand, detail))
    }

    /// The noise that the first steps left, until it is known how neighbours err alike.
    fn find_noise(&mut self, steps: usize, scatter: f64) {
        if steps <= FINDING_STEPS && self.state.correlated <= 1.0 {
            let least_mm = 1e-3 * self.options.noise_mm;
            self.state.sigma_mm = (self.state.sigma_mm * scatter).max(least_mm);
        }
    }

    /// Takes half as much of a step as before, from where it began; whether there is less to take, or it stands there again.
    fn less_far(&mut self, stand: &Stand, halvings: &mut i32) -> bool {
        // A time that steps over a vertex of the path comes back with the next step, and so for ever.
        let enough = if stand.near { MOST_HALVINGS } else { NO_WAY_DOWN };
        if *halvings >= enough {
            self.stand_at(stand);
            return false;
        }
        self.recall(stand);
        *halvings += 1;
        self.apply(&stand.step.times(0.5_f64.powi(*halvings)), &stand.solution);
        true
    }

    /// What is kept from reversals, s: warily or not. Until it is known how neighbours err alike, times are less certain than they
    /// seem.
    fn guard_s(&self, detail: timing::Detail, wary: bool) -> f64 {
        let unweighed = self.state.knows() && !self.state.bent;
        if wary || unweighed { WARY_S.max(detail.guard_s()) } else { detail.guard_s() }
    }

    /// Holds the slides of runs that would follow ahead of time, if they do not follow late already; whether any were
    /// not held before.
    fn stop_at_once(&mut self, step: &Unknowns) -> bool {
        let mut newly = false;
        for (index, run) in self.runs.iter().enumerate() {
            let ahead = step.own[index][self.columns.following(index)] < 0.0;
            if ahead && run.alignment.time_map.following_s <= 0.0 && !self.state.at_once[index] {
                self.state.at_once[index] = true;
                newly = true;
            }
        }
        newly
    }

    /// The solution with the steps that a time constant cannot take held at what it can, so that the others do not answer to
    /// what does not happen. What is held moves those of other runs, and beyond their bounds maybe, until none is.
    ///
    /// No slide follows ahead of time. The effect of a time constant grows with its square: far away its slope is
    /// another one.
    fn held_within_bounds(
        &self,
        rows: &Bordered,
        mut solution: BorderedSolution,
    ) -> Result<BorderedSolution> {
        let mut held: Vec<(usize, usize, f64, f64)> = Vec::new();
        loop {
            let before = held.len();
            for (index, run) in self.runs.iter().enumerate() {
                let map = &run.alignment.time_map;
                let following = {
                    let least_s = (-map.following_s).max(-timing::STRIDE_S);
                    (self.columns.following(index), least_s, timing::STRIDE_S, timing::AT_ONCE_S)
                };
                let stride = timing::ROUNDED_STRIDE;
                let rounded = self.columns.rounded(index);
                let rounded = rounded.map(|column| (column, -stride, stride, timing::HELD_SHARE));
                for (column, least, most, sigma) in std::iter::once(following).chain(rounded) {
                    let step = solution.unknowns().own[index][column];
                    let possible = step.clamp(least, most);
                    let held_before =
                        held[..before].iter().any(|held| (held.0, held.1) == (index, column));
                    if (possible - step).abs() > 0.0 && !held_before {
                        held.push((index, column, possible, sigma));
                    }
                }
            }
            if held.len() == before {
                return Ok(solution);
            }
            solution = self.solve(&rows.with_priors(&held)?)?;
        }
    }

    /// Where the fit stands now, with the step that it is about to take.
    fn stand(
        &self,
        left_mm: f64,
        step: Unknowns,
        solution: BorderedSolution,
        scatter: f64,
        near: bool,
    ) -> Stand {
        let maps = self.runs.iter().map(|run| run.alignment.time_map.clone()).collect();
        Stand { left_mm, step, solution, scatter, near, values: self.state.values.clone(), maps }
    }

    /// Goes back to where it stood.
    fn stand_at(&mut self, stand: &Stand) {
        self.recall(stand);
        self.place_taken();
    }

    /// The coefficients and times of where it stood, to take another step from there: the samples are laid after that.
    fn recall(&mut self, stand: &Stand) {
        self.state.values.clone_from(&stand.values);
        for (run, map) in self.runs.iter_mut().zip(&stand.maps) {
            run.alignment.time_map.clone_from(map);
        }
    }

    /// The end of a round that has not quite come to rest: a smooth one only has to come near.
    fn hardly_settled(&mut self, stand: Stand, detail: timing::Detail) -> Outcome {
        let outcome = self.settled(stand, MOST_STEPS);
        self.state.settled = detail == timing::Detail::Smooth;
        outcome
    }

    /// The end of a round that has come to rest, with the noise that its last solution left.
    fn settled(&mut self, stand: Stand, steps: usize) -> Outcome {
        self.state.sigma_mm *= stand.scatter;
        self.state.settled = true;
        Outcome { solution: stand.solution, steps }
    }
}

/// The error of a fit that goes to and fro.
fn unsettled() -> Error {
    Error::new(Kind::Undetermined, format!("the fit does not settle within {MOST_STEPS} steps")).hint(
        "the log may be of another program, the feed override may not have stood where the test file says, or there are too many terms for these arcs",
    )
}

/// Whether a fit is near whose step changes so many computed readings by so much together, in units of the noise as what is left
/// scatters, and whether that is enough: the smooth fit only has to come near, the chords take over from there.
fn comes_near(detail: timing::Detail, change: f64, scatter: f64, count: f64) -> [bool; 2] {
    let hardly = change < NEARLY * scatter * count.sqrt();
    match detail {
        timing::Detail::Smooth => [true, hardly],
        timing::Detail::Full => [hardly, change < NEGLIGIBLE * scatter.max(1e-12)],
    }
}

/// Whether a step takes back more than half of the one before, by what both change of the computed readings.
fn takes_back(rows: &Bordered, before: &Unknowns, step: &Unknowns) -> bool {
    let square = |of: &Unknowns| rows.change(of).powi(2);
    let product = 0.5 * (square(&before.plus(step)) - square(before) - square(step));
    product < -0.5 * square(before)
}
