//! The path on the sphere seen from two sides, and the speed over time.

use nalgebra::Vector3;

use super::legs::Leg;
use crate::motion::{BlockKind, Trajectory};
use crate::report::draw::chart::{Axis, Chart};
use crate::report::draw::svg::{Anchor, Drawing, envelope};

/// Size of a view, pixels, and the radius of the sphere in it.
const VIEW: f64 = 460.0;
const RADIUS: f64 = 185.0;
/// How far a line is shifted to the right of its direction, pixels.
const LANE: f64 = 3.0;
/// Points of the speed.
const SPEED_POINTS: usize = 2400;

/// How a unit vector is seen: right, up, and towards the eye.
type Projection = dyn Fn(&Vector3<f64>) -> (f64, f64, f64);

/// One view.
pub(super) fn view(
    legs: &[Leg],
    radial: &[Vec<Vector3<f64>>],
    seen: &Projection,
    told: &str,
) -> String {
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

/// The speed over the time of the program.
pub(super) fn speed(trajectory: &Trajectory, legs: &[Leg]) -> String {
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
