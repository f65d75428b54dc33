//! Where a ball may have moved: every moment tried in one pass, of every run by itself or of all at once; and where it may have moved
//! and come back.

use rayon::prelude::*;

use super::candidate::Candidate;
use crate::diagnose::thresholds::{SHOWS, UNDECIDED_SIGMAS};
use crate::model::{Cause, Form, Runs, Seat, Shape};
use crate::residual::{self, Beside, Element, Fitted, Noise, Owner};
use crate::solve::dot;

/// A step needs so many samples of a run on either side: two readings that went wrong, one after the other, are fewer than half of
/// them. Whether so few say enough is for what counts to decide.
const FEWEST: usize = 5;
/// Two steps are looked for at so many moments of a run first,
const MOMENTS: usize = 48;
/// where a share of what counts is enough, because either may be half a distance off;
const NEAR: f64 = 0.5;
/// and then each to the sample, in turns.
const ROUNDS: usize = 4;
/// Gains of one column differ by less.
const ROUNDING: f64 = 1e-6;

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

/// Two steps of one ball in one run that together explain most: of a ball that stood off for a while and came back either step by itself
/// explains next to nothing. `None` where no second one explains `least_mm2` more than the best by itself, or where it is not decided
/// between this and the same of another ball or direction, as within one arc about a pole.
pub(crate) fn pair(cause: &'static Cause, beside: &Beside, least_mm2: f64) -> Option<Fitted> {
    let runs: Vec<(usize, usize)> = beside.residuals.runs().collect();
    let of_seat = |seat: Seat| runs.iter().map(move |&(repeat, run)| (seat, repeat, run));
    let places: Vec<(Seat, usize, usize)> = cause.seats().into_iter().flat_map(of_seat).collect();
    let found: Vec<Option<([Element; 2], f64)>> = places
        .par_iter()
        .map(|&(seat, repeat, run)| {
            let at_once = Shape { cause, seat, inner: Some(0.0) };
            let steps = Steps::of(beside, &[(repeat, run)], &at_once)?;
            let (moments_s, gain_mm2) = steps.best_pair(least_mm2)?;
            let owner = Owner::One { repeat, run };
            let element = |moment_s| {
                let shape = Shape { inner: Some(moment_s), ..at_once };
                Element::new(Form::Cause(shape), owner)
            };
            Some((moments_s.map(element), gain_mm2))
        })
        .collect();
    let found: Vec<([Element; 2], f64)> = found.into_iter().flatten().collect();
    let (best, most_mm2) = found.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let fitted = residual::fit(beside, best.to_vec())?;
    // What another one with the trace t' lacks of t is |t - t'|², with the deviation 2 sqrt(v) |t - t'|. The same column to rounding is
    // named as its first seat.
    let noise = Noise::of(beside.residuals, &fitted.left_mm(beside));
    let undecided_mm2 = (2.0 * UNDECIDED_SIGMAS).powi(2) * noise.long_run_mm2;
    let nearly = (most_mm2 - undecided_mm2)..(most_mm2 * (1.0 - ROUNDING));
    let untold = found
        .iter()
        .any(|(other, gain_mm2)| nearly.contains(gain_mm2) && other[0].owner == best[0].owner);
    (!untold).then_some(fitted)
}

/// Moment (s) and gain (mm²) of the best step of a ball at the same moment of these runs.
fn best_moment(beside: &Beside, runs: &[(usize, usize)], step: &Shape) -> Option<(f64, f64)> {
    let steps = Steps::of(beside, runs, step)?;
    let (best, gain_mm2) = steps.best(None)?;
    Some((steps.moment_s(&best)?, gain_mm2))
}

/// The steps of a ball at every moment of some runs.
struct Steps<'a> {
    beside: &'a Beside<'a>,
    seat: Seat,
    /// Time (s), repeat and sample, the latest first.
    samples: Vec<(f64, usize, usize)>,
    /// A step has so many samples on either side.
    few: usize,
}

/// Sums over the samples after a step, which are those of its column.
#[derive(Clone)]
struct Sums {
    /// The first sample after it, from the end.
    later: usize,
    /// With what the fits of each repeat follow, and their squares,
    along: Vec<Vec<f64>>,
    followed: Vec<f64>,
    /// with the accepted effects,
    along_span: Vec<f64>,
    /// with itself and with what is left.
    squares: f64,
    common: f64,
}

impl Sums {
    /// The product of two steps outside of what the fits follow and of the accepted effects.
    fn outside(&self, other: &Self) -> f64 {
        let along = self.along.iter().zip(&other.along);
        let followed: f64 = along.map(|(a, b)| dot(a, b)).sum();
        self.squares.min(other.squares) - followed - dot(&self.along_span, &other.along_span)
    }

    /// The square of a step outside of them; `None` where too little is left of it.
    fn left(&self) -> Option<f64> {
        let followed = self.followed.iter().sum::<f64>();
        let left = self.squares - followed - dot(&self.along_span, &self.along_span);
        (left > SHOWS * self.squares).then_some(left)
    }

    /// What a step explains, mm², or two with amplitudes of their own.
    fn gain_mm2(&self, other: Option<&Self>) -> Option<f64> {
        let left = self.left()?;
        let Some(other) = other else { return Some(self.common * self.common / left) };
        let (others, both) = (other.left()?, self.outside(other));
        let apart = left * others - both * both;
        if apart < SHOWS * left * others {
            return None;
        }
        let (a, b) = (self.common, other.common);
        Some((a * a * others - 2.0 * a * b * both + b * b * left) / apart)
    }
}

impl<'a> Steps<'a> {
    fn of(beside: &'a Beside<'a>, runs: &[(usize, usize)], step: &Shape) -> Option<Self> {
        let repeats = &beside.residuals.repeats;
        let time = step.dependence()?.variable;
        let of_run = |&(repeat, run): &(usize, usize)| {
            repeats[repeat].runs[run].samples.clone().map(move |k| {
                let at = &repeats[repeat].samples[k].situation;
                (time.value(&at.pose, &at.motion).unwrap_or(0.0), repeat, k)
            })
        };
        let mut samples: Vec<(f64, usize, usize)> = runs.iter().flat_map(of_run).collect();
        samples.sort_by(|a, b| b.0.total_cmp(&a.0));
        Some(Self { beside, seat: step.seat, samples, few: FEWEST * runs.len() })
    }

    /// In the middle between the last sample before a step and the first after it.
    fn moment_s(&self, step: &Sums) -> Option<f64> {
        Some(0.5 * (self.samples.get(step.later + 1)?.0 + self.samples[step.later].0))
    }

    /// Looks at the step before every sample, from the end of the runs back.
    fn each(&self, mut look: impl FnMut(&Sums)) {
        let repeats = &self.beside.residuals.repeats;
        let mut sums = Sums {
            later: 0,
            along: repeats.iter().map(|of| vec![0.0; of.basis.rank()]).collect(),
            followed: vec![0.0; repeats.len()],
            along_span: vec![0.0; self.beside.span.len()],
            squares: 0.0,
            common: 0.0,
        };
        for (later, &(_, repeat, k)) in self.samples.iter().enumerate() {
            let sample = &repeats[repeat].samples[k];
            let worth = self.seat.sensitivity(&sample.situation) * sample.root_weight;
            let along = &mut sums.along[repeat];
            for (a, q) in along.iter_mut().zip(repeats[repeat].basis.row(k)) {
                *a += worth * q;
            }
            sums.followed[repeat] = dot(along, along);
            for (a, unit) in sums.along_span.iter_mut().zip(&self.beside.span) {
                if let Some(u) = unit[repeat].get(k) {
                    *a += worth * u;
                }
            }
            sums.squares += worth * worth;
            sums.common += worth * self.beside.left_mm[repeat][k];
            sums.later = later;
            if later + 1 >= self.few && self.samples.len() - later > self.few {
                look(&sums);
            }
        }
    }

    /// The step that explains most, beside another one or by itself, with what that is, mm².
    fn best(&self, other: Option<&Sums>) -> Option<(Sums, f64)> {
        let mut best: Option<(Sums, f64)> = None;
        self.each(|sums| {
            let far = other.is_none_or(|other| sums.later.abs_diff(other.later) >= self.few);
            if let Some(gain) = sums.gain_mm2(other).filter(|_| far)
                && best.as_ref().is_none_or(|(_, most)| gain > *most)
            {
                best = Some((sums.clone(), gain));
            }
        });
        best
    }

    /// Moments (s) and gain (mm²) of the two steps that explain most, the later one first; `None` where that is not so much more than
    /// the best one does.
    fn best_pair(&self, least_mm2: f64) -> Option<([f64; 2], f64)> {
        let every = self.samples.len().div_ceil(MOMENTS).max(self.few);
        let mut marks: Vec<Sums> = Vec::new();
        let mut best_mm2 = 0.0_f64;
        self.each(|sums| {
            best_mm2 = best_mm2.max(sums.gain_mm2(None).unwrap_or(0.0));
            if sums.later % every == 0 {
                marks.push(sums.clone());
            }
        });
        let pairs = marks.iter().enumerate().flat_map(|(k, early)| {
            marks[..k].iter().filter_map(move |late| Some((early, early.gain_mm2(Some(late))?)))
        });
        let (mut one, coarse_mm2) = pairs
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, gain_mm2)| *gain_mm2 > best_mm2 + NEAR * least_mm2)
            .map(|(one, gain_mm2)| (one.clone(), gain_mm2))?;
        // Each to the sample, beside where the other is: where both were half a distance off the first look is again.
        let mut gain_mm2 = coarse_mm2;
        let mut two = None;
        for _ in 0..ROUNDS {
            let (other, better_mm2) = self.best(Some(&one))?;
            two = Some(std::mem::replace(&mut one, other));
            gain_mm2 = better_mm2;
        }
        let mut moments_s = [self.moment_s(&one)?, self.moment_s(&two?)?];
        moments_s.sort_by(|a, b| b.total_cmp(a));
        (gain_mm2 > best_mm2 + least_mm2).then_some((moments_s, gain_mm2))
    }
}
