//! The numbers that decide here.

use std::f64::consts::{FRAC_PI_2, TAU};

/// On a shorter arc centre and radius are no more than words: at a right angle a form of 1 um moves the centre by 10 um.
pub(super) const SHORTEST_RAD: f64 = FRAC_PI_2 - 0.01;
/// A circle is whole when no more than this is missing of a turn, rad: an overlap or a feed-in of some degrees.
pub(super) const WHOLE_RAD: f64 = TAU - 0.1;
/// Nor may more than this be without a reading, rad: 10 degrees, in which a form of up to ten waves hides half of its height.
pub(super) const WIDEST_GAP_RAD: f64 = 0.175;
/// Two ways are one test where their spans lie within this of each other, rad.
pub(super) const SAME_SPAN_RAD: f64 = 0.1;
/// And their feeds within this share: rounding of F.
pub(super) const SAME_FEED: f64 = 0.01;
/// A circle is a largest one where its height is below this share of the bar: as alignment tells them.
pub(super) const LARGEST: f64 = 0.01;
/// So few readings are no path.
pub(super) const FEWEST: usize = 24;
/// So often noise is drawn: the scatter of a value is then known to 10 %.
pub(super) const DRAWS: u64 = 50;
