//! Where a fit stands.

use super::input::RunInput;
use super::record::Apart;
use crate::align::{Part, Sample, Section};

/// What comes out beyond so many of its deviations is more than plausible: 1 in 370 of honest machines.
pub const IMPLAUSIBLE: f64 = 3.0;

/// Where a fit stands.
#[derive(Debug, Clone)]
pub(super) struct State {
    /// The parameters of the model, in their units.
    pub(super) values: Vec<f64>,
    /// Standard deviation of a reading, mm.
    pub(super) sigma_mm: f64,
    /// By which factor a mean of many neighbouring readings is less certain than if they were independent.
    pub(super) correlated: f64,
    /// Standard deviation of what each parameter plausibly is, in its unit; `None` where the readings alone decide.
    pub(super) plausible: Vec<Option<f64>>,
    /// Whether the last fit came to rest.
    pub(super) settled: bool,
    /// Whether the times of samples came to rest, so that those near reversals could be let in.
    pub(super) came_to_rest: bool,
    /// Whether derivatives are taken at the machine as it is bent by these values: once they are near the right ones. What
    /// readings see by the bend of the machine alone, a step from far away would follow much too far.
    pub(super) bent: bool,
    /// For each run whether its slides are taken to follow without a lag, because they cannot do so ahead of time.
    pub(super) at_once: Vec<bool>,
    /// Which readings take part.
    pub(super) taking: Taking,
    /// Why each sample of each run takes no part; `None` where it does.
    pub(super) apart: Vec<Vec<Option<Apart>>>,
    /// Robust weights, one for each sample of each run; `None` for all 1.
    pub(super) weights: Option<Vec<Vec<f64>>>,
}

/// Which readings take part in a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Taking {
    /// All.
    Each,
    /// One stands for several, while the fit is sought.
    OneForSeveral,
}

impl State {
    /// Standard deviation that a reading counts with beside what is known otherwise, mm.
    pub(super) fn counts_mm(&self) -> f64 {
        self.sigma_mm * self.correlated
    }

    /// Leaves out what others leave out too.
    pub(super) fn leave_out(&mut self, others: &[Vec<Option<Apart>>]) {
        for (apart, others) in self.apart.iter_mut().flatten().zip(others.iter().flatten()) {
            *apart = apart.or(*others);
        }
    }

    /// The fit is sought with one reading for several where more than the readings is known of it; elsewhere all decide.
    pub(super) fn seeks(&self) -> Taking {
        if self.knows() { Taking::OneForSeveral } else { Taking::Each }
    }

    /// Whether anything is known of the parameters but by readings.
    pub(super) fn knows(&self) -> bool {
        self.plausible.iter().any(Option::is_some)
    }
}

/// Of the while from one reversal of an arc to the next this part is kept from either at the most: on a short bar at a high feed
/// they follow each other within a second, and some readings between them are worth more than the last doubt about their sense.
const MOST_KEPT: f64 = 0.4;

/// Why each sample of each run takes no part; `guard_s` is kept from every reversal and every end of an arc at the least, or
/// [`MOST_KEPT`] where that is less.
pub(super) fn apart(runs: &[RunInput], guard_s: f64) -> Vec<Vec<Option<Apart>>> {
    let of_run = |run: &RunInput| {
        let turns_s = run.alignment.turns_s(&run.following[0]);
        let sections = &run.alignment.sections;
        // A mean over a reversal has no sense.
        let averaged = run.alignment.averaged > 1;
        let half_s = if averaged { 0.5 * run.alignment.sample_period_s } else { 0.0 };
        let turns_in = |section: &Section| {
            let within = |turn: &&[f64; 2]| (section.start_s..section.end_s).contains(&turn[0]);
            turns_s.iter().filter(within).count()
        };
        let apart_s =
            |section: &Section| (section.end_s - section.start_s) / (turns_in(section) + 1) as f64;
        let guards_s: Vec<f64> =
            sections.iter().map(|of| guard_s.min(MOST_KEPT * apart_s(of))).collect();
        let guard_s = |sample: &Sample| match sample.part {
            Part::Arc(section) => guards_s[section],
            _ => guard_s,
        };
        let steps = |sample: &Sample| {
            let guard_s = guard_s(sample);
            let kept_s = half_s + Apart::kept_s(sample, guard_s, 0.0);
            run.alignment.steps_at(sample.leg, sample.program_s, kept_s)
        };
        let apart = |sample: &Sample| {
            let apart = Apart::of(sample, &turns_s, sections, guard_s(sample), half_s);
            apart.or_else(|| steps(sample).then_some(Apart::Reversal))
        };
        run.samples().iter().map(apart).collect()
    };
    runs.iter().map(of_run).collect()
}
