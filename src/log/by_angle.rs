//! Logs without times: what was read at which angle of an arc.

use std::f64::consts::TAU;
use std::ops::Range;

use jiff::civil::Date;

use crate::error::Result;
use crate::solve::{dot, minimax};

/// What a log by angle says beside its readings.
#[derive(Debug, Clone, PartialEq)]
pub struct ByAngle {
    /// The axes of the plane, as indices: angles count from the first towards the second.
    pub plane: [usize; 2],
    /// The arcs, each driven once.
    pub turns: Vec<Turn>,
    /// Programmed feed, mm/s, where the log says it.
    pub feed_mm_s: Option<f64>,
    /// Nominal length of the bar, mm, where the log says it.
    pub nominal_mm: Option<f64>,
    /// Who measured, and with what.
    pub said: Said,
}

/// What a file of Ballbar 20 says of the day, each where it does.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Said {
    /// Who ran it.
    pub operator: Option<String>,
    /// Serial number of the bar.
    pub bar_serial: Option<String>,
    /// When the bar was calibrated last.
    pub bar_calibrated: Option<Date>,
}

/// An arc that was driven once in one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// From the first axis of the plane to the second.
    pub counter_clockwise: bool,
    /// Its readings, as indices, in the order in which they were driven.
    pub readings: Range<usize>,
    /// Where they were taken.
    pub angles: Angles,
}

/// The angles of an arc's readings.
#[derive(Debug, Clone, PartialEq)]
pub enum Angles {
    /// From the first axis of the plane, rad, as the log has them.
    Stated(Vec<f64>),
    /// Evenly over this many rad in the middle of the arc that the program drives.
    Even(f64),
}

/// Circularities of readings that stand evenly over an arc, in the unit of the readings: the range of what is left when the circle
/// by least squares is taken off, and the minimum zone, the least that any circle leaves. On a part of a circle the first may be a
/// quarter larger. ISO 230-4 defines the second and lets the first be used for it.
pub(super) fn circularities(readings: &[Option<f64>], span_rad: f64) -> Result<[f64; 2]> {
    let count = readings.len() as f64;
    let row = |k: usize| {
        let (sin, cos) = (span_rad * ((k as f64 + 0.5) / count - 0.5)).sin_cos();
        [1.0, cos, sin]
    };
    let (rows, read): (Vec<_>, Vec<_>) =
        readings.iter().enumerate().filter_map(|(k, reading)| Some((row(k), (*reading)?))).unzip();
    let fit = minimax(&rows, &read)?;
    let left = rows.iter().zip(&read).map(|(row, read)| read - dot(row, &fit.least_squares));
    let [low, high] = left
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], of| [low.min(of), high.max(of)]);
    Ok([high - low, 2.0 * fit.deviation])
}

/// Arcs of readings that all stand by rising angle, degrees, each at most a full turn: where the angle comes back to its first the next
/// begins, or does not rise, and every second is clockwise. `None` where one has a single reading.
pub(super) fn rising_turns(angles_deg: &[f64]) -> Option<Vec<Turn>> {
    let mut turns = Vec::new();
    let mut from = 0;
    while from < angles_deg.len() {
        let (mut to, mut swept_deg) = (from + 1, 0.0);
        while to < angles_deg.len() {
            let step_deg = step_deg(angles_deg, to);
            swept_deg += step_deg;
            // The reading that closes a circle stands once more at the beginning of the next.
            let closes = to + 1 == angles_deg.len() || self::step_deg(angles_deg, to + 1) == 0.0;
            if step_deg <= 0.0 || swept_deg > 360.0 - CLOSED_DEG && !closes {
                break;
            }
            to += 1;
        }
        let counter_clockwise = turns.len() % 2 == 0;
        let of_arc = angles_deg[from..to].iter().map(|angle| angle.to_radians() % TAU);
        let stated = if counter_clockwise { of_arc.collect() } else { of_arc.rev().collect() };
        if to < from + 2 {
            return None;
        }
        turns.push(Turn { counter_clockwise, readings: from..to, angles: Angles::Stated(stated) });
        from = to;
    }
    Some(turns)
}

/// Angles that lie so near to each other are written for one, degrees.
const CLOSED_DEG: f64 = 1e-6;

/// From the angle before to this one the shorter way, degrees, above -180 and up to 180.
fn step_deg(angles_deg: &[f64], k: usize) -> f64 {
    let step = (angles_deg[k] - angles_deg[k - 1]).rem_euclid(360.0);
    if step > 180.0 { step - 360.0 } else { step }
}

/// Splits angles, degrees, where the direction turns or an angle stands twice: there one arc ends and the next begins. `None` where
/// an angle stands three times.
pub(super) fn turns(angles_deg: &[f64]) -> Option<Vec<Turn>> {
    let step = |k: usize| step_deg(angles_deg, k);
    let mut turns = Vec::new();
    let mut from = 0;
    while from + 1 < angles_deg.len() {
        let first = step(from + 1);
        if first == 0.0 {
            return None;
        }
        let mut to = from + 2;
        while to < angles_deg.len() && step(to) * first > 0.0 {
            to += 1;
        }
        let stated = angles_deg[from..to].iter().map(|angle| angle.to_radians() % TAU).collect();
        turns.push(Turn {
            counter_clockwise: first > 0.0,
            readings: from..to,
            angles: Angles::Stated(stated),
        });
        from = to;
    }
    Some(turns)
}
