//! A chart with two straight axes.

use super::svg::{Anchor, Drawing, text_width};
use super::ticks::ticks;
use crate::report::text::numbers::{fixed, typeset};

/// One axis.
#[derive(Debug, Clone)]
pub(in crate::report) struct Axis {
    /// What it shows, with the unit.
    pub(in crate::report) label: String,
    /// Lowest value.
    pub(in crate::report) low: f64,
    /// Highest value.
    pub(in crate::report) high: f64,
}

impl Axis {
    pub(in crate::report) fn new(label: &str, (low, high): (f64, f64)) -> Self {
        // An axis of no length would divide by zero.
        let high = if high > low { high } else { low + 1.0 };
        Self { label: label.to_owned(), low, high }
    }
}

/// Room around the field, pixels.
const TOP: f64 = 10.0;
const RIGHT: f64 = 14.0;
const BOTTOM: f64 = 40.0;

/// A chart that is being drawn.
#[derive(Debug)]
pub(in crate::report) struct Chart {
    drawing: Drawing,
    x: Axis,
    y: Axis,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

/// What stands under a chart instead of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Bottom {
    Numbers,
    Nothing,
}

impl Chart {
    /// An empty chart of so many pixels, with grid and ticks on both axes.
    pub(in crate::report) fn new(width: f64, height: f64, x: Axis, y: Axis) -> Self {
        Self::with(width, height, x, y, Bottom::Numbers)
    }

    /// The same without ticks on the x axis, for categories.
    pub(in crate::report) fn of_categories(width: f64, height: f64, count: usize, y: Axis) -> Self {
        let x = Axis::new("", (0.0, count.max(1) as f64));
        Self::with(width, height, x, y, Bottom::Nothing)
    }

    fn with(width: f64, height: f64, x: Axis, y: Axis, numbers: Bottom) -> Self {
        let y_ticks = ticks(y.low, y.high, ((height - TOP - BOTTOM) / 28.0) as usize);
        let labels: Vec<String> =
            y_ticks.values.iter().map(|v| typeset(&fixed(*v, y_ticks.decimals))).collect();
        let widest = labels.iter().map(|label| text_width(label)).fold(0.0, f64::max);
        let mut chart = Self {
            drawing: Drawing::new(width, height),
            left: 26.0 + widest,
            right: width - RIGHT,
            top: TOP,
            bottom: height - BOTTOM,
            x,
            y,
        };
        let (left, right, top, bottom) = (chart.left, chart.right, chart.top, chart.bottom);
        chart.drawing.rectangle((left, top), right - left, bottom - top, "field");
        for (value, label) in y_ticks.values.iter().zip(&labels) {
            let y = chart.y_at(*value);
            let class = if value.abs() < 1e-12 { "zero" } else { "grid" };
            chart.drawing.line((left, y), (right, y), class);
            chart.drawing.text((left - 5.0, y + 3.5), Anchor::End, "tick", label);
        }
        if numbers == Bottom::Numbers {
            chart.x_ticks();
            // Where its field is and what it spans, so that a script can tell a point.
            let Axis { low: x_low, high: x_high, .. } = chart.x;
            let Axis { low: y_low, high: y_high, .. } = chart.y;
            let field = [left, right, bottom, top, x_low, x_high, y_low, y_high];
            chart.drawing.attribute("chart", &field.map(|value| format!("{value}")).join(" "));
        }
        let middle = 0.5 * (top + bottom);
        let y_label = chart.y.label.clone();
        chart.drawing.upwards((12.0, middle), "axis", &y_label);
        chart
    }

    fn x_ticks(&mut self) {
        // As many as fit without touching: decide by the widest label of a first guess.
        let room = self.right - self.left;
        let guess = ticks(self.x.low, self.x.high, 8);
        let widest = guess.values.iter().map(|v| text_width(&fixed(*v, guess.decimals)));
        let widest = widest.fold(20.0, f64::max) + 18.0;
        let x_ticks = ticks(self.x.low, self.x.high, ((room / widest) as usize).clamp(2, 12));
        for value in &x_ticks.values {
            let x = self.x_at(*value);
            self.drawing.line((x, self.top), (x, self.bottom), "grid");
            let label = typeset(&fixed(*value, x_ticks.decimals));
            self.drawing.text((x, self.bottom + 14.0), Anchor::Middle, "tick", &label);
        }
        let label = self.x.label.clone();
        let middle = 0.5 * (self.left + self.right);
        self.drawing.text((middle, self.bottom + 31.0), Anchor::Middle, "axis", &label);
    }

    pub(in crate::report) fn x_at(&self, value: f64) -> f64 {
        let share = (value - self.x.low) / (self.x.high - self.x.low);
        self.left + share.clamp(-0.5, 1.5) * (self.right - self.left)
    }

    pub(in crate::report) fn y_at(&self, value: f64) -> f64 {
        let share = (value - self.y.low) / (self.y.high - self.y.low);
        self.bottom - share.clamp(0.0, 1.0) * (self.bottom - self.top)
    }

    fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.x_at(x), self.y_at(y))
    }

    /// A line through points, in units of the axes.
    pub(in crate::report) fn line(&mut self, points: &[(f64, f64)], class: &str) {
        let points: Vec<(f64, f64)> = points.iter().map(|point| self.at(*point)).collect();
        self.drawing.polyline(&points, class);
    }

    /// What lies between two lines, in units of the axes.
    pub(in crate::report) fn band(&mut self, low: &[(f64, f64)], high: &[(f64, f64)], class: &str) {
        let around = low.iter().chain(high.iter().rev());
        let points: Vec<(f64, f64)> = around.map(|point| self.at(*point)).collect();
        self.drawing.polygon(&points, class);
    }

    /// Dots, in units of the axes.
    pub(in crate::report) fn dots(&mut self, points: &[(f64, f64)], class: &str) {
        let points: Vec<(f64, f64)> = points.iter().map(|point| self.at(*point)).collect();
        self.drawing.dots(points.into_iter(), class);
    }

    /// A stretch of the x axis, shaded over the whole height.
    pub(in crate::report) fn shade(&mut self, from: f64, to: f64, class: &str) {
        let (x0, x1) = (self.x_at(from), self.x_at(to));
        self.drawing.rectangle((x0, self.top), x1 - x0, self.bottom - self.top, class);
    }

    /// A mark across the whole height.
    pub(in crate::report) fn upright(&mut self, x: f64, class: &str) {
        let x = self.x_at(x);
        self.drawing.line((x, self.top), (x, self.bottom), class);
    }

    /// A bar from zero, between two places of the x axis.
    pub(in crate::report) fn bar(&mut self, from: f64, to: f64, value: f64, class: &str) {
        let (x0, x1) = (self.x_at(from), self.x_at(to));
        let (zero, y) = (self.y_at(0.0), self.y_at(value));
        self.drawing.rectangle((x0, y), x1 - x0, zero - y, class);
    }

    /// An error bar of plus and minus `half` about a value.
    pub(in crate::report) fn error_bar(&mut self, x: f64, value: f64, half: f64) {
        let (x, low, high) = (self.x_at(x), self.y_at(value - half), self.y_at(value + half));
        self.drawing.line((x, low), (x, high), "error");
        for y in [low, high] {
            self.drawing.line((x - 4.0, y), (x + 4.0, y), "error");
        }
    }

    /// Text under the field, held in its middle.
    pub(in crate::report) fn below(&mut self, x: f64, text: &str) {
        let at = (self.x_at(x), self.bottom + 15.0);
        self.drawing.text(at, Anchor::Middle, "tick strong", text);
    }

    /// Text in the field at a place of the axes, moved by pixels.
    pub(in crate::report) fn note(
        &mut self,
        at: (f64, f64),
        by: (f64, f64),
        anchor: Anchor,
        text: &str,
    ) {
        let (x, y) = self.at(at);
        self.drawing.text((x + by.0, y + by.1), anchor, "note", text);
    }

    /// Text in the upper corner of the field.
    pub(in crate::report) fn title(&mut self, text: &str) {
        let at = (self.left + 7.0, self.top + 14.0);
        self.drawing.text(at, Anchor::Start, "title", text);
    }

    pub(in crate::report) fn finish(self, told: &str) -> String {
        self.drawing.finish(told)
    }
}
