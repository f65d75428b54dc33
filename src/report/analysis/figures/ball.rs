//! What is left, on the sphere: where on it the model is wrong, and by how much.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::figure::Figure;
use crate::report::analysis::traces::OnCircle;
use crate::report::draw::svg::Drawing;
use crate::report::draw::ticks::round_up;
use crate::report::text::numbers::{fixed, many};

/// Size of the drawing and radius of the sphere, pixels.
const SIZE: f64 = 440.0;
const RADIUS: f64 = 195.0;
/// Seen from here: azimuth and height above the equator, degrees. The script begins with the same.
const AZIMUTH_DEG: f64 = -60.0;
const HEIGHT_DEG: f64 = 30.0;
/// Readings of all runs within so many degrees of a circle, driven one way, are one dot: what repeats is not hidden by noise.
const STRETCH_DEG: f64 = 2.0;
/// The way back is drawn so much deeper, as a share of the radius: it runs beside the way there.
const DEEPER: f64 = 0.97;
/// Shades on either side of "about nothing".
const SHADES: f64 = 2.0;

/// What is left of the readings on all circles; none of a single circle, which its own chart shows better.
pub(in crate::report) fn left_over(circles: &[OnCircle]) -> Option<Figure> {
    if circles.len() < 2 {
        return None;
    }
    let mut dots: Vec<(Vector3<f64>, f64)> = Vec::new();
    for circle in circles {
        let [u, v] = circle.circle.directions();
        for forward in [true, false] {
            let mut sums: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
            for trace in circle.traces.iter().filter(|trace| trace.forward == forward) {
                let left = trace.measured_um.iter().zip(&trace.predicted_um).map(|(m, p)| m - p);
                for (angle_rad, left_um) in trace.angle_rad.iter().zip(left) {
                    let stretch = angle_rad.to_degrees().rem_euclid(360.0) / STRETCH_DEG;
                    let sum = sums.entry(stretch.floor() as i64).or_default();
                    *sum = (sum.0 + 1.0, sum.1 + left_um);
                }
            }
            let radius = if forward { 1.0 } else { DEEPER };
            dots.extend(sums.into_iter().map(|(stretch, (count, left_um))| {
                let angle_rad = ((stretch as f64 + 0.5) * STRETCH_DEG).to_radians();
                ((u * angle_rad.cos() + v * angle_rad.sin()) * radius, left_um / count)
            }));
        }
    }
    if dots.is_empty() {
        return None;
    }
    let rms = (dots.iter().map(|dot| dot.1.powi(2)).sum::<f64>() / dots.len() as f64).sqrt();
    let limit_um = round_up((2.0 * rms).max(1e-3));
    let mut drawing = Drawing::new(SIZE, SIZE);
    let middle = 0.5 * SIZE;
    drawing.attribute("sphere", &format!("{middle} {middle} {RADIUS} {limit_um}"));
    drawing.circle((middle, middle), RADIUS, "globe");
    drawing.begin("curves");
    let (sine, cosine) = AZIMUTH_DEG.to_radians().sin_cos();
    let (up, level) = HEIGHT_DEG.to_radians().sin_cos();
    let seen = |at: &Vector3<f64>| {
        let depth = at.x * cosine + at.y * sine;
        let right = at.y * cosine - at.x * sine;
        let place = (middle + RADIUS * right, middle - RADIUS * (at.z * level - depth * up));
        (place, depth * level + at.z * up >= 0.0)
    };
    for near in [false, true] {
        // The grey ones first, the dark ones last.
        for shade in [2, 1, 3, 0, 4] {
            let of_it = dots.iter().filter(|(_, left)| self::shade(*left / limit_um) == shade);
            let places = of_it.map(|(at, _)| seen(at)).filter(|seen| seen.1 == near);
            let side = if near { "near" } else { "far" };
            drawing.dots(places.map(|seen| seen.0), &format!("{side} left{shade}"));
        }
    }
    drawing.end();
    let bounds =
        [0.25, 0.75].map(|share| fixed(share * limit_um, if limit_um < 1.0 { 3 } else { 2 }));
    Some(Figure {
        svg: drawing.finish("what is left of the readings, on the sphere"),
        caption: format!(
            "Readings minus prediction on {}, mean of all runs over 2\u{b0}, the way back inside of the way there, seen from azimuth \u{2212}60\u{b0}, 30\u{b0} above the equator, the far side pale. Grey: less than {} µm. Orange: longer, blue: shorter than predicted, dark from {} µm. Arcs of one colour are an error of the machine that the model lacks.",
            many(circles.len(), "circle"),
            bounds[0],
            bounds[1]
        ),
        tall: false,
    })
}

/// Which shade a value has that is told as a share of the limit.
fn shade(share: f64) -> i32 {
    ((SHADES * share).round().clamp(-SHADES, SHADES) + SHADES) as i32
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::report::analysis::traces;
    use crate::report::fixture;

    #[test]
    fn shades_are_symmetric() {
        let shades = [-9.0, -0.8, -0.3, -0.2, 0.0, 0.2, 0.3, 0.8, 9.0].map(shade);
        assert_eq!(shades, [0, 0, 1, 2, 2, 2, 3, 4, 4]);
    }

    #[test]
    fn several_circles_make_a_sphere() {
        let fixture = fixture::identified("hu40t");
        let circles = traces::circles(&fixture.analysis, &fixture.identifications);
        let svg = left_over(&circles).unwrap().svg;
        for shade in ["left0", "left2", "left4"] {
            for side in ["near", "far"] {
                assert!(svg.contains(&format!("dots {side} {shade}")), "{side} {shade}");
            }
        }
        assert!(left_over(&circles[..1]).is_none());
    }
}
