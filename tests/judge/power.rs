//! What is in force before the program says anything.

use std::collections::BTreeSet;

/// What a path can depend on without having stated it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Unstated {
    /// G20, G21.
    Unit,
    /// G90, G91.
    Distance,
    /// G54 to G59: which of them.
    Offset,
    /// G93 to G95.
    Feed,
    /// G00 to G03, or a fixed cycle.
    Motion,
    /// G17 to G19, of an arc.
    Plane,
    /// G41 to G44 and the fixed cycles: G40, G49, G80.
    Cutter,
    Length,
    Cycle,
    /// G68, G16, G51: options of a Fanuc; cycles 10 and 11 of a TNC.
    Rotation,
    Polar,
    Scaling,
    /// TRANS of a Siemens, cycle 7 of a TNC.
    Shift,
    /// TRAORI of a Siemens.
    Transformation,
    /// Cycle 8 of a TNC.
    Mirror,
    /// A parameter of a Fanuc: X10 is 10 um or 10 mm.
    Point,
    /// What another work offset than that of the test holds.
    OtherOffset,
}

impl Unstated {
    /// Only some controls can do it, and some refuse the word that ends it: its lack is a warning.
    pub(crate) fn is_option(self) -> bool {
        matches!(
            self,
            Self::Rotation
                | Self::Polar
                | Self::Scaling
                | Self::Shift
                | Self::Transformation
                | Self::Mirror
        )
    }
}

/// The groups in which somebody left something else than a program of a ball-bar test needs. Empty: all as it needs.
#[derive(Debug, Clone, Default)]
pub(crate) struct PowerOn(pub(crate) BTreeSet<Unstated>);

impl PowerOn {
    /// One of them is left otherwise.
    pub(crate) fn with(left: Unstated) -> Self {
        Self(BTreeSet::from([left]))
    }

    pub(crate) fn has(&self, group: Unstated) -> bool {
        self.0.contains(&group)
    }
}
