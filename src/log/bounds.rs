//! What no log of a ball-bar goes beyond.

/// No telescoping ball-bar reaches further than a few mm; beyond this the unit is wrong.
pub(super) const LARGEST_DEVIATION_MM: f64 = 10.0;
/// Readings of a log: more than half an hour at 2000 a second, or a night at 100; what is made of them takes a hundred
/// times their memory.
pub(super) const MOST_READINGS: usize = 4_000_000;
/// No clock has gone for longer, s: three hundred years, whichever day its times count from.
pub(super) const LATEST_S: f64 = 1e10;
/// A bar that reads so many times its range is none: ranges are stated by eye.
pub(super) const BEYOND: f64 = 2.0;
