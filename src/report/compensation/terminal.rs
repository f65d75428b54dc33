//! A compensation for the terminal, and as the page that lies beside its files.

use std::fmt::Write as _;

use super::{Compensated, words};
use crate::report::text::layout::{paragraph, table};

/// What the files do, how they are loaded, and how their signs are seen.
pub fn compensation_text(told: &Compensated) -> String {
    let of = told.of;
    let mut text = format!(
        "Compensation of {} for {}, of {} ({})\n",
        told.machine,
        of.asked.control.title(),
        told.test,
        told.file
    );
    for sentence in words::verdict(told) {
        paragraph(&mut text, "  ", &sentence);
    }
    let mut listed = |title: &str, all: &[String]| {
        if all.is_empty() {
            return;
        }
        let _ = writeln!(text, "\n{title}");
        for told in all {
            paragraph(&mut text, "  - ", told);
        }
    };
    listed("Not certain of this format", &of.written.unsure);
    listed("What did not fit the control", &of.written.lost);
    listed("How it is loaded", &of.written.load);
    let before = !of.asked.existing.is_empty();
    let points: Vec<String> =
        of.points.iter().map(|of_point| words::point(of_point, of.asked.control, before)).collect();
    listed("See at one point that the sign is right", &points);
    text.push_str("\nWhat is compensated and what is left (um rms over what was measured)\n");
    let head = ["", "before", "left"].map(str::to_owned).to_vec();
    let rows = of.left.groups.iter().map(|group| {
        vec![group.name.clone(), words::um(group.before_mm), words::um(group.after_mm)]
    });
    text.push_str(&table(&std::iter::once(head).chain(rows).collect::<Vec<_>>(), "lrr"));
    paragraph(
        &mut text,
        "  ",
        "Errors are actual less commanded of the tool against the workpiece, along the programmed directions.",
    );
    if !told.found.is_empty() {
        text.push_str("\nWhat `diagnose` found (um rms of the residual)\n");
        let rows = told.found.iter().map(|(title, mm)| vec![title.clone(), words::um(*mm)]);
        text.push_str(&table(&rows.collect::<Vec<_>>(), "lr"));
    }
    paragraph(
        &mut text,
        "  ",
        "What hangs on speed, on time or on the way since a reversal is in no table; what hangs on the position of slides alone is in the functions.",
    );
    text
}
