//! Which effect is hidden, apart from how much of it.

use super::chance::Chance;
use crate::machine::Axis;
use crate::model::{
    Ball, CAUSES, Cause, Coefficient, Component, Effect, Law, Power, Seat, SeatKind, SetUp, Unit,
};

/// The causes that are hidden in trials of the library: those whose effect is the machine's or the bar's, and shows
/// by itself.
pub fn drawn() -> Vec<&'static Cause> {
    let shows = |law: &Law| matches!(law, Law::Curve(..) | Law::Wave(..) | Law::Harmonics(_));
    CAUSES.iter().filter(|cause| shows(&cause.law)).collect()
}

/// The causes that the library does not have.
pub(super) fn outside() -> Vec<&'static Cause> {
    CAUSES.iter().filter(|cause| !cause.is_known()).collect()
}

/// Periods of screws, of their halves and of encoders, mm; as often as each, any other.
const PERIODS_MM: [f64; 9] = [20.0, 10.0, 5.0, 10.0 / 3.0, 4.0, 6.0, 8.0, 12.0, 16.0];
/// What any other is between, mm.
const PERIOD_MM: [f64; 2] = [3.0, 60.0];

/// What one is between where nobody thinks of screws, mm.
const ANY_PERIOD_MM: [f64; 2] = [2.0, 100.0];

/// Where and when a campaign measures.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reach {
    /// From .. to of every slide, mm.
    pub(super) travel_mm: [[f64; 2]; 3],
    /// First and last sample of every run, s since its program began.
    pub(super) elapsed_s: Vec<[f64; 2]>,
    /// Whether periods are drawn evenly, not as screws have them.
    pub(super) anywhere: bool,
}

/// An effect of a cause, with an amplitude of its own unit: 1 um, 10 urad.
pub(super) fn effect(cause: &'static Cause, reach: &Reach, chance: &mut Chance) -> Effect {
    let seat = seat(cause, chance);
    let within = |[low, high]: [f64; 2], share: f64| {
        let aside = share * (high - low);
        [low + aside, high - aside]
    };
    let run = chance.below(reach.elapsed_s.len());
    let slide = seat.axis().unwrap_or(Axis::X).index();
    let degree = match cause.law {
        Law::Harmonics(_) => 3 + chance.below(4),
        _ => 4 + chance.below(2),
    };
    let mut number = |key: &str| match key {
        "period" if reach.anywhere => chance.log_between(ANY_PERIOD_MM),
        "period" => match chance.below(PERIODS_MM.len() + 1) {
            k if k < PERIODS_MM.len() => PERIODS_MM[k],
            _ => chance.between(PERIOD_MM),
        },
        "phase" => chance.between([0.0, std::f64::consts::TAU]),
        "decay" => chance.log_between([0.1, 2.0]),
        "distance" => chance.log_between([0.5, 30.0]),
        "time_constant" => chance.log_between([100.0, 3000.0]),
        "moment" => chance.between(within(reach.elapsed_s[run], 0.1)),
        "run" => run as f64 + 1.0,
        "degree" => degree as f64,
        "order" => chance.below(2 * degree + 1) as f64 - degree as f64,
        "frequency" => chance.log_between([0.1, 60.0]),
        "speed" => chance.log_between([5.0, 500.0]) / 60.0,
        "at" => chance.between(within(reach.travel_mm[slide], 0.1)),
        "width" => chance.between([4.0, 40.0]),
        "delay" => 1e-3 * chance.sign(),
        // 0.1 mm from one end to the other of 100 mm, or a hundredth of it in rad.
        "slope" => 1e-5 * unit(seat) * chance.sign(),
        _ => 1e-3 * unit(seat) * chance.sign(),
    };
    let values = cause.keys.iter().map(|key| number(key.name)).collect();
    Effect::new(cause, seat, values)
}

/// What 1 mm is in the unit of a seat, for a first guess: angles act on levers of some 100 mm.
fn unit(seat: Seat) -> f64 {
    if seat.unit() == Unit::UM { 1.0 } else { 1e-2 }
}

fn seat(cause: &Cause, chance: &mut Chance) -> Seat {
    let translations = &Component::ALL[..3];
    let slide = chance.one_of(&Axis::ALL);
    let ball = |ball, axis| Seat::Ball(SetUp { ball, axis });
    let with_sense = cause.law.over().is_some_and(|over| over.with_sense);
    match cause.seat {
        // What turns with the sense is drawn along lines, where technicians know it.
        SeatKind::Function if with_sense => Seat::Function(slide, chance.one_of(translations)),
        SeatKind::Function => Seat::Function(slide, chance.one_of(&Component::ALL)),
        SeatKind::Angle => Seat::Function(slide, chance.one_of(&Component::ALL[3..])),
        SeatKind::Ball => ball(chance.one_of(&[Ball::Tool, Ball::Workpiece]), slide),
        SeatKind::Reading if chance.below(4) == 3 => Seat::Bar,
        SeatKind::Reading => ball(Ball::Tool, slide),
        SeatKind::Body => match chance.below(10) {
            0..3 => ball(Ball::Tool, slide),
            3..6 => ball(Ball::Workpiece, slide),
            6..9 => {
                let component = translations[slide.index()];
                Seat::Coefficient(Coefficient { slide, component, power: Power::P1 })
            }
            _ => Seat::Bar,
        },
        SeatKind::Coefficient => {
            chance.one_of(&Coefficient::all().map(Seat::Coefficient).collect::<Vec<_>>())
        }
        SeatKind::None => Seat::Whole,
        SeatKind::Slide | SeatKind::Slides => Seat::Slide(slide),
    }
}
