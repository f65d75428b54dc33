//! What a compensation leaves of the errors over what was measured, and of which errors it is.
//!
//! The control is sent to `p - t(p)`, `t` what its tables take off, and the tool is there by `e` off again. Sizes are of the points within
//! what was measured, with the four sets of senses that have the mean of all eight, without the rigid motion of the workpiece that fits best.
//! Groups are functions of one slide from the place of the tables, rms over its range without its mean; *angles* is what hangs on more
//! slides than one, rms over the points.

use nalgebra::Vector3;

use super::field::{Displacement, Field, Row};
use super::near::Measured;
use super::rigid::Rigid;
use super::tables::Tables;
use crate::machine::{Axis, Pose};

/// Sizes of what is off, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Root mean square of the length.
    pub rms_mm: f64,
    /// Largest length.
    pub largest_mm: f64,
}

/// A group of errors before and after, mm rms.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Such as `positioning X`.
    pub name: String,
    /// Without the tables.
    pub before_mm: f64,
    /// With them.
    pub after_mm: f64,
}

/// What is left.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// Without the tables, or with those that were there before.
    pub before: Sizes,
    /// With them.
    pub after: Sizes,
    /// The groups of errors.
    pub groups: Vec<Group>,
    /// Largest vector that is taken off, from what is taken off in the middle, mm.
    pub taken_mm: f64,
}

const SENSES: [[f64; 3]; 4] =
    [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
/// Points in the box that holds what was measured, and of a slide alone.
const POINTS: usize = 8000;
const OF_A_SLIDE: usize = 200;
/// The root of `x^(d+1) = x + 1` for one dimension and for three. Multiples of its inverse powers fill a unit box evenly and
/// never step by the pitch of an error, as those of a grid may (M. Roberts, The unreasonable effectiveness of quasirandom
/// sequences, 2018).
const ONE: f64 = 1.618_033_988_749_895;
const THREE: f64 = 1.220_744_084_605_759_5;

/// The errors of a machine with what its control takes off.
pub(super) struct Beside<'a> {
    pub(super) field: &'a Field<'a>,
    /// What was taken off when it was measured.
    pub(super) existing: &'a Tables,
    pub(super) tables: &'a Tables,
}

impl Beside<'_> {
    /// What is taken off beside what was taken off before, mm.
    pub(super) fn taken_mm(&self, pose: &Pose) -> Vector3<f64> {
        let (machine, tool) = (&self.field.errors().machine, self.field.tool_ball_mm());
        self.tables.error_mm(machine, tool, pose) - self.existing.error_mm(machine, tool, pose)
    }

    /// What is left, mm.
    pub(super) fn left_mm(&self, pose: &Pose) -> Vector3<f64> {
        let taken_mm = self.taken_mm(pose);
        let sent = Pose { position_mm: pose.position_mm - taken_mm, ..*pose };
        self.field.error_mm(&sent) - taken_mm
    }

    /// All of it, the place of the tables given.
    pub(super) fn left(&self, place_mm: Vector3<f64>) -> Left {
        let before = |pose: &Pose| self.field.error_mm(pose);
        let after = |pose: &Pose| self.left_mm(pose);
        let points = self.points();
        let middle = Pose { position_mm: place_mm, sense: Vector3::zeros() };
        let zero_mm = self.taken_mm(&middle);
        let taken = points
            .iter()
            .flat_map(|p| poses(*p))
            .map(|pose| (self.taken_mm(&pose) - zero_mm).norm());
        let (groups_before, groups_after) =
            (self.groups(&points, place_mm, &before), self.groups(&points, place_mm, &after));
        let groups = groups_before
            .into_iter()
            .zip(groups_after)
            .map(|((name, before_mm), (_, after_mm))| Group { name, before_mm, after_mm });
        Left {
            before: sizes(&points, &before),
            after: sizes(&points, &after),
            groups: groups.collect(),
            taken_mm: taken.fold(0.0, f64::max),
        }
    }

    /// Points within what was measured.
    fn points(&self) -> Vec<Vector3<f64>> {
        let measured = Measured::by(self.field.errors());
        let [low, high] = measured.range_mm();
        let at = |k: usize| {
            let share = |of: i32| (k as f64 * THREE.powi(-of)).fract();
            low + (high - low).component_mul(&Vector3::new(share(1), share(2), share(3)))
        };
        (0..POINTS).map(at).filter(|p| measured.beyond_mm(p) <= 1e-6).collect()
    }

    /// Names and sizes of groups, mm rms.
    fn groups(
        &self,
        points: &[Vector3<f64>],
        place_mm: Vector3<f64>,
        of: &impl Fn(&Pose) -> Vector3<f64>,
    ) -> Vec<(String, f64)> {
        let still = |position_mm| of(&Pose { position_mm, sense: Vector3::zeros() });
        let zero_mm = still(place_mm);
        let rigid = fitted(points, &still);
        let straight = |position_mm: Vector3<f64>| {
            let mut error = displacement(still(position_mm) - zero_mm);
            rigid.take_off(&position_mm, &mut error);
            error.error_mm
        };
        let [low, high] = Measured::by(self.field.errors()).range_mm();
        let moved = |over: Axis, at: f64| {
            let mut position_mm = place_mm;
            position_mm[over.index()] = at;
            position_mm
        };
        let mut told = Vec::new();
        for over in Axis::ALL {
            let k = over.index();
            let at =
                (0..OF_A_SLIDE).map(|i| low[k] + (high[k] - low[k]) * (i as f64 / ONE).fract());
            let at: Vec<Vector3<f64>> = at.map(|at| moved(over, at)).collect();
            let count = at.len() as f64;
            let each: Vec<Vector3<f64>> = at.iter().map(|p| straight(*p)).collect();
            let mean = each.iter().sum::<Vector3<f64>>() / count;
            let rms = |j: usize| {
                (each.iter().map(|e| (e[j] - mean[j]).powi(2)).sum::<f64>() / count).sqrt()
            };
            for along in Axis::ALL {
                let name = if along == over {
                    format!("positioning {over}")
                } else {
                    format!("straightness and squareness of {over} along {along}")
                };
                told.push((name, rms(along.index())));
            }
            let turned = at.iter().map(|p| {
                let with = |sense: f64| {
                    let mut senses = Vector3::zeros();
                    senses[k] = sense;
                    of(&Pose { position_mm: *p, sense: senses })
                };
                0.5 * (with(1.0) - with(-1.0))
            });
            let squares = turned
                .fold(Vector3::zeros(), |sum: Vector3<f64>, half| sum + half.component_mul(&half));
            told.push((format!("lost motion of {over}, half of it"), (squares[k] / count).sqrt()));
            let aside = squares.sum() - squares[k];
            told.push((format!("lateral play of {over}, half of it"), (aside / count).sqrt()));
        }
        let angles = points.iter().map(|p| {
            let alone = Axis::ALL.map(|over| still(moved(over, p[over.index()])) - zero_mm);
            (still(*p) - zero_mm - alone.iter().sum::<Vector3<f64>>()).norm_squared()
        });
        told.push((
            "angles, and whatever hangs on more slides than one".into(),
            (angles.sum::<f64>() / points.len().max(1) as f64).sqrt(),
        ));
        told
    }
}

fn poses(position_mm: Vector3<f64>) -> impl Iterator<Item = Pose> {
    SENSES.into_iter().map(move |sense| Pose { position_mm, sense: sense.into() })
}

fn displacement(error_mm: Vector3<f64>) -> Displacement {
    Displacement { error_mm, rows: [Row::zero(0), Row::zero(0), Row::zero(0)] }
}

fn fitted(points: &[Vector3<f64>], of: &impl Fn(Vector3<f64>) -> Vector3<f64>) -> Rigid {
    let all: Vec<_> = points.iter().map(|p| (*p, displacement(of(*p)))).collect();
    Rigid::fit(&all, 0)
}

fn sizes(points: &[Vector3<f64>], of: &impl Fn(&Pose) -> Vector3<f64>) -> Sizes {
    let rigid = fitted(points, &|position_mm| of(&Pose { position_mm, sense: Vector3::zeros() }));
    let (mut squares, mut count, mut largest_mm) = (0.0, 0_usize, 0.0_f64);
    for pose in points.iter().flat_map(|p| poses(*p)) {
        let mut error = displacement(of(&pose));
        rigid.take_off(&pose.position_mm, &mut error);
        squares += error.error_mm.norm_squared();
        count += 1;
        largest_mm = largest_mm.max(error.error_mm.norm());
    }
    Sizes { rms_mm: (squares / count.max(1) as f64).sqrt(), largest_mm }
}
