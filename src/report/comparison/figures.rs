//! Differences with their uncertainties, a line a quantity.

use crate::monitor::{Change, Judged};
use crate::report::draw::svg::{Anchor, Drawing, text_width};
use crate::report::draw::ticks::{symmetric, ticks};
use crate::report::text::numbers::{fixed, typeset};

const WIDTH: f64 = 760.0;
const ROW: f64 = 20.0;
const TOP: f64 = 8.0;
const BOTTOM: f64 = 40.0;
/// By how much bold letters are wider.
const BOLD: f64 = 1.12;
/// A bar reaches so many standard deviations either way.
const SIGMAS: f64 = 2.0;

/// Differences of one unit about zero; a bar reaches over two standard deviations on either side.
pub(super) fn differences(changes: &[&Change], unit: &str) -> String {
    let names = changes.iter().map(|change| BOLD * text_width(&change.name));
    let left = names.fold(60.0, f64::max) + 14.0;
    let reach = |change: &&Change| change.difference().abs() + SIGMAS * change.sigma.unwrap_or(0.0);
    let most = symmetric(changes.iter().map(reach));
    let height = TOP + ROW * changes.len() as f64 + BOTTOM;
    let (right, bottom) = (WIDTH - 16.0, height - BOTTOM);
    let at = |value: f64| left + (0.5 + 0.5 * (value / most).clamp(-1.0, 1.0)) * (right - left);
    let mut drawing = Drawing::new(WIDTH, height);
    drawing.rectangle((left, TOP), right - left, bottom - TOP, "field");
    let scale = ticks(-most, most, 8);
    for value in &scale.values {
        let class = if value.abs() < 1e-12 { "zero" } else { "grid" };
        drawing.line((at(*value), TOP), (at(*value), bottom), class);
        let label = typeset(&fixed(*value, scale.decimals));
        drawing.text((at(*value), bottom + 14.0), Anchor::Middle, "tick", &label);
    }
    for (row, change) in changes.iter().enumerate() {
        let y = TOP + ROW * (row as f64 + 0.5);
        let (value, sigma) = (change.difference(), change.sigma.unwrap_or(0.0));
        let strong = if change.judged == Judged::Changed { "tick strong" } else { "tick" };
        drawing.text((left - 7.0, y + 3.5), Anchor::End, strong, &change.name);
        let half = SIGMAS * sigma;
        drawing.line((at(value - half), y), (at(value + half), y), "error");
        for end in [value - half, value + half] {
            drawing.line((at(end), y - 4.0), (at(end), y + 4.0), "error");
        }
        let class = if change.judged == Judged::Changed { "reading" } else { "found" };
        drawing.dots(std::iter::once((at(value), y)), class);
    }
    let label = format!("after minus before, {unit}");
    drawing.text((0.5 * (left + right), height - 8.0), Anchor::Middle, "axis", &label);
    drawing.finish(&format!("differences in {unit}"))
}
