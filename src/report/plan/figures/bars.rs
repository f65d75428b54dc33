//! Travel and time of a test as bars.

use crate::report::draw::svg::{Anchor, Drawing, text_width};
use crate::report::draw::ticks::ticks;
use crate::report::plan::facts::{TestOutlook, TimeFacts};
use crate::report::plan::rows::clock;
use crate::report::text::numbers::{fixed, typeset};

const WIDTH: f64 = 880.0;
/// Height of a bar and from bar to bar, pixels.
const BAR: f64 = 15.0;
const ROW: f64 = 20.0;

/// The kinds of time in the order of the bar: name, class.
pub(in crate::report::plan) const KINDS: [(&str, &str); 6] = [
    ("arcs", "k0"),
    ("transits", "k1"),
    ("other feed", "k2"),
    ("dwells", "k3"),
    ("rapid", "k4"),
    ("operator, assumed", "k5"),
];

fn widest<'a>(texts: impl Iterator<Item = &'a str>) -> f64 {
    texts.map(text_width).fold(0.0, f64::max)
}

/// Time by kind of every mounting.
pub(in crate::report::plan) fn time(test: &TestOutlook) -> String {
    let left = 14.0 + widest(test.mountings.iter().map(|m| m.name.as_str()));
    let right = WIDTH - 60.0;
    let longest_s = test.mountings.iter().map(|m| m.time.total_s).fold(1.0, f64::max);
    let x_at = |seconds: f64| left + (right - left) * seconds / longest_s;
    let bottom = 6.0 + ROW * test.mountings.len() as f64;
    let mut drawing = Drawing::new(WIDTH, bottom + 36.0);
    let marks = ticks(0.0, longest_s / 60.0, 10);
    for minutes in &marks.values {
        let x = x_at(minutes * 60.0);
        drawing.line((x, 2.0), (x, bottom), "grid");
        let label = fixed(*minutes, marks.decimals);
        drawing.text((x, bottom + 14.0), Anchor::Middle, "tick", &label);
    }
    let middle = 0.5 * (left + right);
    drawing.text((middle, bottom + 30.0), Anchor::Middle, "axis", "minutes");
    for (k, mounting) in test.mountings.iter().enumerate() {
        let y = 6.0 + ROW * k as f64;
        drawing.text((left - 6.0, y + 12.0), Anchor::End, "tick strong", &mounting.name);
        let mut from_s = 0.0;
        for (seconds, (_, class)) in kinds(&mounting.time).into_iter().zip(KINDS) {
            drawing.rectangle((x_at(from_s), y), x_at(from_s + seconds) - x_at(from_s), BAR, class);
            from_s += seconds;
        }
        let total = clock(mounting.time.total_s);
        drawing.text((x_at(from_s) + 6.0, y + 12.0), Anchor::Start, "tick", &total);
    }
    drawing.finish(&format!("Time by kind of {}", test.name))
}

fn kinds(time: &TimeFacts) -> [f64; 6] {
    [time.arcs_s, time.transits_s, time.other_feed_s, time.dwell_s, time.rapid_s, time.operator_s]
}

/// What every mounting needs of the travel of each axis; the stroke is where the balls coincide.
pub(in crate::report::plan) fn travel(test: &TestOutlook) -> String {
    let left = 14.0 + widest(test.mountings.iter().map(|m| m.name.as_str()));
    let right = WIDTH - 110.0;
    let block = 34.0 + ROW * test.mountings.len() as f64;
    let mut drawing = Drawing::new(WIDTH, 3.0 * block);
    for axis in 0..3 {
        let top = 20.0 + block * axis as f64;
        let Some(first) = test.mountings.first() else { break };
        let [low, high] = first.travel[axis].limits_mm;
        let x_at = |mm: f64| left + (right - left) * (mm - low) / (high - low);
        let bottom = top + ROW * test.mountings.len() as f64 - 2.0;
        let name = format!("{}, mm", first.travel[axis].axis);
        drawing.text((left, top - 6.0), Anchor::Start, "axis strong", &name);
        drawing.rectangle((left, top - 2.0), right - left, bottom - top + 2.0, "field");
        for mm in ticks(low, high, 8).values {
            let x = x_at(mm);
            drawing.line((x, top - 2.0), (x, bottom), "grid");
            // Beside the axis' name there is room from the second tick on.
            if x > left + text_width(&name) + 20.0 {
                let label = typeset(&fixed(mm, 0));
                drawing.text((x, top - 6.0), Anchor::Middle, "tick", &label);
            }
        }
        for (k, mounting) in test.mountings.iter().enumerate() {
            let y = top + ROW * k as f64;
            let used = &mounting.travel[axis];
            let [from, to] = used.used_mm.map(x_at);
            drawing.rectangle((from, y), to - from, BAR, "used");
            let x = x_at(mounting.coincidence_mm[axis]);
            drawing.line((x, y), (x, y + BAR), "error");
            drawing.text((left - 6.0, y + 12.0), Anchor::End, "tick strong", &mounting.name);
            let left_over = format!("{} mm left", fixed(used.margin_mm, 1));
            drawing.text((right + 8.0, y + 12.0), Anchor::Start, "tick", &left_over);
        }
    }
    drawing.finish(&format!("Travel that {} needs", test.name))
}
