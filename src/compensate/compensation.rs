//! Tables for a control, read back as the control will, with what they leave and how to see that their signs are right.

use nalgebra::Vector3;

use super::controls::{Control, Limits, Named, Written};
use super::error_model::ErrorModel;
use super::field::Field;
use super::left::{Beside, Left};
use super::near::Measured;
use super::tables::Tables;
use super::wanted::Wanted;
use crate::error::{Error, Result};
use crate::machine::{Axis, Pose};

/// No correction is larger, mm.
pub const LARGEST_MM: f64 = 0.5;

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Compensating {
    /// For which control.
    pub control: Control,
    /// What it takes.
    pub limits: Limits,
    /// Tip of the tool in the frame of the last slide on the tool side, mm.
    pub tool_ball_mm: Vector3<f64>,
    /// Where the other slides are while one moves, machine coordinates, mm.
    pub place_mm: Vector3<f64>,
    /// The files that were active when the machine was measured: the new ones have both.
    pub existing: Vec<Named>,
}

/// One point at which it is seen whether a sign is right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnePoint {
    /// The slide that moves, in the positive direction, and the direction in which it is looked.
    pub over: Axis,
    /// As above.
    pub along: Axis,
    /// From where to where, machine coordinates, mm.
    pub from_mm: f64,
    /// As above.
    pub to_mm: f64,
    /// How much farther the tool goes than it should, as the machine was measured, mm.
    pub off_mm: f64,
    /// The same with the files, mm.
    pub left_mm: f64,
    /// The same with every sign turned, mm.
    pub wrong_mm: f64,
}

/// Files for a control, and what they do.
#[derive(Debug, Clone, PartialEq)]
pub struct Compensation {
    /// What was asked for.
    pub asked: Compensating,
    /// The files.
    pub written: Written,
    /// What is left with them.
    pub left: Left,
    /// Where to look; the own direction of a slide first.
    pub points: Vec<OnePoint>,
}

impl Compensation {
    /// Of a machine.
    ///
    /// # Errors
    /// When the files cannot hold it, when a correction is beyond what is one, or leads beyond the travel.
    pub fn of(errors: &ErrorModel, asked: &Compensating) -> Result<Self> {
        let field = Field::new(errors, asked.tool_ball_mm)?;
        let existing = match &asked.existing[..] {
            [] => Tables::default(),
            files => asked.control.read(files, &asked.limits)?,
        };
        let wanted = Wanted::new(&field, asked.place_mm, &existing);
        let written = asked.control.write(&wanted, &asked.limits)?;
        // What counts is what the control will read.
        let tables = asked.control.read(&written.files, &asked.limits)?;
        let beside = Beside { field: &field, existing: &existing, tables: &tables };
        let left = beside.left(asked.place_mm);
        if left.taken_mm.is_nan() || left.taken_mm > LARGEST_MM {
            return Err(Error::input(format!(
                "the correction would be {:.3} mm, and more than {LARGEST_MM} mm is none",
                left.taken_mm
            ))
            .hint(
                "set the machine up first: look for what is wrong with steps, pitch or squareness",
            ));
        }
        let [low, high] = Measured::by(errors).range_mm();
        for axis in Axis::ALL {
            let k = axis.index();
            let [least, most] = errors.machine.slide(axis).travel_mm;
            if low[k] - left.taken_mm < least || high[k] + left.taken_mm > most {
                return Err(Error::input(format!(
                    "what was measured ends within {:.3} mm of the travel of {axis}, {least} to {most} mm: the correction would lead beyond it",
                    left.taken_mm
                ))
                .hint("measure away from the end of the travel"));
            }
        }
        let points = points(&beside, asked.place_mm);
        Ok(Self { asked: asked.clone(), written, left, points })
    }
}

/// Places of a slide that are looked at.
const PLACES: u32 = 20;
/// Less is not seen with an indicator, mm.
const SEEN_MM: f64 = 0.2e-3;

/// Of each slide the direction in which the most is taken off, its own where that is half as much.
fn points(beside: &Beside, place_mm: Vector3<f64>) -> Vec<OnePoint> {
    let [low, high] = Measured::by(beside.field.errors()).range_mm();
    let mut told = Vec::new();
    for over in Axis::ALL {
        let k = over.index();
        let pose = |at: f64| {
            let mut pose = Pose { position_mm: place_mm, sense: Vector3::ith(k, 1.0) };
            pose.position_mm[k] = at;
            pose
        };
        let places =
            (0..=PLACES).map(|i| low[k] + (high[k] - low[k]) * f64::from(i) / f64::from(PLACES));
        let places: Vec<f64> = places.map(|at| at.round().clamp(low[k], high[k])).collect();
        let start = beside.taken_mm(&pose(places[0]));
        let most = |j: usize| {
            let change = |at: f64| (beside.taken_mm(&pose(at)) - start)[j];
            places.iter().map(|at| (*at, change(*at))).fold((places[0], 0.0_f64), |best, now| {
                if now.1.abs() > best.1.abs() { now } else { best }
            })
        };
        let all = Axis::ALL.map(|along| (along, most(along.index())));
        let largest = all.iter().map(|(_, of)| of.1.abs()).fold(0.0, f64::max);
        if largest < SEEN_MM {
            continue;
        }
        let own = all[k].1.1.abs() >= 0.5 * largest;
        let chosen =
            all.iter().find(|(along, of)| if own { *along == over } else { of.1.abs() >= largest });
        let Some((along, (to_mm, taken_mm))) = chosen.copied() else { continue };
        let j = along.index();
        let change =
            |of: &dyn Fn(&Pose) -> Vector3<f64>| (of(&pose(to_mm)) - of(&pose(places[0])))[j];
        let off_mm = change(&|pose| beside.field.error_mm(pose));
        told.push(OnePoint {
            over,
            along,
            from_mm: places[0],
            to_mm,
            off_mm,
            left_mm: change(&|pose| beside.left_mm(pose)),
            wrong_mm: off_mm + taken_mm,
        });
    }
    told
}
