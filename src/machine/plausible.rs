//! What is plausible for a machine that does its work: how large its errors are before anything was measured.
//!
//! These are standard deviations of normal priors. They do not say how good a machine is, but beyond what nobody
//! would believe without looking twice: a fit that has nothing else to go by stays within them, and what comes out
//! beyond three of them is told.

/// Standard deviations of what a machine's errors plausibly are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plausible {
    /// Scale and squareness, mm/mm. A scale without compensation in a workshop that is 10 K off is 120 um/m out, an
    /// axis that was set with an indicator and a bad square some 100 um/m.
    pub slope: f64,
    /// Straightness, and the positioning error without its scale, over 100 mm either way, mm.
    pub way_mm: f64,
    /// Half of a reversal error or of a lateral play, mm: an axis with a worn nut.
    pub reversal_mm: f64,
    /// Angle by which a slide turns from the middle of a test to its end, rad.
    pub turn_rad: f64,
    /// Angle by which it bends on the way, rad.
    pub bend_rad: f64,
    /// Half of the angle by which it tips over at a reversal, rad.
    pub tip_rad: f64,
    /// Place of a ball, mm: set by hand with the balls brought together.
    pub set_up_mm: f64,
}

impl Default for Plausible {
    fn default() -> Self {
        Self {
            slope: 200e-6,
            way_mm: 5e-3,
            reversal_mm: 20e-3,
            turn_rad: 50e-6,
            bend_rad: 20e-6,
            tip_rad: 10e-6,
            set_up_mm: 0.1,
        }
    }
}
