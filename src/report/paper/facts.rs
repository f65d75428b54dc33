//! The comparison with the paper as JSON.

use serde_json::{Value, json};

use crate::identify::Seen;
use crate::paper::{Comparison, Nearest, Row, StrategyRows};

/// For another program.
pub fn paper_json(paper: &Comparison, nearest: Option<&Nearest>) -> Value {
    let seen = |seen: &Seen| {
        let full = seen.rank == seen.columns;
        json!({
            "rank": seen.rank,
            "condition": seen.condition,
            "raw_condition": full.then_some(seen.raw_condition),
        })
    };
    let row = |row: &Row| {
        json!({
            "columns": row.stage.columns,
            "removed": row.stage.removed().collect::<Vec<_>>(),
            "paper": {
                "rank": row.paper_rank,
                "condition": row.paper_condition,
                "raw_condition": row.paper_raw_condition,
            },
            "carriage": seen(&row.carriage),
            "base": seen(&row.base),
            "verdict": row.verdict,
        })
    };
    let strategy = |rows: &StrategyRows| {
        json!({
            "strategy": rows.strategy.name(),
            "stages": rows.rows.iter().map(row).collect::<Vec<_>>(),
            "confounded": { "carriage": rows.carriage, "base": rows.base },
            "rank_with_x_and_z_on_base": rows.x_and_z_base,
        })
    };
    let at = &paper.geometry;
    json!({
        "format": "ballbar.paper/1",
        "geometry": {
            "coincidence_mm": at.coincidence_mm,
            "tool_length_mm": at.tool_length_mm,
            "ball_bar_mm": at.bar_mm,
            "meridian_deg": at.meridian_deg,
        },
        "volume": paper.volume.iter().map(row).collect::<Vec<_>>(),
        "strategies": paper.strategies.iter().map(strategy).collect::<Vec<_>>(),
        "mountings": paper.mountings.iter().map(|row| json!({
            "what": row.what, "of_53": row.of_53, "of_90": row.of_90,
        })).collect::<Vec<_>>(),
        "times": paper.times.iter().map(|time| json!({
            "what": time.what,
            "arcs_s": time.arcs_s,
            "transits_s": time.transits_s,
            "feed_in_s": time.feed_in_s,
            "dwells_s": time.dwells_s,
            "total_s": time.total_s(),
            "overshoot_to_37_min_deg": time.overshoot_deg(),
            "longer_pauses_to_37_min_s": time.longer_pauses_s(),
            "readings_on_arcs_per_s": time.readings_on_arcs_per_s(),
        })).collect::<Vec<_>>(),
        "nearest": nearest.map(|nearest| json!({
            "volume": {
                "range_mm": nearest.volume.range_mm,
                "tool_length_mm": nearest.volume.tool_length_mm,
                "conditions": nearest.volume.conditions,
                "worst_factor": nearest.volume.worst_factor,
            },
            "bar": nearest.bar.iter().map(|found| json!({
                "coincidence_mm": found.geometry.coincidence_mm,
                "tool_length_mm": found.geometry.tool_length_mm,
                "meridian_deg": found.geometry.meridian_deg,
                "conditions": found.conditions,
                "worst_factor": found.worst_factor,
            })).collect::<Vec<_>>(),
        })),
    })
}
