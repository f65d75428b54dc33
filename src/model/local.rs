//! The names of the errors of a machine where it was measured, and how large they plausibly are.

use std::fmt;

use super::coefficient::Component;
use crate::machine::{Axis, Plausible};

/// The shape of a local error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LocalShape {
    /// Linear: a scale, a squareness, a turn.
    P1,
    /// A bow.
    P2,
    /// An S.
    P3,
    /// With the sense of the slide: a reversal.
    Sense,
}

impl LocalShape {
    /// P1, P2, P3, sense in this order.
    pub const ALL: [Self; 4] = [Self::P1, Self::P2, Self::P3, Self::Sense];
}

/// One local error of one slide, such as `TXY1` or `RBXb`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Local {
    /// The slide that errs.
    pub slide: Axis,
    /// Displacement along X, Y, Z, or rotation about them.
    pub component: Component,
    /// How it goes along the slide.
    pub shape: LocalShape,
}

impl Local {
    /// All 72, slide after slide.
    pub fn all() -> impl Iterator<Item = Self> {
        Axis::ALL.into_iter().flat_map(|slide| {
            Component::ALL.into_iter().flat_map(move |component| {
                LocalShape::ALL.into_iter().map(move |shape| Self { slide, component, shape })
            })
        })
    }

    /// Standard deviation of what it plausibly is, mm or rad, over a half range `reach_mm`.
    ///
    /// A slope is one of the whole machine, so that its end grows with the range. What bends is smooth: a bow of a
    /// way grows with the square of its length, an S with its cube, and angles by one less.
    pub fn plausible(&self, plausible: &Plausible, reach_mm: f64) -> f64 {
        let longer = reach_mm / 100.0;
        match (self.component.is_angular(), self.shape) {
            (false, LocalShape::P1) => plausible.slope * reach_mm,
            (false, LocalShape::P2) => plausible.way_mm * longer.powi(2),
            (false, LocalShape::P3) => plausible.way_mm * longer.powi(3),
            (false, LocalShape::Sense) => plausible.reversal_mm,
            (true, LocalShape::P1) => plausible.turn_rad * longer,
            (true, LocalShape::P2 | LocalShape::P3) => plausible.bend_rad * longer.powi(2),
            (true, LocalShape::Sense) => plausible.tip_rad,
        }
    }
}

impl fmt::Display for Local {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [function, shape] = [
            if self.component.is_angular() { 'R' } else { 'T' },
            ['1', '2', '3', 'b'][self.shape as usize],
        ];
        write!(f, "{function}{}{}{shape}", self.component.letter(), self.slide)
    }
}
