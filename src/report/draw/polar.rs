//! A polar chart: deviations from a circle, magnified along the radius.

use super::svg::{Anchor, Drawing, text_width};
use super::ticks::{round_down, round_up};
use crate::report::text::numbers::{fixed, signed, typeset};

/// Radius of the nominal circle, pixels.
const NOMINAL: f64 = 108.0;
/// How far outwards and inwards a deviation may reach, as a share of the nominal radius.
const OUTWARDS: f64 = 0.6;
const INWARDS: f64 = 0.72;
/// Rings are at least so far apart, pixels.
const DIVISION: f64 = 10.0;

/// How deviations are magnified.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::report) struct Magnification {
    /// How many times larger a deviation is drawn than the bar's length.
    pub(in crate::report) times: f64,
    /// From ring to ring, um.
    pub(in crate::report) division_um: f64,
    pixels_per_um: f64,
}

impl Magnification {
    /// The largest of the series 1, 2, 5 with which all deviations between two limits fit.
    pub(in crate::report) fn for_deviations(low_um: f64, high_um: f64, length_mm: f64) -> Self {
        let outwards = (high_um.max(0.0) * 1e-3 / length_mm) / OUTWARDS;
        let inwards = (-low_um.min(0.0) * 1e-3 / length_mm) / INWARDS;
        // Nothing to show is shown at the magnification of a hundredth of a micrometre.
        let times = round_down(1.0 / outwards.max(inwards).max(1e-5 / length_mm));
        let pixels_per_um = times * NOMINAL / (length_mm * 1e3);
        Self { times, division_um: round_up(DIVISION / pixels_per_um), pixels_per_um }
    }

    /// In words, for a caption; `alike` where all bars have the length that it was made for.
    pub(in crate::report) fn sentence(&self, alike: bool) -> String {
        let decimals = if self.division_um < 0.1 { 2 } else { usize::from(self.division_um < 1.0) };
        let division = format!("{} µm per division", fixed(self.division_um, decimals));
        if !alike {
            return division;
        }
        let times = crate::report::text::numbers::count(self.times.round() as usize);
        format!("deviations magnified {times} times, {division}")
    }
}

/// A polar chart that is being drawn; angles counter-clockwise from the right.
#[derive(Debug)]
pub(in crate::report) struct Polar {
    drawing: Drawing,
    centre: (f64, f64),
    scale: Magnification,
}

impl Polar {
    /// Rings, spokes and labels; `whole` for a full circle, otherwise the upper half. `spokes` names
    /// the directions at 0, 90, 180 and 270 degrees.
    pub(in crate::report) fn new(
        whole: bool,
        scale: Magnification,
        title: &str,
        spokes: [&str; 4],
    ) -> Self {
        let outer = NOMINAL * (1.0 + OUTWARDS);
        let width = 2.0 * outer + 64.0;
        let top = 46.0;
        let centre = (0.5 * width, top + outer);
        let height = if whole { top + 2.0 * outer + 26.0 } else { top + outer + 34.0 };
        let mut polar = Self { drawing: Drawing::new(width, height), centre, scale };
        polar.drawing.text((8.0, 16.0), Anchor::Start, "title", title);
        polar.grid(whole, outer, spokes);
        polar
    }

    fn grid(&mut self, whole: bool, outer: f64, spokes: [&str; 4]) {
        let division = self.scale.division_um * self.scale.pixels_per_um;
        let (inside, outside) =
            ((INWARDS * NOMINAL / division) as i32, (OUTWARDS * NOMINAL / division) as i32);
        for k in -inside..=outside {
            let radius = NOMINAL + f64::from(k) * division;
            self.arc(radius, whole, if k == 0 { "nominal" } else { "ring" });
        }
        let (first, last) = (NOMINAL - f64::from(inside) * division, outer);
        for k in 0..if whole { 12 } else { 7 } {
            let angle = f64::from(k * 30).to_radians();
            self.drawing.line(
                self.place(angle, first),
                self.place(angle, last),
                if k % 3 == 0 { "spoke strong" } else { "spoke" },
            );
            let at = self.place(angle, outer + 12.0);
            let (anchor, down) = match k * 30 {
                0 => (Anchor::Start, -2.0),
                180 => (Anchor::End, -2.0),
                90 => (Anchor::Middle, 0.0),
                270 => (Anchor::Middle, 8.0),
                angle if !(90..270).contains(&angle) => (Anchor::Start, 4.0),
                _ => (Anchor::End, 4.0),
            };
            let back = match k * 30 {
                0 => -9.0,
                180 => 9.0,
                _ => 0.0,
            };
            let degrees = format!("{}°", k * 30);
            let name = if k % 3 == 0 { spokes[k as usize / 3] } else { "" };
            if k % 3 == 0 && matches!(k, 0 | 6) {
                // Two short lines beside the field: there is no room for a long one.
                self.drawing.text((at.0 + back, at.1 + down), anchor, "tick", &degrees);
                self.drawing.text((at.0 + back, at.1 + down - 12.0), anchor, "tick strong", name);
            } else {
                let text = if name.is_empty() { degrees } else { format!("{degrees} {name}") };
                self.drawing.text((at.0, at.1 + down), anchor, "tick", &text);
            }
        }
        self.ring_labels(inside, outside, division);
    }

    /// Numbers of the rings below the spoke to the right.
    fn ring_labels(&mut self, inside: i32, outside: i32, division: f64) {
        let decimals = if self.scale.division_um < 0.1 {
            2
        } else {
            usize::from(self.scale.division_um < 1.0)
        };
        let text = |k: i32| typeset(&signed(f64::from(k) * self.scale.division_um, decimals));
        let widest = (-inside..=outside).map(|k| text_width(&text(k))).fold(0.0, f64::max);
        let every = ((widest + 4.0) / division).ceil().max(1.0) as i32;
        let labels: Vec<(f64, String)> = (-inside..=outside)
            .filter(|k| k % every == 0)
            .map(|k| (NOMINAL + f64::from(k) * division, text(k)))
            .collect();
        for (radius, label) in labels {
            let at = (self.centre.0 + radius, self.centre.1 + 12.0);
            self.drawing.text(at, Anchor::Middle, "halo", &label);
        }
        let at = (self.centre.0 + NOMINAL * (1.0 + OUTWARDS) + 12.0, self.centre.1 + 12.0);
        self.drawing.text(at, Anchor::Start, "tick", "µm");
    }

    fn arc(&mut self, radius: f64, whole: bool, class: &str) {
        if whole {
            self.drawing.circle(self.centre, radius, class);
            return;
        }
        let points: Vec<(f64, f64)> =
            (0..=90).map(|k| self.place(f64::from(2 * k).to_radians(), radius)).collect();
        self.drawing.polyline(&points, class);
    }

    fn place(&self, angle_rad: f64, radius: f64) -> (f64, f64) {
        (self.centre.0 + radius * angle_rad.cos(), self.centre.1 - radius * angle_rad.sin())
    }

    /// Begins the curves, and says to a script where they are and of which circle.
    pub(in crate::report) fn begin_curves(&mut self, circle: usize) {
        let (x, y) = self.centre;
        self.drawing.attribute("circle", &circle.to_string());
        let place =
            format!("{} {} {NOMINAL} {}", fixed(x, 1), fixed(y, 1), self.scale.pixels_per_um);
        self.drawing.attribute("place", &place);
        self.drawing.begin("curves");
    }

    /// Ends them.
    pub(in crate::report) fn end_curves(&mut self) {
        self.drawing.end();
    }

    /// A curve of angle (rad) and deviation (um).
    pub(in crate::report) fn curve(&mut self, points: &[(f64, f64)], class: &str) {
        let points: Vec<(f64, f64)> = points
            .iter()
            .map(|(angle_rad, deviation_um)| {
                // Beyond the field a curve would run through other figures.
                let out = deviation_um * self.scale.pixels_per_um;
                let out = out.clamp(-0.9 * NOMINAL, (OUTWARDS + 0.02) * NOMINAL);
                self.place(*angle_rad, NOMINAL + out)
            })
            .collect();
        self.drawing.polyline(&points, class);
    }

    pub(in crate::report) fn finish(self, told: &str) -> String {
        self.drawing.finish(told)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_magnification_is_round_and_everything_fits() {
        for (low, high) in [(-3.0, 4.0), (-0.2, 0.1), (-120.0, 80.0), (0.0, 12.0)] {
            let scale = Magnification::for_deviations(low, high, 150.0);
            let leading = scale.times / 10.0_f64.powf(scale.times.log10().floor());
            assert!([1.0, 2.0, 5.0, 10.0].iter().any(|m| (leading - m).abs() < 1e-6), "{scale:?}");
            assert!(high * scale.pixels_per_um <= OUTWARDS * NOMINAL * 1.001);
            assert!(-low * scale.pixels_per_um <= INWARDS * NOMINAL * 1.001);
            // The next of the series would be too large.
            let used = (high * scale.pixels_per_um / (OUTWARDS * NOMINAL))
                .max(-low * scale.pixels_per_um / (INWARDS * NOMINAL));
            assert!(used > 0.39, "{used}");
        }
    }

    #[test]
    fn no_deviation_at_all_is_no_division_by_zero() {
        let scale = Magnification::for_deviations(0.0, 0.0, 150.0);
        assert!(scale.times.is_finite() && scale.division_um > 0.0);
    }
}
