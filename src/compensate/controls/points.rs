//! Where the points of a table are.

use super::asked::Limits;
use crate::error::{Error, Result};
use crate::machine::Axis;

/// Steps that people use, of each decade.
const STEPS: [f64; 4] = [1.0, 2.0, 2.5, 5.0];

/// The smallest such step that is not smaller, mm.
fn usual_mm(step_mm: f64) -> f64 {
    let decade = 10_f64.powf(step_mm.log10().floor());
    let of_decade = STEPS.iter().map(|step| step * decade);
    of_decade.chain([10.0 * decade]).find(|step| *step >= step_mm * (1.0 - 1e-9)).unwrap_or(step_mm)
}

/// So many steps over what was measured follow any error that was.
pub(super) const ENOUGH: f64 = 20.0;

/// Multiples of a step within a travel, their step, and whether it is larger than it should be.
pub(super) struct Even {
    pub(super) at_mm: Vec<f64>,
    pub(super) step_mm: f64,
    pub(super) coarse: bool,
}

/// Points at multiples of one step over ends of a slide.
///
/// # Errors
/// When a step that was asked for needs more points than the control has.
pub(super) fn even(
    axis: Axis,
    [low_mm, high_mm]: [f64; 2],
    measured_mm: [f64; 2],
    limits: &Limits,
) -> Result<Even> {
    let most = limits.most_points.max(2);
    let fine_mm = usual_mm(((measured_mm[1] - measured_mm[0]) / ENOUGH).max(1.0));
    let needed = |step_mm: f64| {
        let (first, last) = (first(low_mm, step_mm), last(high_mm, step_mm));
        (last - first + 1.0).max(0.0)
    };
    let mut step_mm = limits.step_mm.unwrap_or(fine_mm);
    if limits.step_mm.is_some() && needed(step_mm) > most as f64 {
        return Err(Error::input(format!(
            "points {step_mm} mm apart over {low_mm} to {high_mm} mm of {axis} are {}, and the control has {most}",
            needed(step_mm)
        ))
        .hint("a larger `--step`, or `--points` if your control has more"));
    }
    while needed(step_mm) > most as f64 {
        step_mm = usual_mm(step_mm * 1.01);
    }
    while needed(step_mm) < 2.0 {
        step_mm *= 0.5;
    }
    let (first, count) = (first(low_mm, step_mm), needed(step_mm) as usize);
    let at_mm = (0..count).map(|k| (first + k as f64) * step_mm).collect();
    let coarse = limits.step_mm.is_none() && step_mm > fine_mm * 1.001;
    Ok(Even { at_mm, step_mm, coarse })
}

/// Which multiple of a step is the first, or the last, within an end.
fn first(low_mm: f64, step_mm: f64) -> f64 {
    (low_mm / step_mm - 1e-9).ceil()
}

fn last(high_mm: f64, step_mm: f64) -> f64 {
    (high_mm / step_mm + 1e-9).floor()
}

/// What is told of points that are too few.
pub(super) fn coarse(axis: Axis, step_mm: f64) -> String {
    format!(
        "the control has too few points for {axis}: they are {} mm apart, and a twentieth of what was measured would be less",
        (step_mm * 1e3).round() * 1e-3
    )
}
