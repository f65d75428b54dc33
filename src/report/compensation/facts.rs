//! A compensation for other programs.

use serde_json::{Value, json};

use super::Compensated;
use crate::compensate::{OnePoint, Sizes};

/// All of it as JSON.
pub fn compensation_json(told: &Compensated) -> Value {
    let of = told.of;
    let sizes = |of: &Sizes| json!({ "rms_um": um(of.rms_mm), "largest_um": um(of.largest_mm) });
    let groups = of.left.groups.iter().map(|group| {
        json!({ "name": group.name, "before_rms_um": um(group.before_mm), "after_rms_um": um(group.after_mm) })
    });
    let point = |of: &OnePoint| {
        json!({
            "slide": of.over.to_string(),
            "along": of.along.to_string(),
            "from_mm": of.from_mm,
            "to_mm": of.to_mm,
            "off_um": um(of.off_mm),
            "left_um": um(of.left_mm),
            "left_if_signs_are_wrong_um": um(of.wrong_mm),
        })
    };
    json!({
        "test": told.test,
        "machine": told.machine,
        "analysis": told.file,
        "control": of.asked.control.name(),
        "files": of.written.files.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        "tool_mm": <[f64; 3]>::from(of.asked.tool_ball_mm),
        "place_mm": <[f64; 3]>::from(of.asked.place_mm),
        "active_when_measured": told.active,
        "holds_what_was_active": !of.asked.existing.is_empty(),
        "directions_shrunk": told.shrunk.directions,
        "directions": told.shrunk.of,
        "volumetric_before_shrinking_um": um(told.shrunk_mm[0]),
        "volumetric_um": um(told.shrunk_mm[1]),
        "unknown_noise_um": um(told.unknown.noise),
        "unknown_all_um": um(told.unknown.all),
        "repeats_over_noise": told.changed,
        "before": sizes(&of.left.before),
        "after": sizes(&of.left.after),
        "largest_correction_um": um(of.left.taken_mm),
        "groups": groups.collect::<Vec<_>>(),
        "one_point": of.points.iter().map(point).collect::<Vec<_>>(),
        "found": told.found.iter().map(|(title, mm)| json!({ "title": title, "residual_rms_um": um(*mm) })).collect::<Vec<_>>(),
        "lost": of.written.lost,
        "not_certain": of.written.unsure,
        "load": of.written.load,
    })
}

fn um(mm: f64) -> f64 {
    1e3 * mm + 0.0
}
