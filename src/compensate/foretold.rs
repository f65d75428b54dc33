//! What a laser would read: positioning along an axis (ISO 230-2) and along diagonals of a box (ISO 230-6).
//!
//! On its way there and back over a straight line the tool errs along the line by `f_i` and `b_i` at point `i`, both counted from
//! the start of the way there. Without what repeats scatter by, which the model does not have:
//!
//! | | is |
//! | --- | --- |
//! | `E` | range of all `f_i` and `b_i`: bidirectional systematic deviation |
//! | `E forward`, `E backward` | range of `f_i`, of `b_i` |
//! | `M` | range of `(f_i + b_i) / 2` |
//! | `B` | largest magnitude of `f_i - b_i`: reversal |
//!
//! A rigid motion of the workpiece changes none of them.

use nalgebra::Vector3;

use super::field::{Field, Row};
use super::figures::Figure;
use super::near::Measured;
use crate::machine::{Axis, Pose};

/// Points of a line: cubics and reversals need no more.
const POINTS: u32 = 21;

/// A straight line on which a laser stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// `X`, or a diagonal such as `PPN`: the signs of the way there along X, Y, Z; `PP0` lies in the XY plane.
    pub name: String,
    /// Machine coordinates of both ends, mm.
    pub ends_mm: [Vector3<f64>; 2],
    /// From one end to the other.
    pub points: Vec<LinePoint>,
    /// `E`, `E forward`, `E backward`, `M`, `B`.
    pub figures: [Figure; 5],
}

/// A point of a line.
#[derive(Debug, Clone, PartialEq)]
pub struct LinePoint {
    /// How far from the start, mm.
    pub at_mm: f64,
    /// On the way there.
    pub forward: Figure,
    /// On the way back.
    pub backward: Figure,
    /// Whether something was measured near.
    pub near: bool,
}

/// The axes of a box, its diagonals in planes and its body diagonals; what has no length is none.
pub(super) fn lines(field: &Field, [low_mm, high_mm]: [Vector3<f64>; 2]) -> Vec<Line> {
    let (middle_mm, half_mm) = (0.5 * (low_mm + high_mm), 0.5 * (high_mm - low_mm));
    let mut told = Vec::new();
    for axis in Axis::ALL {
        let way = half_mm.component_mul(&Vector3::ith(axis.index(), 1.0));
        told.push((axis.to_string(), way));
    }
    for (p, q) in [(0, 1), (1, 2), (2, 0)] {
        for sign in [1.0, -1.0] {
            let mut signs = Vector3::zeros();
            (signs[p], signs[q]) = (1.0, sign);
            told.push((name(&signs), half_mm.component_mul(&signs)));
        }
    }
    for (y, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let signs = Vector3::new(1.0, y, z);
        told.push((name(&signs), half_mm.component_mul(&signs)));
    }
    let whole = |(name, way): &(String, Vector3<f64>)| {
        let moving = |sign: char| sign != '0';
        let axes = if name.len() == 1 { 1 } else { name.chars().filter(|c| moving(*c)).count() };
        way.iter().filter(|mm| mm.abs() > 0.0).count() == axes
    };
    told.retain(whole);
    told.into_iter()
        .map(|(name, way)| line(field, name, [middle_mm - way, middle_mm + way]))
        .collect()
}

fn name(signs: &Vector3<f64>) -> String {
    let letter = |sign: &f64| match sign {
        sign if *sign > 0.0 => 'P',
        sign if *sign < 0.0 => 'N',
        _ => '0',
    };
    signs.iter().map(letter).collect()
}

fn line(field: &Field, name: String, ends_mm: [Vector3<f64>; 2]) -> Line {
    let way_mm = ends_mm[1] - ends_mm[0];
    let length_mm = way_mm.norm();
    let direction = way_mm / length_mm;
    // A slide that stands is as it is in the mean.
    let sense = way_mm.map(|mm| if mm == 0.0 { 0.0 } else { mm.signum() });
    let at = |k: u32, sense: Vector3<f64>| {
        let position_mm = ends_mm[0] + way_mm * (f64::from(k) / f64::from(POINTS - 1));
        let displacement = field.displacement(&Pose { position_mm, sense });
        let mut row = Row::zero(field.width());
        for j in 0..3 {
            row.add(&displacement.rows[j], direction[j]);
        }
        (displacement.error_mm.dot(&direction), row)
    };
    let (start_mm, start) = at(0, sense);
    let from_start = |(error_mm, mut row): (f64, Row)| {
        row.add(&start, -1.0);
        (error_mm - start_mm, row)
    };
    let forward: Vec<(f64, Row)> = (0..POINTS).map(|k| from_start(at(k, sense))).collect();
    let backward: Vec<(f64, Row)> = (0..POINTS).map(|k| from_start(at(k, -sense))).collect();
    let both = |factor: f64, sign: f64| {
        let each = forward.iter().zip(&backward).map(|((f, by_f), (b, by_b))| {
            let mut row = Row::zero(field.width());
            row.add(by_f, factor);
            row.add(by_b, factor * sign);
            (factor * (f + sign * b), row)
        });
        each.collect::<Vec<_>>()
    };
    let all: Vec<(f64, Row)> = forward.iter().chain(&backward).cloned().collect();
    let (mean, step) = (both(0.5, 1.0), both(1.0, -1.0));
    let steepest = step.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let figures = [
        range(field, &all),
        range(field, &forward),
        range(field, &backward),
        range(field, &mean),
        steepest.map_or(Figure::default(), |(mm, row)| Figure::of(field, mm.abs(), row)),
    ];
    let measured = Measured::by(field.errors());
    let points = forward.iter().zip(&backward).enumerate().map(|(k, (there, back))| {
        let share = k as f64 / f64::from(POINTS - 1);
        LinePoint {
            at_mm: share * length_mm,
            forward: Figure::of(field, there.0, &there.1),
            backward: Figure::of(field, back.0, &back.1),
            near: measured.is_near(&(ends_mm[0] + way_mm * share)),
        }
    });
    Line { name, ends_mm, points: points.collect(), figures }
}

fn range(field: &Field, of: &[(f64, Row)]) -> Figure {
    let high = of.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let low = of.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(high), Some(low)) = (high, low) else { return Figure::default() };
    let mut row = high.1.clone();
    row.add(&low.1, -1.0);
    Figure::of(field, high.0 - low.0, &row)
}
