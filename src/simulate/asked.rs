//! What is true of what people ask: scales, squarenesses, reversals and lateral plays along straight lines through a
//! place, from the exact chain.

use nalgebra::Vector3;

use super::bend::{Bent, Condition};
use super::scenario::Scenario;
use crate::error::Result;
use crate::machine::{Axis, Machine, Mounting};
use crate::model::Effect;

/// Intervals of a line: Simpson's rule is exact for the cubics times `u` to 1e-7 of them.
const INTERVALS: u32 = 48;

/// The true values at a place, by name such as `scale X`; mm/mm and mm. Of hidden effects only backlash that grows along the
/// travel is in them: in the middle the machine has what it is there.
///
/// | name | value |
/// | --- | --- |
/// | `scale H` | least-squares slope of the displacement along H on the way along H, mean of both senses |
/// | `squareness HI` | slope along I on the way along H, plus slope along H on the way along I |
/// | `reversal H`, `lateral play H in I` | step from negative to positive motion in the middle |
///
/// # Errors
/// When the scenario cannot be.
pub fn at_the_place(
    machine: &Machine,
    mounting: &Mounting,
    scenario: &Scenario,
    middle_mm: &Vector3<f64>,
    reach_mm: &Vector3<f64>,
) -> Result<Vec<(String, f64)>> {
    let grows = |effect: &Effect| effect.cause.id == "growing-backlash";
    let mut bare = scenario.clone();
    bare.hidden.retain(grows);
    let line = Line { bent: Bent::new(machine, mounting, &bare)?, middle_mm, reach_mm };
    let axes: Vec<Axis> =
        Axis::ALL.into_iter().filter(|axis| reach_mm[axis.index()] > 0.0).collect();
    let mut all = Vec::new();
    for (k, &first) in axes.iter().enumerate() {
        all.push((format!("scale {first}"), line.slope(first)[first.index()]));
        all.push((format!("reversal {first}"), line.step_mm(first)[first.index()]));
        for &second in axes.iter().filter(|axis| **axis != first) {
            let play_mm = line.step_mm(first)[second.index()];
            all.push((format!("lateral play {first} in {second}"), play_mm));
        }
        for &second in &axes[k + 1..] {
            let sum = line.slope(first)[second.index()] + line.slope(second)[first.index()];
            all.push((format!("squareness {first}{second}"), sum));
        }
    }
    Ok(all)
}

struct Line<'a> {
    bent: Bent,
    middle_mm: &'a Vector3<f64>,
    reach_mm: &'a Vector3<f64>,
}

impl Line<'_> {
    /// Displacement of the tool ball where one slide stands `u` of its range away and has come in a sense, mm.
    fn displaced_mm(&self, axis: Axis, u: f64, sense: f64) -> Vector3<f64> {
        let direction = Vector3::ith(axis.index(), 1.0);
        let position_mm = self.middle_mm + u * self.reach_mm[axis.index()] * direction;
        let condition = Condition { sense: sense * direction, ..Condition::rest(position_mm) };
        self.bent.displaced_mm(&condition)
    }

    fn step_mm(&self, axis: Axis) -> Vector3<f64> {
        self.displaced_mm(axis, 0.0, 1.0) - self.displaced_mm(axis, 0.0, -1.0)
    }

    /// `3 / (2 r) ∫ e u du` by Simpson's rule.
    fn slope(&self, axis: Axis) -> Vector3<f64> {
        let weighted = |k: u32| {
            let u = f64::from(k) / f64::from(INTERVALS) * 2.0 - 1.0;
            let weight = match k {
                0 | INTERVALS => 1.0,
                k => f64::from(2 + 2 * (k % 2)),
            };
            let both = self.displaced_mm(axis, u, 1.0) + self.displaced_mm(axis, u, -1.0);
            0.5 * both * weight * u
        };
        let integral = (0..=INTERVALS).map(weighted).sum::<Vector3<f64>>() * 2.0
            / (3.0 * f64::from(INTERVALS));
        1.5 * integral / self.reach_mm[axis.index()]
    }
}
