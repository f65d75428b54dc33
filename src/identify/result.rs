//! What an identification says.

use super::across::Across;
use super::asked::Known;
use super::input::RunInput;
use super::record::Record;
use super::state::IMPLAUSIBLE;
use crate::align::{Alignment, Circle, TimeMap};
use crate::model::Parameter;
use crate::solve::{Matrix, NoiseModel, NullDirection, median};

/// One estimated parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Name and unit.
    pub parameter: Parameter,
    /// The value, in its unit.
    pub value: f64,
    /// Standard deviation by the noise, in its unit: what repeats would scatter.
    pub sigma: f64,
    /// Standard deviation, in its unit, by the noise and by what these runs cannot tell from other plausible faults;
    /// `None` where nothing was taken for plausible.
    pub all: Option<f64>,
    /// Standard deviation of what it was taken to be plausibly, in its unit.
    pub plausible: Option<f64>,
    /// How much of it the data determine: 1 all, 0 nothing, between: only together with others.
    pub observed: f64,
}

/// A run that took part.
#[derive(Debug, Clone)]
pub struct IdentifiedRun {
    /// Its name.
    pub name: String,
    /// Index of its mounting in the model.
    pub mounting: usize,
    /// Nominal length of the bar that was used, mm.
    pub nominal_mm: f64,
    /// The aligned log, its time map refined.
    pub alignment: Alignment,
    /// When the log was read by its alignment alone, before any fit.
    pub(super) aligned: TimeMap,
    /// The legs whose offsets were fitted: those that had readings when the fit began.
    pub(super) legs: Vec<usize>,
    /// Its readings, in order.
    pub records: Vec<Record>,
}

impl IdentifiedRun {
    /// The same run, to be identified otherwise.
    pub fn again(&self) -> RunInput {
        let mut run = self.taking(self.alignment.clone());
        run.aligned = self.aligned.clone();
        run
    }

    /// The same run, to be identified from where the first fit began: what that did not know may have moved its times
    /// farther than a fit that begins with them comes back from.
    pub(super) fn afresh(&self) -> RunInput {
        let mut alignment = self.alignment.clone();
        alignment.time_map = self.aligned.clone();
        self.taking(alignment)
    }

    /// Whether its feed was held, although readings might tell more of it.
    pub(super) fn holds_pace(&self) -> bool {
        self.alignment.time_map.pace_held.is_some()
    }

    fn taking(&self, alignment: Alignment) -> RunInput {
        RunInput::new(self.name.clone(), self.mounting, self.nominal_mm, alignment)
    }

    /// The readings that took part.
    pub fn used(&self) -> impl Iterator<Item = &Record> + Clone {
        self.records.iter().filter(|record| record.used())
    }
}

/// A run of which a fit explains little beside its set-up.
#[derive(Debug, Clone)]
pub struct LittleExplained {
    /// Its name.
    pub run: String,
    /// What the fit leaves, mm rms.
    pub left_mm: f64,
    /// What a set-up alone would leave, mm rms.
    pub by_set_up_mm: f64,
}

/// What came out.
#[derive(Debug)]
pub struct Identification {
    /// The parameters of the model, in its order.
    pub estimates: Vec<Estimate>,
    pub(super) across: Across,
    /// Correlation of the estimates.
    pub correlation: Matrix,
    /// Covariance of the estimates by the noise.
    pub covariance: Matrix,
    /// How much each estimate (row) errs where a fault (column) is one plausible standard deviation: first the
    /// parameters in their order, then how the control may have driven, then effects that nobody has explained; `None` where
    /// nothing was taken for plausible.
    pub left_open: Option<Matrix>,
    /// How many effects that nobody has explained are among these.
    pub unexplained: usize,
    /// What a standard deviation of each independent combination of the numbers of effects (column) does to the
    /// estimates (row): a part of `covariance` that all repeats have in common; `None` where there are no effects.
    pub effects: Option<Matrix>,
    /// Rank over the coefficients, by the noise; where something was taken for plausible, how many numbers the
    /// readings decided, rounded.
    pub rank: usize,
    /// Condition number of the scaled columns over the observed directions.
    pub condition: f64,
    /// What is confounded, by index of parameter.
    pub null_directions: Vec<NullDirection>,
    /// Standard deviation that a reading counted with beside what is known otherwise, mm.
    pub counts_mm: f64,
    /// The noise.
    pub noise: NoiseModel,
    /// The runs, their time maps refined.
    pub runs: Vec<IdentifiedRun>,
    /// Root mean square of the residuals of the samples that were used, mm.
    pub rms_mm: f64,
    /// How many times chance that is; `None` where it is little more.
    pub beyond_chance: Option<f64>,
    /// The runs of which it explains little, the least first, where that is beyond chance.
    pub little_explained: Vec<LittleExplained>,
    /// Samples that were used.
    pub used: usize,
    /// Gauss-Newton steps.
    pub steps: usize,
    /// Whether the fit came to rest.
    pub(super) settled: bool,
}

impl Identification {
    /// The same runs, to be identified otherwise.
    pub fn again(&self) -> Vec<RunInput> {
        self.runs.iter().map(IdentifiedRun::again).collect()
    }

    /// The same runs, to be identified otherwise from where the first fit began.
    pub(super) fn afresh(&self) -> Vec<RunInput> {
        self.runs.iter().map(IdentifiedRun::afresh).collect()
    }

    /// Where to hold the feeds, in plausible deviations from those of engagement and release, where one was found that is farther off
    /// than is plausible while more is left than chance leaves: what the model does not have was taken for it.
    ///
    /// What a control takes longer at standstills than planned is told for a feed in all runs alike: the others say where.
    pub(super) fn feeds_held(&self) -> Option<f64> {
        let off = self.runs.iter().map(|run| run.alignment.time_map.pace_off());
        let (plausible, astray): (Vec<f64>, Vec<f64>) =
            off.partition(|off| off.abs() < IMPLAUSIBLE);
        let runs_after_feed = self.beyond_chance.is_some() && !astray.is_empty();
        runs_after_feed.then(|| median(plausible).unwrap_or(0.0))
    }

    /// Whether it is of the same test as another: each drives the circles of the other, in the same mountings.
    pub fn is_of_test_of(&self, other: &Self) -> bool {
        let arcs = |of: &'_ Self| -> Vec<(usize, Circle)> {
            let of_run = |run: &IdentifiedRun| {
                let arcs = run.alignment.sections.iter().filter(|section| !section.transit);
                arcs.map(|section| (run.mounting, section.circle)).collect::<Vec<_>>()
            };
            of.runs.iter().flat_map(of_run).collect()
        };
        let (own, its) = (arcs(self), arcs(other));
        let within = |arcs: &[(usize, Circle)], all: &[(usize, Circle)]| {
            arcs.iter().all(|of| all.iter().any(|one| one.0 == of.0 && one.1.is_same(&of.1)))
        };
        within(&own, &its) && within(&its, &own)
    }

    /// What is known of the parameters, with the values as they were estimated.
    pub fn known<'a>(&'a self, values: &'a [f64]) -> Known<'a> {
        Known {
            values,
            covariance: &self.covariance,
            left_open: self.left_open.as_ref(),
            unexplained: self.unexplained,
            effects: self.effects.as_ref(),
        }
    }

    /// The columns of [`Self::left_open`] of how the control may have driven.
    pub fn open_by_driving(&self) -> Option<Matrix> {
        let (open, count) = (self.left_open.as_ref()?, self.estimates.len());
        let faults = open.columns() - self.unexplained;
        Some(Matrix::from_fn(count, faults - count, |i, k| open[(i, count + k)]))
    }

    /// The estimated values in the order of the model.
    pub fn values(&self) -> Vec<f64> {
        self.estimates.iter().map(|estimate| estimate.value).collect()
    }

    /// How far the readings that were used are from their mean, mm rms.
    pub fn spread_mm(&self) -> f64 {
        let read = || self.runs.iter().flat_map(IdentifiedRun::used).map(|r| r.sample.deviation_mm);
        let count = self.used.max(1) as f64;
        let mean_mm = read().sum::<f64>() / count;
        (read().map(|mm| (mm - mean_mm).powi(2)).sum::<f64>() / count).sqrt()
    }

    /// The estimate of a name.
    pub fn estimate(&self, name: &str) -> Option<&Estimate> {
        self.estimates.iter().find(|estimate| estimate.parameter.name == name)
    }
}
