//! A settled fit as a linear problem: what any further column could explain.
//!
//! With the rows `B` of a fit (coefficients and times, weighed, the rows about time included) and
//! `Q = B D^-1 V_r S_r^-1` orthonormal over the directions that the fit keeps, a further column `c`
//! explains what is left of it,
//!
//! `c' = c - Q Q^T c`,
//!
//! and changes the parameters of the fit by `- F Q^T c` per unit, `F = D^-1 V_r S_r^-1`.

use super::fit::Fit;
use super::follows::Follows;
use super::input::Options;
use super::record::{Apart, Record};
use super::result::{Identification, IdentifiedRun};
use super::state::{State, Taking};
use super::timing::Detail;
use crate::align::{Alignment, Part, Sample};
use crate::error::Result;
use crate::model::{Model, Situation};
use crate::solve::{Basis, Matrix, dot};

/// A reading that the fit used.
#[derive(Debug, Clone)]
pub struct LinearSample {
    /// Index of its run.
    pub run: usize,
    /// Number of its arc, counted over the runs: what is left out together.
    pub arc: usize,
    /// Index of the section of its program that it lies on.
    pub section: usize,
    /// How many blocks of its program lie behind it, the part of its own block among them: the same place in all repeats,
    /// however fast each was driven.
    pub blocks: f64,
    /// Index of its record among those of its run.
    pub reading: usize,
    /// Time on the instrument's clock, s.
    pub log_s: f64,
    /// Observed minus computed, mm, where no slide follows later than others: the fit lets them, so that its times are
    /// right, but that is not part of the model.
    pub left_mm: f64,
    /// Where it was taken.
    pub situation: Situation,
    /// Root of its weight, 0 to 1.
    pub root_weight: f64,
}

/// A settled fit as a linear problem.
#[derive(Debug, Clone)]
pub struct Linearised {
    /// The samples, in the order of runs and time.
    pub samples: Vec<LinearSample>,
    /// `Q` at the samples.
    pub basis: Basis,
    /// `F`: faults per unit of `Q^T c`, `c` in mm: first the parameters of the model (mm, rad), then how the control may
    /// have driven, in the order of [`Identification::left_open`].
    pub factor: Matrix,
    /// What is plausible of each of them, a standard deviation; infinite where the readings alone decide.
    pub deviations: Vec<f64>,
}

impl LinearSample {
    /// Time since the program began, s, on the machine's clock.
    pub fn elapsed_s(&self) -> f64 {
        self.situation.motion.elapsed_s
    }

    /// Time in the program, s.
    pub fn program_s(&self) -> f64 {
        self.situation.motion.program_s
    }
}

impl Identification {
    /// The fit as it came to rest, where readings count with this standard deviation, mm.
    pub(super) fn at_rest<'a>(
        &self,
        model: &'a Model<'a>,
        options: &'a Options,
        counts_mm: f64,
    ) -> Fit<'a> {
        let kept = |run: &IdentifiedRun| run.records.iter().map(|record| record.apart).collect();
        let state = State {
            values: self.values(),
            sigma_mm: counts_mm,
            correlated: 1.0,
            settled: true,
            came_to_rest: true,
            bent: self.left_open.is_some(),
            taking: Taking::Each,
            at_once: vec![false; self.runs.len()],
            plausible: self.estimates.iter().map(|estimate| estimate.plausible).collect(),
            apart: self.runs.iter().map(kept).collect(),
            weights: Some(
                self.runs
                    .iter()
                    .map(|run| run.records.iter().map(|r| r.weight).collect())
                    .collect(),
            ),
        };
        let mut fit = Fit::at(model, self.again(), options, state);
        fit.columns.legs = self.runs.iter().map(|run| run.legs.clone()).collect();
        fit
    }

    /// The fit that came out, as a linear problem.
    ///
    /// # Errors
    /// When the fit's rows are not finite.
    pub fn linearised(&self, model: &Model, options: &Options) -> Result<Linearised> {
        // What is still left of an effect looks like noise that hangs together for long, and readings that count for little
        // would leave to what is plausible what they tell: here they count for all they are.
        let mut fit = self.at_rest(model, options, self.rms_mm.max(1e-9));
        // By the times as they settled, a sample that the fit used may lie just beyond the end of its arc.
        let part = |record: &Record| {
            record.apart.or(match record.sample.part {
                Part::Arc(_) => None,
                _ => Some(Apart::Ramp),
            })
        };
        let within = |run: &IdentifiedRun| run.records.iter().map(part).collect();
        fit.state.apart = self.runs.iter().map(within).collect();
        fit.columns.unlike = false;
        let solution = fit.solve(&fit.rows()?)?;
        let follows = Follows::of(&fit, &solution);
        // What is left is so to the digit: nothing that the fit follows is in it.
        let step = solution.unknowns();
        let take_part = fit.state.apart.iter().flatten().filter(|apart| apart.is_none()).count();
        let mut samples = Vec::with_capacity(take_part);
        let mut basis = Basis::with_room(follows.rank(), take_part);
        let mut q = vec![0.0; follows.rank()];
        // Run and section of the arc before.
        let mut last = None;
        let mut arcs = 0;
        for (index, run) in self.runs.iter().enumerate() {
            let step = [&step.own[index][..], &step.shared].concat();
            let section = |k: usize| match (fit.state.apart[index][k], run.records[k].sample.part) {
                (None, Part::Arc(section)) => Some(section),
                _ => None,
            };
            let taken: Vec<usize> =
                (0..run.records.len()).filter(|k| section(*k).is_some()).collect();
            fit.each_row(index, &taken, Detail::Full, |k, row, residual_mm| {
                let Some(section) = section(k) else { return };
                if last.replace((index, section)) != Some((index, section)) {
                    arcs += 1;
                }
                let record = &run.records[k];
                let sample = &record.sample;
                let root_weight = record.weight.sqrt();
                follows.row(index, row, root_weight / fit.state.counts_mm(), &mut q);
                basis.push(&q);
                samples.push(LinearSample {
                    left_mm: residual_mm - dot(row, &step),
                    run: index,
                    arc: arcs - 1,
                    section,
                    blocks: blocks_behind(&run.alignment, sample),
                    reading: k,
                    log_s: sample.log_s,
                    situation: model.situation(&sample.pose, &sample.motion, run.mounting),
                    root_weight,
                });
            });
        }
        let (factor, deviations) = follows.faults(&fit);
        Ok(Linearised { samples, basis, factor, deviations })
    }
}

/// How many blocks of its program lie behind a sample, the part of its own block among them.
fn blocks_behind(alignment: &Alignment, sample: &Sample) -> f64 {
    let part = alignment.trajectory.blocks().get(sample.block).map_or(0.0, |block| {
        (sample.program_s - block.start_s) / block.duration_s.max(f64::EPSILON)
    });
    sample.block as f64 + part.clamp(0.0, 1.0)
}
