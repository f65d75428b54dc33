//! What features are made of: a circular test in its plane, and the model that its runs were identified with.

use nalgebra::Vector3;

use crate::diagnose::{Finding, Owner};
use crate::identify::{Answer, Asked, Identification, ask, deviation};
use crate::machine::{Axis, Pose};
use crate::model::{HeldEffect, LocalFrame, Model, Situation};
use crate::solve::dot;

/// What a feature adds to the length at a situation of a run, mm.
pub(super) type Column<'a> = Box<dyn Fn(&Situation, usize) -> f64 + 'a>;

/// A feature before it is ranked.
pub(super) struct Draft<'a> {
    pub(super) feature: super::feature::Feature,
    pub(super) column: Column<'a>,
}

/// Another repeat of the same test.
pub(super) struct Repeat<'a> {
    pub(super) model: Model<'a>,
    pub(super) identification: &'a Identification,
}

impl Repeat<'_> {
    fn ask(&self, frame: &LocalFrame, asked: &[Asked]) -> Vec<Answer> {
        let values = self.identification.values();
        ask(&self.model, frame, &self.identification.known(&values), asked)
    }
}

/// A circular test in its plane.
pub(super) struct Scene<'a> {
    pub(super) model: &'a Model<'a>,
    pub(super) frame: &'a LocalFrame,
    pub(super) identification: &'a Identification,
    pub(super) values: &'a [f64],
    pub(super) others: &'a [Repeat<'a>],
    pub(super) held: &'a [HeldEffect],
    pub(super) findings: &'a [Finding],
    /// Index of the repeat.
    pub(super) repeat: usize,
    /// The axes of the plane, the first one first.
    pub(super) axes: [Axis; 2],
    /// The axis that is normal to it.
    pub(super) normal: Axis,
    pub(super) radius_mm: f64,
    pub(super) feed_mm_s: f64,
    /// Indices of the runs of its ways.
    pub(super) runs: Vec<usize>,
}

impl Scene<'_> {
    /// Answers, in the order in which they are asked, none known better than repeats scatter.
    pub(super) fn ask<const N: usize>(&self, asked: [Asked; N]) -> [Option<Answer>; N] {
        let known = self.identification.known(self.values);
        let mut answers = ask(self.model, self.frame, &known, &asked).into_iter();
        let others: Vec<Vec<Answer>> =
            self.others.iter().map(|repeat| repeat.ask(self.frame, &asked)).collect();
        std::array::from_fn(|k| {
            let answer = answers.next()?;
            let its = others.iter().filter_map(|answers| answers.get(k));
            let values: Vec<f64> = std::iter::once(&answer).chain(its).map(|a| a.value).collect();
            Some(answer.scattering(deviation(&values).unwrap_or(0.0)))
        })
    }

    /// How far a slide is from the middle of the test, mm.
    pub(super) fn beside_mm(&self, at: &Situation, axis: Axis) -> f64 {
        at.pose.position_mm[axis.index()] - self.frame.middle_mm[axis.index()]
    }

    /// A place of which some slides only are where they are there, the others at the middle of the test, mm.
    pub(super) fn at_middle(&self, here: &Pose, stays: impl Fn(Axis) -> bool) -> Vector3<f64> {
        let of = |axis: Axis| if stays(axis) { here.position_mm } else { self.frame.middle_mm };
        Vector3::from_fn(|k, _| of(Axis::ALL[k])[k])
    }

    /// The effects that the model holds beside its parameters, each with the index of its finding: they stand in the order of the
    /// findings, of what differs from run to run one a run.
    pub(super) fn found(&self) -> Vec<(usize, &HeldEffect)> {
        let mut held = self.held.iter();
        let mut found = Vec::new();
        for (k, finding) in self.findings.iter().enumerate() {
            let of_one_run = held.as_slice().first().is_some_and(|held| held.run.is_some());
            let count = match finding.owner() {
                // One for all, or one for each run where these tell when they began.
                Owner::All if !of_one_run => 1,
                Owner::One { repeat, .. } => usize::from(repeat == self.repeat),
                Owner::All | Owner::EachRun => self.identification.runs.len(),
            };
            found.extend(held.by_ref().take(count).map(|held| (k, held)));
        }
        found
    }
}

/// What an effect adds to the length at a situation of a run, mm.
pub(super) fn added_mm(held: &HeldEffect, at: &Situation, run: usize) -> f64 {
    if !held.is_in(run) {
        return 0.0;
    }
    let mut columns = vec![0.0; held.amplitudes.len()];
    let own = Situation { motion: held.its(&at.motion), ..at.clone() };
    held.form.term().columns(&own, &mut columns);
    dot(&columns, &held.amplitudes)
}
