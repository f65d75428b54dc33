//! A motion that was recorded, on the time of its program.

use nalgebra::Vector3;

use super::block::State;
use super::slides::{Slides, Turn};
use crate::log::Stand;

/// A velocity is that over so long, s: in less, what a slide wavers by looks fast.
const SPEED_S: f64 = 5e-3;

/// A motion that was recorded, on the time of its program: operator's pauses are left out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Driven {
    rows: Vec<Stand>,
    /// Of each slide its first motion and every reversal.
    turns: [Vec<Turn>; 3],
    /// From when to when all slides stand, s.
    rests_s: Vec<[f64; 2]>,
    /// Half of the time that a velocity is taken over, s.
    aside_s: f64,
}

/// From the time of a recording to that of its program.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cuts {
    /// When the program begins, s of the recording.
    pub(super) begins_s: f64,
    /// From when to when the operator paused, s of the recording, in order.
    pub(super) pauses_s: Vec<[f64; 2]>,
}

impl Cuts {
    /// Program time, s; in a pause that at which it begins.
    pub(super) fn program_s(&self, recorded_s: f64) -> f64 {
        let paused = |[from_s, to_s]: &[f64; 2]| (recorded_s.min(*to_s) - from_s).max(0.0);
        recorded_s - self.begins_s - self.pauses_s.iter().map(paused).sum::<f64>()
    }
}

impl Driven {
    pub(super) fn new(rows: &[Stand], slides: Slides, cuts: &Cuts) -> Self {
        let mut kept: Vec<Stand> = Vec::with_capacity(rows.len());
        for row in rows {
            let time_s = cuts.program_s(row.time_s);
            // In a pause time stands.
            if kept.last().is_none_or(|last| last.time_s < time_s) {
                kept.push(Stand { time_s, ..*row });
            }
        }
        let rests_s = slides.rests.iter().map(|rest| rest.map(|row| rows[row].time_s));
        let rests_s = rests_s.map(|rest_s| rest_s.map(|at_s| cuts.program_s(at_s))).collect();
        let turns = slides.turns.map(|of| {
            let cut = |turn: Turn| Turn { at_s: cuts.program_s(turn.at_s), ..turn };
            of.into_iter().map(cut).collect()
        });
        let mut apart_s: Vec<f64> =
            rows.windows(2).map(|two| two[1].time_s - two[0].time_s).collect();
        apart_s.sort_by(f64::total_cmp);
        let period_s = apart_s.get(apart_s.len() / 2).copied().unwrap_or(SPEED_S);
        Self { rows: kept, turns, rests_s, aside_s: 0.5 * SPEED_S.max(2.0 * period_s) }
    }

    /// Where the slides were, mm; before the first row and after the last they stand.
    pub(super) fn position_mm(&self, program_s: f64) -> Vector3<f64> {
        let next = self.rows.partition_point(|row| row.time_s <= program_s);
        let (Some(before), Some(after)) =
            (self.rows.get(next.wrapping_sub(1)), self.rows.get(next))
        else {
            let end = if next == 0 { self.rows.first() } else { self.rows.last() };
            return end.map_or_else(Vector3::zeros, |row| row.position_mm);
        };
        let lasts_s = after.time_s - before.time_s;
        let share = (program_s - before.time_s) / lasts_s;
        let way = after.position_mm - before.position_mm;
        let (earlier, later) = (self.rows.get(next.wrapping_sub(2)), self.rows.get(next + 1));
        // A cubic with the velocities of the neighbouring rows: a circle looked at every 20 ms is one still. A slide that stands
        // between two rows stands at both.
        let slope = |slide: usize, from: &Stand, at: &Stand, to: &Stand| {
            let [first, second] =
                [(from, at), (at, to)].map(|(a, b)| b.position_mm[slide] - a.position_mm[slide]);
            let stands = first.abs() < f64::EPSILON || second.abs() < f64::EPSILON;
            if stands { 0.0 } else { (first + second) / (to.time_s - from.time_s) * lasts_s }
        };
        let (s, left) = (share, 1.0 - share);
        Vector3::from_fn(|k, _| {
            let at_start = earlier.map_or(way[k], |earlier| slope(k, earlier, before, after));
            let at_end = later.map_or(way[k], |later| slope(k, before, after, later));
            before.position_mm[k]
                + way[k] * s * s * (3.0 - 2.0 * s)
                + s * left * (left * at_start - s * at_end)
        })
    }

    /// How the machine was at a time within a block, by its index.
    pub(super) fn at(&self, program_s: f64, block: usize) -> State {
        State {
            position_mm: self.position_mm(program_s),
            velocity_mm_s: self.velocity_mm_s(program_s),
            sense: Vector3::from_fn(|slide, _| self.sense(slide, program_s)),
            block,
        }
    }

    /// Velocity of the slides, mm/s; 0 where all stand.
    pub(super) fn velocity_mm_s(&self, program_s: f64) -> Vector3<f64> {
        if self.rests(program_s) {
            return Vector3::zeros();
        }
        let [before_s, after_s] = [-self.aside_s, self.aside_s].map(|aside_s| program_s + aside_s);
        (self.position_mm(after_s) - self.position_mm(before_s)) / (after_s - before_s)
    }

    /// Whether all slides stand.
    pub(super) fn rests(&self, program_s: f64) -> bool {
        let begun = self.rests_s.partition_point(|rest| rest[0] <= program_s);
        self.rests_s[..begun].last().is_some_and(|rest| program_s < rest[1])
    }

    fn sense(&self, slide: usize, program_s: f64) -> f64 {
        let turns = &self.turns[slide];
        let begun = turns.partition_point(|turn| turn.at_s <= program_s);
        turns[..begun].last().map_or(0.0, |turn| turn.sense)
    }

    /// When any slide began to move in another sense than before, s, in order.
    pub(super) fn turns_s(&self) -> Vec<f64> {
        let mut times_s: Vec<f64> = self.turns.iter().flatten().map(|turn| turn.at_s).collect();
        times_s.sort_by(f64::total_cmp);
        times_s
    }

    /// When (s) and where (mm) a slide turned round, in order.
    pub(super) fn reversals(&self, slide: usize) -> impl Iterator<Item = (f64, f64)> {
        // The first motion is none.
        self.turns[slide].iter().skip(1).map(|turn| (turn.at_s, turn.at_mm))
    }
}
