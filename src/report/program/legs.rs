//! What a program drives on the sphere, leg by leg.

use nalgebra::Vector3;

use crate::motion::{Block, Trajectory};
use crate::nc::Sphere;
use crate::plan::OVERSHOOT;
use crate::report::draw::svg::thinned;
use crate::report::text::numbers::fixed;

/// Points of a leg in a view.
const VIEW_POINTS: usize = 120;

/// A stretch on the sphere without a pause, under one comment.
pub(super) struct Leg {
    pub(super) name: String,
    pub(super) line: usize,
    pub(super) start: String,
    pub(super) duration: String,
    pub(super) length: String,
    pub(super) class: &'static str,
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    /// Unit vectors from the workpiece ball, the length of the bar being 1.
    pub(super) points: Vec<Vector3<f64>>,
}

/// What is driven on the sphere, and the moves at feed that lead to it and away.
pub(super) fn legs(trajectory: &Trajectory, sphere: &Sphere) -> (Vec<Leg>, Vec<Vec<Vector3<f64>>>) {
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
    // What is driven beyond an arc is drawn as the ways are.
    let beside = name == "TRANSIT" || name.ends_with(OVERSHOOT);
    *passes += usize::from(!beside);
    let class = match (beside, *passes % 2) {
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
