//! What a control should take off, by functions of one slide each.
//!
//! `e_kh(h, s)` is the error along `k` when slide `h` stands there and has come in the sense `s`, the other slides at a stated place, of
//! a stated tool: angles act with both. A rigid motion of the workpiece is its set-up: it is turned so that X is straight, and
//! XY flat, on the average over what was measured, and the errors of squareness stand in `e_xy`, `e_xz` and `e_yz` alone. Each
//! function is 0, mean of both senses, where the machine is referenced; beyond what was measured it keeps the value of the end.
//! Of a slide that stood still, as the third one of a plane, nothing is wanted: what it does by direction is in no reading.

use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};

use super::field::Field;
use super::near::Measured;
use super::tables::Tables;
use crate::machine::{Axis, Machine, Pose, SlideError};

/// The functions of a machine, with what its control takes off already.
#[derive(Debug)]
pub struct Wanted<'a> {
    field: &'a Field<'a>,
    place_mm: Vector3<f64>,
    existing: &'a Tables,
    turn: Vector3<f64>,
}

/// Points of a slide on which a slope is fitted.
const POINTS: u32 = 21;
/// A slide that went less stood still, mm: it only wavered, or its files are rounded.
const STANDS_MM: f64 = 1.0;

impl<'a> Wanted<'a> {
    /// With the other slides at this place, on top of what is taken off already.
    pub fn new(field: &'a Field<'a>, place_mm: Vector3<f64>, existing: &'a Tables) -> Self {
        let mut wanted = Self { field, place_mm, existing, turn: Vector3::zeros() };
        let slope = |over: Axis, along: Axis| {
            let [low, high] = wanted.range_mm(over);
            let middle = 0.5 * (low + high);
            let at = (0..POINTS)
                .map(|k| low + (high - low) * f64::from(k) / f64::from(POINTS - 1))
                .map(|at| (at - middle, wanted.raw_mm(over, at, 0.0)[along.index()]));
            let (products, squares) = at.fold((0.0, 0.0), |(products, squares), (h, e)| {
                (products + h * e, squares + h * h)
            });
            if squares > 0.0 { products / squares } else { 0.0 }
        };
        wanted.turn = Vector3::new(
            slope(Axis::Y, Axis::Z),
            -slope(Axis::X, Axis::Z),
            slope(Axis::X, Axis::Y),
        );
        wanted
    }

    /// The machine.
    pub(super) fn machine(&self) -> &Machine {
        &self.field.errors().machine
    }

    /// What is taken off already.
    pub(super) fn existing(&self) -> &Tables {
        self.existing
    }

    /// Lowest and highest position of a slide that was measured, mm.
    pub(super) fn range_mm(&self, over: Axis) -> [f64; 2] {
        Measured::by(self.field.errors()).range_mm().map(|end| end[over.index()])
    }

    /// Whether a slide stood still in the test.
    fn stood(&self, over: Axis) -> bool {
        let [low, high] = self.range_mm(over);
        high - low < STANDS_MM
    }

    /// Lowest and highest position of a slide that a function of it is told for, mm: where it was measured; of one that stood
    /// still its travel, over which what is taken off already may differ.
    pub(super) fn told_mm(&self, over: Axis) -> [f64; 2] {
        if self.stood(over) { self.machine().slide(over).travel_mm } else { self.range_mm(over) }
    }

    /// Where a slide is referenced: its zero, or the end of its travel that is nearest to it, mm.
    pub(super) fn reference_mm(&self, over: Axis) -> f64 {
        let [low, high] = self.machine().slide(over).travel_mm;
        0.0_f64.clamp(low, high)
    }

    /// The rigid motion that is the set-up of the workpiece, mm.
    pub(super) fn rigid_mm(&self, position_mm: &Vector3<f64>) -> Vector3<f64> {
        self.turn.cross(&(position_mm - self.place_mm))
    }

    fn raw_mm(&self, over: Axis, position_mm: f64, sense: f64) -> Vector3<f64> {
        let k = over.index();
        let [low, high] = self.range_mm(over);
        let mut pose = Pose { position_mm: self.place_mm, sense: Vector3::zeros() };
        pose.position_mm[k] = position_mm.clamp(low, high);
        pose.sense[k] = sense;
        self.field.error_mm(&pose)
    }

    /// `e_kh(h, s)`, mm.
    pub(super) fn error_mm(&self, over: Axis, along: Axis, position_mm: f64, sense: f64) -> f64 {
        let j = along.index();
        let [low, high] = self.range_mm(over);
        let turned = |at: f64| {
            let motion = Vector3::ith(over.index(), at.clamp(low, high));
            self.turn.cross(&motion)[j]
        };
        let reference_mm = self.reference_mm(over);
        let of = |at: f64, s: f64| {
            let existing = self.existing.of_slide_mm(over, along, at, s);
            if self.stood(over) {
                return existing;
            }
            self.raw_mm(over, at, s)[j] - turned(at) + existing
        };
        of(position_mm, sense) - of(reference_mm, 0.0)
    }

    /// The error at a point, mean of both senses, from that at the place, without the set-up of the workpiece; beyond what was
    /// measured that of its end, mm.
    pub(super) fn vector_mm(&self, position_mm: &Vector3<f64>) -> Vector3<f64> {
        let ends: [[f64; 2]; 3] = Axis::ALL.map(|axis| self.range_mm(axis));
        let within = Vector3::from_fn(|k, _| position_mm[k].clamp(ends[k][0], ends[k][1]));
        let at = |position_mm| Pose { position_mm, sense: Vector3::zeros() };
        let tool = self.field.tool_ball_mm();
        let existing = self.existing.error_mm(self.machine(), tool, &at(within))
            - self.existing.error_mm(self.machine(), tool, &at(self.place_mm));
        self.field.error_mm(&at(within))
            - self.field.error_mm(&at(self.place_mm))
            - self.rigid_mm(&within)
            + existing
    }

    /// The six errors of each slide where one of them stands, mean of both senses.
    pub(super) fn slide(&self, over: Axis, position_mm: f64) -> SlideError {
        let k = over.index();
        let [low, high] = self.range_mm(over);
        let mut pose = Pose { position_mm: self.place_mm, sense: Vector3::zeros() };
        pose.position_mm[k] = position_mm.clamp(low, high);
        self.field.slides(&pose)[k]
    }

    /// Scales on the diagonal and squarenesses `e_xy`, `e_xz`, `e_yz` above it that fit best over what was measured; a turn of the
    /// workpiece is taken off.
    pub(super) fn linear(&self) -> Matrix3<f64> {
        let measured = Measured::by(self.field.errors());
        let [low, high] = measured.range_mm();
        let middle_mm = 0.5 * (low + high);
        let (mut normal, mut right) = (Matrix4::zeros(), [Vector4::zeros(); 3]);
        for k in 0..GRID.pow(3) {
            let of = [k % GRID, k / GRID % GRID, k / GRID / GRID];
            let share = Vector3::from(of.map(|k| f64::from(k) / f64::from(GRID - 1)));
            let position_mm = low + (high - low).component_mul(&share);
            if measured.beyond_mm(&position_mm) > 0.0 {
                continue;
            }
            let from = position_mm - middle_mm;
            let row = Vector4::new(from.x, from.y, from.z, 1.0);
            let error_mm = self.field.error_mm(&Pose { position_mm, sense: Vector3::zeros() });
            normal += row * row.transpose();
            for (right, error_mm) in right.iter_mut().zip(&error_mm) {
                *right += row * *error_mm;
            }
        }
        // A slide that did not move has no slope.
        for k in 0..4 {
            normal[(k, k)] += RIDGE * normal.trace().max(f64::MIN_POSITIVE);
        }
        let Some(solved) = normal.cholesky() else { return Matrix3::zeros() };
        let rows = right.map(|right| solved.solve(&right));
        let slopes = Matrix3::from_fn(|j, k| rows[j][k]);
        let mut linear = Matrix3::from_diagonal(&slopes.diagonal());
        for (j, k) in [(0, 1), (0, 2), (1, 2)] {
            linear[(j, k)] = slopes[(j, k)] + slopes[(k, j)];
        }
        linear + self.existing.linear
    }

    /// Lost motion of a slide, mean over what is told of it, mm.
    pub(super) fn play_mm(&self, over: Axis) -> f64 {
        let each = self
            .points_mm(over)
            .map(|at| self.error_mm(over, over, at, -1.0) - self.error_mm(over, over, at, 1.0));
        each.sum::<f64>() / f64::from(POINTS)
    }

    /// Largest less smallest of a function over what is told of a slide, mm.
    pub(super) fn extent_mm(&self, of: impl Fn(f64) -> f64, over: Axis) -> f64 {
        extent(self.points_mm(over).map(of))
    }

    /// Largest less smallest of a function of position and sense over what is told of a slide and both senses, mm.
    pub(super) fn extent_both_mm(&self, of: impl Fn(f64, f64) -> f64, over: Axis) -> f64 {
        extent(self.points_mm(over).flat_map(|at| [of(at, 1.0), of(at, -1.0)]))
    }

    fn points_mm(&self, over: Axis) -> impl Iterator<Item = f64> {
        let [low, high] = self.told_mm(over);
        (0..POINTS).map(move |k| low + (high - low) * f64::from(k) / f64::from(POINTS - 1))
    }
}

fn extent(values: impl Iterator<Item = f64>) -> f64 {
    let (least, most) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), e| (least.min(e), most.max(e)));
    most - least
}

/// Points along each axis where a linear error is fitted.
const GRID: u32 = 9;
/// Of the trace: what no point shows is nothing.
const RIDGE: f64 = 1e-12;
