//! What the paper's tables say and ours beside it, cell by cell.

use crate::identify::Seen;
use crate::paper::{Comparison, Nearest, Row, StrategyRows};

/// Rounded to three significant digits, in powers of ten where it is large.
fn rounded(value: f64) -> String {
    match value {
        _ if !value.is_finite() => "-".to_owned(),
        _ if value < 1e5 => {
            let decimals = (2 - value.log10().floor() as i32).max(0);
            let unit = 10_f64.powi(2 - value.log10().floor() as i32);
            format!("{:.*}", decimals as usize, (value * unit).round() / unit)
        }
        _ => format!("{value:.1e}"),
    }
}

/// With a mark where directions had to be left out.
fn condition(seen: &Seen) -> String {
    format!("{}{}", rounded(seen.condition), if seen.rank < seen.columns { "*" } else { "" })
}

/// Columns as they are: only with the full rank is it more than rounding.
fn raw(seen: &Seen) -> String {
    if seen.rank == seen.columns { rounded(seen.raw_condition) } else { "-".to_owned() }
}

pub(super) const HEAD: [&str; 10] = [
    "columns",
    "rank paper",
    "carriage",
    "base",
    "cond. paper",
    "carriage",
    "base",
    "raw paper",
    "base",
    "verdict",
];

pub(super) fn cells(row: &Row) -> [String; 10] {
    [
        row.stage.columns.to_string(),
        row.paper_rank.map_or("-".to_owned(), |rank| rank.to_string()),
        row.carriage.rank.to_string(),
        row.base.rank.to_string(),
        row.paper_condition.map_or("-".to_owned(), |printed| printed.to_string()),
        condition(&row.carriage),
        condition(&row.base),
        row.paper_raw_condition.map_or("-".to_owned(), |printed| format!("{printed:e}")),
        raw(&row.base),
        row.verdict.clone(),
    ]
}

pub(super) fn title(rows: &StrategyRows) -> String {
    rows.strategy.name().to_uppercase()
}

pub(super) fn geometry(paper: &Comparison) -> String {
    let at = &paper.geometry;
    let [x, y, z] = at.coincidence_mm;
    format!(
        "Mitsui Seiki HU40-T, wCBXFZYSt; balls coincide at X{x} Y{y} Z{z}, tool ball {} mm below its slide, bar {} mm,\nmeridians over {} deg",
        at.tool_length_mm, at.bar_mm, at.meridian_deg
    )
}

/// What a search has found, a line a place.
pub(super) fn nearest_lines(nearest: &Nearest) -> Vec<String> {
    let volume = &nearest.volume;
    let [x, y, z] = volume.range_mm.map(|[low, high]| format!("{low} to {high}"));
    let [a, b] = volume.conditions.map(rounded);
    let mut lines = vec![format!(
        "volume: X {x}, Y {y}, Z {z} mm, tool {} mm: {a} and {b} (paper 387 and 108), {:.0} % off at most",
        volume.tool_length_mm,
        (volume.worst_factor - 1.0) * 100.0
    )];
    for found in &nearest.bar {
        let at = &found.geometry;
        let [x, y, z] = at.coincidence_mm;
        let [c2, c5, c6, c10] = found.conditions.map(rounded);
        lines.push(format!(
            "meridians over {} deg: balls coincide at X{x} Y{y} Z{z}, tool {} mm: 2D {c2}, 3D5 {c5}, 3D6 {c6}, 3D10 {c10} (paper 2801, 1950, 1948, 1948), {:.0} % off at most",
            at.meridian_deg,
            at.tool_length_mm,
            (found.worst_factor - 1.0) * 100.0
        ));
    }
    lines
}
