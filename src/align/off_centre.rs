//! Balls that stand so far off that the bar reads where the program has it out of its range, or runs out of it on an arc.
//!
//! Then the log shows other engagements than the program has, and nothing of it can be laid over. But an arc still reads as
//! one: `d = c + u · e` along the commanded unit vectors `u`, with the offset `e` of the tool ball and a constant `c`. Every
//! moment of the log is tried as the beginning of the longest arc.

use nalgebra::{Matrix4, Vector3, Vector4};

use super::run::Run;
use super::samples::{Alignment, Part};
use super::section;
use crate::motion::BlockKind;
use crate::solve;

/// The arc is looked at in so many places.
const PLACES: usize = 120;
/// It is laid over the log in steps of this part of its duration: the offset turns by two degrees on a full circle.
const STEPS: f64 = 180.0;
/// And not more often than this: a log may be a hundred times as long as its arcs.
const MOST_TRIES: f64 = 20_000.0;
/// This part of its readings must be there: the rest was out of the range.
const READ: f64 = 0.4;
/// What is left of the readings, rms, as a part of them: a machine with errors of 50 um beside an offset of 1 mm.
const LEFT: f64 = 0.05;
/// In directions that an arc hardly has an offset is not told.
const FLAT: f64 = 1e-3;

/// Where a log was laid over its program, its arcs leave so many times more than elsewhere in the log if it was laid over wrongly:
/// of an arc that is laid over the operator's pause some half of the readings are left, of one that is not [`LEFT`] at the most.
const WORSE: f64 = 4.0;
/// So many readings tell how large they are.
const LOOKED_AT: usize = 2000;
/// Half of the readings of an arc are larger than this part of its offset.
const SWINGS: f64 = 0.25;

/// How far off the tool ball stood when the log was taken, where the program means the balls to meet, mm; nothing along what
/// its longest arc does not show, and `None` where that is not what is wrong: where `laid` is how the log lies over the
/// program, and its readings are those of arcs there.
pub fn off_centre(run: &Run, laid: Option<&Alignment>) -> Option<Vector3<f64>> {
    let planned;
    let trajectory = if let Some(laid) = laid {
        &laid.trajectory
    } else {
        planned = run.trajectory(run.feed_override);
        &planned
    };
    // Where the bar waits out of its range, an offset by the rest of the way brings it in.
    let waits = trajectory.blocks().iter().filter(|block| block.kind == BlockKind::Stop);
    let beyond = waits
        .map(|block| run.rig.commanded_deviation_mm(&block.start_mm).abs() - run.rig.bar.range_mm);
    let least_mm = beyond.filter(|mm| *mm > 0.0).fold(run.rig.bar.range_mm, f64::min);
    let readings = run.log.readings();
    let some = readings.iter().step_by(readings.len().div_ceil(LOOKED_AT).max(1));
    let sizes_mm = some.filter_map(|reading| reading.deviation_mm).map(f64::abs);
    if solve::median(sizes_mm.collect())? < SWINGS * least_mm {
        return None;
    }

    let sections = section::sections(trajectory, &run.rig);
    let arc = sections.iter().max_by(|a, b| a.duration_s().total_cmp(&b.duration_s()))?;
    let unit =
        |program_s: f64| run.rig.commanded_mm(&trajectory.at(program_s).position_mm).normalize();
    let duration_s = arc.duration_s();
    let later_s = |place: usize| duration_s * (place as f64 + 0.5) / PLACES as f64;
    let units: Vec<(f64, Vector3<f64>)> =
        (0..PLACES).map(|place| (later_s(place), unit(arc.start_s + later_s(place)))).collect();
    let (first, last) = (readings.first()?, readings.last()?);
    let span_s = last.time_s - first.time_s;
    let step_s = (duration_s / STEPS).max(span_s / MOST_TRIES);
    let at = |time_s: f64| {
        let next = readings.partition_point(|reading| reading.time_s < time_s);
        readings.get(next).and_then(|reading| reading.deviation_mm)
    };
    let tried = (0..(span_s / step_s) as usize).filter_map(|k| {
        let begins_s = first.time_s + step_s * k as f64;
        let read = units.iter().map(|(later_s, unit)| Some((*unit, at(begins_s + later_s)?)));
        Circle::through(read.flatten()).filter(|of| of.readings > READ * PLACES as f64)
    });
    let best = tried.min_by(|a, b| a.left.total_cmp(&b.left))?;
    if best.left > LEFT || best.offset_mm.norm() < least_mm {
        return None;
    }
    let agrees = |laid: &Alignment| {
        let samples = laid.samples().into_iter();
        let on_arcs = samples.filter(|sample| matches!(sample.part, Part::Arc(_)));
        let read = on_arcs.map(|sample| (unit(sample.program_s), sample.deviation_mm));
        Circle::through(read).is_some_and(|of| of.left < WORSE * best.left)
    };
    (!laid.is_some_and(agrees)).then_some(best.offset_mm)
}

/// Readings as of a circle or a sphere about another centre.
struct Circle {
    offset_mm: Vector3<f64>,
    readings: f64,
    /// What is left of the readings, as a part of them.
    left: f64,
}

impl Circle {
    /// Through readings (mm), each with its commanded unit vector.
    fn through(read: impl Iterator<Item = (Vector3<f64>, f64)>) -> Option<Self> {
        let (mut normal, mut rhs) = (Matrix4::zeros(), Vector4::zeros());
        let (mut square, mut readings) = (0.0, 0.0);
        for (unit, deviation_mm) in read {
            let row = unit.push(1.0);
            normal += row * row.transpose();
            rhs += row * deviation_mm;
            square += deviation_mm * deviation_mm;
            readings += 1.0;
        }
        let solution = normal.svd(true, true).solve(&rhs, FLAT * readings).ok()?;
        let left_square = (square - solution.dot(&rhs)).max(0.0);
        Some(Self { offset_mm: solution.xyz(), readings, left: (left_square / square).sqrt() })
    }
}
