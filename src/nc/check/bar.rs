//! Rules of the ball-bar: reach, engagement, sphere, chords, what stands inside an arc, release.

use nalgebra::Vector3;

use super::bodies::Bodies;
use super::findings::Findings;
use super::sphere::Sphere;
use crate::error::Error;
use crate::machine::{Axis, Machine};
use crate::nc::grammar::Grammar;
use crate::nc::lines::Line;
use crate::nc::listing::Listing;
use crate::nc::program::{Action, Move, Step};
use crate::nc::run::{Mark, Ran};
use crate::nc::word::{Fault, Word};

/// A radial move keeps within this angle of the radius: its cosine, 5 degrees.
const RADIAL: f64 = 0.996;

/// What interrupts the motion between two moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pause {
    pub(super) line: usize,
    pub(super) label: usize,
    pub(super) word: Option<Word>,
    /// It only slows the arc down, and does not end it.
    pub(super) dwell: bool,
}

pub(super) fn check(
    listing: &Listing,
    ran: &Ran,
    machine: &Machine,
    sphere: &Sphere,
    findings: &mut Findings,
) {
    let mut walk = Walk {
        listing,
        machine,
        sphere,
        bodies: Bodies::of(machine, sphere.centre_mm),
        findings,
        bar: Bar::Never,
        stopped: false,
        fitted: false,
        moved: [false; 3],
        before: None,
        pause: None,
        gap: false,
        last: 0,
    };
    let mut marks = ran.marks.iter().peekable();
    for (index, step) in ran.steps.iter().enumerate() {
        while let Some(mark) = marks.next_if(|mark| mark.step <= index) {
            walk.mark(mark);
        }
        walk.step(step);
        if walk.findings.are_too_many() {
            return;
        }
    }
    walk.end();
    walk.starts(ran);
}

/// What became of the bar so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bar {
    Never,
    Engaged,
    Released,
}

pub(super) struct Walk<'a, 'b> {
    pub(super) listing: &'a Listing<'b>,
    pub(super) machine: &'a Machine,
    pub(super) sphere: &'a Sphere,
    /// What stands behind the balls, where the machine file says it.
    pub(super) bodies: Option<Bodies>,
    pub(super) findings: &'a mut Findings,
    pub(super) bar: Bar,
    /// The operator could fit the bar, or take it off.
    pub(super) stopped: bool,
    /// The bar is in the machine: from its engagement to the stop after its release.
    pub(super) fitted: bool,
    pub(super) moved: [bool; 3],
    /// The last move, and its label, if the bar was engaged all along it.
    pub(super) before: Option<(Move, usize)>,
    pub(super) pause: Option<Pause>,
    /// A block in between could not be followed: what leads on from it is not judged.
    pub(super) gap: bool,
    pub(super) last: usize,
}

/// An error of the block in a line.
pub(super) fn in_line(listing: &Listing, line: usize, what: String) -> Error {
    match listing.block_of(line) {
        Some(block) => listing.locate(block.line, Fault::line(what)),
        None => listing.whole(what),
    }
}

impl Walk<'_, '_> {
    pub(super) fn error(&mut self, line: usize, rule: &'static str, what: String, hint: &str) {
        let listing = self.listing;
        self.findings.error_of(rule, what, |what| in_line(listing, line, what).hint(hint));
    }

    pub(super) fn warning(&mut self, line: usize, rule: &'static str, what: String, hint: &str) {
        let error = in_line(self.listing, line, what).hint(hint);
        self.findings.warning(rule, error);
    }

    fn mark(&mut self, mark: &Mark) {
        match mark.word {
            None => self.gap = true,
            Some(word) => {
                let label = self.before.map_or(0, |(_, label)| label);
                let Line { number, .. } = mark.line;
                let pause = Pause { line: number, label, word: Some(word), dwell: false };
                self.pause.get_or_insert(pause);
            }
        }
    }

    fn step(&mut self, step: &Step) {
        self.last = step.line;
        let pause = |dwell| Pause { line: step.line, label: step.label, word: None, dwell };
        match &step.action {
            Action::Move(motion) if motion.rapid => self.rapid(step, motion),
            Action::Move(motion) => self.feed(step, motion),
            Action::Dwell { .. } => drop(self.pause.get_or_insert(pause(true))),
            Action::Stop => {
                self.stopped = true;
                self.fitted &= self.bar == Bar::Engaged;
                self.pause = Some(pause(false));
            }
            Action::End => {}
        }
        if let Action::Move(motion) = &step.action {
            self.bodies(step, motion);
            let chord = motion.end_mm - motion.start_mm;
            for (moved, along) in self.moved.iter_mut().zip(chord.iter()) {
                *moved |= along.abs() > 1e-9;
            }
            self.pause = None;
            self.gap = false;
        }
    }

    fn rapid(&mut self, step: &Step, motion: &Move) {
        if !self.gap {
            if let Some(what) = self.rapid_in_reach(motion) {
                let hint = "position outside of the reach, one axis after the other, and move inside it at feed; a Fanuc goes straight only if a parameter says so (LRP)";
                self.error(step.line, "rapid-in-reach", what, hint);
            } else if self.fitted {
                let what = "positioning with the bar fitted".to_owned();
                let hint = "write M00 after the release, so that the bar is taken off first";
                self.error(step.line, "fitted", what, hint);
            }
        }
        if self.bar == Bar::Engaged {
            self.bar = Bar::Released;
        }
        (self.stopped, self.fitted) = (false, false);
        self.before = None;
    }

    /// Where a positioning comes within the reach of the bar: on a straight line, and on a Fanuc with every axis at its
    /// own rapid traverse too.
    pub(super) fn rapid_in_reach(&self, motion: &Move) -> Option<String> {
        let reach_mm = self.sphere.length_mm + self.sphere.range_mm;
        let [straight_mm, _] = self.sphere.distances_mm(motion);
        if straight_mm <= reach_mm {
            return Some(format!(
                "positioning passes {straight_mm:.3} mm from the workpiece ball, within the reach of the bar, {reach_mm:.3} mm"
            ));
        }
        let bends = Grammar::of(self.machine.controller().dialect).bends;
        let nearest_mm = bends.then(|| self.sphere.dog_leg_mm(motion, self.machine)).flatten();
        let nearest_mm = nearest_mm.filter(|near| *near <= reach_mm)?;
        Some(format!(
            "positioning passes {nearest_mm:.3} mm from the workpiece ball where every axis goes at its own rapid traverse"
        ))
    }

    fn feed(&mut self, step: &Step, motion: &Move) {
        let start_mm = self.sphere.distance_mm(&motion.start_mm);
        let end_mm = self.sphere.distance_mm(&motion.end_mm);
        let inside = self.sphere.reads(end_mm);
        let [least_mm, _] = self.sphere.distances_mm(motion);
        if inside || self.fitted {
            self.too_fast(step, motion);
        }
        if self.bar != Bar::Engaged {
            if self.sphere.too_near(least_mm) {
                self.too_near(step, least_mm);
            } else if self.bar == Bar::Released && self.fitted && self.sphere.in_reach(least_mm) {
                self.comes_back(step, least_mm);
            }
            if inside {
                self.engage(step, motion, start_mm);
            }
            self.before = None;
            return;
        }
        if inside {
            self.along(step, motion);
        } else if self.sphere.too_near(least_mm) {
            self.leaves(step, least_mm);
            self.before = None;
        } else if end_mm > self.sphere.length_mm && self.along_radius_of(&motion.start_mm, motion) {
            // Where the bar still holds both balls is what counts: far out, every way looks like a radius.
            self.bar = Bar::Released;
            self.before = None;
        } else {
            self.leaves(step, end_mm);
            self.before = None;
        }
    }

    /// What stands behind the balls, wherever the bar is.
    fn bodies(&mut self, step: &Step, motion: &Move) {
        let Some(bodies) = &mut self.bodies else { return };
        let touch = bodies.follow(motion, self.machine);
        let used_up = bodies.is_used_up();
        if let Some(touch) = touch.filter(|_| !self.gap) {
            let section = self.listing.labels.get(step.label).map_or("", String::as_str);
            let what = touch.told(section);
            let hint = "check the coordinates of this block, and `[clearance]` in the machine file";
            self.error(step.line, "clearance", what, hint);
        } else if used_up {
            self.bodies = None;
            let what = "tool and support run beside each other for too long: from here on nobody looked whether they touch";
            self.error(step.line, "clearance", what.to_owned(), "divide the program");
        }
    }

    /// A feed move inside of what the bar can be, or through the workpiece ball: whether the bar is fitted or not, no
    /// program of a ball-bar test goes there.
    fn too_near(&mut self, step: &Step, least_mm: f64) {
        if self.gap {
            return;
        }
        let shortest_mm = self.sphere.length_mm - self.sphere.range_mm;
        let what = format!(
            "the path passes {least_mm:.3} mm from the workpiece ball, nearer than the bar is short, {shortest_mm:.3} mm"
        );
        let hint = "check the coordinates of this block, their signs and their decimal points";
        self.error(step.line, "too-near", what, hint);
    }

    /// A bar that was pulled off hangs loose until somebody takes it off or puts it in again.
    fn comes_back(&mut self, step: &Step, least_mm: f64) {
        if self.gap {
            return;
        }
        let what = format!(
            "the path comes back to {least_mm:.3} mm from the workpiece ball, to a bar that it has released"
        );
        let hint = "check the coordinates of the last block and of this one; between release and engagement, M00 lets the operator take the bar off";
        self.error(step.line, "engagement", what, hint);
    }

    /// Whether a move leads along the radius of its end.
    pub(super) fn radial(&self, motion: &Move) -> bool {
        self.along_radius_of(&motion.end_mm, motion)
    }

    /// Whether a move leads along the radius of a point.
    fn along_radius_of(&self, point_mm: &Vector3<f64>, motion: &Move) -> bool {
        let radius = point_mm - self.sphere.centre_mm;
        let chord = motion.end_mm - motion.start_mm;
        radius.dot(&chord).abs() > RADIAL * radius.norm() * chord.norm()
    }

    fn engage(&mut self, step: &Step, motion: &Move, start_mm: f64) {
        let first = std::mem::replace(&mut self.bar, Bar::Engaged) == Bar::Never;
        self.fitted = true;
        if self.gap {
            return;
        }
        let unmoved: Vec<String> = Axis::ALL
            .into_iter()
            .filter(|axis| !self.moved[axis.index()])
            .map(|axis| axis.to_string())
            .collect();
        let mut told: Vec<(&'static str, String, &'static str)> = Vec::new();
        if !unmoved.is_empty() {
            told.push((
                "sense",
                format!("{} has not moved when the bar engages", unmoved.join(" and ")),
                "its hysteresis is on an unknown side until it turns round: approach with every axis moving",
            ));
        }
        if self.sphere.reads(start_mm) || !self.radial(motion) {
            told.push((
                "engagement",
                "the bar does not engage along the radius".to_owned(),
                "feed in from outside the range of the bar along the radius: the moment that the bar \
                 begins to read ties the log to the program",
            ));
        }
        if first && !self.stopped {
            told.push((
                "fit",
                "no M00 before the bar engages".to_owned(),
                "stop outside of the range, so that the bar can be fitted",
            ));
        }
        for (rule, what, hint) in told {
            self.warning(step.line, rule, what, hint);
        }
    }

    pub(super) fn leaves(&mut self, step: &Step, distance_mm: f64) {
        if self.gap {
            return;
        }
        let over_mm = distance_mm - self.sphere.length_mm;
        let what = format!(
            "the path leaves the sphere: the bar would be {:.3} mm {} and reads {} mm",
            over_mm.abs(),
            if over_mm > 0.0 { "longer" } else { "shorter" },
            self.sphere.range_mm
        );
        let hint =
            "check the coordinates of this block; feed out along the radius to release the bar";
        self.error(step.line, "sphere", what, hint);
    }

    fn end(&mut self) {
        if self.bar == Bar::Never {
            let error = self.listing.whole("the bar never engages").hint(
                "no feed move ends on the sphere: check the work offset, the mounting and the length of the bar",
            );
            self.findings.error("engagement", error);
        } else if self.bar == Bar::Engaged {
            let what = "the program ends with the bar engaged".to_owned();
            let hint = "feed out along the radius beyond the range of the bar before the end";
            self.error(self.last, "release", what, hint);
        } else if self.fitted {
            let what = "the program ends with the bar fitted".to_owned();
            let hint = "write M00 after the release, so that the bar is taken off, and retract before the end";
            self.warning(self.last, "fitted", what, hint);
        }
    }
}
