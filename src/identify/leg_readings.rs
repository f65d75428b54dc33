//! The readings of a leg, and what a shift of the leg leaves of them.

use rayon::prelude::*;

use super::input::RunInput;
use super::leg_path::{Facets, Senses};
use super::timing::{Detail, TURNING_S, view};
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

/// A reading of a leg.
pub(super) struct Reading<'a> {
    sample: &'a Sample,
    /// It minus the slow part of the prediction, without what the path has stepped until there, mm.
    slow_mm: f64,
    /// By how much the bar is longer with the senses after so many turns of the program, and after each of the next, mm: wherever a shift
    /// brings it.
    turned_mm: (usize, Vec<f64>),
}

/// The readings of a leg, each with what a shift of the leg leaves of its prediction.
pub(super) struct LegReadings<'a> {
    model: &'a Model<'a>,
    values: &'a [f64],
    run: &'a RunInput,
    pub(super) readings: Vec<Reading<'a>>,
    /// Of the program.
    senses: &'a Senses,
    /// Of the path.
    facets: Facets<'a>,
    /// Over so long a sample goes, s; 0 of a single reading.
    window_s: f64,
}

impl<'a> LegReadings<'a> {
    pub(super) fn of_leg(
        model: &'a Model<'a>,
        values: &'a [f64],
        (run, senses): (&'a RunInput, &'a Senses),
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
                let stepped_mm = run.alignment.stepped_mm(leg, sample.program_s);
                let slow_mm = view.residual_mm + stepped_mm;
                Reading { sample, slow_mm, turned_mm: (0, Vec::new()) }
            })
            .collect();
        let alignment = &run.alignment;
        let window_s = if alignment.averaged > 1 { alignment.sample_period_s } else { 0.0 };
        let facets = Facets::of_leg(run, leg, window_s);
        Self { model, values, run, readings, senses, facets, window_s }
    }

    /// From when to when its readings go, s.
    fn span_s(&self) -> [f64; 2] {
        [self.readings.first(), self.readings.last()]
            .map(|reading| reading.map_or(0.0, |reading| reading.sample.program_s))
    }

    /// From the first of its readings to the last, s.
    pub(super) fn lasts_s(&self) -> f64 {
        let [first_s, last_s] = self.span_s();
        last_s - first_s
    }

    /// A reversal lies so near that it may be on the other side, s.
    fn zone_s(&self) -> f64 {
        TURNING_S + 0.5 * self.window_s
    }

    /// Looks up what so many shifts within a reach see of the path, of whose facets this is a small part, s.
    pub(super) fn look_up(&mut self, reach_s: f64, part_s: f64, shifts: usize) {
        let [first_s, last_s] = self.span_s();
        let asked_for = shifts * self.readings.len();
        self.facets.look_up([first_s - reach_s, last_s + reach_s], part_s, asked_for);
        let (model, values, mounting) = (self.model, self.values, self.run.mounting);
        let (senses, far_s) = (self.senses, reach_s + self.zone_s());
        self.readings.par_iter_mut().for_each(|Reading { sample, turned_mm, .. }| {
            let length_mm = |pose: &Pose| model.length_mm(values, pose, &sample.motion, mounting);
            let longer_mm = |turns: usize| {
                let sense = *senses.after(turns);
                if sense == sample.pose.sense {
                    return 0.0;
                }
                length_mm(&Pose { sense, ..sample.pose }) - length_mm(&sample.pose)
            };
            let [first, last] =
                [-far_s, far_s].map(|aside_s| senses.turns_before(sample.program_s + aside_s, 0));
            *turned_mm = (first, (first..=last).map(longer_mm).collect());
        });
    }

    /// Sums of squares with steps a shift later, of those that were [looked up](Self::look_up), and of facets about their mean.
    pub(super) fn misfit(&self, shift_s: f64, visible: bool) -> Misfit {
        let (alignment, senses, window_s) = (&self.run.alignment, self.senses, self.window_s);
        let zone_s = self.zone_s();
        // In the order of time the turns before a reading are those before the last one, and maybe the next.
        let mut before = 0;
        let of_reading = |Reading { sample, slow_mm, turned_mm: (first, turned_mm) }: &Reading| {
            let program_s = sample.program_s + shift_s;
            // With senses and steps of the path as they are at another time.
            let left_mm = |then_s: f64, turns: usize| {
                let turned_mm = turned_mm.get(turns.saturating_sub(*first)).copied();
                slow_mm - alignment.stepped_mm(sample.leg, then_s) - turned_mm.unwrap_or(0.0)
            };
            let (from_s, to_s) = (program_s - zone_s, program_s + zone_s);
            before = senses.turns_before(from_s, before);
            let near = senses.turn_s(before).filter(|s| *s < to_s);
            let least_mm = match near {
                None => left_mm(program_s, before),
                Some(turn_s) => {
                    let sides = [(from_s, before), (to_s, senses.turns_before(to_s, before))];
                    let sides = sides.map(|(then_s, turns)| left_mm(then_s, turns));
                    turning_mm(sides, program_s - turn_s, window_s)
                }
            };
            [least_mm, self.facets.at_mm(program_s)]
        };
        let pairs: Vec<[f64; 2]> = self.readings.iter().map(of_reading).collect();
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
