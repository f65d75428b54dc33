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

/// Pairs of runs, of those that are `possible`, whose logs fit the other's program, at whatever feed.
pub(super) fn pairs(
    runs: &[&MeasuredRun],
    possible: &dyn Fn([usize; 2]) -> bool,
    test: &Test,
    machine: &Machine,
) -> Vec<Pair> {
    let pairs = (0..runs.len()).flat_map(|k| (k + 1..runs.len()).map(move |l| [k, l]));
    let differ = |[k, l]: [usize; 2]| {
        runs[k].source != runs[l].source || runs[k].mounting != runs[l].mounting
    };
    let pair = |of: [usize; 2]| {
        let exchanged = exchanged(runs[of[0]], runs[of[1]]);
        let excess = |run: &MeasuredRun| {
            let laid = run.aligned(test, machine).ok()?;
            Some(laid.alignment.time_map.override_excess.abs())
        };
        let [a, b] = [excess(&exchanged[0])?, excess(&exchanged[1])?];
        Some(Pair { of, exchanged, as_stated: a.max(b) < OTHER_FEED })
    };
    pairs.filter(|of| possible(*of) && differ(*of)).filter_map(pair).collect()
}

/// Whether logs that were exchanged may leave less than they do where they stand, mm rms, as far as a first look tells: those
/// that stood right leave much more then, and no second look is worth its time.
pub(super) fn may_leave_less(
    repeats: &[Vec<MeasuredRun>],
    model: &Model,
    as_listed_mm: f64,
    test: &Test,
) -> Result<bool> {
    let options = Options::of(test);
    let left = repeats.par_iter().map(|runs| {
        let laid = runs.iter().map(|run| run.aligned(test, model.machine()));
        let laid: Vec<RunInput> = laid.collect::<Result<_>>()?;
        let used: usize = laid.iter().map(|run| run.samples().len()).sum();
        Ok((leaves_roughly_mm(model, laid, &options)?.powi(2), used as f64))
    });
    let left: Vec<(f64, f64)> = left.collect::<Result<_>>()?;
    let (squares_mm2, used) =
        left.iter().fold((0.0, 0.0), |sum, (mm2, used)| (sum.0 + mm2 * used, sum.1 + used));
    Ok(squares_mm2 < as_listed_mm.powi(2) * used)
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
