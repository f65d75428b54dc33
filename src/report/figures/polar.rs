//! Polar plots of every circle, forward and backward, measured and predicted (paper, Figures 4 and 5).

use super::Figure;
use crate::align::Circle;
use crate::report::svg::thinned;
use crate::report::svg_polar::{Magnification, Polar};
use crate::report::traces::{OnCircle, Trace};

/// Points of a curve of the first repeat, and of the others, which are drawn faintly.
const POINTS: usize = 500;
const FAINT_POINTS: usize = 180;

/// One polar plot a circle, all at one magnification, and that magnification in words.
pub(in crate::report) fn polar(circles: &[OnCircle], length_mm: f64) -> (Vec<Figure>, String) {
    let values = || {
        circles
            .iter()
            .flat_map(|circle| &circle.traces)
            .flat_map(|trace| trace.measured_um.iter().chain(&trace.predicted_um))
            .copied()
    };
    let scale = Magnification::for_deviations(
        values().fold(0.0, f64::min),
        values().fold(0.0, f64::max),
        length_mm,
    );
    // A whole circle is as high as two halves.
    let halves = circles.iter().filter(|circle| !circle.whole()).count();
    let figures = circles
        .iter()
        .map(|circle| Figure {
            svg: figure(circle, scale),
            caption: String::new(),
            tall: halves > 1 && circle.whole(),
        })
        .collect();
    (figures, scale.sentence())
}

fn figure(circle: &OnCircle, scale: Magnification) -> String {
    let name = circle.circle.name();
    let spokes = match circle.circle {
        Circle::Equator => ["+X", "+Y", "−X", "−Y"],
        Circle::Meridian { .. } => ["", "pole +Z", "", "−Z"],
        Circle::Other { .. } => ["", "", "", ""],
    };
    let mut polar = Polar::new(circle.whole(), scale, &name, spokes);
    // Faint ones first, so that the first repeat lies on top.
    for trace in circle.traces.iter().filter(|trace| trace.repeat > 0) {
        draw(&mut polar, trace, false, FAINT_POINTS, "faint");
    }
    for trace in circle.traces.iter().filter(|trace| trace.repeat == 0) {
        draw(&mut polar, trace, false, POINTS, "measured");
    }
    for trace in circle.traces.iter().filter(|trace| trace.repeat == 0) {
        draw(&mut polar, trace, true, POINTS, "predicted");
    }
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
