//! Effects on the error functions of a slide.

use std::f64::consts::TAU;

use super::readings::warmed;
use crate::machine::{Axis, SlideError};
use crate::model::{AMPLITUDE, Component, Effect, Seat};
use crate::simulate::bend::Condition;

/// The length that the amplitude of a higher degree is stated at, mm.
const DEGREE_AT_MM: f64 = 100.0;

/// The speed that the amplitude of a friction tilt is stated at, mm/s: 1000 mm/min.
const TILT_AT_MM_S: f64 = 1000.0 / 60.0;

/// Adds what the effects make of the error functions to the errors of the slides (mm and rad, directions
/// of `F`): displacements of the slide itself, as the coefficients of the paper are.
pub(crate) fn add_to_slides(hidden: &[Effect], now: &Condition, slides: &mut [SlideError; 3]) {
    for effect in hidden {
        let (slide, component, value) = match effect.seat {
            Seat::Function(slide, component) => (slide, component, error(effect, slide, now)),
            // The scale of a slide that warms; a hidden coefficient is one of the machine's own.
            Seat::Coefficient(of) if effect.cause.id == "drift" => {
                let h_mm = now.position_mm[of.slide.index()];
                (of.slide, of.component, warmed(effect, now.elapsed_s) * h_mm)
            }
            _ => continue,
        };
        let part = part_of(&mut slides[slide.index()], component);
        *part += value;
    }
}

fn part_of(error: &mut SlideError, component: Component) -> &mut f64 {
    let vector =
        if component.is_angular() { &mut error.rotation_rad } else { &mut error.translation_mm };
    &mut vector[component.direction()]
}

/// What one effect adds to its error function, mm or rad, as the table of causes states it.
fn error(effect: &Effect, slide: Axis, now: &Condition) -> f64 {
    let k = slide.index();
    let (h_mm, sense) = (now.position_mm[k], now.sense[k]);
    let amplitude = effect.get(AMPLITUDE);
    let from_at = || (h_mm - effect.get("at")) / effect.get("width");
    match effect.cause.id {
        "cyclic" => amplitude * (TAU * h_mm / effect.get("period") + effect.get("phase")).sin(),
        "degree" => amplitude * (h_mm / DEGREE_AT_MM).powi(effect.get("degree") as i32),
        "bump" => amplitude * (-0.5 * from_at().powi(2)).exp(),
        "joint" => amplitude * from_at().tanh(),
        "growing-backlash" => effect.get("slope") * sense * (h_mm - effect.get("from")),
        "pre-sliding" => {
            // A slide that has never turned round leans as far as it can.
            let left = now.reversals[k]
                .map_or(0.0, |reversal| (-reversal.ago_mm / effect.get("distance")).exp());
            amplitude * sense * (1.0 - 2.0 * left)
        }
        // Where a slide moves, its sense is the sign of its velocity.
        "friction-tilt" => amplitude * sense * (now.velocity_mm_s[k].abs() / TILT_AT_MM_S).sqrt(),
        _ => 0.0,
    }
}
