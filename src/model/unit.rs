//! Units in which numbers are written and read.

/// The unit in which a number is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// What the written name ends with, such as `mm_min`; empty where the name says it already.
    pub suffix: &'static str,
    /// As it is read, such as `mm/min`.
    pub symbol: &'static str,
    /// What a number in this unit is multiplied by to be in mm, s, rad.
    pub si: f64,
    /// The unit that it is in then.
    pub base: &'static str,
}

impl Unit {
    /// Micrometres.
    pub const UM: Self = Self::new("um", "um", 1e-3, "mm");
    /// Microradians.
    pub const URAD: Self = Self::new("urad", "urad", 1e-6, "rad");
    /// Micrometres in a metre.
    pub const UM_M: Self = Self::new("um_m", "um/m", 1e-6, "mm/mm");
    /// Microradians in a millimetre.
    pub const URAD_MM: Self = Self::new("urad_mm", "urad/mm", 1e-6, "rad/mm");
    /// Millimetres.
    pub const MM: Self = Self::new("mm", "mm", 1.0, "mm");
    /// Radians.
    pub const RAD: Self = Self::new("rad", "rad", 1.0, "rad");
    /// Milliseconds.
    pub const MS: Self = Self::new("ms", "ms", 1e-3, "s");
    /// Seconds.
    pub const S: Self = Self::new("s", "s", 1.0, "s");
    /// Turns in a second.
    pub const HZ: Self = Self::new("hz", "Hz", 1.0, "Hz");
    /// Millimetres in a minute.
    pub const MM_MIN: Self = Self::new("mm_min", "mm/min", 1.0 / 60.0, "mm/s");
    /// Parts of a hundred.
    pub const PERCENT: Self = Self::new("", "%", 1e-2, "1");
    /// Parts of a million.
    pub const PPM: Self = Self::new("", "ppm", 1e-6, "1");
    /// A plain number.
    pub const NONE: Self = Self::new("", "", 1.0, "1");

    const fn new(suffix: &'static str, symbol: &'static str, si: f64, base: &'static str) -> Self {
        Self { suffix, symbol, si, base }
    }
}
