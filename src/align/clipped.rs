//! Readings that were cut off at one value, and those of an instrument that goes on reading its limit while it is out of
//! range.

use crate::log::{Log, Reading};

/// So many readings at the very limit are none by chance.
const FEWEST: usize = 10;
/// The flat top of a smooth curve, read in coarse steps, holds up to 5.3 times the readings of the next step below (a
/// curve of fourth order, whose top just reaches the step); where more are at the limit, it is one.
const PILED: usize = 6;
/// And so many stand one behind the other.
const TOGETHER: usize = 3;

/// No bar reads less either way, mm (`range_mm`). Nearer to its nominal length readings pile up on a machine that goes round
/// as it should.
const LEAST_MM: f64 = 0.01;

/// The limits that the readings of a log were cut off at, mm, at most one either way.
fn limits_mm(log: &Log) -> Vec<f64> {
    let mut values: Vec<f64> =
        log.readings().iter().filter_map(|reading| reading.deviation_mm).collect();
    values.sort_by(f64::total_cmp);
    let equal = |a: &f64, b: &f64| a.total_cmp(b).is_eq();
    let mut steps = values.chunk_by(equal);
    let ends = [(steps.next(), steps.next()), (steps.next_back(), steps.next_back())];
    let limit = |(outermost, next): (Option<&[f64]>, Option<&[f64]>)| {
        let (outermost, next) = (outermost?, next?);
        let piled = outermost[0].abs() >= LEAST_MM
            && outermost.len() >= FEWEST
            && outermost.len() > PILED * next.len();
        (piled && longest(log, outermost[0]) >= TOGETHER).then_some(outermost[0])
    };
    ends.into_iter().filter_map(limit).collect()
}

/// How many readings of one value stand one behind the other at most.
fn longest(log: &Log, value_mm: f64) -> usize {
    let alike = |a: &Reading, b: &Reading| a.deviation_mm == b.deviation_mm;
    let of = log.readings().chunk_by(alike);
    of.filter(|stretch| stretch[0].deviation_mm == Some(value_mm))
        .map(<[_]>::len)
        .max()
        .unwrap_or(0)
}

/// The log with what was cut off as out of range, and the readings that were; `None` where nothing was.
pub fn taken_out(log: &Log) -> Option<(Log, Vec<Reading>)> {
    let limits_mm = limits_mm(log);
    let cut = |reading: &Reading| reading.deviation_mm.is_some_and(|mm| limits_mm.contains(&mm));
    let clipped: Vec<Reading> = log.readings().iter().filter(|r| cut(r)).copied().collect();
    (!clipped.is_empty()).then(|| (log.without(|reading| cut(reading)), clipped))
}
