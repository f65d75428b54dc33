//! Readings that were cut off at one value, and those of an instrument that goes on reading its limit while it is out of
//! range.

use crate::log::{Log, Reading};

/// So many readings at the very limit are none by chance.
const FEWEST: usize = 10;
/// The flat top of a smooth curve, read in coarse steps, holds up to 5.3 times the readings of the next step below (a
/// curve of fourth order, whose top just reaches the step); where more are at the limit, it is one. A curve that dips twice holds up to
/// 10 times as many, and its readings are left out for nothing.
const PILED: usize = 6;
/// And so many stand one behind the other.
const TOGETHER: usize = 3;

/// No bar reads less either way, mm (`range_mm`). Nearer to its nominal length readings pile up on a machine that goes round
/// as it should.
const LEAST_MM: f64 = 0.01;

/// Where the readings of a log end, one way, in more readings than a machine that goes round leaves there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit {
    /// The outermost value, mm.
    pub(super) at_mm: f64,
    /// The next one that was read, mm.
    pub(super) next_mm: f64,
}

impl Limit {
    /// Whether so many readings at the limit are too many beside those at the next value.
    pub(super) fn is_piled(at: usize, next: usize) -> bool {
        at > PILED * next
    }
}

/// The limits that the readings of a log seem to be cut off at, at most one either way.
pub(super) fn limits(log: &Log) -> Vec<Limit> {
    let mut values: Vec<f64> =
        log.readings().iter().filter_map(|reading| reading.deviation_mm).collect();
    values.sort_by(f64::total_cmp);
    let equal = |a: &f64, b: &f64| a.total_cmp(b).is_eq();
    let mut steps = values.chunk_by(equal);
    let ends = [(steps.next(), steps.next()), (steps.next_back(), steps.next_back())];
    let limit = |(outermost, next): (Option<&[f64]>, Option<&[f64]>)| {
        let (outermost, next) = (outermost?, next?);
        let limit = Limit { at_mm: outermost[0], next_mm: next[0] };
        let piled = limit.at_mm.abs() >= LEAST_MM
            && outermost.len() >= FEWEST
            && Limit::is_piled(outermost.len(), next.len());
        (piled && longest(log, limit.at_mm) >= TOGETHER).then_some(limit)
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

/// The log with what was cut off as out of range, and the readings that were.
pub(super) fn without(log: &Log, limits: &[Limit]) -> (Log, Vec<Reading>) {
    let is_at = |limit: &Limit, mm: f64| limit.at_mm.total_cmp(&mm).is_eq();
    let cut = |reading: &Reading| {
        reading.deviation_mm.is_some_and(|mm| limits.iter().any(|limit| is_at(limit, mm)))
    };
    let clipped = log.readings().iter().filter(|reading| cut(reading)).copied().collect();
    (log.without(|reading| cut(reading)), clipped)
}

/// The same of all limits of a log; `None` where it has none.
pub fn taken_out(log: &Log) -> Option<(Log, Vec<Reading>)> {
    let limits = limits(log);
    (!limits.is_empty()).then(|| without(log, &limits))
}
