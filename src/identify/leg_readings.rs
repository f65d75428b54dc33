//! The readings of a leg, and what a shift of the leg leaves of them.

use nalgebra::Vector3;

use super::input::RunInput;
use super::timing::{Detail, SMOOTH_S, TURNING_S, view};
use crate::align::{Part, Sample};
use crate::machine::Pose;
use crate::model::Model;

/// The least that may be left of a sample whose middle is so long after a reversal of the program, from what is left with the
/// senses before and after it, mm: its slide turns up to [`TURNING_S`] earlier or later. A single reading is read on one
/// side, the mean of a window on both.
fn turning_mm([before_mm, after_mm]: [f64; 2], since_s: f64, window_s: f64) -> f64 {
    let ends_mm = [-TURNING_S, TURNING_S].map(|earlier_s| {
        let since_s = since_s + earlier_s;
        let after = if window_s > 0.0 {
            (since_s / window_s + 0.5).clamp(0.0, 1.0)
        } else {
            f64::from(u8::from(since_s > 0.0))
        };
        before_mm + after * (after_mm - before_mm)
    });
    let [one_mm, other_mm] = ends_mm;
    if window_s > 0.0 && one_mm * other_mm < 0.0 {
        0.0
    } else if one_mm.abs() < other_mm.abs() {
        one_mm
    } else {
        other_mm
    }
}

/// What a shift of a leg leaves.
#[expect(clippy::struct_field_names, reason = "each says its unit")]
pub(super) struct Misfit {
    /// Sum of squares with the steps at reversals, mm².
    pub(super) steps_mm2: f64,
    /// Sum of the products of that with facets, mm².
    pub(super) both_mm2: f64,
    /// Sum of squares of facets, mm²; 0 where they are not seen.
    pub(super) squares_mm2: f64,
}

impl Misfit {
    /// By how much a part of the facets lowers the sum of squares, mm².
    pub(super) fn part_mm2(&self, part: f64) -> f64 {
        part * (2.0 * self.both_mm2 - part * self.squares_mm2)
    }

    /// By how much the part of them does that fits best, from none to all, mm²: by how much a control rounds facets out is not
    /// known yet.
    pub(super) fn facets_mm2(&self) -> f64 {
        if self.squares_mm2 > 0.0 {
            self.part_mm2((self.both_mm2 / self.squares_mm2).clamp(0.0, 1.0))
        } else {
            0.0
        }
    }
}

/// The readings of a leg, each with what a shift of the leg leaves of its prediction.
pub(super) struct LegReadings<'a> {
    model: &'a Model<'a>,
    values: &'a [f64],
    run: &'a RunInput,
    /// Sample, and its reading minus the slow part of the prediction, mm.
    pub(super) readings: Vec<(&'a Sample, f64)>,
    /// Of the program.
    reversals_s: &'a [f64],
}

impl<'a> LegReadings<'a> {
    pub(super) fn of_leg(
        model: &'a Model<'a>,
        values: &'a [f64],
        (run, reversals_s): (&'a RunInput, &'a [f64]),
        leg: usize,
        stride: usize,
    ) -> Self {
        let readings = run
            .samples()
            .iter()
            .step_by(stride)
            .filter(|s| s.leg == leg && matches!(s.part, Part::Arc(_)))
            .map(|sample| {
                let view = view(model, values, run, sample, Detail::Smooth);
                (sample, view.residual_mm)
            })
            .collect();
        Self { model, values, run, readings, reversals_s }
    }

    /// From the first of its readings to the last, s.
    pub(super) fn lasts_s(&self) -> f64 {
        let [first, last] = [self.readings.first(), self.readings.last()]
            .map(|reading| reading.map_or(0.0, |(sample, _)| sample.program_s));
        last - first
    }

    /// Over so long a sample goes, s; 0 of a single reading.
    fn window_s(&self) -> f64 {
        let alignment = &self.run.alignment;
        if alignment.averaged > 1 { alignment.sample_period_s } else { 0.0 }
    }

    /// Sums of squares with steps a shift later, and of facets about their mean.
    pub(super) fn misfit(&self, shift_s: f64, visible: bool) -> Misfit {
        let alignment = &self.run.alignment;
        let (coincidence_mm, trajectory) = (alignment.coincidence_mm(), &alignment.trajectory);
        let length_mm = |pose: &Pose, sample: &Sample| {
            self.model.length_mm(self.values, pose, &sample.motion, self.run.mounting)
        };
        let window_s = self.window_s();
        let zone_s = TURNING_S + 0.5 * window_s;
        let pairs: Vec<[f64; 2]> = self
            .readings
            .iter()
            .map(|(sample, slow_mm)| {
                let program_s = sample.program_s + shift_s;
                let state = trajectory.at_near(program_s, sample.block);
                let mean_mm = |over_s: f64| alignment.mean_mm(sample.leg, program_s, over_s);
                // A sample that is the mean of readings has the mean of the facets that went by.
                let commanded_mm = if window_s > 0.0 {
                    mean_mm(window_s)
                } else {
                    (state.position_mm - coincidence_mm).norm() - alignment.radius_mm
                };
                let facet_mm = commanded_mm - mean_mm(SMOOTH_S);
                // With senses and steps of the path as they are at another time.
                let left_mm = |then_s: f64, sense: Vector3<f64>| {
                    let left_mm =
                        slow_mm - alignment.steps_mm(sample.leg, sample.program_s, then_s);
                    if sense == sample.pose.sense {
                        return left_mm;
                    }
                    let turned = Pose { sense, ..sample.pose };
                    left_mm - (length_mm(&turned, sample) - length_mm(&sample.pose, sample))
                };
                let before = self.reversals_s.partition_point(|s| *s < program_s - zone_s);
                let near = self.reversals_s.get(before).filter(|s| **s < program_s + zone_s);
                let least_mm = match near {
                    None => left_mm(program_s, state.sense),
                    Some(&reversal_s) => {
                        let sides = [-zone_s, zone_s].map(|aside_s| {
                            let then_s = program_s + aside_s;
                            left_mm(then_s, trajectory.at_near(then_s, state.block).sense)
                        });
                        turning_mm(sides, program_s - reversal_s, window_s)
                    }
                };
                [least_mm, facet_mm]
            })
            .collect();
        let mean_mm = pairs.iter().map(|pair| pair[1]).sum::<f64>() / pairs.len().max(1) as f64;
        let (mut left, mut both, mut facets) = (0.0, 0.0, 0.0);
        for [left_mm, facet_mm] in pairs {
            let (left_mm, aside_mm) = (left_mm - mean_mm, facet_mm - mean_mm);
            left += left_mm.powi(2);
            both += left_mm * aside_mm;
            facets += aside_mm.powi(2);
        }
        let squares_mm2 = if visible { facets } else { 0.0 };
        Misfit { steps_mm2: left, both_mm2: both, squares_mm2 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_over_a_reversal_lies_between_its_sides_and_a_reading_on_one_of_them() {
        let is = |since_s: f64, window_s: f64, mm: f64| {
            assert!((turning_mm([1.0, -3.0], since_s, window_s) - mm).abs() < 1e-12, "{since_s}");
        };
        // Of a window of 20 ms up to 10 ms earlier or later: at the reversal any mixture, 15 ms past it at least three quarters.
        is(0.0, 0.02, 0.0);
        is(0.015, 0.02, -2.0);
        is(-0.02, 0.02, 1.0);
        is(0.02, 0.02, -3.0);
        is(-0.005, 0.0, 1.0);
        is(0.005, 0.0, 1.0);
        is(0.011, 0.0, -3.0);
    }
}
