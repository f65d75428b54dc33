//! Every cause tried on every seat, cheaply: what is worth a closer look.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::candidate::Candidate;
use super::channel::{Channel, Look};
use super::curves;
use super::knock;
use super::vibration;
use crate::diagnose::thresholds::SEEN;
use crate::identify::Campaign;
use crate::machine::Axis;
use crate::model::{Ball, Coefficient, Component, Kind, Power, Seat, SetUp, Shape, Variable};
use crate::residual::{Beside, Element, System, Tuning};

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
    direct: Vec<(Element, System)>,
}

/// What the screen shows beside what is accepted.
#[derive(Debug)]
pub(crate) struct Prospect<'a> {
    pub(crate) beside: Beside<'a>,
    pub(crate) looks: Vec<Look<'a>>,
    direct: &'a [(Element, System)],
}

/// Numbers from one to another, evenly in the logarithm.
fn grid(low: f64, high: f64, count: usize) -> Vec<f64> {
    let ratio = (high / low).ln() / (count - 1) as f64;
    (0..count).map(|k| low * (k as f64 * ratio).exp()).collect()
}

impl Screen {
    /// Gathers what an effect may hang on.
    pub(crate) fn new(alone: &Beside, campaign: &Campaign) -> Self {
        let mut plan: Vec<(Variable, bool, Vec<Seat>)> = Vec::new();
        for axis in Axis::ALL {
            let functions: Vec<Seat> = Component::ALL
                .into_iter()
                .map(|component| Seat::Function(axis, component))
                .collect();
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
        let channels: Vec<Vec<Channel>> = plan
            .par_iter()
            .map(|(variable, with_sense, seats)| {
                Channel::gather(alone.residuals, *variable, *with_sense, seats)
            })
            .collect();
        let roundness = Kind::Roundness.cause();
        let mut direct: Vec<Shape> = roundness
            .whole_numbers("degree")
            .map(|degree| Shape { cause: roundness, seat: Seat::Whole, inner: Some(degree) })
            .collect();
        direct.extend(
            Coefficient::all()
                .filter(|coefficient| !campaign.estimates(&coefficient.to_string()))
                .map(|coefficient| Shape {
                    cause: Kind::Coefficient.cause(),
                    seat: Seat::Coefficient(coefficient),
                    inner: None,
                }),
        );
        direct.extend(grid(1e-3, 40e-3, 24).into_iter().map(|delay_s| Shape {
            cause: Kind::Servo.cause(),
            seat: Seat::Whole,
            inner: Some(delay_s),
        }));
        let direct = direct
            .into_par_iter()
            .filter_map(|shape| {
                let element = Element::shared(shape);
                let system = System::of(alone, &element);
                // What the model follows never shows.
                (system.share_outside() > SEEN).then_some((element, system))
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
        let mut found: Vec<Candidate> =
            self.looks.par_iter().map(of_channel).collect::<Vec<_>>().concat();
        let direct: Vec<Option<Candidate>> = self
            .direct
            .par_iter()
            .map(|(element, system)| {
                let gain_mm2 = system.gain_mm2(beside)?;
                Some(Candidate { element: element.clone(), gain_mm2 })
            })
            .collect();
        found.extend(direct.into_iter().flatten());
        found.extend(knock::candidates(beside));
        // A line that explains much less than something else is that one's shadow.
        let curve_mm2 = curves::most_mm2(&self.looks, beside.noise());
        let best_mm2 =
            found.iter().map(|found| found.gain_mm2).fold(least_mm2.max(curve_mm2), f64::max);
        found.extend(vibration::candidates(beside, tuning, best_mm2));
        found
    }
}

/// The causes that hang on a channel's variable.
fn of_channel(channel: &Look) -> Vec<Candidate> {
    let place = channel.of;
    let one = |kind: Kind, inners: &[Option<f64>], shape: &dyn Fn(f64, f64) -> f64| {
        let best = inners
            .iter()
            .filter_map(|inner| {
                let at = inner.unwrap_or(0.0);
                let over: Vec<f64> = channel.centers.iter().map(|v| shape(*v, at)).collect();
                let explained = channel.explained(&[over], 0.0)?;
                (explained.share_outside > SEEN).then_some((*inner, explained.gain_mm2))
            })
            .max_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(inner, gain_mm2)| {
            let shape = Shape { cause: kind.cause(), seat: place.seat, inner };
            Candidate { element: Element::shared(shape), gain_mm2 }
        })
    };
    let some = |values: Vec<f64>| values.into_iter().map(Some).collect::<Vec<_>>();
    match (place.variable, place.with_sense) {
        (Variable::Position(_), false) => {
            let power = |h: f64, degree: f64| (h / 100.0).powi(degree as i32);
            let mut found = cyclic(channel);
            let degrees = Kind::Degree.cause().whole_numbers("degree");
            found.extend(degrees.filter_map(|degree| one(Kind::Degree, &[Some(degree)], &power)));
            found
        }
        (Variable::Position(_), true) => {
            one(Kind::GrowingBacklash, &[None], &|h, _| h).into_iter().collect()
        }
        (Variable::WaySinceReversal(_), _) => {
            let ways = some(grid(0.02, 60.0, 16));
            let shape = |s: f64, distance: f64| 1.0 - 2.0 * (-s / distance).exp();
            one(Kind::PreSliding, &ways, &shape).into_iter().collect()
        }
        (Variable::Velocity(_), false) if matches!(place.seat, Seat::Slide(_)) => {
            one(Kind::Servo, &[None], &|v, _| -v).into_iter().collect()
        }
        (Variable::Velocity(_), true) => {
            let speeds = some(grid(0.05, 20.0, 12));
            one(Kind::StickSlip, &speeds, &|v, speed| -(-v.abs() / speed).exp())
                .into_iter()
                .collect()
        }
        (Variable::SinceReversal(_), _) => {
            let decays = some(grid(0.05, 20.0, 14));
            one(Kind::ReversalSpike, &decays, &|t, decay| (-t / decay).exp()).into_iter().collect()
        }
        (Variable::Elapsed, _) => {
            let last = channel.centers.iter().copied().fold(1.0, f64::max);
            let constants = some(grid(0.03 * last, 20.0 * last, 14));
            one(Kind::Drift, &constants, &|t, constant| -(-t.max(0.0) / constant).exp_m1())
                .into_iter()
                .collect()
        }
        _ => Vec::new(),
    }
}

/// The periods of an error function that explain most.
fn cyclic(channel: &Look) -> Vec<Candidate> {
    let (low, high) = channel
        .centers
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
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
            let shape = Shape {
                cause: Kind::Cyclic.cause(),
                seat: channel.of.seat,
                inner: Some(number.recip()),
            };
            (explained.share_outside > SEEN).then_some(Candidate {
                element: Element::shared(shape),
                gain_mm2: explained.gain_mm2,
            })
        })
        .collect()
}
