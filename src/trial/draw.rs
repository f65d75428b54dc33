//! Which effect is hidden, apart from how much of it.

use super::chance::Chance;
use crate::machine::Axis;
use crate::model::{Ball, CAUSES, Cause, Coefficient, Component, Effect, Power, Seat, SetUp};

/// The causes that are hidden in trials of the library.
pub const DRAWN: [&str; 11] = [
    "cyclic",
    "servo",
    "reversal-spike",
    "growing-backlash",
    "pre-sliding",
    "drift",
    "knock",
    "roundness",
    "degree",
    "vibration",
    "stick-slip",
];
/// The causes that the library does not have.
pub(super) const OUTSIDE: [&str; 3] = ["bump", "joint", "friction-tilt"];
/// Periods of screws, of their halves and of encoders, mm; as often as each, any other.
const PERIODS_MM: [f64; 9] = [20.0, 10.0, 5.0, 10.0 / 3.0, 4.0, 6.0, 8.0, 12.0, 16.0];
/// What any other is between, mm.
const PERIOD_MM: [f64; 2] = [3.0, 60.0];

/// Where and when a campaign measures.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reach {
    /// From .. to of every slide, mm.
    pub(super) travel_mm: [[f64; 2]; 3],
    /// First and last sample of every run, s since its program began.
    pub(super) elapsed_s: Vec<[f64; 2]>,
}

/// An effect of a cause, with an amplitude of its own unit: 1 um, 10 urad.
pub(super) fn effect(cause: &'static Cause, reach: &Reach, chance: &mut Chance) -> Effect {
    let seat = seat(cause, chance);
    let within = |[low, high]: [f64; 2], share: f64| {
        let aside = share * (high - low);
        [low + aside, high - aside]
    };
    let run = chance.below(reach.elapsed_s.len());
    let slide = match seat {
        Seat::Function(slide, _) | Seat::Slide(slide) => slide.index(),
        _ => 0,
    };
    let degree = match cause.id {
        "roundness" => 3 + chance.below(4),
        _ => 4 + chance.below(2),
    };
    let mut number = |key: &str| match key {
        "period_mm" => match chance.below(PERIODS_MM.len() + 1) {
            k if k < PERIODS_MM.len() => PERIODS_MM[k],
            _ => chance.between(PERIOD_MM),
        },
        "phase_rad" => chance.between([0.0, std::f64::consts::TAU]),
        "decay_ms" => chance.log_between([0.1, 2.0]),
        "distance_mm" => chance.log_between([0.5, 30.0]),
        "time_constant_s" => chance.log_between([100.0, 3000.0]),
        "moment_s" => chance.between(within(reach.elapsed_s[run], 0.1)),
        "run" => run as f64 + 1.0,
        "degree" => degree as f64,
        "order" => chance.below(2 * degree + 1) as f64 - degree as f64,
        "frequency_hz" => chance.log_between([0.1, 60.0]),
        "speed_mm_min" => chance.log_between([5.0, 500.0]) / 60.0,
        "at_mm" => chance.between(within(reach.travel_mm[slide], 0.1)),
        "width_mm" => chance.between([4.0, 40.0]),
        "delay_ms" => 1e-3 * chance.sign(),
        // 0.1 mm from one end to the other of 100 mm, or a hundredth of it in rad.
        "slope_um_m" => 1e-5 * unit(seat) * chance.sign(),
        _ => 1e-3 * unit(seat) * chance.sign(),
    };
    let values = cause.keys.iter().map(|key| number(key.name)).collect();
    Effect::new(cause, seat, values)
}

/// What 1 mm is in the unit of a seat, for a first guess: angles act on levers of some 100 mm.
fn unit(seat: Seat) -> f64 {
    match seat {
        Seat::Function(_, component) if component.is_angular() => 1e-2,
        Seat::Coefficient(_) => 1e-2,
        _ => 1.0,
    }
}

fn seat(cause: &Cause, chance: &mut Chance) -> Seat {
    let translations = &Component::ALL[..3];
    let slide = chance.one_of(&Axis::ALL);
    let ball = |ball, axis| Seat::Ball(SetUp { ball, axis });
    match cause.id {
        "cyclic" | "degree" | "bump" | "joint" => {
            Seat::Function(slide, chance.one_of(&Component::ALL))
        }
        "growing-backlash" | "pre-sliding" => Seat::Function(slide, chance.one_of(translations)),
        "friction-tilt" => Seat::Function(slide, chance.one_of(&Component::ALL[3..])),
        "knock" => ball(chance.one_of(&[Ball::Tool, Ball::Workpiece]), slide),
        "vibration" if chance.below(4) == 3 => Seat::Bar,
        "vibration" => ball(Ball::Tool, slide),
        "drift" => match chance.below(10) {
            0..3 => ball(Ball::Tool, slide),
            3..6 => ball(Ball::Workpiece, slide),
            6..9 => {
                let component = translations[slide.index()];
                Seat::Coefficient(Coefficient { slide, component, power: Power::P1 })
            }
            _ => Seat::Bar,
        },
        "roundness" => Seat::Whole,
        _ => Seat::Slide(slide),
    }
}

/// The causes of these names.
pub(super) fn causes(names: &[&str]) -> Vec<&'static Cause> {
    CAUSES.iter().filter(|cause| names.contains(&cause.id)).collect()
}
