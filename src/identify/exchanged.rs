//! Logs that stand at other runs than their own.

use rayon::prelude::*;

use super::campaign::{Campaign, Failure};
use super::fit::leaves_roughly_mm;
use super::input::{Options, RunInput};
use super::measured::{MeasuredRepeat, MeasuredRun};
use super::place;
use super::result::{Identification, IdentifiedRun};
use crate::error::{Error, Kind, Result};
use crate::machine::Machine;
use crate::model::{LOCAL, Model};
use crate::plan::Test;

/// Logs that leave less than this share of the residual when they are exchanged were: another program, or the same in
/// another place, drives other errors, and nothing but the right one halves what is left by chance.
const EXCHANGED: f64 = 0.5;

/// Where each of two runs has the errors of the other, the fit leaves about as much as readings differ from each other; a
/// tenth of that is suspicion enough.
const MIXED_UP: f64 = 0.1;

impl Campaign {
    /// What came of some measurements, unless logs of theirs stand at each other's runs: where not all can be laid over
    /// their programs, or a fit does not explain what was read.
    pub(super) fn refuse_exchanged(
        test: &Test,
        machine: &Machine,
        measured: &[MeasuredRepeat],
        of: Result<Self>,
    ) -> Result<Self> {
        let fits = |repeat: &Identification| repeat.rms_mm < MIXED_UP * repeat.spread_mm();
        let mislaid = match &of {
            Ok(campaign) => {
                let feeds = |of: &Identification| of.runs.iter().any(at_another_feed);
                !campaign.left_out.is_empty() || campaign.repeats.iter().any(feeds)
            }
            Err(_) => true,
        };
        let explained = of.as_ref().is_ok_and(|campaign| campaign.repeats.iter().all(fits));
        // A log that cannot be read is told before where it may belong.
        let unread = measured.iter().flat_map(|repeat| &repeat.runs).any(Result::is_err);
        if explained && !mislaid || of.is_err() && unread {
            return of;
        }
        let all: Vec<&MeasuredRun> = measured
            .iter()
            .flat_map(|repeat| &repeat.runs)
            .filter_map(|run| run.as_ref().ok())
            .collect();
        if let Some(pair) = pairs_of(&all).find(|[k, l]| {
            differ(all[*k], all[*l]) && all[*k].log.has_the_readings_of(&all[*l].log)
        }) {
            return Err(copied(pair.map(|k| all[k].name.as_str()), test));
        }
        let as_stated = |run: &&MeasuredRun| as_stated(run, test, machine);
        let apart: Vec<bool> = all.iter().map(|run| !as_stated(run)).collect();
        // Where all that could be laid is explained, it is one of the others that stands elsewhere.
        let any = of.is_ok() && !explained || !apart.contains(&true);
        // And neither of two that are exchanged stands in a repeat that is explained at the feed that is stated.
        let as_it_should = |run: &&MeasuredRun| {
            let is_of = |of: &&Identification| of.runs.iter().any(|other| other.name == run.name);
            let repeat = of.as_ref().ok().and_then(|of| of.repeats.iter().find(is_of));
            repeat.is_some_and(|of| fits(of) && !of.runs.iter().any(at_another_feed))
        };
        let suspect: Vec<bool> = all.iter().map(|run| !as_it_should(run)).collect();
        let possible =
            |[k, l]: [usize; 2]| suspect[k] && suspect[l] && (any || apart[k] || apart[l]);
        let may_halve = |[k, l]: [usize; 2]| {
            of.as_ref().is_ok_and(|of| of.may_halve([&all[k].name, &all[l].name]))
        };
        let at_any_feed = |pair: [usize; 2]| !explained && may_halve(pair);
        let pairs = pairs(&all, &possible, &at_any_feed, test, machine);
        let names = |pair: &Pair| pair.of.map(|k| all[k].name.as_str());
        let neither = |pair: &&Pair| pair.as_stated && pair.of.iter().all(|k| apart[*k]);
        if let Some(pair) = pairs.iter().find(neither) {
            let why = "each fits the other's program, and not its own";
            return Err(error(names(pair), why, test));
        }
        let readable = measured.iter().map(|repeat| {
            let runs = repeat.runs.iter().filter_map(|run| run.as_ref().ok());
            runs.cloned().collect()
        });
        let readable: Vec<Vec<MeasuredRun>> = readable.collect();
        let promising = |pair: &&Pair| match &of {
            Ok(_) => may_halve(pair.of),
            Err(_) => pair.as_stated,
        };
        let promising: Vec<&Pair> = pairs.iter().filter(promising).collect();
        let model = match &of {
            Ok(of) => of.model(test, machine, 0),
            Err(_) => at_the_place(&all, test, machine),
        };
        let likeliest = model
            .ok()
            .and_then(|model| likeliest(&promising, &readable, &model, test, EXCHANGED.powi(2)));
        if let Some(pair) = likeliest {
            let repeats = pair.in_place(&readable);
            let Ok(other) = Self::of_measured(test, machine, repeats, Failure::LeaveOut) else {
                return of;
            };
            let exchanged_mm = other.rms_mm();
            let (as_listed_mm, left_out) = match &of {
                Ok(campaign) => (campaign.rms_mm(), campaign.left_out.len()),
                Err(_) => (f64::INFINITY, measured.len()),
            };
            let fits_there = |name: &str| {
                let there = other.repeats.iter().find(|of| of.runs.iter().any(|r| r.name == name));
                there.is_some_and(fits)
            };
            // Where no model fits as it is listed, anything would be better.
            let now_fits = other.left_out.len() < left_out;
            let better = if now_fits {
                names(pair).into_iter().all(fits_there)
            } else {
                other.left_out.len() == left_out && exchanged_mm < EXCHANGED * as_listed_mm
            };
            if better {
                let as_listed = if now_fits {
                    "no model fits them".to_owned()
                } else {
                    format!("the model leaves {:.2} um rms", 1e3 * as_listed_mm)
                };
                let why = format!(
                    "as they are listed {as_listed}, exchanged {:.2} um",
                    1e3 * exchanged_mm
                );
                return Err(error(names(pair), &why, test));
            }
        }
        of
    }

    /// Whether what the repeats of two runs leave is so much of all that exchanging their logs may halve it: what other repeats
    /// leave stays. Where one of the runs was left out, nobody knows.
    fn may_halve(&self, runs: [&str; 2]) -> bool {
        let has = |repeat: &Identification, name: &str| repeat.runs.iter().any(|r| r.name == name);
        let leaves_mm2 = |repeat: &Identification| repeat.rms_mm.powi(2) * repeat.used as f64;
        let others = self.repeats.iter().filter(|repeat| !runs.iter().any(|run| has(repeat, run)));
        let are_in = runs.iter().all(|run| self.repeats.iter().any(|repeat| has(repeat, run)));
        let others_mm2: f64 = others.map(leaves_mm2).sum();
        !are_in || others_mm2 < EXCHANGED.powi(2) * self.leaves_mm2()
    }
}

/// Each two of some runs, once.
fn pairs_of(runs: &[&MeasuredRun]) -> impl Iterator<Item = [usize; 2]> {
    let number = runs.len();
    (0..number).flat_map(move |k| (k + 1..number).map(move |l| [k, l]))
}

/// What a machine does at the place of a test, whatever terms are asked for: for a first look where no model fits.
fn at_the_place<'a>(runs: &[&MeasuredRun], test: &Test, machine: &'a Machine) -> Result<Model<'a>> {
    let laid: Vec<RunInput> = runs.iter().filter_map(|r| r.aligned(test, machine).ok()).collect();
    let frame = place::of(test, machine, laid.iter());
    let names: Vec<String> = test.mountings().iter().map(|m| m.name.clone()).collect();
    let terms = place::terms(&[LOCAL.to_owned()], frame.as_ref(), machine, &names)?;
    Ok(Model::new(machine, test.mountings().iter().map(|m| m.mounting).collect(), terms))
}

/// Whether two runs were of other programs, or at other places.
fn differ(a: &MeasuredRun, b: &MeasuredRun) -> bool {
    a.source != b.source || a.mounting != b.mounting
}

/// Two runs with the log of each at the other's program.
fn exchanged(a: &MeasuredRun, b: &MeasuredRun) -> [MeasuredRun; 2] {
    let with_log =
        |of: &MeasuredRun, log: &MeasuredRun| MeasuredRun { log: log.log.clone(), ..of.clone() };
    [with_log(a, b), with_log(b, a)]
}

/// A feed that is farther off than a control's own doing, as a share of 1.
const OTHER_FEED: f64 = 0.02;

/// Whether a run was driven at another feed than is stated.
fn at_another_feed(run: &IdentifiedRun) -> bool {
    run.alignment.time_map.override_excess.abs() >= OTHER_FEED
}

/// Whether a log can be laid over its program at the feed that is stated.
fn as_stated(run: &MeasuredRun, test: &Test, machine: &Machine) -> bool {
    let aligned = run.aligned(test, machine);
    aligned.is_ok_and(|run| run.alignment.time_map.override_excess.abs() < OTHER_FEED)
}

/// Two runs whose logs can be laid over each other's program, which is another one.
struct Pair {
    /// Their indices.
    of: [usize; 2],
    /// The same with the log of each at the other's program.
    exchanged: [MeasuredRun; 2],
    /// Whether both were driven at the feed that is stated then.
    as_stated: bool,
}

/// Pairs of runs, of those that are `possible`, whose logs fit the other's program: at the feed that is stated, or at whatever
/// feed where a pair is to be looked at so.
fn pairs(
    runs: &[&MeasuredRun],
    possible: &dyn Fn([usize; 2]) -> bool,
    at_any_feed: &dyn Fn([usize; 2]) -> bool,
    test: &Test,
    machine: &Machine,
) -> Vec<Pair> {
    let pair = |of: [usize; 2]| {
        let exchanged = exchanged(runs[of[0]], runs[of[1]]);
        let as_stated = exchanged.iter().all(|run| as_stated(run, test, machine));
        let laid = || exchanged.iter().all(|run| run.aligned(test, machine).is_ok());
        let fits = as_stated || at_any_feed(of) && laid();
        fits.then_some(Pair { of, exchanged, as_stated })
    };
    let differ = |[k, l]: &[usize; 2]| differ(runs[*k], runs[*l]);
    pairs_of(runs).filter(|of| possible(*of)).filter(differ).filter_map(pair).collect()
}

impl Pair {
    /// Repeats with the logs of the two exchanged.
    fn in_place(&self, repeats: &[Vec<MeasuredRun>]) -> Vec<Vec<MeasuredRun>> {
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
fn likeliest<'a>(
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
fn error(names: [&str; 2], why: &str, test: &Test) -> Error {
    let [a, b] = names;
    Error::new(
        Kind::Mismatch,
        format!("the logs of `{a}` and `{b}` stand at each other's run: {why}"),
    )
    .hint(format!("exchange the two `log = ...` in {}", test.file().display()))
}

/// The error where runs that differ have the same log, which is right for one of them at most.
fn copied(names: [&str; 2], test: &Test) -> Error {
    let [a, b] = names;
    Error::new(
        Kind::Mismatch,
        format!("the logs of `{a}` and `{b}` hold the same readings, and their programs or places differ: one is not of its run"),
    )
    .hint(format!("give each run its own log in {}", test.file().display()))
}
