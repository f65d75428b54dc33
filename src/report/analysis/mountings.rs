//! What is told of mountings, and of which one where a test has several.

use std::fmt::Write as _;

use super::facts::{Analysis, MountingFacts};
use crate::report::text::numbers::fixed;

impl Analysis {
    /// Nominal lengths of the bars of the mountings, each once, in words, mm.
    pub(super) fn bar_lengths(&self) -> String {
        let mut lengths: Vec<String> = Vec::new();
        for mounting in &self.test.mountings {
            let length = mounting.bar_length_mm.to_string();
            if !lengths.contains(&length) {
                lengths.push(length);
            }
        }
        lengths.join(" and ")
    }

    /// Whether what is told must say of which mounting it is.
    pub(super) fn several_mountings(&self) -> bool {
        self.test.mountings.len() > 1
    }

    /// A name with that of its mounting, where the test has several.
    pub(super) fn in_mounting(&self, name: &str, mounting: usize) -> String {
        match self.test.mountings.get(mounting) {
            Some(of) if self.several_mountings() => format!("{name}, {}", of.name),
            _ => name.to_owned(),
        }
    }

    /// Where the balls of a mounting were, in words; with several, also what may differ between them.
    pub(super) fn told(&self, mounting: &MountingFacts) -> String {
        let place = |mm: [f64; 3]| mm.map(|c| fixed(c, 3)).join(", ");
        let mut told =
            format!("{}: balls coincide at ({}) mm", mounting.name, place(mounting.coincidence_mm));
        if self.several_mountings() {
            let _ = write!(
                told,
                ", tool ball at ({}) mm, bar of {} mm",
                place(mounting.tool_ball_mm),
                mounting.bar_length_mm
            );
        }
        told
    }
}
