//! Arcs of G02 and G03: from what a block says to a centre and an angle.

use std::f64::consts::TAU;

use crate::path::{Point, Turn};

/// The radii at both ends may differ by so much, mm: a control's own tolerance.
const RADII_MM: f64 = 0.01;
/// Ends that are nearer than this are one, mm.
const CLOSED_MM: f64 = 1e-5;
/// By so much half the chord may be larger than the radius, mm: one increment.
const HALF_MM: f64 = 1e-3;

/// The arc about a centre; sense is +1 for G03.
pub(crate) fn about(
    from: Point,
    to: Point,
    normal: usize,
    sense: i8,
    centre_mm: Point,
) -> Result<Turn, &'static str> {
    let (u, v) = ((normal + 1) % 3, (normal + 2) % 3);
    let polar = |p: Point| {
        let (a, b) = (p[u] - centre_mm[u], p[v] - centre_mm[v]);
        (a.hypot(b), b.atan2(a))
    };
    let ((first_mm, first_rad), (last_mm, last_rad)) = (polar(from), polar(to));
    if first_mm < CLOSED_MM {
        return Err("an arc about its own start");
    }
    if (first_mm - last_mm).abs() > RADII_MM {
        return Err("an arc with two radii");
    }
    let closed = (from[u] - to[u]).hypot(from[v] - to[v]) < CLOSED_MM;
    let sense = f64::from(sense);
    let turned_rad = ((last_rad - first_rad) * sense).rem_euclid(TAU);
    let sweep_rad = sense * if closed { TAU } else { turned_rad };
    Ok(Turn { normal, centre_mm, sweep_rad })
}

/// The arc of a radius: less than half a turn, or more where the radius is negative.
pub(crate) fn of_radius(
    from: Point,
    to: Point,
    normal: usize,
    sense: i8,
    radius_mm: f64,
) -> Result<Turn, &'static str> {
    let (u, v) = ((normal + 1) % 3, (normal + 2) % 3);
    let (along, across) = (to[u] - from[u], to[v] - from[v]);
    let chord_mm = along.hypot(across);
    if chord_mm < CLOSED_MM {
        return Err("a radius of a full circle");
    }
    if chord_mm / 2.0 > radius_mm.abs() + HALF_MM {
        return Err("a radius that is too small");
    }
    let height_mm = (radius_mm * radius_mm - chord_mm * chord_mm / 4.0).max(0.0).sqrt();
    // To the left of the chord, or to its right.
    let left_mm = height_mm * f64::from(sense) * radius_mm.signum();
    let mut centre_mm = from;
    centre_mm[u] += along / 2.0 - across / chord_mm * left_mm;
    centre_mm[v] += across / 2.0 + along / chord_mm * left_mm;
    about(from, to, normal, sense, centre_mm)
}
