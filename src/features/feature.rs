//! A feature of a plane.

use crate::machine::Axis;

/// What it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Squareness of the axes of the plane.
    Squareness(Axis, Axis),
    /// Scale of the first less that of the second, over the diameter.
    ScaleMismatch(Axis, Axis),
    /// Backlash of an axis.
    Backlash(Axis),
    /// Lateral play of an axis in the direction of another.
    LateralPlay(Axis, Axis),
    /// Straightness of an axis in the direction of another.
    Straightness(Axis, Axis),
    /// Positioning error of an axis without its scale.
    Positioning(Axis),
    /// Rotation of an axis about another.
    Angle(Axis, Axis),
    /// Step of that rotation from negative to positive motion.
    AngularReversal(Axis, Axis),
    /// By how much the first axis follows later than the second.
    ServoMismatch(Axis, Axis),
    /// A finding of the diagnosis, by its index.
    Found(usize),
}

/// As tolerances are judged: with one deviation a third of all features that are none would be told.
const EXPANDED: f64 = 2.0;

/// A feature with what repairing it would gain.
#[derive(Debug, Clone, PartialEq)]
pub struct Feature {
    /// What it is.
    pub kind: Kind,
    /// Its value, in its unit.
    pub value: f64,
    /// Standard deviation by the noise.
    pub noise: Option<f64>,
    /// Standard deviation by the noise and by what these runs cannot tell from other plausible faults.
    pub all: Option<f64>,
    /// Unit of value and uncertainties: `um`, `um/m`, `urad`, `ms`.
    pub unit: &'static str,
    /// Values at the positive and the negative end of the axis, in that unit.
    pub at_ends: Option<[f64; 2]>,
    /// Of a curve, how far its middle lies from between its ends, mm.
    pub sag_mm: Option<f64>,
    /// What Ballbar 20 ranks it by, mm; `None` of what it does not know.
    pub size_mm: Option<f64>,
    /// That as a share of the sum of all.
    pub share: Option<f64>,
    /// By how much G(b) falls without it, of one way G, mm.
    pub fall_mm: f64,
    /// Standard deviation of that by the noise of the value, mm.
    pub fall_noise_mm: Option<f64>,
    /// Standard deviation of that by all that is not known of the value, mm.
    pub fall_all_mm: Option<f64>,
    /// By how much the volumetric error falls without it, mm rms over the sphere that was measured; `None` where not all axes
    /// moved, or where it displaces nothing that stands still.
    pub volumetric_fall_mm: Option<f64>,
    /// What is left once it and those before it in the order of repair are gone; `None` of what is not told apart from 0.
    pub then: Option<Left>,
}

/// What is left without several features.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Left {
    /// Of G(b), of one way of G, mm.
    pub deviation_mm: f64,
    /// Of the volumetric error, mm rms; `None` where not all axes moved.
    pub volumetric_mm: Option<f64>,
}

impl Feature {
    /// A value with its uncertainties in a unit, and nothing else yet.
    pub(super) fn of(
        kind: Kind,
        unit: &'static str,
        value: f64,
        [noise, all]: [Option<f64>; 2],
    ) -> Self {
        Self {
            kind,
            value: value + 0.0,
            noise,
            all,
            unit,
            at_ends: None,
            sag_mm: None,
            size_mm: None,
            share: None,
            fall_mm: 0.0,
            fall_noise_mm: None,
            fall_all_mm: None,
            volumetric_fall_mm: None,
            then: None,
        }
    }

    /// All that is not known of the value, in its unit.
    pub fn uncertainty(&self) -> Option<f64> {
        self.all.or(self.noise)
    }

    /// Whether it is larger than its expanded uncertainty.
    pub fn is_told(&self) -> bool {
        self.value.abs() > EXPANDED * self.uncertainty().unwrap_or(0.0)
    }
}
