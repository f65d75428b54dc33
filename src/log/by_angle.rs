//! Logs without times: what was read at which angle of an arc.

use std::f64::consts::TAU;
use std::ops::Range;

use jiff::civil::Date;

use crate::error::Result;
use crate::solve::{Truncation, Tsqr, solve};

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
    /// Its readings, as indices.
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

/// Circularity of readings that stand evenly over an arc, as Ballbar 20 computes it, in the unit of the readings: the width of
/// what is left of them when the circle through them, by least squares, is taken off.
pub(super) fn circularity(readings: &[Option<f64>], span_rad: f64) -> Result<f64> {
    let count = readings.len() as f64;
    let angle = |k: usize| span_rad * ((k as f64 + 0.5) / count - 0.5);
    let mut rows = Tsqr::new(3);
    let read =
        || readings.iter().enumerate().filter_map(|(k, reading)| Some((angle(k), (*reading)?)));
    for (angle, reading) in read() {
        rows.push_weighted(&[1.0, angle.cos(), angle.sin()], reading, 1.0);
    }
    let solution = solve(&rows.finish()?, Truncation::Relative(1e-12))?;
    let [radius, x, y] = [solution.x()[0], solution.x()[1], solution.x()[2]];
    let left = read().map(|(angle, reading)| reading - radius - x * angle.cos() - y * angle.sin());
    let [low, high] = left
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], of| [low.min(of), high.max(of)]);
    Ok(high - low)
}

/// Splits angles, degrees, where the direction turns or an angle stands twice: there one arc ends and the next begins. `None` where
/// an angle stands three times.
pub(super) fn turns(angles_deg: &[f64]) -> Option<Vec<Turn>> {
    let step = |k: usize| {
        let step = (angles_deg[k] - angles_deg[k - 1]).rem_euclid(360.0);
        if step > 180.0 { step - 360.0 } else { step }
    };
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
