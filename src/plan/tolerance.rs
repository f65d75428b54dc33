//! What a machine must keep: limits that results are judged by.

use serde::Deserialize;
use toml::Spanned;

use crate::error::Result;
use crate::toml_text::Text;

/// Limits; each where one is stated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tolerance {
    /// Of the circular deviation G of each way, mm.
    pub circular_mm: Option<f64>,
    /// Of the bi-directional circular deviation G(b), mm.
    pub bidirectional_mm: Option<f64>,
    /// Of the radial deviation F either way, mm.
    pub radial_mm: Option<f64>,
    /// Of squarenesses, rad.
    pub squareness_rad: Option<f64>,
    /// Of reversals, mm.
    pub reversal_mm: Option<f64>,
    /// Of scales, as a share of 1.
    pub scale: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawTolerance {
    circular_deviation_um: Option<Spanned<f64>>,
    bidirectional_circular_deviation_um: Option<Spanned<f64>>,
    radial_deviation_um: Option<Spanned<f64>>,
    squareness_um_m: Option<Spanned<f64>>,
    reversal_um: Option<Spanned<f64>>,
    scale_um_m: Option<Spanned<f64>>,
}

/// Limits, um and um/m: from less than any bar tells to a machine that nobody tests.
const LIMITS: [f64; 2] = [0.01, 1e4];

impl RawTolerance {
    pub(super) fn check(&self, text: &Text<'_>) -> Result<Tolerance> {
        let limit = |value: &Option<Spanned<f64>>, key: &str, unit: f64| {
            let value = value.as_ref().map(|value| text.within(value, key, LIMITS[0], LIMITS[1]));
            value.transpose().map(|value| value.map(|value| value * unit))
        };
        let bidirectional = "bidirectional_circular_deviation_um";
        Ok(Tolerance {
            circular_mm: limit(&self.circular_deviation_um, "circular_deviation_um", 1e-3)?,
            bidirectional_mm: limit(
                &self.bidirectional_circular_deviation_um,
                bidirectional,
                1e-3,
            )?,
            radial_mm: limit(&self.radial_deviation_um, "radial_deviation_um", 1e-3)?,
            squareness_rad: limit(&self.squareness_um_m, "squareness_um_m", 1e-6)?,
            reversal_mm: limit(&self.reversal_um, "reversal_um", 1e-3)?,
            scale: limit(&self.scale_um_m, "scale_um_m", 1e-6)?,
        })
    }
}
