//! What a slide can do: numbers beyond are slips of the pen.

/// Speeds of a slide, mm/min: a hand wheel creeps faster than the lowest, linear motors reach a quarter of the highest.
pub(super) const SPEEDS_MM_MIN: [f64; 2] = [1.0, 1e6];
/// Accelerations of a slide and along the path, mm/s²: the lowest takes minutes to come up to speed, the highest is a
/// hundred times that of free fall, and linear motors reach a tenth of it.
pub(super) const ACCELERATIONS_MM_S2: [f64; 2] = [1.0, 1e6];
/// Leads of screws, mm, and of the pinions that stand for them: a turn of a pinion of 300 mm is a metre.
pub(super) const PITCHES_MM: [f64; 2] = [0.1, 1000.0];
