//! Logs that stand at each other's runs.

use rayon::prelude::*;

use super::fit::leaves_roughly_mm;
use super::input::{Options, RunInput};
use super::measured::MeasuredRun;
use super::result::IdentifiedRun;
use crate::error::{Error, Kind, Result};
use crate::machine::Machine;
use crate::model::Model;
use crate::plan::Test;

/// Two runs with the log of each at the other's program.
fn exchanged(a: &MeasuredRun, b: &MeasuredRun) -> [MeasuredRun; 2] {
    let with_log =
        |of: &MeasuredRun, log: &MeasuredRun| MeasuredRun { log: log.log.clone(), ..of.clone() };
    [with_log(a, b), with_log(b, a)]
}

/// A feed that is farther off than a control's own doing, as a share of 1.
const OTHER_FEED: f64 = 0.02;

/// Whether a run was driven at another feed than is stated.
pub(super) fn at_another_feed(run: &IdentifiedRun) -> bool {
    run.alignment.time_map.override_excess.abs() >= OTHER_FEED
}

/// Whether a log can be laid over its program at the feed that is stated.
pub(super) fn as_stated(run: &MeasuredRun, test: &Test, machine: &Machine) -> bool {
    let aligned = run.aligned(test, machine);
    aligned.is_ok_and(|run| run.alignment.time_map.override_excess.abs() < OTHER_FEED)
}

/// Two runs whose logs can be laid over each other's program, which is another one.
pub(super) struct Pair {
    /// Their indices.
    pub(super) of: [usize; 2],
    /// The same with the log of each at the other's program.
    pub(super) exchanged: [MeasuredRun; 2],
    /// Whether both were driven at the feed that is stated then.
    pub(super) as_stated: bool,
}

/// Pairs of runs, of those that are `possible`, whose logs fit the other's program: at the feed that is stated, or at whatever
/// feed where a pair is to be looked at so.
pub(super) fn pairs(
    runs: &[&MeasuredRun],
    possible: &dyn Fn([usize; 2]) -> bool,
    at_any_feed: &dyn Fn([usize; 2]) -> bool,
    test: &Test,
    machine: &Machine,
) -> Vec<Pair> {
    let pairs = (0..runs.len()).flat_map(|k| (k + 1..runs.len()).map(move |l| [k, l]));
    let differ = |[k, l]: [usize; 2]| {
        runs[k].source != runs[l].source || runs[k].mounting != runs[l].mounting
    };
    let pair = |of: [usize; 2]| {
        let exchanged = exchanged(runs[of[0]], runs[of[1]]);
        let as_stated = exchanged.iter().all(|run| as_stated(run, test, machine));
        let laid = || exchanged.iter().all(|run| run.aligned(test, machine).is_ok());
        let fits = as_stated || at_any_feed(of) && laid();
        fits.then_some(Pair { of, exchanged, as_stated })
    };
    pairs.filter(|of| possible(*of) && differ(*of)).filter_map(pair).collect()
}

impl Pair {
    /// Repeats with the logs of the two exchanged.
    pub(super) fn in_place(&self, repeats: &[Vec<MeasuredRun>]) -> Vec<Vec<MeasuredRun>> {
        let of_run = |run: &MeasuredRun| {
            self.exchanged.iter().find(|other| other.name == run.name).unwrap_or(run).clone()
        };
        repeats.iter().map(|runs| runs.iter().map(of_run).collect()).collect()
    }

    fn is_of(&self, runs: &[MeasuredRun]) -> bool {
        runs.iter().any(|run| self.exchanged.iter().any(|other| other.name == run.name))
    }
}

/// The pair whose exchange leaves least, where that is at `most` so much of what is left as they are listed, of squares, as far
/// as a first look at the smooth path tells. Wrong logs take longest to identify: no second look at others is worth its time.
pub(super) fn likeliest<'a>(
    pairs: &[&'a Pair],
    repeats: &[Vec<MeasuredRun>],
    model: &Model,
    test: &Test,
    most: f64,
) -> Option<&'a Pair> {
    let options = Options::of(test);
    // Sum of squares, mm²; unbounded where the logs cannot be laid or fitted.
    let leaves_mm2 = |runs: &Vec<MeasuredRun>| {
        let laid = runs.iter().map(|run| run.aligned(test, model.machine()));
        let laid = laid.collect::<Result<Vec<RunInput>>>().ok()?;
        let used: usize = laid.iter().map(|run| run.samples().len()).sum();
        Some(leaves_roughly_mm(model, laid, &options).ok()?.powi(2) * used as f64)
    };
    let leaves_mm2 = |runs: &Vec<MeasuredRun>| leaves_mm2(runs).unwrap_or(f64::INFINITY);
    let as_listed_mm2: Vec<f64> = repeats.par_iter().map(leaves_mm2).collect();
    let exchanged_mm2 = |pair: &&Pair| -> f64 {
        let now = pair.in_place(repeats);
        let of = |(runs, as_listed_mm2): (&Vec<MeasuredRun>, &f64)| {
            if pair.is_of(runs) { leaves_mm2(runs) } else { *as_listed_mm2 }
        };
        now.iter().zip(&as_listed_mm2).map(of).sum()
    };
    let left_mm2: Vec<f64> = pairs.par_iter().map(exchanged_mm2).collect();
    let (pair, left_mm2) = pairs.iter().zip(left_mm2).min_by(|a, b| a.1.total_cmp(&b.1))?;
    (left_mm2 < most * as_listed_mm2.iter().sum::<f64>()).then_some(pair)
}

/// The error: which, and why.
pub(super) fn error(names: [&str; 2], why: &str, test: &Test) -> Error {
    let [a, b] = names;
    Error::new(
        Kind::Mismatch,
        format!("the logs of `{a}` and `{b}` stand at each other's run: {why}"),
    )
    .hint(format!("exchange the two `log = ...` in {}", test.file().display()))
}
