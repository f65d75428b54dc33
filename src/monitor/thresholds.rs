//! Every number that decides in this room.

/// So many comparisons with nothing changed may say that something has.
pub(super) const BY_CHANCE: f64 = 0.01;
/// A change is told apart from what may have changed with it beyond this many standard deviations: 95 %.
pub(super) const APART: f64 = 2.0;
/// A test tells most of what it tells more than this share of, of what was plausible.
pub(super) const TOLD: f64 = 0.5;
/// Set up again, a ball stands within this share of the bar's length of where it was; errors as smooth as those of slides
/// change by as little of themselves.
pub(super) const SAME_PLACE: f64 = 0.05;
/// Balls brought together by hand stand within this of where a test takes them to be, standard deviation, mm: the default of what
/// is plausible for a set-up.
pub(super) const SET_UP_MM: f64 = 0.1;
/// Nominal lengths, diameters, angles and feeds that differ by less than this share are the same.
pub(super) const SAME_NOMINAL: f64 = 1e-3;
/// A trend needs more tests than its line has numbers, and one more to see them scatter.
pub(super) const LEAST_POINTS: usize = 3;
