//! All runs of a test: read, aligned, grouped by repeat and identified.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use jiff::civil::Date;
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use super::complete::explicit_terms;

use super::input::{Options, RunInput};
use super::measured::{MeasuredRepeat, MeasuredRun};
use super::place;
use super::result::Identification;
use super::slip::identify_beside_slips;
use super::turning::spikes;
use crate::error::{Error, Result};
use crate::log::Log;
use crate::machine::{Axis, Machine, Mounting};
use crate::model::{Form, HeldEffect, LOCAL, LocalFrame, Model};
use crate::plan::{Run, Test};

/// All repeats of a test, identified.
#[derive(Debug)]
pub struct Campaign {
    /// The terms, `complete` made explicit: one set for all repeats, or they would have no mean.
    pub terms: Vec<String>,
    /// The place of the test; `None` where no run drives an arc.
    pub frame: Option<Arc<LocalFrame>>,
    /// The repeats.
    pub repeats: Vec<Identification>,
    /// Effects that each repeat was identified with beside the terms.
    pub held: Vec<Vec<HeldEffect>>,
    /// Runs that take no part, with the reason.
    pub left_out: Vec<(String, Error)>,
    /// What was measured, also what was left out; campaigns of the same measurements share it.
    pub(super) measured: Arc<Vec<MeasuredRepeat>>,
}

/// What becomes of a repeat that cannot be aligned or identified.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// It fails the campaign; of several the first.
    Refuse,
    /// It is left out, with all its runs, as long as another is left.
    LeaveOut,
}

impl Campaign {
    /// Reads, aligns and identifies every repeat of a test: runs with the same repeat number together,
    /// repeats apart.
    ///
    /// Repeats are worked on side by side; `finished` is called after each. The result does not depend on
    /// the number of threads.
    pub fn of(
        test: &Test,
        machine: &Machine,
        failure: Failure,
        finished: &(dyn Fn() + Sync),
    ) -> Result<Self> {
        let mut repeats: BTreeMap<u32, Vec<&Run>> = BTreeMap::new();
        for run in test.runs()? {
            repeats.entry(run.repeat).or_default().push(run);
        }
        let repeats: Vec<Vec<&Run>> = repeats.into_values().collect();
        let read = |runs: &Vec<&Run>| MeasuredRepeat {
            names: runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>().join(", "),
            runs: runs.iter().map(|run| MeasuredRun::read(test, run)).collect(),
        };
        let measured: Vec<MeasuredRepeat> = repeats.par_iter().map(read).collect();
        Self::unless_exchanged(test, machine, &Arc::new(measured), failure, finished)
    }

    /// Identifies all repeats, and refuses logs that stand at each other's runs before a repeat that cannot be identified.
    fn unless_exchanged(
        test: &Test,
        machine: &Machine,
        measured: &Arc<Vec<MeasuredRepeat>>,
        failure: Failure,
        finished: &(dyn Fn() + Sync),
    ) -> Result<Self> {
        let of = Self::of_repeats(test, machine, Arc::clone(measured), failure, finished);
        Self::refuse_exchanged(test, machine, measured, of)?.or(failure)
    }

    /// As it is, or as what is left out fails it.
    fn or(self, failure: Failure) -> Result<Self> {
        match self.left_out.first() {
            Some((_, error)) if failure == Failure::Refuse => Err(error.clone()),
            _ => Ok(self),
        }
    }

    /// What the fits leave, mm rms over all repeats.
    pub fn rms_mm(&self) -> f64 {
        let used: usize = self.repeats.iter().map(|repeat| repeat.used).sum();
        (self.leaves_mm2() / used.max(1) as f64).sqrt()
    }

    /// As [`of`](Self::of), of logs that are in no file: the runs of each repeat.
    ///
    /// # Errors
    /// As there.
    pub fn of_logs(
        test: &Test,
        machine: &Machine,
        repeats: Vec<Vec<MeasuredRun>>,
        failure: Failure,
    ) -> Result<Self> {
        let measured = Arc::new(MeasuredRepeat::all(repeats));
        Self::unless_exchanged(test, machine, &measured, failure, &|| ())
    }

    /// Aligns and identifies repeats that were measured, the runs of each together.
    ///
    /// # Errors
    /// As for [`of`](Self::of).
    pub fn of_measured(
        test: &Test,
        machine: &Machine,
        repeats: Vec<Vec<MeasuredRun>>,
        failure: Failure,
    ) -> Result<Self> {
        let measured = Arc::new(MeasuredRepeat::all(repeats));
        Self::of_repeats(test, machine, measured, failure, &|| ())?.or(failure)
    }

    /// The same measurements laid over their programs again, as another test and another machine have
    /// them, and identified; what cannot be is left out.
    ///
    /// # Errors
    /// When nothing is left.
    pub fn realigned(&self, test: &Test, machine: &Machine) -> Result<Self> {
        Self::of_repeats(test, machine, Arc::clone(&self.measured), Failure::LeaveOut, &|| ())
    }

    /// The same alignments identified again, as another test and another machine have them.
    ///
    /// # Errors
    /// When a repeat cannot be identified so.
    pub fn reidentified(&self, test: &Test, machine: &Machine) -> Result<Self> {
        let aligned = self.repeats.iter().map(Identification::again).collect();
        let (measured, left_out) = (Arc::clone(&self.measured), self.left_out.clone());
        let failed = left_out.len();
        let of = Self::of_aligned(test, machine, measured, aligned, left_out, &|| ())?;
        match of.left_out.get(failed) {
            Some((_, error)) => Err(error.clone()),
            None => Ok(of),
        }
    }

    /// What the fits leave, mm².
    pub fn leaves_mm2(&self) -> f64 {
        self.repeats.iter().map(|repeat| repeat.rms_mm.powi(2) * repeat.used as f64).sum()
    }

    /// Identifies all repeats that can be; one that cannot even be aligned fails it at once, or is left out.
    fn of_repeats(
        test: &Test,
        machine: &Machine,
        measured: Arc<Vec<MeasuredRepeat>>,
        failure: Failure,
        finished: &(dyn Fn() + Sync),
    ) -> Result<Self> {
        let aligned: Vec<Result<Vec<RunInput>>> =
            measured.par_iter().map(|repeat| repeat.aligned(test, machine)).collect();
        let mut left_out = Vec::new();
        let mut usable = Vec::new();
        for (repeat, aligned) in measured.iter().zip(aligned) {
            match aligned {
                Ok(aligned) => usable.push(aligned),
                Err(error) if failure == Failure::Refuse => return Err(error),
                Err(error) => left_out.push((repeat.names.clone(), error)),
            }
        }
        Self::of_aligned(test, machine, measured, usable, left_out, finished)
    }

    /// Identifies repeats whose logs are aligned; `left_out` are those that could not be.
    fn of_aligned(
        test: &Test,
        machine: &Machine,
        measured: Arc<Vec<MeasuredRepeat>>,
        mut aligned: Vec<Vec<RunInput>>,
        mut left_out: Vec<(String, Error)>,
        finished: &(dyn Fn() + Sync),
    ) -> Result<Self> {
        let options = Options::of(test);
        let mut terms = test.estimation().terms.clone();
        let frame = place::of(test, machine, aligned.iter().flatten());
        if let Some(first) = aligned.first_mut() {
            let mountings: Vec<(String, Mounting)> =
                test.mountings().iter().map(|m| (m.name.clone(), m.mounting)).collect();
            let runs = std::mem::take(first);
            (terms, *first) = explicit_terms(&terms, machine, &mountings, runs, &options)?;
        }
        let empty = Self {
            terms,
            frame,
            repeats: Vec::new(),
            held: Vec::new(),
            left_out: Vec::new(),
            measured,
        };
        let results: Vec<(String, Result<Identification>)> = aligned
            .into_par_iter()
            .map(|inputs| {
                let of: Vec<&str> = inputs.iter().map(|run| run.name.as_str()).collect();
                let of = of.join(", ");
                let identified = empty
                    .model_with(test, machine, &[])
                    .and_then(|model| identify_beside_slips(&model, inputs, &options));
                finished();
                (of, identified)
            })
            .collect();
        let mut repeats = Vec::new();
        for (names, result) in results {
            match result {
                Ok(identification) => repeats.push(identification),
                Err(error) => left_out.push((names, error)),
            }
        }
        match left_out.first() {
            // Nothing is left: the first reason is as good as any.
            Some((_, error)) if repeats.is_empty() => Err(error.clone()),
            _ => Ok(Self { held: vec![Vec::new(); repeats.len()], repeats, left_out, ..empty }),
        }
    }

    /// The day on which the first of the logs began, where one says it.
    pub fn began(&self) -> Option<Date> {
        self.logs().filter_map(Log::began).min()
    }

    /// SHA-256 of all readings, in hexadecimal: the same of the same logs, whatever else a test file says of them.
    pub fn readings_sha256(&self) -> String {
        let mut hasher = Sha256::new();
        for log in self.logs() {
            hasher.update((log.readings().len() as u64).to_le_bytes());
            for reading in log.readings() {
                hasher.update(reading.time_s.to_bits().to_le_bytes());
                let deviation_mm = reading.deviation_mm.unwrap_or(f64::NAN);
                hasher.update(deviation_mm.to_bits().to_le_bytes());
            }
        }
        hasher.finalize().iter().fold(String::new(), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        })
    }

    pub(super) fn logs(&self) -> impl Iterator<Item = &Log> {
        let runs = self.measured.iter().flat_map(|repeat| &repeat.runs);
        runs.filter_map(|run| Some(&run.as_ref().ok()?.log))
    }

    /// Runs whose logs hold the same readings: no two runs do that by chance.
    fn copied(&self) -> Option<String> {
        let read = self.measured.iter().flat_map(|repeat| &repeat.runs);
        let runs: Vec<&MeasuredRun> = read.filter_map(|run| run.as_ref().ok()).collect();
        let first = |k: usize| {
            let same = |other: &&&MeasuredRun| other.log.has_the_readings_of(&runs[k].log);
            runs[k + 1..].iter().find(same).map(|other| [runs[k], *other])
        };
        let [a, b] = (0..runs.len()).find_map(first)?;
        Some(format!(
            "the logs of `{}` and `{}` hold the same readings: one is a copy of the other, and what is said of noise and of what repeats counts it twice; give each run its own log",
            a.name, b.name
        ))
    }

    /// What speaks against the fits, none of it twice.
    pub fn cautions(&self, test: &Test, machine: &Machine) -> Vec<String> {
        let loss = test.estimation().loss;
        let mut told: Vec<String> = self.copied().into_iter().collect();
        let each = self.repeats.par_iter().map(|repeat| repeat.cautions(machine, loss));
        for caution in each.collect::<Vec<_>>().concat() {
            if !told.contains(&caution) {
                told.push(caution);
            }
        }
        told.extend(self.turning_far_off().into_iter().map(|(_, caution)| caution));
        told
    }

    /// Axes where the bar reads far off as they turn round, each with its caution: a spike, perhaps, that no reading tells that
    /// takes part.
    pub fn turning_far_off(&self) -> Vec<(Axis, String)> {
        spikes(self.repeats.iter().flat_map(|repeat| &repeat.runs))
    }

    /// Whether a coefficient of this name is estimated, by itself or in what the machine does where it was measured.
    pub fn estimates(&self, name: &str) -> bool {
        if self.terms.iter().any(|term| term == LOCAL) {
            return true;
        }
        let first = self.repeats.first();
        first.is_some_and(|repeat| repeat.estimates.iter().any(|e| e.parameter.name == name))
    }

    /// The model that a repeat was identified with.
    pub fn model<'a>(&self, test: &Test, machine: &'a Machine, repeat: usize) -> Result<Model<'a>> {
        self.model_with(test, machine, self.held.get(repeat).map_or(&[], Vec::as_slice))
    }

    /// The terms of the campaign with the test's curves and effects held beside them.
    pub fn model_with<'a>(
        &self,
        test: &Test,
        machine: &'a Machine,
        held: &[HeldEffect],
    ) -> Result<Model<'a>> {
        let names: Vec<String> = test.mountings().iter().map(|m| m.name.clone()).collect();
        let mountings = test.mountings().iter().map(|m| m.mounting).collect();
        let mut terms = place::terms(&self.terms, self.frame.as_ref(), machine, &names)?;
        let curves = test.estimation().curves.iter().map(|(curve, values)| HeldEffect {
            form: Form::Empirical(curve.clone()),
            amplitudes: values.clone(),
            run: None,
            earlier_s: 0.0,
        });
        for held in curves.chain(held.iter().cloned()) {
            terms.push(Box::new(held));
        }
        Ok(Model::new(machine, mountings, terms))
    }
}
