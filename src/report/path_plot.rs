//! A program as a picture: its path on the sphere, and its speed over time.

use askama::Template;
use nalgebra::Vector3;

use super::numbers::fixed;
use super::svg::{Anchor, Drawing, envelope, thinned};
use super::svg_chart::{Axis, Chart};
use crate::error::{Error, Kind, Result};
use crate::motion::{Block, BlockKind, Trajectory};
use crate::nc::Sphere;

/// Size of a view, pixels, and the radius of the sphere in it.
const VIEW: f64 = 460.0;
const RADIUS: f64 = 185.0;
/// How far a line is shifted to the right of its direction, pixels.
const LANE: f64 = 3.0;
/// Points of a line in a view, and of the speed.
const VIEW_POINTS: usize = 120;
const SPEED_POINTS: usize = 2400;

/// A stretch on the sphere without a pause, under one comment.
struct Leg {
    name: String,
    line: usize,
    start: String,
    duration: String,
    length: String,
    class: &'static str,
    from_s: f64,
    to_s: f64,
    /// Unit vectors from the workpiece ball, the length of the bar being 1.
    points: Vec<Vector3<f64>>,
}

/// How a unit vector is seen: right, up, and towards the eye.
type Seen = dyn Fn(&Vector3<f64>) -> (f64, f64, f64);

#[derive(Template)]
#[template(path = "path.html")]
struct Page<'a> {
    plot: &'a Plot,
}

struct Plot {
    title: String,
    legs: Vec<Leg>,
    above: String,
    oblique: String,
    speed: String,
}

/// The page of a program around a ball-bar.
///
/// # Errors
/// When the page cannot be filled.
pub fn path_page(title: &str, trajectory: &Trajectory, sphere: &Sphere) -> Result<String> {
    let (legs, radial) = legs(trajectory, sphere);
    let above = |v: &Vector3<f64>| (v.x, v.y, v.z);
    // From azimuth -60 degrees, 30 degrees above the equator.
    let (sine, cosine) = (-60_f64).to_radians().sin_cos();
    let oblique = move |v: &Vector3<f64>| {
        let (right, depth) = (v.y * cosine - v.x * sine, v.x * cosine + v.y * sine);
        (right, v.z * 0.75_f64.sqrt() - depth * 0.5, depth * 0.75_f64.sqrt() + v.z * 0.5)
    };
    let plot = Plot {
        title: title.to_owned(),
        above: view(&legs, &radial, &above, "the path seen from +Z"),
        oblique: view(&legs, &radial, &oblique, "the path seen obliquely"),
        speed: speed(trajectory, &legs),
        legs,
    };
    Page { plot: &plot }
        .render()
        .map_err(|error| Error::new(Kind::Output, format!("the picture cannot be drawn: {error}")))
}

/// What is driven on the sphere, and the moves at feed that lead to it and away.
fn legs(trajectory: &Trajectory, sphere: &Sphere) -> (Vec<Leg>, Vec<Vec<Vector3<f64>>>) {
    let unit = |at: &Vector3<f64>| (at - sphere.centre_mm) / sphere.length_mm;
    let on = |v: &Vector3<f64>| (v.norm() - 1.0).abs() * sphere.length_mm <= sphere.range_mm;
    let mut legs: Vec<Leg> = Vec::new();
    let mut radial = Vec::new();
    let mut open: Option<Vec<&Block>> = None;
    let mut passes = 0;
    let mut close = |open: &mut Option<Vec<&Block>>| {
        let blocks = open.take().unwrap_or_default();
        if let [first, ..] = blocks[..] {
            legs.push(leg(trajectory, &blocks, first, &unit, &mut passes));
        }
    };
    for block in trajectory.blocks() {
        let Some(motion) = block.motion().filter(|motion| !motion.rapid) else {
            close(&mut open);
            continue;
        };
        let (from, to) = (unit(&motion.start_mm), unit(&motion.end_mm));
        if !(on(&from) && on(&to)) {
            close(&mut open);
            radial.push(vec![from, to]);
            continue;
        }
        if open.as_ref().is_some_and(|blocks| blocks[0].label != block.label) {
            close(&mut open);
        }
        open.get_or_insert_with(Vec::new).push(block);
    }
    close(&mut open);
    (legs, radial)
}

fn leg(
    trajectory: &Trajectory,
    blocks: &[&Block],
    first: &Block,
    unit: &dyn Fn(&Vector3<f64>) -> Vector3<f64>,
    passes: &mut usize,
) -> Leg {
    let name = trajectory.label(first).to_owned();
    let transit = name == "TRANSIT";
    *passes += usize::from(!transit);
    let class = match (transit, *passes % 2) {
        (true, _) => "transit",
        (false, 1) => "forward",
        (false, _) => "backward",
    };
    let mut points = vec![unit(&first.start_mm)];
    let (mut length_mm, mut to_s) = (0.0, first.start_s);
    for block in blocks {
        if let Some(motion) = block.motion() {
            let pieces = (motion.length_mm() / 2.0).ceil().clamp(1.0, 400.0) as usize;
            points.extend((1..=pieces).map(|k| unit(&motion.at(k as f64 / pieces as f64).0)));
            length_mm += motion.length_mm();
        }
        to_s = block.start_s + block.duration_s;
    }
    Leg {
        name,
        line: first.line,
        start: fixed(first.start_s, 1),
        duration: fixed(to_s - first.start_s, 1),
        length: fixed(length_mm, 1),
        class,
        from_s: first.start_s,
        to_s,
        points: thinned(&points, VIEW_POINTS),
    }
}

/// One view.
fn view(legs: &[Leg], radial: &[Vec<Vector3<f64>>], seen: &Seen, told: &str) -> String {
    let mut drawing = Drawing::new(VIEW, VIEW);
    let centre = VIEW / 2.0;
    drawing.circle((centre, centre), RADIUS, "globe");
    let at = |v: &Vector3<f64>| {
        let (right, up, near) = seen(v);
        (centre + RADIUS * right, centre - RADIUS * up, near)
    };
    for (order, leg) in legs.iter().enumerate() {
        let lane = shifted(&leg.points.iter().map(at).collect::<Vec<_>>());
        // A piece as long as it stays on one side of the sphere.
        let mut start = 0;
        for k in 1..=lane.len() {
            if k == lane.len() || (lane[k].2 < -1e-9) != (lane[start].2 < -1e-9) {
                let piece: Vec<_> =
                    lane[start..(k + 1).min(lane.len())].iter().map(|p| (p.0, p.1)).collect();
                let far = if lane[start].2 < -1e-9 { " far" } else { "" };
                drawing.polyline(&piece, &format!("{}{far}", leg.class));
                start = k;
            }
        }
        // Not in the middle, where meridians cross, and not the same place for two passes.
        let place = lane.len() * (3 + order % 3) / 12;
        if let (Some(tail), Some(tip)) = (lane.get(place), lane.get(place + 1)) {
            let (dx, dy) = (tip.0 - tail.0, tip.1 - tail.1);
            let size = dx.hypot(dy);
            if size > 1e-6 {
                let (dx, dy) = (dx / size * 7.0, dy / size * 7.0);
                let head = [
                    (tail.0 + dx, tail.1 + dy),
                    (tail.0 - dy * 0.5, tail.1 + dx * 0.5),
                    (tail.0 + dy * 0.5, tail.1 - dx * 0.5),
                ];
                drawing.polygon(&head, leg.class);
                let beside = (tail.0 - dy * 1.7, tail.1 + dx * 1.7 + 4.0);
                drawing.text(beside, Anchor::Middle, "order", &(order + 1).to_string());
            }
        }
    }
    for path in radial {
        // The feed-in is a millimetre or two: drawn ten times as long to be seen.
        let stretched = |v: &Vector3<f64>| at(&(v * (1.0 + 10.0 * (v.norm() - 1.0)) / v.norm()));
        let points: Vec<_> = path.iter().map(stretched).map(|p| (p.0, p.1)).collect();
        drawing.polyline(&points, "radial");
    }
    drawing.finish(told)
}

/// A line shifted to the right of its direction.
fn shifted(points: &[(f64, f64, f64)]) -> Vec<(f64, f64, f64)> {
    (0..points.len())
        .map(|k| {
            let (from, to) = (points[k.saturating_sub(1)], points[(k + 1).min(points.len() - 1)]);
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            let size = dx.hypot(dy).max(1e-9);
            // On the screen y goes down: to the right of (dx, dy) is (-dy, dx).
            (points[k].0 - dy / size * LANE, points[k].1 + dx / size * LANE, points[k].2)
        })
        .collect()
}

fn speed(trajectory: &Trajectory, legs: &[Leg]) -> String {
    let end_s = trajectory.end_s();
    let mut points = Vec::new();
    for block in trajectory.blocks() {
        let inside = |share: f64| {
            let time_s = block.start_s + share * block.duration_s;
            (time_s, trajectory.at(time_s).velocity_mm_s.norm() * 60.0)
        };
        points.extend([0.001, 0.25, 0.5, 0.75, 0.999].map(inside));
    }
    let feeds = trajectory.blocks().iter().filter(|block| block.kind == BlockKind::Feed);
    let fastest = feeds
        .filter_map(|block| block.motion().map(|motion| motion.feed_mm_s * 60.0))
        .fold(1.0, f64::max);
    let mut chart = Chart::new(
        1000.0,
        230.0,
        Axis::new("time, s", (0.0, end_s)),
        Axis::new("speed, mm/min", (0.0, fastest * 1.15)),
    );
    for leg in legs {
        chart.shade(leg.from_s, leg.to_s, &format!("shade {}", leg.class));
    }
    for block in trajectory.blocks().iter().filter(|block| block.kind == BlockKind::Stop) {
        chart.upright(block.start_s, "stop");
    }
    chart.line(&envelope(&points, SPEED_POINTS), "speed");
    chart.finish("speed over time")
}
