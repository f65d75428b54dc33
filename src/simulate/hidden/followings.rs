//! Effects that keep a slide from where it is commanded to be.
//!
//! All are stated in the programmed sense: a slide that stands `d` off its commanded place displaces the
//! tool by `d` *relative to the workpiece* along programmed +H. A table (a slide on the workpiece side)
//! itself moves by `-d` in `F`; the exact chain, which is asked at the place where the slide really
//! stands, knows the sides and the pivots. The error functions are not asked there: the scale reads what
//! is commanded.

use nalgebra::Vector3;

use crate::machine::Axis;
use crate::model::{AMPLITUDE, Effect, Seat};
use crate::simulate::bend::Condition;

/// How late every slide follows, s: the tool relative to the workpiece lags by `delay · v` along the
/// programmed direction, on either side of the machine.
pub(crate) fn delay_s(hidden: &[Effect]) -> Vector3<f64> {
    of_slides(hidden, |effect, _| match effect.cause.id {
        "servo" => effect.get("delay"),
        _ => 0.0,
    })
}

/// How far friction displaces every slide, mm in the programmed sense.
///
/// - reversal spike: `A b exp(-(t - t_reversal) / decay)` in program time, 0 where the slide has never
///   turned round
/// - stick-slip: `-A b exp(-|v| / speed)`; at rest the slide still leans against its last motion
pub(crate) fn displacement_mm(hidden: &[Effect], now: &Condition) -> Vector3<f64> {
    of_slides(hidden, |effect, k| {
        let amplitude_mm = effect.get(AMPLITUDE) * now.sense[k];
        match effect.cause.id {
            "reversal-spike" => now.reversals[k].map_or(0.0, |reversal| {
                amplitude_mm * (-reversal.ago_s / effect.get("decay")).exp()
            }),
            "stick-slip" => {
                let speeds = now.velocity_mm_s[k].abs() / effect.get("speed");
                -amplitude_mm * (-speeds).exp()
            }
            _ => 0.0,
        }
    })
}

/// The sum over the effects that act on a slide as a whole.
fn of_slides(hidden: &[Effect], value: impl Fn(&Effect, usize) -> f64) -> Vector3<f64> {
    Vector3::from(Axis::ALL.map(|slide| {
        let acts = |effect: &&Effect| matches!(effect.seat, Seat::Slide(s) if s == slide);
        let on = hidden.iter().filter(|e| acts(e) || e.seat == Seat::Whole);
        on.map(|effect| value(effect, slide.index())).sum()
    }))
}
