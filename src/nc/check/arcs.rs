//! Rules of what is driven with the bar engaged: sphere, chords, corners, what stands inside an arc.

use super::bar::{Pause, Walk, in_line};
use crate::nc::program::{Move, Path, Step};
use crate::nc::word::Fault;

/// A point of an arc that is off by more was not rounded but mistyped, mm.
const OFF_SPHERE_MM: f64 = 0.01;

/// Largest sagitta without a plan that says otherwise, mm: a few times what a bar resolves.
const SAG_MM: f64 = 1e-3;

/// Feeds that differ by less, as a share, are the same: F is rounded.
const SAME: f64 = 1e-3;

impl Walk<'_, '_> {
    /// With the bar fitted, nothing goes faster than planned.
    pub(super) fn too_fast(&mut self, step: &Step, motion: &Move) {
        let fastest = self.sphere.feeds_mm_s.iter().copied().reduce(f64::max);
        if let Some(planned) = fastest.filter(|feed| motion.feed_mm_s > feed * (1.0 + SAME)) {
            let what = format!(
                "{:.1} mm/min with the bar fitted, and the test file says {:.1} mm/min",
                motion.feed_mm_s * 60.0,
                planned * 60.0
            );
            self.error(step.line, "feed", what, "correct F, or `feed_mm_min` in the test file");
        }
    }

    /// A move with the bar engaged at both ends.
    pub(super) fn along(&mut self, step: &Step, motion: &Move) {
        let length_mm = self.sphere.length_mm;
        let [least_mm, most_mm] = self.sphere.distances_mm(motion);
        let worst_mm = if length_mm - least_mm > most_mm - length_mm { least_mm } else { most_mm };
        let continues = self.before.filter(|_| !self.gap);
        if !self.sphere.reads(worst_mm) {
            self.leaves(step, worst_mm);
        } else if !self.gap && !self.radial(motion) {
            self.on_arc(step, motion, worst_mm);
        }
        if let Some((before, label)) = continues {
            let cosine = before.at(1.0).1.dot(&motion.at(0.0).1).clamp(-1.0, 1.0);
            let corner_rad = cosine.acos();
            let goes_on = corner_rad <= self.machine.controller().corner_stop_rad;
            match self.pause {
                Some(pause) if goes_on && (pause.label == step.label || label == step.label) => {
                    self.inside_arc(pause);
                }
                None if !goes_on && !self.radial(motion) && !self.radial(&before) => {
                    let what =
                        format!("a corner of {:.0} degrees on the sphere", corner_rad.to_degrees());
                    let hint = "check the coordinates of this block and the last; arcs are divided by a dwell";
                    self.warning(step.line, "corner", what, hint);
                }
                _ => {}
            }
        }
        self.before = Some((*motion, step.label));
    }

    /// A chord or an arc that stays on the sphere.
    fn on_arc(&mut self, step: &Step, motion: &Move, worst_mm: f64) {
        let controller = self.machine.controller();
        let chord_mm = motion.length_mm();
        let length_mm = self.sphere.length_mm;
        let line = motion.path == Path::Line;
        let sag_mm = if line { chord_mm * chord_mm / (8.0 * length_mm) } else { 0.0 };
        // A chord that is rounded at both ends sags a little more than planned.
        let allowed_mm = self.sphere.chord_sag_mm.map_or(SAG_MM, |sag| sag * 1.05 + 1e-5);
        let ends_mm = [&motion.start_mm, &motion.end_mm]
            .map(|point| (self.sphere.distance_mm(point) - length_mm).abs());
        let off_mm = if line { ends_mm[1] } else { (worst_mm - length_mm).abs() };
        let needs_s = chord_mm / motion.feed_mm_s;
        let mut told: Vec<(&'static str, String, String)> = Vec::new();
        if off_mm > OFF_SPHERE_MM {
            told.push((
                "off-sphere",
                format!("the path is {:.1} um off the sphere", off_mm * 1e3),
                "check the coordinates of this block: the bar reads a mistyped point as an error of the machine".to_owned(),
            ));
        }
        if sag_mm > allowed_mm {
            told.push((
                "sag",
                format!("the chord sags {:.2} um", sag_mm * 1e3),
                format!("{:.2} um were planned: divide the arc more finely", allowed_mm * 1e3),
            ));
        }
        if motion.exact_stop && line {
            told.push((
                "exact-stop",
                "exact stop at every chord".to_owned(),
                "write G64: with G61 or G09 the machine stops at the end of each block".to_owned(),
            ));
        }
        if needs_s < controller.block_time_s * (1.0 - 1e-9) {
            told.push((
                "block-rate",
                format!(
                    "the block lasts {:.2} ms, and the control needs {:.2} ms for one",
                    needs_s * 1e3,
                    controller.block_time_s * 1e3
                ),
                "the control cannot keep the feed: lower it, or allow more sag".to_owned(),
            ));
        }
        let feeds = &self.sphere.feeds_mm_s;
        if !feeds.is_empty()
            && feeds.iter().all(|feed| (motion.feed_mm_s / feed - 1.0).abs() > SAME)
        {
            let planned: Vec<String> = feeds.iter().map(|f| format!("{:.1}", f * 60.0)).collect();
            told.push((
                "feed",
                format!("an arc at {:.1} mm/min", motion.feed_mm_s * 60.0),
                format!("the test file says {} mm/min", planned.join(" and ")),
            ));
        }
        for (rule, what, hint) in told {
            self.warning(step.line, rule, what, &hint);
        }
    }

    fn inside_arc(&mut self, pause: Pause) {
        let name = match (pause.word, pause.dwell) {
            (Some(word), _) => word.name(),
            (None, true) => "a dwell".to_owned(),
            (None, false) => "a stop".to_owned(),
        };
        let error = match (pause.word, self.listing.block_of(pause.line)) {
            (Some(word), Some(block)) => {
                self.listing.locate(block.line, Fault::word(&word, format!("{name} inside an arc")))
            }
            _ => in_line(self.listing, pause.line, format!("{name} inside an arc")),
        };
        let error = error.hint(
            "it ends the look-ahead, and the arc is driven in two pieces: move it to the end of the arc",
        );
        if pause.word.is_none() && !pause.dwell {
            self.findings.error("inside-arc", error);
        } else {
            self.findings.warning("inside-arc", error);
        }
    }
}
