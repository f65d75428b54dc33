//! What stays in force from block to block.

use super::bounds;
use super::code::{Code, Motion};
use super::word::{Fault, Word};

/// How many millimetres an inch has.
const INCH_MM: f64 = 25.4;

/// Which groups of modal words a program has set so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Stated(u32);

impl Stated {
    /// Whether a word of the group of this one was written.
    pub(crate) fn has(self, code: Code) -> bool {
        self.0 & (1 << code.group().0) != 0
    }
}

/// What stays in force from block to block.
#[derive(Debug, Clone)]
pub(crate) struct Modal {
    /// Kind of motion; none until the program says so, because a parameter of the control decides it.
    pub(crate) motion: Option<Motion>,
    /// The axis normal to the plane of arcs: 0, 1, 2 for X, Y, Z.
    pub(crate) plane_axis: usize,
    /// G20 rather than G21.
    pub(crate) inch: bool,
    /// G91 rather than G90.
    pub(crate) incremental: bool,
    /// 54 to 59.
    pub(crate) work_offset: u8,
    /// G61 rather than G64.
    pub(crate) exact_stop: bool,
    /// Feed in mm/s; 0 as long as there is none.
    pub(crate) feed_mm_s: f64,
    /// What the program has said; the rest is what holds before it says anything.
    pub(crate) stated: Stated,
}

impl Default for Modal {
    fn default() -> Self {
        Self {
            motion: None,
            plane_axis: 2,
            inch: false,
            incremental: false,
            work_offset: 54,
            exact_stop: false,
            feed_mm_s: 0.0,
            stated: Stated::default(),
        }
    }
}

impl Modal {
    /// Puts a G word in force.
    pub(crate) fn apply(&mut self, code: Code) {
        self.stated.0 |= 1 << code.group().0;
        match code {
            Code::Motion(motion) => self.motion = Some(motion),
            Code::Plane(axis) => self.plane_axis = axis,
            Code::Inch(inch) => {
                // Controls differ in what an old F means after a change of unit: it has to be said again.
                if inch != self.inch {
                    self.feed_mm_s = 0.0;
                }
                self.inch = inch;
            }
            Code::Incremental(incremental) => self.incremental = incremental,
            Code::WorkOffset(number) => self.work_offset = number,
            Code::ExactStopMode(on) => self.exact_stop = on,
            Code::Default(_)
            | Code::ExactStop
            | Code::Dwell
            | Code::MachineCoordinates
            | Code::Pole
            | Code::LookAhead(_) => {}
        }
    }

    /// Puts a feed in force: mm/min or inch/min, with or without a point.
    pub(crate) fn set_feed(&mut self, word: &Word) -> Result<(), Fault> {
        if word.value < 0.0 {
            return Err(Fault::word(word, format!("the feed {} is negative", word.value))
                .hint("F is a speed in mm/min or inch/min, never negative"));
        }
        let unit_mm = if self.inch { INCH_MM } else { 1.0 };
        let feed_mm_min = word.value * unit_mm;
        bounds::check_feed(word, feed_mm_min)?;
        self.feed_mm_s = feed_mm_min / 60.0;
        Ok(())
    }

    /// The length that a word of X, Y, Z, I, J, K or R stands for, mm: without a point it may count in increments.
    pub(crate) fn length_mm(&self, word: &Word, increments: bool) -> f64 {
        match (self.inch, word.point || !increments) {
            (false, true) => word.value,
            (false, false) => word.value / 1e3,
            (true, true) => word.value * INCH_MM,
            (true, false) => word.value / 1e4 * INCH_MM,
        }
    }
}
