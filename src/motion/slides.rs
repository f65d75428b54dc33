//! Which way the slides of a recorded motion went, and when they stood.
//!
//! A servo dithers: its slide wavers about where it is meant to be. So a slide is followed with some play: it has moved when it
//! has come farther than it wavers, and it has turned round when it has come back by more than that from the farthest
//! place that it reached. It turned round when it left that place, which is told by when it was so far away and when four
//! times as far: with the constant acceleration of a circle's extreme or of a start, `x = a (t - t0)² / 2`, the second takes
//! twice as long, and `t0 = 2 t(w) - t(4 w)`.

use nalgebra::Vector3;

use crate::log::Stand;

/// So far every slide may waver, mm: what a control commands has no dither but is written with so many digits.
const LEAST_MM: f64 = 1e-5;
/// And no servo that holds its place wavers by more, mm.
const MOST_MM: f64 = 0.02;
/// By how much more than it was seen to waver in one standstill it may in another.
const OFTEN: f64 = 2.0;
/// Between one step of its scale and two: a reading between two steps jumps to and fro, and that is no way.
const STEPS: f64 = 1.5;
/// How long a standstill is in which it is looked at, s; in the middle half the slide has arrived.
const QUIET_S: f64 = 0.4;
/// So many rows later it is no start any more.
const FAR_ROWS: usize = 10_000;
/// What is shorter may be a slow start, s.
const REST_S: f64 = 0.02;

/// A slide begins to move one way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    /// When, s.
    pub(super) at_s: f64,
    /// Where, mm.
    pub(super) at_mm: f64,
    /// Which way it goes on: 1 or -1.
    pub(super) sense: f64,
}

/// What the slides did.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Slides {
    /// Of each slide its first motion and every reversal.
    pub(super) turns: [Vec<Turn>; 3],
    /// From which row to which all slides stand.
    pub(super) rests: Vec<[usize; 2]>,
    /// The way of the tool from the first row to each, mm, what the slides waver left out.
    pub(super) ways_mm: Vec<f64>,
}

impl Slides {
    /// Of the rows of a recording.
    pub(super) fn of(rows: &[Stand]) -> Self {
        let waver_mm = waver_mm(rows);
        let followed = [0, 1, 2].map(|slide| followed_mm(rows, slide, waver_mm[slide]));
        let ways_mm = ways_mm(&followed);
        // A slide that has arrived creeps on by no more than it wavers.
        let creeps_mm = Vector3::from(waver_mm).norm();
        let joined = joined(rests(rows, &ways_mm, REST_S), &ways_mm, creeps_mm);
        let rests = joined.into_iter().map(|rest| arrived(rows, rest, creeps_mm / OFTEN)).collect();
        let turns = [0, 1, 2].map(|slide| turns(rows, slide, waver_mm[slide]));
        Self { turns, rests, ways_mm }
    }
}

/// How far each slide wavers where it stands, mm.
fn waver_mm(rows: &[Stand]) -> [f64; 3] {
    let coarse = [0, 1, 2].map(|slide| followed_mm(rows, slide, MOST_MM));
    let quiet = rests(rows, &ways_mm(&coarse), QUIET_S);
    [0, 1, 2].map(|slide| {
        let at_mm = |row: &Stand| row.position_mm[slide];
        let mut seen_mm: Vec<f64> = quiet
            .iter()
            .filter_map(|[from, to]| {
                let quarter = (to - from) / 4;
                let middle = rows.get(from + quarter..=to - quarter)?;
                let ends = middle
                    .iter()
                    .map(at_mm)
                    .fold([f64::MAX, f64::MIN], |[low, high], at| [low.min(at), high.max(at)]);
                Some(ends[1] - ends[0])
            })
            .collect();
        seen_mm.sort_by(f64::total_cmp);
        let seen_mm = seen_mm.get(seen_mm.len() / 2).copied().unwrap_or(0.0);
        let steps = rows.windows(2).map(|two| (at_mm(&two[1]) - at_mm(&two[0])).abs());
        let step_mm = steps.filter(|step| *step > 0.0).min_by(f64::total_cmp).unwrap_or(0.0);
        (OFTEN * seen_mm).max(STEPS * step_mm).clamp(LEAST_MM, MOST_MM)
    })
}

/// A slide with the play `w`: it stays as long as the slide is within `w / 2` of it.
fn followed_mm(rows: &[Stand], slide: usize, waver_mm: f64) -> Vec<f64> {
    let half_mm = 0.5 * waver_mm;
    let mut here_mm = rows.first().map_or(0.0, |row| row.position_mm[slide]);
    let follow = |row: &Stand| {
        let at_mm = row.position_mm[slide];
        here_mm = here_mm.clamp(at_mm - half_mm, at_mm + half_mm);
        here_mm
    };
    rows.iter().map(follow).collect()
}

fn ways_mm(followed: &[Vec<f64>; 3]) -> Vec<f64> {
    let mut way_mm = 0.0;
    let step = |row: usize| {
        if row > 0 {
            let of = |slide: &Vec<f64>| (slide[row] - slide[row - 1]).powi(2);
            way_mm += followed.iter().map(of).sum::<f64>().sqrt();
        }
        way_mm
    };
    (0..followed[0].len()).map(step).collect()
}

/// From which row to which no slide moves, for this time at least.
fn rests(rows: &[Stand], ways_mm: &[f64], least_s: f64) -> Vec<[usize; 2]> {
    let mut rests = Vec::new();
    let mut from = 0;
    for row in 1..=rows.len() {
        // The way is summed up: where nothing is added, it is the same number.
        if row < rows.len() && ways_mm[row].total_cmp(&ways_mm[from]).is_eq() {
            continue;
        }
        if rows[row - 1].time_s - rows[from].time_s >= least_s {
            rests.push([from, row - 1]);
        }
        from = row;
    }
    rests
}

/// Rests between which the tool goes no farther than this are one.
fn joined(rests: Vec<[usize; 2]>, ways_mm: &[f64], creeps_mm: f64) -> Vec<[usize; 2]> {
    let mut joined: Vec<[usize; 2]> = Vec::new();
    for rest in rests {
        match joined.last_mut() {
            Some(last) if ways_mm[rest[0]] - ways_mm[last[1]] < creeps_mm => last[1] = rest[1],
            _ => joined.push(rest),
        }
    }
    joined
}

/// A rest from when the tool has come as near to where it stands as it wavers until it has gone as far away: one that wavers finds
/// the ends of that only after some rows, and has moved on for as long.
fn arrived(rows: &[Stand], [from, to]: [usize; 2], wavers_mm: f64) -> [usize; 2] {
    let quarter = (to - from) / 4;
    let middle = &rows[from + quarter..=to - quarter];
    let sum_mm = middle.iter().map(|row| row.position_mm).sum::<Vector3<f64>>();
    let place_mm = sum_mm / middle.len() as f64;
    let there = |row: &&Stand| (row.position_mm - place_mm).norm() < wavers_mm;
    let before = rows[..from].iter().rev().take_while(there).count();
    let after = rows[to + 1..].iter().take_while(there).count();
    [from - before, to + after]
}

fn turns(rows: &[Stand], slide: usize, waver_mm: f64) -> Vec<Turn> {
    let at_mm = |row: usize| rows[row].position_mm[slide];
    let mut turns: Vec<Turn> = Vec::new();
    // Before the first motion either end may be where it begins.
    let mut ends = [0, 0];
    for row in 0..rows.len() {
        let sense = turns.last().map_or(0.0, |turn| turn.sense);
        let at = at_mm(row);
        if sense >= 0.0 && at >= at_mm(ends[1]) {
            ends[1] = row;
        }
        if sense <= 0.0 && at <= at_mm(ends[0]) {
            ends[0] = row;
        }
        let downwards = sense >= 0.0 && at < at_mm(ends[1]) - waver_mm;
        let upwards = sense <= 0.0 && at > at_mm(ends[0]) + waver_mm;
        if downwards || upwards {
            let from = if downwards { ends[1] } else { ends[0] };
            let sense = if downwards { -1.0 } else { 1.0 };
            let at_s = departure_s(rows, slide, [from, row], waver_mm, sense);
            turns.push(Turn { at_s, at_mm: at_mm(from), sense });
            ends = [row, row];
        }
    }
    turns
}

/// When a slide left a place that it was last seen at in the first of two rows, and has been away from by more than it wavers since the second, s.
fn departure_s(
    rows: &[Stand],
    slide: usize,
    [from, beyond]: [usize; 2],
    waver_mm: f64,
    sense: f64,
) -> f64 {
    let away_mm =
        |row: usize| sense * (rows[row].position_mm[slide] - rows[from].position_mm[slide]);
    let passed_s = |row: usize, level_mm: f64| {
        let (before, after) = (away_mm(row - 1), away_mm(row));
        let share = ((level_mm - before) / (after - before)).clamp(0.0, 1.0);
        rows[row - 1].time_s + share * (rows[row].time_s - rows[row - 1].time_s)
    };
    let near_s = passed_s(beyond, waver_mm);
    let goes_on = |row: &usize| away_mm(*row) > waver_mm;
    let next = (beyond..rows.len()).take(FAR_ROWS);
    let far = next.take_while(goes_on).find(|row| away_mm(*row) >= 4.0 * waver_mm);
    // One that goes back before it has got there was away for as long as it took.
    let begun_s = far.map_or(rows[from].time_s, |row| 2.0 * near_s - passed_s(row, 4.0 * waver_mm));
    begun_s.clamp(rows[from].time_s, near_s)
}

#[cfg(test)]
#[allow(clippy::panic)]
mod tests {
    use super::*;

    /// Rows of every millisecond.
    fn rows(seconds: f64, at_mm: impl Fn(f64) -> [f64; 3]) -> Vec<Stand> {
        let count = (seconds * 1e3) as usize;
        let row = |k: usize| {
            let time_s = k as f64 * 1e-3;
            Stand { time_s, position_mm: at_mm(time_s).into() }
        };
        (0..=count).map(row).collect()
    }

    /// A full circle of 100 mm in XY in 20 s between standstills of a second; Y turns at 6 s and 16 s, X at 11 s.
    fn circle_mm(t: f64) -> [f64; 3] {
        let angle = ((t - 1.0) / 20.0).clamp(0.0, 1.0) * std::f64::consts::TAU;
        [100.0 * angle.cos(), 100.0 * angle.sin(), 5.0]
    }

    /// What a servo adds that wavers by so much either way, mm: never the same from one millisecond to the next.
    fn dither(t: f64, of: usize, most_mm: f64) -> f64 {
        let k = (t * 1e3).round();
        most_mm * (k * (0.9 + 0.37 * of as f64)).sin() * (k * 0.071).cos()
    }

    #[test]
    fn a_slide_that_wavers_has_not_turned() {
        for (most_mm, step_mm) in [(0.0, 1e-6), (0.0, 1e-3), (0.5e-3, 1e-5), (2e-3, 1e-4)] {
            let seen = rows(22.0, |t| {
                let plain = circle_mm(t);
                [0, 1, 2].map(|k| {
                    let wavers = plain[k] + dither(t, k, most_mm);
                    (wavers / step_mm).round() * step_mm
                })
            });
            let slides = Slides::of(&seen);
            let [x, y, z] = &slides.turns;
            let senses =
                |of: &Vec<Turn>| of.iter().map(|turn| turn.sense as i32).collect::<Vec<_>>();
            assert_eq!(senses(x), [-1, 1], "{most_mm} {step_mm}: {x:?}");
            assert_eq!(senses(y), [1, -1, 1], "{most_mm} {step_mm}: {y:?}");
            assert!(z.is_empty(), "Z stands and wavers");
            // By what it wavers it does not show when exactly it turned: x = a t² / 2.
            let waver_mm: f64 = (4.0 * most_mm).max(1.5 * step_mm).max(1e-5);
            let unknown_s = 2e-3 + (2.0 * waver_mm / (100.0 * 0.314_f64.powi(2))).sqrt();
            for (turn, at_s) in [(&x[1], 11.0), (&y[1], 6.0), (&y[2], 16.0)] {
                assert!((turn.at_s - at_s).abs() < unknown_s, "{turn:?} {at_s} {unknown_s}");
            }
            assert_eq!(slides.rests.len(), 2, "{most_mm} {step_mm}");
            let way_mm = slides.ways_mm.last().copied().unwrap_or(0.0);
            assert!((way_mm / (200.0 * std::f64::consts::PI) - 1.0).abs() < 0.01, "{way_mm}");
        }
    }

    #[test]
    fn a_slide_that_stood_turned_when_it_went_on() {
        // Up by 1 mm/s, two seconds at rest, down again.
        let up_and_down = |t: f64| [t.min(1.0) - (t - 3.0).max(0.0), 0.0, 0.0];
        let slides = Slides::of(&rows(4.0, up_and_down));
        let [first, turn] = slides.turns[0][..] else { panic!("{:?}", slides.turns) };
        assert!(first.at_s.abs() < 1e-9 && (turn.at_s - 3.0).abs() < 1e-9, "{turn:?}");
        assert!((turn.at_mm - 1.0).abs() < 1e-9);
        let [[from, to]] = slides.rests[..] else { panic!("{:?}", slides.rests) };
        assert!(from.abs_diff(1000) <= 1 && to.abs_diff(3000) <= 1, "{from} {to}");
    }

    #[test]
    fn a_start_with_constant_acceleration_is_found_by_its_parabola() {
        // 0.01 mm of play, and a start of 10 mm/s² at 1 s.
        let start = |t: f64| 5.0 * (t - 1.0_f64).max(0.0).powi(2);
        let seen = rows(2.0, |t| [start(t), 0.0, 0.0]);
        let beyond = seen.iter().position(|row| row.position_mm.x > 0.01).unwrap_or(0);
        let at_s = departure_s(&seen, 0, [0, beyond], 0.01, 1.0);
        assert!((at_s - 1.0).abs() < 1e-3, "{at_s}");
        let still = Slides::of(&rows(1.0, |_| [1.0, 2.0, 3.0]));
        assert!(still.turns.iter().all(Vec::is_empty));
    }
}
