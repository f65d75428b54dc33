//! One pass over an arc: what is measured, and what is driven before and after it.

use super::arc::Arc;

/// How an arc is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// G02 and G03 where it lies in a coordinate plane, chords where it does not.
    Arcs,
    /// Chords of G01.
    Chords,
}

impl Interpolation {
    /// All.
    pub const ALL: [Self; 2] = [Self::Arcs, Self::Chords];

    /// Its name in a test file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Arcs => "arcs",
            Self::Chords => "chords",
        }
    }
}

/// Ends the comment of what is driven before a data arc and after it: who reads the program knows by it what is data.
pub const OVERSHOOT: &str = "OVERSHOOT";

/// One pass over an arc in one direction, from standstill to standstill.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// The data arc: that part which is measured for its own sake. Of a transit all of it.
    pub arc: Arc,
    /// Angle that is driven on the same circle before the data arc, and as much after it, rad.
    pub overshoot_rad: f64,
    /// Its feed, mm/s.
    pub feed_mm_s: f64,
    /// A way to the next arc rather than an arc.
    pub transit: bool,
}

impl Leg {
    /// All that is driven.
    pub fn driven(&self) -> Arc {
        self.arc.beyond(self.overshoot_rad)
    }

    /// What is driven, in order: overshoot, data arc, overshoot, each beginning where the last one ends; or the data arc alone.
    pub fn pieces(&self) -> Vec<Arc> {
        let whole = self.driven();
        let overshoot_rad = self.overshoot_rad.copysign(self.arc.sweep_rad);
        if self.overshoot_rad <= 0.0 {
            return vec![whole];
        }
        let name = format!("{} {OVERSHOOT}", self.arc.name);
        let overshoot =
            |start| Arc { name: name.clone(), start, sweep_rad: overshoot_rad, ..self.arc.clone() };
        vec![overshoot(whole.start), self.arc.clone(), overshoot(self.arc.at(1.0))]
    }
}
