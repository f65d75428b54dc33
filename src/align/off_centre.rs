//! Balls that stand so far off that the bar reads where the program has it out of its range, or runs out of it on an arc.
//!
//! Then the log shows other engagements than the program has, and nothing of it can be laid over. But an arc still reads as
//! one: `d = c + u · e` along the commanded unit vectors `u`, with the offset `e` of the tool ball and a constant `c`. Every
//! moment of the log is tried as the beginning of the longest arc.

use nalgebra::{Matrix4, Vector3, Vector4};

use super::run::Run;
use super::section;
use crate::log::Log;
use crate::motion::{BlockKind, Trajectory};

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

/// How far off the tool ball stood when the log was taken, where the program means the balls to meet, mm; nothing along what
/// its longest arc does not show, and `None` where that is not what is wrong.
pub fn off_centre(run: &Run) -> Option<Vector3<f64>> {
    let trajectory = Trajectory::new(run.program, run.rig.machine, run.feed_override);
    let sections = section::sections(&trajectory, &run.rig);
    let arc = sections.iter().max_by(|a, b| a.duration_s().total_cmp(&b.duration_s()))?;
    let duration_s = arc.duration_s();
    // Where the bar waits out of its range, an offset by the rest of the way brings it in.
    let waits = trajectory.blocks().iter().filter(|block| block.kind == BlockKind::Stop);
    let beyond = waits
        .map(|block| run.rig.commanded_deviation_mm(&block.start_mm).abs() - run.rig.bar.range_mm);
    let least_mm = beyond.filter(|mm| *mm > 0.0).fold(run.rig.bar.range_mm, f64::min);

    let units: Vec<(f64, Vector3<f64>)> = (0..PLACES)
        .map(|place| {
            let later_s = duration_s * (place as f64 + 0.5) / PLACES as f64;
            let position_mm = trajectory.at(arc.start_s + later_s).position_mm;
            (later_s, run.rig.commanded_mm(&position_mm).normalize())
        })
        .collect();
    let (first, last) = (run.log.readings().first()?, run.log.readings().last()?);
    let span_s = last.time_s - first.time_s;
    let step_s = (duration_s / STEPS).max(span_s / MOST_TRIES);
    let tries = (span_s / step_s) as usize;
    let laid = (0..tries).filter_map(|k| laid(run.log, &units, first.time_s + step_s * k as f64));
    let best = laid.min_by(|a, b| a.left.total_cmp(&b.left))?;
    (best.left < LEFT && best.offset_mm.norm() > least_mm).then_some(best.offset_mm)
}

/// An arc laid over a log.
struct Laid {
    offset_mm: Vector3<f64>,
    /// What is left of the readings, as a part of them.
    left: f64,
}

fn laid(log: &Log, units: &[(f64, Vector3<f64>)], begins_s: f64) -> Option<Laid> {
    let readings = log.readings();
    let (mut normal, mut rhs, mut square) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
    let mut count = 0.0;
    for (later_s, unit) in units {
        let at_s = begins_s + later_s;
        let next = readings.partition_point(|reading| reading.time_s < at_s);
        let Some(deviation_mm) = readings.get(next).and_then(|reading| reading.deviation_mm) else {
            continue;
        };
        let row = Vector4::new(unit.x, unit.y, unit.z, 1.0);
        normal += row * row.transpose();
        rhs += row * deviation_mm;
        square += deviation_mm * deviation_mm;
        count += 1.0;
    }
    if count < READ * units.len() as f64 {
        return None;
    }
    let solution = normal.svd(true, true).solve(&rhs, FLAT * count).ok()?;
    let left_square = (square - solution.dot(&rhs)).max(0.0);
    Some(Laid { offset_mm: solution.xyz(), left: (left_square / square).sqrt() })
}
