//! In which order the readings of clockwise runs stand: as they were driven, or by rising angle like those of the others.
//!
//! A file without angles does not say. The readings tell by what is the same both ways and no mirror image of itself about the
//! middle of the arc: above all that the balls are not quite where the program has them. With `psi` the angle from the middle,
//! and `r = a + b cos psi + s sin psi + c cos 2 psi + d sin 2 psi` fitted to each run, s is the same both ways where the
//! order is right, and of opposite sign where it is not. Reversal and servo errors, which differ from one way to the other,
//! have of a whole circle no part in s.

use crate::error::Result;
use crate::solve::{Truncation, Tsqr, solve};

/// What the readings of both directions tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Listed {
    /// As they were driven.
    AsDriven,
    /// By rising angle.
    ByAngle,
    /// Neither for certain; the larger of what would tell, mm.
    NotTold(f64),
}

/// Less than that may be a part of reversal, mm: of a part of a circle it is not apart from s.
const LEAST_MM: f64 = 0.005;
/// One order must make the runs agree so many times better than the other does.
const TIMES: f64 = 4.0;
/// Of a shorter arc the five terms are not told apart, rad.
const SHORTEST_RAD: f64 = std::f64::consts::PI;

/// The order in which clockwise readings stand that are taken as driven, by runs in both directions, mm, even over an arc.
///
/// # Errors
/// When a fit fails, which finite readings do not make.
pub(super) fn listed(
    counter_clockwise: &[Vec<Option<f64>>],
    clockwise: &[Vec<Option<f64>>],
    span_rad: f64,
) -> Result<Listed> {
    if span_rad < SHORTEST_RAD {
        return Ok(Listed::NotTold(0.0));
    }
    let mean_mm = |runs: &[Vec<Option<f64>>], way: f64| -> Result<Option<f64>> {
        let mut sum_mm = 0.0;
        for run in runs {
            sum_mm += way * across_mm(run, span_rad)?;
        }
        Ok((!runs.is_empty()).then(|| sum_mm / runs.len() as f64))
    };
    let (Some(counter_mm), Some(clockwise_mm)) =
        (mean_mm(counter_clockwise, 1.0)?, mean_mm(clockwise, -1.0)?)
    else {
        return Ok(Listed::NotTold(0.0));
    };
    // Half of each, so that both are what the balls are off.
    let same_mm = 0.5 * (counter_mm + clockwise_mm).abs();
    let mirrored_mm = 0.5 * (counter_mm - clockwise_mm).abs();
    Ok(if same_mm >= LEAST_MM && same_mm >= TIMES * mirrored_mm {
        Listed::AsDriven
    } else if mirrored_mm >= LEAST_MM && mirrored_mm >= TIMES * same_mm {
        Listed::ByAngle
    } else {
        Listed::NotTold(same_mm.max(mirrored_mm))
    })
}

/// s of readings in the order in which they stand, mm.
fn across_mm(readings: &[Option<f64>], span_rad: f64) -> Result<f64> {
    let mut rows = Tsqr::new(5);
    for (k, reading) in readings.iter().enumerate() {
        let Some(reading_mm) = reading else { continue };
        let (sin, cos) = (span_rad * ((k as f64 + 0.5) / readings.len() as f64 - 0.5)).sin_cos();
        let row = [1.0, cos, sin, cos * cos - sin * sin, 2.0 * sin * cos];
        rows.push_weighted(&row, *reading_mm, 1.0);
    }
    Ok(solve(&rows.finish()?, Truncation::Relative(1e-12))?.x()[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings in the order of driving: both balls across by so much, squareness, servo mismatch and backlash.
    fn run(way: f64, span_deg: f64, across_mm: f64) -> Vec<Option<f64>> {
        let reading = |k: i32| {
            let psi = way * span_deg * ((f64::from(k) + 0.5) / 720.0 - 0.5);
            let (sin, cos) = psi.to_radians().sin_cos();
            let servo_mm = way * 0.012 * sin * cos;
            let backlash_mm = way * 0.004 * cos * sin.signum();
            Some(across_mm * sin + 0.02 * cos + 0.008 * sin * cos + servo_mm + backlash_mm)
        };
        (0..720).map(reading).collect()
    }

    fn told(span_deg: f64, across_mm: f64, by_angle: bool) -> Listed {
        let mut clockwise = run(-1.0, span_deg, across_mm);
        if by_angle {
            clockwise.reverse();
        }
        let counter_clockwise = [run(1.0, span_deg, across_mm)];
        listed(&counter_clockwise, &[clockwise], span_deg.to_radians()).unwrap()
    }

    #[test]
    fn balls_that_are_off_tell_the_order_beside_all_that_differs_from_way_to_way() {
        for span_deg in [360.0, 340.0, 220.0] {
            for across_mm in [0.03, -0.03, 0.012] {
                assert_eq!(told(span_deg, across_mm, false), Listed::AsDriven, "{span_deg}");
                assert_eq!(told(span_deg, across_mm, true), Listed::ByAngle, "{span_deg}");
            }
        }
    }

    #[test]
    fn what_does_not_tell_is_not_guessed() {
        for by_angle in [false, true] {
            assert!(matches!(told(360.0, 1e-3, by_angle), Listed::NotTold(mm) if mm < 0.002));
            assert_eq!(told(90.0, 0.05, by_angle), Listed::NotTold(0.0), "too short");
        }
        let alone = listed(&[], &[run(-1.0, 360.0, 0.05)], std::f64::consts::TAU).unwrap();
        assert_eq!(alone, Listed::NotTold(0.0), "nothing to compare with");
    }
}
