//! Where the tool ball goes: lines, arcs and positionings, and how near they come to a point.

use std::f64::consts::TAU;

/// X, Y and Z, mm.
pub(crate) type Point = [f64; 3];

/// An arc is looked at in steps of this angle, rad: a tenth of a degree. At 1 m between two looks the path is 0.4 um off
/// its chord, which is far below what a bar feels.
const LOOK_RAD: f64 = TAU / 3600.0;

pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn distance_mm(a: Point, b: Point) -> f64 {
    dot(minus(a, b), minus(a, b)).sqrt()
}

/// Part of the way from one point to another.
pub(crate) fn between(from: Point, to: Point, share: f64) -> Point {
    std::array::from_fn(|k| from[k] + (to[k] - from[k]) * share)
}

/// An arc about an axis of the machine, with a lift along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    /// X, Y or Z: 0, 1, 2.
    pub(crate) normal: usize,
    /// Its component along the normal means nothing.
    pub(crate) centre_mm: Point,
    /// Positive by the right hand about the normal.
    pub(crate) sweep_rad: f64,
}

/// The points of an arc, so near to each other that lines between them are the arc.
pub(crate) fn points_of(turn: &Turn, from: Point, to: Point) -> Vec<Point> {
    let (u, v) = ((turn.normal + 1) % 3, (turn.normal + 2) % 3);
    let arm = |p: Point| (p[u] - turn.centre_mm[u], p[v] - turn.centre_mm[v]);
    let ((a, b), (c, d)) = (arm(from), arm(to));
    let (first_mm, last_mm) = (a.hypot(b), c.hypot(d));
    let start_rad = b.atan2(a);
    let looks = (turn.sweep_rad.abs() / LOOK_RAD).ceil().max(1.0) as usize;
    let at = |look: usize| {
        let share = look as f64 / looks as f64;
        let radius_mm = first_mm + (last_mm - first_mm) * share;
        let angle_rad = start_rad + turn.sweep_rad * share;
        let mut point = between(from, to, share);
        point[u] = turn.centre_mm[u] + radius_mm * angle_rad.cos();
        point[v] = turn.centre_mm[v] + radius_mm * angle_rad.sin();
        point
    };
    (0..=looks).map(at).collect()
}

/// The corners of a positioning in which every axis goes at its own rapid traverse and stops when it is there.
pub(crate) fn dog_leg(from: Point, to: Point, rapid_mm_s: [f64; 3]) -> Vec<Point> {
    let needs_s: Point = std::array::from_fn(|k| (to[k] - from[k]).abs() / rapid_mm_s[k]);
    let mut times_s = needs_s;
    times_s.sort_by(f64::total_cmp);
    let at = |time_s: f64| {
        std::array::from_fn(|k| {
            if needs_s[k] <= time_s {
                to[k]
            } else {
                from[k] + (to[k] - from[k]) * time_s / needs_s[k]
            }
        })
    };
    std::iter::once(from).chain(times_s.map(at)).collect()
}

/// Least and largest distance of a polygon from a point, mm.
pub(crate) fn reach_mm(corners: &[Point], centre: Point) -> (f64, f64) {
    let mut least_mm = f64::INFINITY;
    for pair in corners.windows(2) {
        let along = minus(pair[1], pair[0]);
        let squared = dot(along, along);
        let share = if squared > 0.0 { dot(minus(centre, pair[0]), along) / squared } else { 0.0 };
        let foot = between(pair[0], pair[1], share.clamp(0.0, 1.0));
        least_mm = least_mm.min(distance_mm(foot, centre));
    }
    let ends = corners.iter().map(|corner| distance_mm(*corner, centre));
    let most_mm = ends.fold(0.0, f64::max);
    (least_mm.min(most_mm), most_mm)
}
