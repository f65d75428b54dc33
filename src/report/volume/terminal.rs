//! A map for the terminal.

use std::fmt::Write as _;

use super::{Mapped, words};
use crate::compensate::{Figure, Figures, Line};
use crate::report::text::layout::{paragraph, table};
use crate::report::text::numbers::fixed;

/// Figures and foretold lines.
pub fn volume_text(of: &Mapped) -> String {
    let [low_mm, high_mm] = of.map.volume.ends_mm;
    let ends = (0..3).map(|k| {
        let axis = ["X", "Y", "Z"][k];
        format!("{axis} {} to {}", fixed(low_mm[k], 1), fixed(high_mm[k], 1))
    });
    let ends = ends.collect::<Vec<_>>().join(", ");
    let tool = <[f64; 3]>::from(of.tool_ball_mm).map(|mm| fixed(mm, 1)).join(", ");
    let points = of.map.counts.map(|count| count.to_string()).join(" x ");
    let mut text = format!("{} on {}\n", of.test, of.errors.machine.name());
    paragraph(
        &mut text,
        "  ",
        &format!("Machine coordinates {ends} mm, {points} points; tip of the tool at {tool} mm."),
    );
    for sentence in words::verdict(of) {
        paragraph(&mut text, "  ", &sentence);
    }
    for (figures, title) in [
        (&of.map.near, "Volume, where something was measured near (um)"),
        (&of.map.whole, "Whole volume (um)"),
    ] {
        let Some(figures) = figures else { continue };
        let _ = writeln!(text, "\n{title}");
        text.push_str(&table(&rows(figures), "lrrr"));
    }
    if !of.map.lines.is_empty() {
        text.push_str("\nWhat a laser would read (um)\n");
        text.push_str(&table(&lines(&of.map.lines), "lrrrrrrrl"));
    }
    text.push('\n');
    paragraph(&mut text, "  ", words::BASIS);
    text
}

/// Figures as rows: name, value, noise, all.
pub(super) fn rows(of: &Figures) -> Vec<Vec<String>> {
    let [x, y, z] = &of.ranges;
    let row = |name: &str, figure: &Figure| {
        let mut row = vec![name.to_owned()];
        row.extend(words::cells(figure));
        row
    };
    let head = ["", "value", "noise", "all"].map(str::to_owned).to_vec();
    vec![
        head,
        row("largest", &of.largest),
        row("95 %", &of.most),
        row("rms", &of.rms),
        row("range in X", x),
        row("range in Y", y),
        row("range in Z", z),
    ]
}

/// Foretold lines as rows.
pub(super) fn lines(of: &[Line]) -> Vec<Vec<String>> {
    let head = ["line", "length mm", "E", "noise", "all", "M", "B", "all of B", "measured"];
    let rows = of.iter().map(|line| {
        let [e, _, _, mean, reversal] = &line.figures;
        let length_mm = (line.ends_mm[1] - line.ends_mm[0]).norm();
        let [value, noise, all] = words::cells(e);
        let [mean, ..] = words::cells(mean);
        let [step, _, step_all] = words::cells(reversal);
        let name = line.name.clone();
        vec![name, fixed(length_mm, 1), value, noise, all, mean, step, step_all, words::near(line)]
    });
    std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect()
}
