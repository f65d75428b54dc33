//! Effects that make the machine another one than its files say.

use nalgebra::Vector3;

use crate::machine::{Machine, Mounting, Pivot};
use crate::model::{Ball, Effect, Seat};
use crate::simulate::scenario::Scenario;

/// The scenario with the coefficients, the feed override and the clock that are hidden.
pub(crate) fn settings_of(scenario: &Scenario) -> Scenario {
    let mut real = scenario.clone();
    for effect in &scenario.hidden {
        match (effect.cause.id, effect.seat) {
            ("coefficient", Seat::Coefficient(of)) => {
                real.errors.set(of, real.errors.get(of) + effect.get("value"));
            }
            ("feed-override", _) => real.feed_override = effect.get("percent"),
            // Kept as a share in an effect, in parts per million here.
            ("clock", _) => real.clock_ppm = effect.get("ppm") / 1e-6,
            _ => {}
        }
    }
    real
}

/// The machine with the pivots that are hidden.
pub(crate) fn machine_of(machine: &Machine, hidden: &[Effect]) -> Machine {
    hidden.iter().fold(machine.clone(), |machine, effect| match (effect.cause.id, effect.seat) {
        ("pivot", Seat::Slide(slide)) => {
            let other = match machine.slide(slide).pivot {
                Pivot::Carriage => Pivot::Base,
                Pivot::Base => Pivot::Carriage,
            };
            machine.with_pivot(slide, other)
        }
        _ => machine,
    })
}

/// The mounting with the balls where they really are: the tool ball in its frame, and the machine
/// coordinates at which the balls coincide.
pub(crate) fn mounting_of(mounting: &Mounting, hidden: &[Effect]) -> Mounting {
    Mounting {
        coincidence_mm: mounting.coincidence_mm + offset_mm(hidden, Ball::Workpiece),
        tool_ball_mm: mounting.tool_ball_mm + offset_mm(hidden, Ball::Tool),
    }
}

/// How far a ball is from where the test file has it, mm.
///
/// The work offset lies at the workpiece ball, so the whole path goes along with it: of that ball this is
/// also how far every machine coordinate is from what the test file believes.
pub(crate) fn offset_mm(hidden: &[Effect], ball: Ball) -> Vector3<f64> {
    hidden.iter().filter(|effect| effect.cause.id == "ball-place").fold(
        Vector3::zeros(),
        |mut offset, effect| {
            if let Seat::Ball(of) = effect.seat
                && of.ball == ball
            {
                offset[of.axis.index()] += effect.get("offset");
            }
            offset
        },
    )
}
