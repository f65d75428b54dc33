//! Effects in words.

use crate::diagnose::Number;
use crate::machine::{Axis, Machine};
use crate::model::{AMPLITUDE, Averaged, Ball, Component, Effect, Power, Seat};
use crate::report::text::numbers::{decimals, fixed};

/// Common multiples of sample rates are looked for up to so many times the fastest.
const MOST_FOLDS: u32 = 12;
/// A drift that is as good as a straight line is told by what it does in this time, min.
const DRIFT_MIN: f64 = 15.0;

/// A period is a part of a pitch within this share of it, however well it is known.
const NEAR_A_PITCH: f64 = 2e-3;

/// A seat with what it is: `EXX (positioning of X)`; empty for the whole.
pub(super) fn seat(seat: Seat) -> String {
    match (what(seat), seat) {
        (Some(what), _) => format!("{seat} ({what})"),
        (None, Seat::Bar) => "the bar".into(),
        (None, _) => seat.to_string(),
    }
}

/// What a seat is, where its name does not say it.
pub(super) fn what(seat: Seat) -> Option<String> {
    match seat {
        Seat::Function(slide, component) => Some(function(slide, component)),
        Seat::Ball(set_up) => {
            let ball = match set_up.ball {
                Ball::Tool => "tool ball",
                Ball::Workpiece => "workpiece ball",
            };
            Some(format!("{ball} in {}", set_up.axis))
        }
        Seat::Coefficient(of) if of.power == Power::P1 && along(of.slide, of.component) => {
            Some(format!("scale of {}", of.slide))
        }
        Seat::Coefficient(of) => Some(function(of.slide, of.component)),
        Seat::Slide(_) | Seat::Bar | Seat::Whole => None,
    }
}

fn along(slide: Axis, component: Component) -> bool {
    component as usize == slide.index()
}

fn function(slide: Axis, component: Component) -> String {
    let about = ['X', 'Y', 'Z'][component.direction()];
    if component.is_angular() {
        format!("rotation of {slide} about {about}")
    } else if along(slide, component) {
        format!("positioning of {slide}")
    } else {
        format!("straightness of {slide} in {about}")
    }
}

/// An effect as `simulate --hide` takes it, with five digits of each number.
pub(super) fn shortened(effect: &Effect) -> String {
    let short = |number: f64| {
        let text = fixed(number, decimals(number, 5));
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    };
    let on = Some(format!("on={}", effect.seat)).filter(|_| effect.seat != Seat::Whole);
    let numbers =
        effect.written().into_iter().map(|(key, value)| format!("{key}={}", short(value)));
    let parts: Vec<String> = on.into_iter().chain(numbers).collect();
    format!("{}:{}", effect.cause.id, parts.join(","))
}

/// `amplitude 1.201 +- 0.002 um, period 10.0000 +- 0.0003 mm`.
pub(super) fn numbers(numbers: &[Number]) -> String {
    let told: Vec<String> = numbers.iter().map(number).collect();
    told.join(", ")
}

fn number(number: &Number) -> String {
    let unit = if number.unit.is_empty() { String::new() } else { format!(" {}", number.unit) };
    let value = if let Some(sigma) = number.sigma.filter(|sigma| *sigma > 0.0) {
        let places = decimals(sigma, 2).min(6);
        format!("{} +- {}", fixed(number.value, places), fixed(sigma, places))
    } else {
        let whole = number.value.fract().abs() < 1e-9;
        fixed(number.value, if whole { 0 } else { decimals(number.value, 4).min(6) })
    };
    format!("{} {value}{unit}", number.what)
}

/// What follows from a cause's numbers, in sentences.
pub(super) fn remarks(effect: &Effect, numbers: &[Number], machine: &Machine) -> Vec<String> {
    match (effect.cause.id, effect.seat) {
        ("cyclic", Seat::Function(axis, _)) => vec![screw(effect, numbers, machine, axis)],
        ("servo", Seat::Slide(axis)) => {
            let delay_ms = 1e3 * effect.get("delay");
            let how = if delay_ms < 0.0 { "less" } else { "more" };
            let size_ms = delay_ms.abs();
            vec![format!(
                "{axis} lags {} ms {how} than the axes that are not named. A lag that all axes share appears as a delay of the log.",
                fixed(size_ms, decimals(size_ms, 3).min(3))
            )]
        }
        ("drift", _) => {
            let minutes = effect.get("time_constant") / 60.0;
            let unit = effect.seat.unit();
            let first = -effect.get(AMPLITUDE) / unit.si * (-DRIFT_MIN / minutes).exp_m1();
            vec![format!(
                "In the first {DRIFT_MIN} min it reaches {} {}; 95 % of the whole is reached after {} min.",
                fixed(first, decimals(first, 3)),
                unit.symbol,
                fixed(3.0 * minutes, usize::from(minutes < 3.0))
            )]
        }
        _ => Vec::new(),
    }
}

/// The frequencies that look the same in readings that are these means, Hz: common multiples of their rates, less and more than the
/// lowest of them, as far as some mean holds them. Of single readings the first multiple has them, of means of five the fifth may.
pub(super) fn aliases(frequency_hz: f64, windows: &[Averaged]) -> Option<String> {
    let rates_hz: Vec<f64> = windows.iter().map(|window| window.lasts_s().recip()).collect();
    let fastest_hz = rates_hz.iter().copied().fold(0.0, f64::max);
    let whole = |multiple_hz: f64| {
        rates_hz.iter().all(|rate_hz| {
            let times = multiple_hz / rate_hz;
            (times - times.round()).abs() < 0.01
        })
    };
    let multiple_hz = (1..=MOST_FOLDS).map(|k| f64::from(k) * fastest_hz).find(|hz| whole(*hz))?;
    let folded = frequency_hz % multiple_hz;
    let lowest_hz = folded.min(multiple_hz - folded);
    let most = windows.iter().map(|window| window.readings).fold(1.0, f64::max);
    let folded = (1..=most as u32).map(|k| f64::from(k) * multiple_hz);
    let folded = folded.flat_map(|of_fold| [of_fold - lowest_hz, of_fold + lowest_hz]);
    let held = |hz: &f64| windows.iter().any(|window| window.holds(*hz));
    let all = std::iter::once(lowest_hz).chain(folded).filter(held).take(3);
    let others = all.filter(|hz| (hz - frequency_hz).abs() > 0.01 * multiple_hz);
    let others: Vec<String> = others.map(|hz| fixed(hz, 1)).collect();
    Some(format!("At these sample rates {} Hz would look the same.", others.join(" or ")))
}

/// Which part of the screw's pitch a period is.
fn screw(effect: &Effect, numbers: &[Number], machine: &Machine, axis: Axis) -> String {
    let Some(pitch_mm) = machine.slide(axis).screw_pitch_mm else {
        return format!(
            "The machine file does not state the pitch of the {axis} screw (`screw_pitch_mm`)."
        );
    };
    let period_mm = effect.get("period");
    let sigma_mm = numbers.iter().find(|n| n.what == "period").and_then(|n| n.sigma).unwrap_or(0.0);
    let part = [1.0, 2.0, 3.0, 4.0].into_iter().zip(["", "half ", "a third of ", "a quarter of "]);
    for (times, words) in part {
        let off_mm = (times * period_mm - pitch_mm).abs();
        if off_mm < (3.0 * times * sigma_mm).max(NEAR_A_PITCH * pitch_mm) {
            return format!(
                "The period is {words}the pitch of the {axis} screw, {pitch_mm} mm: {}.",
                match times as usize {
                    1 => "once per turn of the screw, as from its run-out".to_owned(),
                    times => format!(
                        "{times} times per turn of the screw, as from its bearing, coupling or encoder"
                    ),
                }
            );
        }
    }
    format!(
        "The period is no simple part of the pitch of the {axis} screw, {pitch_mm} mm. Check the scale and what else turns with the drive."
    )
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn of(what: &str, unit: &'static str, value: f64, sigma: Option<f64>) -> Number {
        Number { name: String::new(), what: what.into(), unit, value, sigma }
    }

    #[test]
    fn numbers_have_two_digits_of_their_sigma() {
        let told = numbers(&[
            of("amplitude", "um", 1.200_951, Some(0.002_38)),
            of("period", "mm", 9.999_901, Some(0.000_26)),
            of("time constant", "s", 489.66, Some(6.3)),
            of("speed", "mm/min", 12.0, None),
            of("amplitude 2", "um/m", 0.5, None),
        ]);
        assert_eq!(
            told,
            "amplitude 1.2010 +- 0.0024 um, period 9.99990 +- 0.00026 mm, time constant 489.7 +- 6.3 s, speed 12 mm/min, amplitude 2 0.5000 um/m"
        );
    }

    #[test]
    fn a_period_is_held_against_the_screw() {
        let machine = Machine::read("machines/hu40t.toml".as_ref()).unwrap();
        for (period, told) in [
            (10.0, "the pitch of the X screw"),
            (5.004, "half the pitch"),
            (2.5, "a quarter of the pitch"),
            (7.7, "no simple part"),
        ] {
            let text = format!("cyclic:on=EBX,amplitude_urad=1,period_mm={period}");
            let remarks = remarks(&Effect::parse(&text).unwrap(), &[], &machine);
            assert!(remarks[0].contains(told), "{remarks:?}");
        }
    }

    /// Means of five readings in 20 ms have nothing of what is near their rate, a sixth of what is further off, and all of what is
    /// near that of the readings.
    #[test]
    fn frequencies_that_look_the_same_are_those_that_readings_have() {
        let single = Averaged { readings: 1.0, period_s: 0.1 };
        let five = Averaged { readings: 5.0, period_s: 0.004 };
        for (windows, named_hz, others) in [
            (vec![single], 2.3, "7.7 or 12.3"),
            (vec![single, Averaged { period_s: 0.04, ..single }], 2.3, "47.7 or 52.3"),
            (vec![five], 0.3555, "249.6 or 250.4"),
            (vec![five], 7.0, "43.0 or 57.0"),
            (vec![five], 58.7, "8.7 or 41.3"),
        ] {
            let told = aliases(named_hz, &windows).unwrap();
            assert_eq!(told, format!("At these sample rates {others} Hz would look the same."));
        }
    }

    #[test]
    fn seats_are_told_in_words() {
        for (name, told) in [
            ("EXX", "EXX (positioning of X)"),
            ("EZX", "EZX (straightness of X in Z)"),
            ("EBX", "EBX (rotation of X about Y)"),
            ("EZt", "EZt (tool ball in Z)"),
            ("EYY1", "EYY1 (scale of Y)"),
            ("Y", "Y"),
        ] {
            assert_eq!(seat(Seat::parse(name).unwrap()), told);
        }
    }
}
