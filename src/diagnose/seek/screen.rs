//! Every cause tried on every seat, cheaply: what is worth a closer look.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::candidate::Candidate;
use super::channel::{Channel, Look, Worths};
use super::curves;
use super::knock;
use super::vibration;
use crate::diagnose::thresholds::SHOWS;
use crate::identify::Campaign;
use crate::machine::Axis;
use crate::model::{
    Ball, CAUSES, Cause, Coefficient, Component, Inner, Law, Power, Runs, Seat, SetUp, Shape,
    Start, Variable,
};
use crate::residual::{Anywhere, Beside, Element, Fitted, System, Tuning};

/// The shortest period looked for, mm: a reading every 0.83 mm still tells it.
const SHORTEST_MM: f64 = 2.0;
/// Periods of one error function that are looked at closely.
const PERIODS: usize = 4;
/// Peaks this close, in steps of a fifth of a wave over the way, are side lobes of the higher one; what is left
/// of the lower one when that is accounted for is looked at then.
const SIDE_LOBES: usize = 12;
/// Waves shorter than this part of the way are not followed by the cubics.
const FAST: f64 = 6.0;
/// Everything that effects may hang on, gathered once.
#[derive(Debug)]
pub(crate) struct Screen {
    channels: Vec<Channel>,
    /// Causes that hang on nothing that is gathered: pass over the samples each.
    direct: Vec<(Element, Anywhere)>,
}

/// What the screen shows beside what is accepted.
#[derive(Debug)]
pub(crate) struct Prospect<'a> {
    pub(crate) beside: Beside<'a>,
    pub(crate) looks: Vec<Look<'a>>,
    direct: &'a [(Element, Anywhere)],
}

/// Numbers from one to another, evenly in the logarithm.
fn grid(low: f64, high: f64, count: usize) -> Vec<f64> {
    let ratio = (high / low).ln() / (count - 1) as f64;
    (0..count).map(|k| low * (k as f64 * ratio).exp()).collect()
}

/// Everything that effects, known or not, may hang on: a variable, whether with the sense, and what they displace.
pub(super) fn gathered() -> Vec<(Variable, bool, Vec<Seat>)> {
    let mut plan: Vec<(Variable, bool, Vec<Seat>)> = Vec::new();
    for axis in Axis::ALL {
        let functions: Vec<Seat> =
            Component::ALL.into_iter().map(|component| Seat::Function(axis, component)).collect();
        let slide = vec![Seat::Slide(axis)];
        plan.push((Variable::Position(axis), false, functions.clone()));
        plan.push((Variable::Position(axis), true, functions.clone()));
        plan.push((Variable::WaySinceReversal(axis), true, functions.clone()));
        // A slide as a whole is its own positioning error.
        let mut others = functions;
        others[axis.index()] = Seat::Slide(axis);
        plan.push((Variable::Velocity(axis), false, others));
        plan.push((Variable::Velocity(axis), true, slide.clone()));
        plan.push((Variable::SinceReversal(axis), true, slide));
    }
    let balls = Axis::ALL.map(|axis| Seat::Ball(SetUp { ball: Ball::Tool, axis }));
    let scales = [Component::X, Component::Y, Component::Z]
        .into_iter()
        .zip(Axis::ALL)
        .map(|(component, slide)| Coefficient { slide, component, power: Power::P1 })
        .map(Seat::Coefficient);
    plan.push((
        Variable::Elapsed,
        false,
        balls.into_iter().chain(scales).chain([Seat::Bar]).collect(),
    ));
    plan
}

impl Screen {
    /// Gathers what an effect may hang on.
    pub(crate) fn new(alone: &Beside, campaign: &Campaign) -> Self {
        let gathered = gathered();
        let seats = gathered.iter().flat_map(|(_, _, seats)| seats).copied().collect();
        let worths = Worths::of(alone.residuals, seats);
        let channels: Vec<Vec<Channel>> = gathered
            .par_iter()
            .map(|(variable, with_sense, seats)| {
                Channel::gather(&worths, *variable, *with_sense, seats)
            })
            .collect();
        let direct: Vec<Shape> = CAUSES.iter().flat_map(|cause| direct(cause, campaign)).collect();
        let direct = direct
            .into_par_iter()
            .filter_map(|shape| {
                let element = Element::shared(shape);
                let system = System::of(alone, &element);
                // What the model follows never shows.
                (system.share_outside() > SHOWS).then(|| (element, system.into_anywhere()))
            })
            .collect();
        Self { channels: channels.into_iter().flatten().collect(), direct }
    }

    /// What shows beside what is accepted.
    pub(crate) fn beside<'a>(&'a self, beside: Beside<'a>) -> Prospect<'a> {
        let looks = self.channels.par_iter().map(|channel| channel.beside(&beside)).collect();
        Prospect { looks, direct: &self.direct, beside }
    }
}

impl Prospect<'_> {
    /// Candidates, the best of each cause and seat, in no order; what takes longer to look for is left out
    /// where it explains less than `least_mm2`.
    pub(crate) fn candidates(&self, tuning: &Tuning, least_mm2: f64) -> Vec<Candidate> {
        let beside = &self.beside;
        let middle_mm = &beside.residuals.middle_mm;
        let mut found: Vec<Candidate> = self
            .looks
            .par_iter()
            .map(|look| of_channel(look, middle_mm))
            .collect::<Vec<_>>()
            .concat();
        let direct: Vec<Option<Candidate>> = self
            .direct
            .par_iter()
            .map(|(element, anywhere)| {
                let columns = element.columns(beside.residuals);
                let gain_mm2 = anywhere.gain_mm2(&columns, beside)?;
                Some(Candidate { element: element.clone(), gain_mm2 })
            })
            .collect();
        found.extend(direct.into_iter().flatten());
        for cause in starting(|start| *start == Start::Moments) {
            found.extend(knock::candidates(cause, beside));
        }
        // A line that explains much less than something else is that one's shadow.
        let curve_mm2 = curves::most_mm2(&self.looks, beside.noise());
        let best_mm2 =
            found.iter().map(|found| found.gain_mm2).fold(least_mm2.max(curve_mm2), f64::max);
        for cause in starting(|start| *start == Start::Lines) {
            found.extend(vibration::candidates(cause, beside, tuning, best_mm2));
        }
        found
    }

    /// Two moves of a ball in one run that explain `least_mm2` more than one.
    pub(crate) fn there_and_back(&self, least_mm2: f64) -> Option<Fitted> {
        let moves = starting(|start| *start == Start::Moments);
        moves
            .filter(|cause| cause.runs == Runs::One)
            .find_map(|cause| knock::pair(cause, &self.beside, least_mm2))
    }
}

/// The causes whose inner number is looked for in some way.
fn starting(so: impl Fn(&Start) -> bool) -> impl Iterator<Item = &'static Cause> {
    CAUSES.iter().filter(move |cause| cause.law.inner().is_some_and(|inner| so(&inner.start)))
}

/// What hangs on no variable that is gathered, one shape for each inner number.
fn direct(cause: &'static Cause, campaign: &Campaign) -> Vec<Shape> {
    let of_seat = |seat: Seat| -> Vec<Shape> {
        let inners = match cause.law(seat) {
            Law::Harmonics(_) | Law::Corner(_) => numbers(cause, seat, 0.0, 0.0),
            Law::Constant => vec![None],
            Law::Curve(..) | Law::Wave(..) | Law::Setting | Law::Unknown(_) => Vec::new(),
        };
        inners.into_iter().map(|inner| Shape { cause, seat, inner }).collect()
    };
    let missing = |seat: &Seat| match seat {
        Seat::Coefficient(of) => !campaign.estimates(&of.to_string()),
        _ => true,
    };
    cause.seats().into_iter().filter(missing).flat_map(of_seat).collect()
}

/// The inner numbers that are tried on a seat; `longest` is the largest value of the variable, `middle` that in the middle of the
/// test.
fn numbers(cause: &Cause, seat: Seat, longest: f64, middle: f64) -> Vec<Option<f64>> {
    let Some((inner, key)) = cause.inner(seat) else { return vec![None] };
    let some = |values: Vec<f64>| values.into_iter().map(Some).collect();
    match inner.start {
        Start::Grid([low, high], count) => some(grid(low, high, count)),
        Start::TimeConstants([low, high], count) => {
            some(grid(low * longest, high * longest, count))
        }
        Start::Middle => some(vec![middle]),
        Start::Whole => some(key.whole_numbers().collect()),
        Start::Waves | Start::Lines | Start::Moments => Vec::new(),
    }
}

/// The causes that hang on a channel's variable.
pub(super) fn of_channel(channel: &Look, middle_mm: &[f64; 3]) -> Vec<Candidate> {
    let place = channel.of;
    let hangs_on_it = |cause: &&Cause| {
        let axis = place.variable.slide().unwrap_or(Axis::X);
        let over = cause.law(place.seat).over();
        let same = over.is_some_and(|over| {
            (over.variable)(axis) == place.variable && over.with_sense == place.with_sense
        });
        same && cause.seats().contains(&place.seat)
    };
    let middle = place.variable.slide().map_or(0.0, |axis| middle_mm[axis.index()]);
    CAUSES.iter().filter(hangs_on_it).flat_map(|cause| of_cause(cause, channel, middle)).collect()
}

/// A cause in a channel: the number inside that explains most, or each that is another thing.
fn of_cause(cause: &'static Cause, channel: &Look, middle: f64) -> Vec<Candidate> {
    let seat = channel.of.seat;
    let f = match cause.law(seat) {
        Law::Curve(_, f, _) => f,
        Law::Wave(_, _, Inner { start: Start::Waves, .. }) => return cyclic(cause, channel),
        _ => return Vec::new(),
    };
    let explained = |inner: Option<f64>| {
        let at = |value: f64| f(value, inner.unwrap_or(0.0));
        // What it is before its slide has ever reversed; over other variables no sample is there.
        let never = Some(at(f64::INFINITY)).filter(|f| f.is_finite());
        let over = channel.centers.iter().copied().map(at).chain(never).collect();
        let explained = channel.explained(&[over], 0.0)?;
        (explained.share_outside > SHOWS).then_some((inner, explained.gain_mm2))
    };
    let candidate = |(inner, gain_mm2): (Option<f64>, f64)| {
        let shape = Shape { cause, seat, inner };
        Candidate { element: Element::shared(shape), gain_mm2 }
    };
    let longest = channel.centers.iter().copied().fold(1.0, f64::max);
    let found = numbers(cause, seat, longest, middle).into_iter().filter_map(explained);
    match cause.law(seat).inner() {
        Some(Inner { start: Start::Whole, .. }) => found.map(candidate).collect(),
        _ => found.max_by(|a, b| a.1.total_cmp(&b.1)).map(candidate).into_iter().collect(),
    }
}

/// The periods of an error function that explain most.
fn cyclic(cause: &'static Cause, channel: &Look) -> Vec<Candidate> {
    let [low, high] = channel.range();
    let way_mm = high - low;
    if way_mm < 4.0 * SHORTEST_MM {
        return Vec::new();
    }
    let step = 0.2 / way_mm;
    let count = ((SHORTEST_MM.recip() - 0.8 / way_mm) / step) as usize;
    let sums = channel.sums();
    let waves = |number: f64| -> [Vec<f64>; 2] {
        let turns = channel.centers.iter().map(|v| (TAU * v * number).sin_cos());
        let (sine, cosine): (Vec<f64>, Vec<f64>) = turns.unzip();
        [sine, cosine]
    };
    // Rotated from one wave number to the next.
    let [mut sine, mut cosine] = waves(0.8 / way_mm);
    let turn: Vec<(f64, f64)> =
        channel.centers.iter().map(|v| (TAU * v * step).sin_cos()).collect();
    let gains: Vec<f64> = (0..count)
        .map(|k| {
            let number = 0.8 / way_mm + k as f64 * step;
            let gain = if number * way_mm > FAST {
                sums.explained(&sine, &cosine)
            } else {
                let shapes = [sine.clone(), cosine.clone()];
                channel.explained(&shapes, 1e-6).map_or(0.0, |explained| explained.gain_mm2)
            };
            for ((s, c), (ts, tc)) in sine.iter_mut().zip(&mut cosine).zip(&turn) {
                (*s, *c) = (*s * tc + *c * ts, *c * tc - *s * ts);
            }
            gain
        })
        .collect();
    let mut peaks: Vec<usize> = (0..count)
        .filter(|&k| {
            let beside = |i: usize| gains.get(i).copied().unwrap_or(0.0);
            gains[k] > 0.0 && gains[k] >= beside(k + 1) && (k == 0 || gains[k] > beside(k - 1))
        })
        .collect();
    peaks.sort_by(|a, b| gains[*b].total_cmp(&gains[*a]));
    let mut apart: Vec<usize> = Vec::new();
    for peak in peaks {
        if apart.iter().all(|other| other.abs_diff(peak) > SIDE_LOBES) {
            apart.push(peak);
        }
    }
    apart
        .into_iter()
        .take(PERIODS)
        .filter_map(|k| {
            let number = 0.8 / way_mm + k as f64 * step;
            let explained = channel.explained(&waves(number), 1e-6)?;
            let shape = Shape { cause, seat: channel.of.seat, inner: Some(number.recip()) };
            (explained.share_outside > SHOWS).then_some(Candidate {
                element: Element::shared(shape),
                gain_mm2: explained.gain_mm2,
            })
        })
        .collect()
}
