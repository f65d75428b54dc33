//! A map as JSON and as CSV; the schema is documented field by field in `docs/volume-schema.md`.

use std::fmt::Write as _;

use nalgebra::Vector3;
use serde_json::{Value, json};

use super::{Mapped, words};
use crate::compensate::{Figure, Figures, Line, Measured, Sigmas};
use crate::report::text::numbers::fixed;

/// All but the points of the map, which are the CSV, without the name of the format.
pub fn volume_json(of: &Mapped) -> Value {
    let map = &of.map;
    let near = map.nodes.iter().filter(|node| node.near).count();
    json!({
        "test": of.test,
        "source": of.file,
        "machine": of.errors.machine.name(),
        "topology": of.errors.machine.topology().as_str(),
        "compensation": of.compensation,
        "tool_ball_mm": place(&of.tool_ball_mm),
        "box_mm": ends(&map.volume.ends_mm),
        "measured_mm": ends(&Measured::by(of.errors).range_mm()),
        "points": map.counts,
        "points_near": near,
        "rigid_motion": if map.volume.keep_rigid { "kept" } else { "taken off" },
        "verdict": words::verdict(of),
        "near": map.near.as_ref().map(figures),
        "whole": map.whole.as_ref().map(figures),
        "lines": map.lines.iter().map(line).collect::<Vec<_>>(),
    })
}

fn place(of: &Vector3<f64>) -> [f64; 3] {
    (*of).into()
}

fn ends(of: &[Vector3<f64>; 2]) -> Value {
    json!({ "low": place(&of[0]), "high": place(&of[1]) })
}

fn figure(of: &Figure) -> Value {
    let Sigmas { noise, all } = of.sigmas;
    json!({ "value_um": of.value_mm * 1e3, "noise_um": noise * 1e3, "all_um": all * 1e3 })
}

fn figures(of: &Figures) -> Value {
    let [x, y, z] = &of.ranges;
    json!({
        "poses": of.poses,
        "largest": figure(&of.largest),
        "largest_at_mm": place(&of.largest_at_mm),
        "not_beyond_95_percent": figure(&of.most),
        "rms": figure(&of.rms),
        "unknown_noise_um": of.unknown.noise * 1e3,
        "unknown_all_um": of.unknown.all * 1e3,
        "range_x": figure(x),
        "range_y": figure(y),
        "range_z": figure(z),
    })
}

fn line(of: &Line) -> Value {
    let [e, forward, backward, mean, reversal] = &of.figures;
    let points = of.points.iter().map(|point| {
        json!({
            "at_mm": point.at_mm,
            "forward": figure(&point.forward),
            "backward": figure(&point.backward),
            "near": point.near,
        })
    });
    json!({
        "line": of.name,
        "from_mm": place(&of.ends_mm[0]),
        "to_mm": place(&of.ends_mm[1]),
        "systematic": figure(e),
        "systematic_forward": figure(forward),
        "systematic_backward": figure(backward),
        "mean_range": figure(mean),
        "reversal": figure(reversal),
        "points": points.collect::<Vec<_>>(),
    })
}

/// Columns of the map.
const HEAD: &str = "x_mm,y_mm,z_mm,ex_um,ey_um,ez_um,size_um,ex_noise_um,ey_noise_um,ez_noise_um,\
ex_all_um,ey_all_um,ez_all_um,measured_near\n";

/// The points of the map: displacement of the tool against the workpiece, mean of both senses.
pub fn volume_csv(of: &Mapped) -> String {
    let mut text = HEAD.to_owned();
    let um = |mm: f64| fixed(mm * 1e3, 4);
    for node in &of.map.nodes {
        let [x, y, z] = place(&node.position_mm).map(|mm| fixed(mm, 4));
        let errors = node.error.map(|of| um(of.value_mm)).join(",");
        let size = um(node.size.value_mm);
        let noise = node.error.map(|of| um(of.sigmas.noise)).join(",");
        let all = node.error.map(|of| um(of.sigmas.all)).join(",");
        let near = u8::from(node.near);
        let _ = writeln!(text, "{x},{y},{z},{errors},{size},{noise},{all},{near}");
    }
    text
}
