//! Polar plots of every circle, forward and backward, measured and predicted (paper, Figures 4 and 5).

use super::figure::Figure;
use crate::align::Circle;
use crate::plan::Plane;
use crate::report::analysis::traces::{OnCircle, Trace};
use crate::report::draw::polar::{Magnification, Polar};
use crate::report::draw::svg::thinned;

/// Points of a curve of the first repeat, and of the others, which are drawn faintly.
const POINTS: usize = 500;
const FAINT_POINTS: usize = 180;

/// One polar plot a circle, a group a mounting, all at one magnification, and that in words. What was predicted `before`
/// anything was found is grey.
pub(in crate::report) fn polar(
    circles: &[OnCircle],
    before: &[OnCircle],
) -> (Vec<Vec<Figure>>, String) {
    let values = || {
        circles
            .iter()
            .flat_map(|circle| &circle.traces)
            .flat_map(|trace| trace.measured_um.iter().chain(&trace.predicted_um))
            .copied()
    };
    // Bars of other lengths are drawn at the same micrometres a division, so that plots can be compared.
    let lengths_mm = || circles.iter().map(|circle| circle.nominal_mm);
    let longest_mm = lengths_mm().reduce(f64::max).unwrap_or(1.0);
    let scale = Magnification::for_deviations(
        values().fold(0.0, f64::min),
        values().fold(0.0, f64::max),
        longest_mm,
    );
    let alike = lengths_mm().all(|length_mm| length_mm >= longest_mm);
    let of_mounting = |circles: &[OnCircle]| -> Vec<Figure> {
        // A whole circle is as high as two halves.
        let halves = circles.iter().filter(|circle| !circle.whole()).count();
        let plot = |circle: &OnCircle| Figure {
            svg: figure(circle, before.iter().find(|before| before.is_same(circle)), scale),
            caption: String::new(),
            tall: halves > 1 && circle.whole(),
        };
        circles.iter().map(plot).collect()
    };
    let groups = circles.chunk_by(|a, b| a.mounting == b.mounting);
    let figures = groups.map(of_mounting).collect();
    (figures, scale.sentence(alike))
}

fn figure(circle: &OnCircle, before: Option<&OnCircle>, scale: Magnification) -> String {
    let name = &circle.name;
    let spokes = match circle.circle {
        Circle::Equator | Circle::Plane(Plane::Xy) => ["+X", "+Y", "−X", "−Y"],
        Circle::Meridian { .. } => ["", "pole +Z", "", "−Z"],
        Circle::Plane(Plane::Yz) => ["+Y", "+Z", "−Y", "−Z"],
        Circle::Plane(Plane::Zx) => ["+Z", "+X", "−Z", "−X"],
        Circle::Other { .. } => ["", "", "", ""],
    };
    let mut polar = Polar::new(circle.whole(), scale, name, spokes);
    polar.begin_curves(circle.number);
    // Faint ones first, so that the first repeat lies on top.
    for trace in circle.traces.iter().filter(|trace| trace.repeat > 0) {
        draw(&mut polar, trace, false, FAINT_POINTS, "faint");
    }
    for trace in circle.traces.iter().filter(|trace| trace.repeat == 0) {
        draw(&mut polar, trace, false, POINTS, "measured");
    }
    for trace in before.iter().flat_map(|of| &of.traces).filter(|trace| trace.repeat == 0) {
        draw(&mut polar, trace, true, POINTS, "before");
    }
    for trace in circle.traces.iter().filter(|trace| trace.repeat == 0) {
        draw(&mut polar, trace, true, POINTS, "predicted");
    }
    polar.end_curves();
    polar.finish(&format!("{name}: measured and predicted deviation, polar"))
}

fn draw(polar: &mut Polar, trace: &Trace, predicted: bool, most: usize, class: &str) {
    let class = format!("{class} {}", direction(trace.forward));
    for piece in trace.pieces(predicted) {
        polar.curve(&thinned(&piece, most), &class);
    }
}

/// Class of a direction of motion.
pub(super) fn direction(forward: bool) -> &'static str {
    if forward { "forward" } else { "backward" }
}
