//! The map of the volumetric error.
//!
//! At points of a box the tool is displaced against the workpiece by `e`, and in the four sets of senses that have the mean of all
//! eight; the map has the mean of both senses, the figures have the senses. Without the rigid motion of the workpiece that fits
//! the map best, or counted from the middle of the test. The machine is at rest: what hangs on speed or time is not in it.

use nalgebra::Vector3;

use super::field::{Displacement, Field, Sigmas};
use super::figures::{Figure, Figures, size};
use super::foretold::{Line, lines};
use super::near::Measured;
use super::rigid::Rigid;
use crate::machine::Pose;

const SENSES: [[f64; 3]; 4] =
    [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];

/// Points along an axis at the most: a map of a cubic needs no more, and 9261 points take some 100 MB.
pub const MOST_POINTS: usize = 21;

/// What volume is looked at, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// Lowest and highest machine coordinates, mm.
    pub ends_mm: [Vector3<f64>; 2],
    /// Points along each axis that has a length, at least 2.
    pub points: usize,
    /// Whether the rigid motion of the workpiece that fits best stays in.
    pub keep_rigid: bool,
}

/// A point of the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Machine coordinates, mm.
    pub position_mm: Vector3<f64>,
    /// Displacement of the tool against the workpiece along X, Y, Z, mean of both senses.
    pub error: [Figure; 3],
    /// Length of that.
    pub size: Figure,
    /// What is not known of the vector: root of the sum of the squares of its three, mm.
    pub unknown: Sigmas,
    /// Whether something was measured near.
    pub near: bool,
}

/// The map of a volume.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeMap {
    /// What was looked at.
    pub volume: Volume,
    /// Points along X, Y, Z.
    pub counts: [usize; 3],
    /// The points, X the fastest.
    pub nodes: Vec<Node>,
    /// What they are together where something was measured near; `None` where nothing was.
    pub near: Option<Figures>,
    /// What all are together; `None` where that is the same.
    pub whole: Option<Figures>,
    /// What a laser would read.
    pub lines: Vec<Line>,
}

impl VolumeMap {
    /// Of a volume.
    pub fn of(field: &Field, volume: &Volume) -> Self {
        let [low_mm, high_mm] = volume.ends_mm;
        let counts = <[f64; 3]>::from(high_mm - low_mm)
            .map(|mm| if mm > 0.0 { volume.points.clamp(2, MOST_POINTS) } else { 1 });
        let at = |k: usize| {
            let of = [k % counts[0], k / counts[0] % counts[1], k / counts[0] / counts[1]];
            Vector3::from_fn(|j, _| {
                let share = of[j] as f64 / (counts[j].max(2) - 1) as f64;
                low_mm[j] + share * (high_mm[j] - low_mm[j])
            })
        };
        let places: Vec<Vector3<f64>> = (0..counts.iter().product()).map(at).collect();
        let displaced = |position_mm: &Vector3<f64>, sense: Vector3<f64>| {
            (*position_mm, field.displacement(&Pose { position_mm: *position_mm, sense }))
        };
        let mut mean: Vec<(Vector3<f64>, Displacement)> =
            places.iter().map(|p| displaced(p, Vector3::zeros())).collect();
        let rigid = if volume.keep_rigid {
            let (_, middle) = displaced(&field.errors().frame.middle_mm, Vector3::zeros());
            Rigid::of_point(&middle, field.width())
        } else {
            Rigid::fit(&mean, field.width())
        };
        for (p, of) in &mut mean {
            rigid.take_off(p, of);
        }
        let mut poses: Vec<(Vector3<f64>, Displacement)> =
            places.iter().flat_map(|p| SENSES.map(|sense| displaced(p, sense.into()))).collect();
        for (p, of) in &mut poses {
            rigid.take_off(p, of);
        }
        let measured = Measured::by(field.errors());
        let near: Vec<_> = poses.iter().filter(|(p, _)| measured.is_near(p)).collect();
        let all: Vec<_> = poses.iter().collect();
        let node = |(position_mm, of): &(Vector3<f64>, Displacement)| {
            let error = [0, 1, 2].map(|k| Figure::of(field, of.error_mm[k], &of.rows[k]));
            let square = |by: fn(&Sigmas) -> f64| {
                error.iter().map(|of| by(&of.sigmas).powi(2)).sum::<f64>().sqrt()
            };
            Node {
                position_mm: *position_mm,
                error,
                size: size(field, of),
                unknown: Sigmas { noise: square(|of| of.noise), all: square(|of| of.all) },
                near: measured.is_near(position_mm),
            }
        };
        Self {
            volume: *volume,
            counts,
            nodes: mean.iter().map(node).collect(),
            whole: (near.len() < all.len()).then(|| Figures::of(field, &all)).flatten(),
            near: Figures::of(field, &near),
            lines: lines(field, volume.ends_mm),
        }
    }
}
