//! The strategies of the paper's Table 2.

use std::f64::consts::PI;

use super::arc::Arc;

/// A named choice of arcs; every arc is driven forward and backward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// The three coordinate planes: equator and meridians 0 and 90.
    TwoD,
    /// The planes and two meridians at 45 degrees.
    ThreeD5,
    /// Equator and five meridians, 36 degrees apart.
    ThreeD6,
    /// Equator and nine meridians, 20 degrees apart.
    ThreeD10,
}

impl Strategy {
    /// All, in the paper's order.
    pub const ALL: [Self; 4] = [Self::TwoD, Self::ThreeD5, Self::ThreeD6, Self::ThreeD10];

    /// Its name in a test file.
    pub fn name(self) -> &'static str {
        match self {
            Self::TwoD => "2d",
            Self::ThreeD5 => "3d5",
            Self::ThreeD6 => "3d6",
            Self::ThreeD10 => "3d10",
        }
    }

    /// Reads a name.
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|strategy| strategy.name().eq_ignore_ascii_case(name))
    }

    /// Azimuths of its meridians, degrees.
    pub fn azimuths_deg(self) -> &'static [u32] {
        match self {
            Self::TwoD => &[0, 90],
            Self::ThreeD5 => &[0, 45, 90, 135],
            Self::ThreeD6 => &[0, 36, 72, 108, 144],
            Self::ThreeD10 => &[0, 20, 40, 60, 80, 100, 120, 140, 160],
        }
    }

    /// The arcs in forward sense: the equator, then the meridians.
    pub fn arcs(self) -> Vec<Arc> {
        let mut arcs = vec![Arc::equator("EQUATOR", 0.0, 2.0 * PI)];
        for &azimuth in self.azimuths_deg() {
            let name = format!("MERIDIAN {azimuth}");
            arcs.push(Arc::meridian(&name, f64::from(azimuth).to_radians(), 0.0, PI));
        }
        arcs
    }
}
