//! What is plausible for a machine that does its work: how large its errors are before anything was measured.
//!
//! These are standard deviations of normal priors. They do not say how good a machine is, but beyond what nobody
//! would believe without looking twice: a fit that has nothing else to go by stays within them, and what comes out
//! beyond three of them is told.

use serde::Deserialize;
use toml::Spanned;

use crate::error::Result;
use crate::toml_text::Text;

/// Standard deviations of what a machine's errors plausibly are: `[plausible]` of a machine file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plausible {
    /// Scale and squareness, mm/mm. A scale without compensation in a workshop that is 10 K off is 120 um/m out, an
    /// axis that was set with an indicator and a bad square some 100 um/m.
    pub slope: f64,
    /// Straightness, and the positioning error without its scale, over 100 mm either way, mm.
    pub way_mm: f64,
    /// Half of a reversal error or of a lateral play, mm: an axis with a worn nut.
    pub reversal_mm: f64,
    /// Angle by which a slide turns from the middle of a test to its end, 100 mm away, rad.
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

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPlausible {
    slope_um_m: Option<Spanned<f64>>,
    way_um: Option<Spanned<f64>>,
    reversal_um: Option<Spanned<f64>>,
    turn_urad: Option<Spanned<f64>>,
    bend_urad: Option<Spanned<f64>>,
    tip_urad: Option<Spanned<f64>>,
    set_up_um: Option<Spanned<f64>>,
}

impl RawPlausible {
    pub(super) fn check(self, text: &Text<'_>) -> Result<Plausible> {
        let usual = Plausible::default();
        // Between nothing at all and what no machine that moves has: a tenth of a millimetre a metre is 100.
        let of = |written: &Option<Spanned<f64>>, key: &str, unit: f64, otherwise: f64| {
            written
                .as_ref()
                .map_or(Ok(otherwise), |written| Ok(text.within(written, key, 1e-3, 1e5)? * unit))
        };
        Ok(Plausible {
            slope: of(&self.slope_um_m, "slope_um_m", 1e-6, usual.slope)?,
            way_mm: of(&self.way_um, "way_um", 1e-3, usual.way_mm)?,
            reversal_mm: of(&self.reversal_um, "reversal_um", 1e-3, usual.reversal_mm)?,
            turn_rad: of(&self.turn_urad, "turn_urad", 1e-6, usual.turn_rad)?,
            bend_rad: of(&self.bend_urad, "bend_urad", 1e-6, usual.bend_rad)?,
            tip_rad: of(&self.tip_urad, "tip_urad", 1e-6, usual.tip_rad)?,
            set_up_mm: of(&self.set_up_um, "set_up_um", 1e-3, usual.set_up_mm)?,
        })
    }
}
