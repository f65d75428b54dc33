//! A drawing as inline SVG. Styles are classes of the page's style sheet.

use std::fmt::Write as _;

use crate::report::text::markup::escaped;
use crate::report::text::numbers::fixed;

/// Where a text is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::report) enum Anchor {
    Start,
    Middle,
    End,
}

/// A drawing, in pixels of the screen; y grows downwards.
#[derive(Debug)]
pub(in crate::report) struct Drawing {
    width: f64,
    height: f64,
    /// What a script has to know of it, such as ` data-circle="1"`.
    attributes: String,
    body: String,
}

impl Drawing {
    pub(in crate::report) fn new(width: f64, height: f64) -> Self {
        Self { width, height, attributes: String::new(), body: String::new() }
    }

    /// Something that a script has to know of it.
    pub(in crate::report) fn attribute(&mut self, name: &str, value: &str) {
        let _ = write!(self.attributes, r#" data-{name}="{}""#, escaped(value));
    }

    /// Begins a group of a class.
    pub(in crate::report) fn begin(&mut self, class: &str) {
        let _ = write!(self.body, r#"<g class="{class}">"#);
    }

    /// Ends it.
    pub(in crate::report) fn end(&mut self) {
        self.body.push_str("</g>");
    }

    /// A straight line.
    pub(in crate::report) fn line(&mut self, from: (f64, f64), to: (f64, f64), class: &str) {
        let _ = write!(
            self.body,
            r#"<line class="{class}" x1="{}" y1="{}" x2="{}" y2="{}"/>"#,
            pixels(from.0),
            pixels(from.1),
            pixels(to.0),
            pixels(to.1)
        );
    }

    /// A line through points.
    pub(in crate::report) fn polyline(&mut self, points: &[(f64, f64)], class: &str) {
        if points.len() < 2 {
            return;
        }
        let _ = write!(self.body, r#"<polyline class="{class}" points=""#);
        for (k, (x, y)) in points.iter().enumerate() {
            let gap = if k > 0 { " " } else { "" };
            let _ = write!(self.body, "{gap}{},{}", pixels(*x), pixels(*y));
        }
        self.body.push_str("\"/>");
    }

    /// Dots of one size, as one path: thousands of circles would make the file slow.
    pub(in crate::report) fn dots(
        &mut self,
        points: impl Iterator<Item = (f64, f64)>,
        class: &str,
    ) {
        let mut path = String::new();
        for (x, y) in points {
            let _ = write!(path, "M{} {}h0", pixels(x), pixels(y));
        }
        if !path.is_empty() {
            let _ = write!(self.body, r#"<path class="dots {class}" d="{path}"/>"#);
        }
    }

    /// A rectangle; a negative height or width is turned round.
    pub(in crate::report) fn rectangle(
        &mut self,
        corner: (f64, f64),
        width: f64,
        height: f64,
        class: &str,
    ) {
        let _ = write!(
            self.body,
            r#"<rect class="{class}" x="{}" y="{}" width="{}" height="{}"/>"#,
            pixels(corner.0.min(corner.0 + width)),
            pixels(corner.1.min(corner.1 + height)),
            pixels(width.abs()),
            pixels(height.abs())
        );
    }

    /// A circle.
    pub(in crate::report) fn circle(&mut self, centre: (f64, f64), radius: f64, class: &str) {
        let _ = write!(
            self.body,
            r#"<circle class="{class}" cx="{}" cy="{}" r="{}"/>"#,
            pixels(centre.0),
            pixels(centre.1),
            pixels(radius)
        );
    }

    /// A closed polygon.
    pub(in crate::report) fn polygon(&mut self, points: &[(f64, f64)], class: &str) {
        let _ = write!(self.body, r#"<polygon class="{class}" points=""#);
        for (x, y) in points {
            let _ = write!(self.body, "{},{} ", pixels(*x), pixels(*y));
        }
        self.body.push_str("\"/>");
    }

    /// Text.
    pub(in crate::report) fn text(
        &mut self,
        at: (f64, f64),
        anchor: Anchor,
        class: &str,
        text: &str,
    ) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let _ = write!(
            self.body,
            r#"<text class="{class}" x="{}" y="{}" text-anchor="{anchor}">{}</text>"#,
            pixels(at.0),
            pixels(at.1),
            escaped(text)
        );
    }

    /// Text that reads upwards, for the axis on the left.
    pub(in crate::report) fn upwards(&mut self, at: (f64, f64), class: &str, text: &str) {
        let _ = write!(
            self.body,
            r#"<text class="{class}" text-anchor="middle" transform="translate({} {}) rotate(-90)">{}</text>"#,
            pixels(at.0),
            pixels(at.1),
            escaped(text)
        );
    }

    /// The finished drawing; `told` is for those who do not see it.
    pub(in crate::report) fn finish(self, told: &str) -> String {
        let (width, height) = (fixed(self.width, 0), fixed(self.height, 0));
        format!(
            r#"<svg width="{width}" viewBox="0 0 {width} {height}"{} role="img" aria-label="{}">{}</svg>"#,
            self.attributes,
            escaped(told),
            self.body
        )
    }
}

/// A tenth of a pixel is finer than print.
fn pixels(value: f64) -> String {
    let text = fixed(value, 1);
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// Width that a text of the small size takes at most, pixels.
pub(in crate::report) fn text_width(text: &str) -> f64 {
    6.2 * text.chars().count() as f64
}

/// At most about `most` of the values, evenly chosen, the first and the last among them.
pub(in crate::report) fn thinned<T: Copy>(values: &[T], most: usize) -> Vec<T> {
    if values.len() <= most || most < 2 {
        return values.to_vec();
    }
    let last = values.len() - 1;
    (0..most).map(|k| values[k * last / (most - 1)]).collect()
}

/// A line of at most about `most` points that keeps the extremes of every stretch.
pub(in crate::report) fn envelope(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    if points.len() <= most.max(4) {
        return points.to_vec();
    }
    let stretch = points.len().div_ceil(most.max(4) / 2);
    let mut kept = Vec::with_capacity(most + 2);
    for chunk in points.chunks(stretch) {
        let by = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let (Some(low), Some(high)) = (chunk.iter().min_by(by), chunk.iter().max_by(by)) else {
            continue;
        };
        if low.0 <= high.0 {
            kept.extend([*low, *high]);
        } else {
            kept.extend([*high, *low]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_short_and_have_no_negative_zero() {
        assert_eq!(pixels(12.0), "12");
        assert_eq!(pixels(12.34), "12.3");
        assert_eq!(pixels(-0.04), "0");
    }

    #[test]
    fn thinning_keeps_both_ends() {
        let all: Vec<usize> = (0..1000).collect();
        let few = thinned(&all, 7);
        assert_eq!((few.len(), few[0], few[6]), (7, 0, 999));
        assert_eq!(thinned(&all, 2000).len(), 1000);
    }

    #[test]
    fn the_envelope_keeps_the_peak() {
        let mut points: Vec<(f64, f64)> = (0..5000).map(|k| (f64::from(k), 0.0)).collect();
        points[3333].1 = 7.0;
        let few = envelope(&points, 200);
        assert!(few.len() <= 202);
        assert!(few.contains(&(3333.0, 7.0)));
        assert!(few.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }

    #[test]
    fn text_is_escaped() {
        let mut drawing = Drawing::new(10.0, 10.0);
        drawing.text((0.0, 0.0), Anchor::Start, "label", "a < b & \"c\"");
        let svg = drawing.finish("x");
        assert!(svg.contains("a &lt; b &amp; &quot;c&quot;"), "{svg}");
    }
}
