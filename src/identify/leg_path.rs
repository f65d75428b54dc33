//! The commanded path of a leg as all shifts of the leg see it: the senses of the slides and the facets of the path, worked out once.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::input::RunInput;
use super::timing::SMOOTH_S;
use crate::motion::Trajectory;

/// From one turn of a program to the next the slides have the same senses; before the first and behind the last they are looked at so
/// far from it, s.
const ASIDE_S: f64 = 1.0;

/// No table of facets has more places, 32 MB: chords of milliseconds along a leg of an hour are worked out one by one.
const MOST_PLACES: usize = 4_000_000;

/// The senses of a program.
pub(super) struct Senses {
    /// When slides turn, s, in order.
    turns_s: Vec<f64>,
    /// Before the first turn, and after each.
    senses: Vec<Vector3<f64>>,
}

impl Senses {
    pub(super) fn of(trajectory: &Trajectory) -> Self {
        let turns_s = trajectory.reversals_s();
        let (first_s, last_s) = (turns_s.first().copied(), turns_s.last().copied());
        let before = std::iter::once(first_s.unwrap_or(0.0) - ASIDE_S);
        let between = turns_s.windows(2).map(|two| 0.5 * (two[0] + two[1]));
        let behind = last_s.map(|s| s + ASIDE_S);
        let each = before.chain(between).chain(behind);
        let senses = each.map(|s| trajectory.at(s).sense).collect();
        Self { turns_s, senses }
    }

    /// How many turns lie before a program time, no fewer than so many.
    pub(super) fn turns_before(&self, program_s: f64, least: usize) -> usize {
        let more = self.turns_s.get(least..).unwrap_or_default().iter();
        least + more.take_while(|s| **s < program_s).count()
    }

    /// When one of them is, s, by its number.
    pub(super) fn turn_s(&self, turn: usize) -> Option<f64> {
        self.turns_s.get(turn).copied()
    }

    /// The senses after so many.
    pub(super) fn after(&self, turns: usize) -> &Vector3<f64> {
        &self.senses[turns.min(self.senses.len() - 1)]
    }
}

/// By how much the commanded path of a leg lies outside of its mean, as a reading has it.
pub(super) struct Facets<'a> {
    run: &'a RunInput,
    leg: usize,
    /// Over so long a sample goes, s; 0 of a single reading.
    window_s: f64,
    looked_up: Option<Table>,
}

/// Values at even times.
struct Table {
    from_s: f64,
    step_s: f64,
    values_mm: Vec<f64>,
}

impl<'a> Facets<'a> {
    pub(super) fn of_leg(run: &'a RunInput, leg: usize, window_s: f64) -> Self {
        Self { run, leg, window_s, looked_up: None }
    }

    /// Works them out every so often from one time to another, s, where they are asked for more often than that: between two such
    /// times a facet, which is a parabola over many of them, is as good as straight.
    pub(super) fn look_up(&mut self, [from_s, to_s]: [f64; 2], step_s: f64, asked_for: usize) {
        let steps = ((to_s - from_s) / step_s).ceil() as usize;
        if steps < asked_for.min(MOST_PLACES) {
            let of_step = |k: usize| self.worked_out_mm(from_s + k as f64 * step_s);
            let values_mm = (0..=steps).into_par_iter().map(of_step).collect();
            self.looked_up = Some(Table { from_s, step_s, values_mm });
        }
    }

    /// At a program time, mm.
    pub(super) fn at_mm(&self, program_s: f64) -> f64 {
        let straight_mm = |table: &Table| {
            let place = (program_s - table.from_s) / table.step_s;
            let below = place as usize;
            let two = table.values_mm.get(below..)?.get(..2)?;
            Some(two[0] + (place - below as f64) * (two[1] - two[0]))
        };
        let looked_up_mm = self.looked_up.as_ref().and_then(straight_mm);
        looked_up_mm.unwrap_or_else(|| self.worked_out_mm(program_s))
    }

    fn worked_out_mm(&self, program_s: f64) -> f64 {
        let alignment = &self.run.alignment;
        let mean_mm = |over_s: f64| alignment.mean_mm(self.leg, program_s, over_s);
        // A sample that is the mean of readings has the mean of the facets that went by.
        let commanded_mm = if self.window_s > 0.0 {
            mean_mm(self.window_s)
        } else {
            let ball_mm =
                alignment.trajectory.at(program_s).position_mm - alignment.coincidence_mm();
            ball_mm.norm() - alignment.radius_mm
        };
        commanded_mm - mean_mm(SMOOTH_S)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::identify::MeasuredRun;
    use crate::plan::Test;

    /// The first run of a set, its paths looked up: 3D6 in chords, at 10 readings a second, and at 250, of which each sample is a mean.
    fn run(of: &str) -> RunInput {
        let test = Test::read(&Path::new("tests/data").join(of).join("test.toml")).unwrap();
        let measured = MeasuredRun::read(&test, &test.runs().unwrap()[0]).unwrap();
        let mut run = measured.aligned(&test, &test.machine().unwrap()).unwrap();
        run.alignment.look_up_means();
        run
    }

    #[test]
    fn between_two_turns_the_senses_stay() {
        for of in ["case-a", "rate250"] {
            let run = run(of);
            let trajectory = &run.alignment.trajectory;
            let senses = Senses::of(trajectory);
            let mut seen = 0;
            for k in 0..20_000 {
                let then_s = trajectory.end_s() * f64::from(k) / 20_000.0;
                let turns = senses.turns_before(then_s, seen);
                assert_eq!(*senses.after(turns), trajectory.at(then_s).sense, "{of} at {then_s} s");
                seen = turns;
            }
            assert!(seen > 20, "{of}: {seen}");
        }
    }

    #[test]
    fn facets_that_are_looked_up_are_those_that_are_worked_out() {
        for of in ["case-a", "rate250"] {
            let run = run(of);
            let alignment = &run.alignment;
            let arc = &alignment.sections[1];
            let leg = alignment.time_map.leg_of(arc.start_s);
            let window_s = if alignment.averaged > 1 { alignment.sample_period_s } else { 0.0 };
            let mut facets = Facets::of_leg(&run, leg, window_s);
            let at_s = |k: i32| arc.start_s + (arc.end_s - arc.start_s) * f64::from(k) / 5000.0;
            let each: Vec<f64> = (0..5000).map(|k| facets.at_mm(at_s(k))).collect();
            let part_s = alignment.time_map.chords[leg].lasts_s / 32.0;
            facets.look_up([arc.start_s, arc.end_s], part_s, usize::MAX);
            assert!(facets.looked_up.is_some());
            let off = |(k, mm): (i32, &f64)| (facets.at_mm(at_s(k)) - mm).powi(2);
            let off_mm2: f64 = (0..).zip(&each).map(off).sum();
            let all_mm2: f64 = each.iter().map(|mm| mm.powi(2)).sum();
            assert!(all_mm2 > 5000.0 * 1e-10 && off_mm2 < 1e-3 * all_mm2, "{of}: {off_mm2}");
        }
    }
}
