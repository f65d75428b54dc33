//! Balls that stand so far off that the bar reads where the program has it out of its range, or runs out of it on an arc.
//!
//! Then the log shows other engagements than the program has, and nothing of it can be laid over. But an arc still reads as
//! one: `d = c + u · e` along the commanded unit vectors `u`, with the offset `e` of the tool ball and a constant `c`. Every
//! moment of the log is tried as the beginning of the longest arc.
//!
//! Arcs then read up to `|e|`, and where the program has the bar wait at `w`, it reads `w - |e|` or more. Where the first is
//! less than the second, a bar of half the range, `w / 2`, would have shown the engagements of the program: its readings
//! beyond are left out, and what is left is laid over.

use nalgebra::{Matrix4, Vector3, Vector4};

use super::run::Run;
use super::samples::{Alignment, Part, Sample};
use super::section;
use super::waits::{laid_within, trajectory_of, waits_mm};
use crate::motion::Trajectory;
use crate::solve;

/// The arc is looked at in so many places.
const PLACES: usize = 120;
/// It is laid over the log in steps of this part of its duration: the offset turns by two degrees on a full circle.
const STEPS: f64 = 180.0;
/// And not more often than this: a log may be a hundred times as long as its arcs.
const MOST_TRIES: f64 = 20_000.0;
/// This part of its readings must be there where the rest may be out of the range, and elsewhere this part.
const READ: f64 = 0.4;
const WHOLE: f64 = 0.9;
/// What is left of the readings, rms, as a part of them: a machine with errors of 50 um beside an offset of 1 mm.
const LEFT: f64 = 0.05;
/// In directions that an arc hardly has an offset is not told.
const FLAT: f64 = 1e-3;

/// Of arcs that are laid over the operator's pause half of the readings or more are left: with less than this nothing else is looked for.
const WRONG: f64 = 0.35;
/// Balls are said to stand too far off where the arcs of a log, as it was laid over its program, leave so many times more than
/// the one arc that is found in it by itself.
const WORSE: f64 = 4.0;
/// Arcs of a log that was laid over its program wrongly leave so many times more than where they are laid over rightly, whatever
/// the machine errs by beside the offset.
const NEARLY_ALL: f64 = 2.0;
/// This part of the offset that brings the bar in by itself does so together with errors of the machine.
const OFF: f64 = 0.5;
/// So many readings tell how large they are.
const LOOKED_AT: usize = 2000;
/// Half of the readings of an arc are larger than this part of its offset.
const SWINGS: f64 = 0.25;

/// Balls that stand off.
pub enum OffCentre {
    /// So far, mm, that stops of the program cannot be told from its arcs. Into which direction does not come of one arc: the
    /// way back is as round, mirrored, and so is a part of a longer way round, turned.
    TooFar(f64),
    /// Not so far.
    Laid {
        /// How far off the tool ball stood when the log was taken, where the program means the balls to meet, mm; nothing
        /// along what arcs do not show.
        offset_mm: Vector3<f64>,
        /// Readings beyond this were left out, mm.
        within_mm: f64,
        /// How the log lies over its program.
        alignment: Box<Alignment>,
    },
}

/// The balls of a run that stand off; `None` where that is not what is wrong: where `laid` is how the log lies over the
/// program, and its readings are those of arcs there.
pub fn off_centre(run: &Run, laid: Option<&Alignment>) -> Option<OffCentre> {
    let trajectory = trajectory_of(run, laid);
    let range_mm = run.rig.bar.range_mm;
    let waits_mm = waits_mm(run, &trajectory);
    // Where the bar waits out of its range, an offset by the rest of the way brings it in.
    let least_mm = waits_mm.map_or(range_mm, |mm| (mm - range_mm).min(range_mm));
    let one_arc = Circle::of_one_arc(run, &trajectory, least_mm)?;
    let left = laid.and_then(|laid| Circle::of_arcs(run, laid)).map_or(1.0, |of| of.left);
    if laid.is_some() && left < WRONG {
        return None;
    }
    let nearer = || {
        // Of arcs that read beyond that, a bar of half the range would have shown pieces.
        let within_mm = waits_mm.map(|mm| 0.5 * mm).filter(|mm| one_arc.offset_mm.norm() < *mm)?;
        let laid = laid_within(run, within_mm)?;
        let of = Circle::of_arcs(run, &laid)?;
        let is_off = of.left < left / NEARLY_ALL && of.offset_mm.norm() > OFF * least_mm;
        is_off.then(|| OffCentre::Laid {
            offset_mm: of.offset_mm,
            within_mm,
            alignment: Box::new(laid),
        })
    };
    nearer().or_else(|| {
        let size_mm = one_arc.offset_mm.norm();
        let is_arc = one_arc.left < LEFT && (laid.is_none() || one_arc.left < left / WORSE);
        (is_arc && size_mm >= least_mm).then_some(OffCentre::TooFar(size_mm))
    })
}

/// Readings as of a circle or a sphere about another centre.
struct Circle {
    offset_mm: Vector3<f64>,
    readings: f64,
    /// What is left of the readings, as a part of them.
    left: f64,
}

impl Circle {
    /// Through the readings of a log that look most like the longest arc of its program, wherever they are; `None` where
    /// they are too small for so large an offset.
    fn of_one_arc(run: &Run, trajectory: &Trajectory, least_mm: f64) -> Option<Self> {
        let readings = run.log.readings();
        let some = readings.iter().step_by(readings.len().div_ceil(LOOKED_AT).max(1));
        let sizes_mm = some.filter_map(|reading| reading.deviation_mm).map(f64::abs);
        if solve::median(sizes_mm.collect())? < SWINGS * least_mm {
            return None;
        }
        let sections = section::sections(trajectory, &run.rig);
        let arc = sections.iter().max_by(|a, b| a.duration_s().total_cmp(&b.duration_s()))?;
        let position_mm = |program_s: f64| trajectory.at(program_s).position_mm;
        let unit = |program_s: f64| run.rig.commanded_mm(&position_mm(program_s)).normalize();
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
            // A bar that stands reads as a circle as well, of no offset, and a part of an arc as one about some other centre: the
            // rest is there, or out of the range.
            let is_arc = |of: &Self| {
                let size_mm = of.offset_mm.norm();
                let read = if size_mm > run.rig.bar.range_mm { READ } else { WHOLE };
                of.readings > read * PLACES as f64 && size_mm > OFF * least_mm
            };
            Self::through(read.flatten()).filter(is_arc)
        });
        tried.min_by(|a, b| a.left.total_cmp(&b.left))
    }

    /// Through what a log reads on the arcs of its program, where it is laid over it.
    fn of_arcs(run: &Run, laid: &Alignment) -> Option<Self> {
        let samples = laid.samples().into_iter();
        let on_arcs = samples.filter(|sample| matches!(sample.part, Part::Arc(_)));
        let unit = |sample: &Sample| run.rig.commanded_mm(&sample.pose.position_mm).normalize();
        Self::through(on_arcs.map(|sample| (unit(&sample), sample.deviation_mm)))
    }

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
