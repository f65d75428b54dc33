//! Where a ball may have moved: every moment tried in one pass, of every run by itself or of all at once.

use rayon::prelude::*;

use super::candidate::Candidate;
use crate::diagnose::thresholds::SHOWS;
use crate::model::{Cause, Form, Runs, Seat, Shape};
use crate::residual::{Beside, Element, Owner};
use crate::solve::dot;

/// A step needs so many samples of a run on either side: two readings that went wrong, one after the other, are fewer than half of
/// them. Whether so few say enough is for what counts to decide.
const FEWEST: usize = 5;

/// Runs that have a step in common: repeat and run of each.
struct Group {
    owner: Owner,
    runs: Vec<(usize, usize)>,
}

/// The best moment of every ball and, where each run has its own, every run.
pub(crate) fn candidates(cause: &'static Cause, beside: &Beside) -> Vec<Candidate> {
    let runs: Vec<(usize, usize)> = beside.residuals.runs().collect();
    let groups: Vec<Group> = match cause.runs {
        Runs::One => runs
            .iter()
            .map(|&(repeat, run)| Group {
                owner: Owner::One { repeat, run },
                runs: vec![(repeat, run)],
            })
            .collect(),
        Runs::Alike => vec![Group { owner: Owner::All, runs }],
        Runs::Each => vec![Group { owner: Owner::EachRun, runs }],
    };
    let seats = cause.seats();
    let each = |group: usize| seats.iter().map(move |seat| (group, *seat));
    let places: Vec<(usize, Seat)> = (0..groups.len()).flat_map(each).collect();
    let found: Vec<Option<Candidate>> = places
        .par_iter()
        .map(|&(group, seat)| {
            let Group { owner, runs } = &groups[group];
            let at_once = Shape { cause, seat, inner: Some(0.0) };
            let (moment_s, gain_mm2) = best_moment(beside, runs, &at_once)?;
            let shape = Shape { inner: Some(moment_s), ..at_once };
            let element = Element::new(Form::Cause(shape), *owner);
            Some(Candidate { element, gain_mm2 })
        })
        .collect();
    found.into_iter().flatten().collect()
}

/// Moment (s) and gain (mm²) of the best step of a ball at the same moment of these runs.
fn best_moment(beside: &Beside, runs: &[(usize, usize)], step: &Shape) -> Option<(f64, f64)> {
    let repeats = &beside.residuals.repeats;
    let mut samples: Vec<(usize, usize)> = runs
        .iter()
        .flat_map(|&(repeat, run)| {
            repeats[repeat].runs[run].samples.clone().map(move |k| (repeat, k))
        })
        .collect();
    let time = step.dependence()?.variable;
    let time_s = |&(repeat, k): &(usize, usize)| {
        let at = &repeats[repeat].samples[k].situation;
        time.value(&at.pose, &at.motion).unwrap_or(0.0)
    };
    samples.sort_by(|a, b| time_s(b).total_cmp(&time_s(a)));
    let few = FEWEST * runs.len();
    // Sums from the end of the runs back to a sample: those of the column of a step before it.
    let mut along: Vec<Vec<f64>> = repeats.iter().map(|of| vec![0.0; of.basis.rank()]).collect();
    let mut followed = vec![0.0; repeats.len()];
    let mut along_span = vec![0.0; beside.span.len()];
    let (mut squares, mut common) = (0.0, 0.0);
    let mut best: Option<(usize, f64)> = None;
    for (later, &(repeat, k)) in samples.iter().enumerate() {
        let sample = &repeats[repeat].samples[k];
        let worth = step.seat.sensitivity(&sample.situation) * sample.root_weight;
        for (a, q) in along[repeat].iter_mut().zip(repeats[repeat].basis.row(k)) {
            *a += worth * q;
        }
        followed[repeat] = dot(&along[repeat], &along[repeat]);
        for (a, unit) in along_span.iter_mut().zip(&beside.span) {
            if let Some(u) = unit[repeat].get(k) {
                *a += worth * u;
            }
        }
        squares += worth * worth;
        common += worth * beside.left_mm[repeat][k];
        let left = squares - followed.iter().sum::<f64>() - dot(&along_span, &along_span);
        let inside = later + 1 >= few && samples.len() - later > few;
        if inside && left > SHOWS * squares {
            let gain = common * common / left;
            if best.is_none_or(|(_, most)| gain > most) {
                best = Some((later, gain));
            }
        }
    }
    let (later, gain) = best?;
    let moment_s = 0.5 * (time_s(samples.get(later + 1)?) + time_s(&samples[later]));
    Some((moment_s, gain))
}
