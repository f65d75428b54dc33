//! Acceleration that builds up in a given time: bell-shaped acceleration.
//!
//! A control with bell-shaped acceleration filters the speed that it has planned: the speed along the
//! path is the mean of the planned speed over the acceleration change time `T`,
//!
//! `s~(t) = 1/T · ∫ s(τ) dτ` over `t-T … t`,
//!
//! so that an acceleration `a` builds up with the jerk `a/T`, and every stretch from rest to rest takes
//! `T` longer. The path itself is not filtered: what moves are the times at which it is passed.

use super::profile::Phase;
use super::profile::Profile;

/// A stretch from rest to rest as planned, at the ends of whose pieces the acceleration changes.
#[derive(Debug, Clone, Copy)]
struct Knot {
    time_s: f64,
    distance_mm: f64,
    speed_mm_s: f64,
    /// Until the next knot.
    acceleration_mm_s2: f64,
}

/// The profiles of the blocks of a stretch from rest to rest, filtered.
pub(super) fn filtered(planned: &[Profile], lengths_mm: &[f64], change_s: f64) -> Vec<Profile> {
    let knots = knots(planned);
    let Some(end_s) = knots.last().map(|knot| knot.time_s) else { return Vec::new() };
    let mut times_s: Vec<f64> =
        knots.iter().flat_map(|knot| [knot.time_s, knot.time_s + change_s]).collect();
    times_s.sort_by(f64::total_cmp);
    times_s.dedup_by(|after, before| *after - *before < 1e-12);
    let mut phases = times_s
        .windows(2)
        .map(|pair| {
            let now = state(&knots, pair[0], end_s);
            let past = state(&knots, pair[0] - change_s, end_s);
            Phase {
                duration_s: pair[1] - pair[0],
                speed_mm_s: (now.distance_mm - past.distance_mm) / change_s,
                acceleration_mm_s2: (now.speed_mm_s - past.speed_mm_s) / change_s,
                jerk_mm_s3: (now.acceleration_mm_s2 - past.acceleration_mm_s2) / change_s,
            }
        })
        .collect::<Vec<_>>()
        .into_iter();
    let mut open = phases.next();
    let last = lengths_mm.len().saturating_sub(1);
    lengths_mm
        .iter()
        .enumerate()
        .map(|(k, length_mm)| {
            let mut left_mm = *length_mm;
            let mut own = Vec::new();
            while let Some(phase) = open {
                let whole_mm = phase.at(phase.duration_s).0;
                // The last block takes all that is left, so that no rounding is lost.
                if k == last || whole_mm <= left_mm {
                    own.push(phase);
                    left_mm -= whole_mm;
                    open = phases.next();
                } else {
                    let time_s = phase.time_of_s(left_mm);
                    let (first, second) = phase.split(time_s);
                    own.push(first);
                    open = Some(second);
                    break;
                }
            }
            Profile::of_phases(own)
        })
        .collect()
}

fn knots(planned: &[Profile]) -> Vec<Knot> {
    let mut knots = Vec::with_capacity(3 * planned.len() + 1);
    let mut now = Knot { time_s: 0.0, distance_mm: 0.0, speed_mm_s: 0.0, acceleration_mm_s2: 0.0 };
    for phase in planned.iter().flat_map(Profile::phases) {
        let t = phase.duration_s;
        if t <= 0.0 {
            continue;
        }
        now.speed_mm_s = phase.speed_mm_s;
        now.acceleration_mm_s2 = phase.acceleration_mm_s2;
        knots.push(now);
        now = after(&now, t);
    }
    knots.push(Knot { speed_mm_s: 0.0, acceleration_mm_s2: 0.0, ..now });
    knots
}

/// The state a time after a knot.
fn after(knot: &Knot, t: f64) -> Knot {
    let Knot { time_s, distance_mm, speed_mm_s, acceleration_mm_s2: a } = *knot;
    Knot {
        time_s: time_s + t,
        distance_mm: distance_mm + speed_mm_s * t + 0.5 * a * t * t,
        speed_mm_s: speed_mm_s + a * t,
        acceleration_mm_s2: a,
    }
}

/// The state at a time; at rest before the beginning and after the end.
fn state(knots: &[Knot], time_s: f64, end_s: f64) -> Knot {
    let still = Knot { speed_mm_s: 0.0, acceleration_mm_s2: 0.0, ..knots[0] };
    if time_s < -1e-12 {
        return still;
    }
    let index = knots.partition_point(|knot| knot.time_s <= time_s + 1e-12).saturating_sub(1);
    let knot = &knots[index];
    if time_s >= end_s - 1e-12 { *knot } else { after(knot, (time_s - knot.time_s).max(0.0)) }
}
