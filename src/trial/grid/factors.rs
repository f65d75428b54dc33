//! What a campaign of the grid is like: one value of every factor.

use crate::simulate::Noise;
use crate::trial::chance::Chance;

/// What is driven.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Driven {
    /// The XY plane, G03 and G02.
    Plane,
    /// Three planes, a program each.
    Planes,
    /// 3D6.
    Sphere,
    /// 3D6 in two mountings.
    TwoPlaces,
}

/// On what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Make {
    /// Horizontal, the zero in the middle of the travel.
    Hu40t,
    /// Vertical, X and Y under the workpiece, the zero at the end of travel.
    Vertical,
}

/// How the control drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Driving {
    /// As planned.
    Planned,
    /// The acceleration builds up in this time, s.
    Bell(f64),
    /// The accelerations are this factor of what the machine file says.
    Acceleration(f64),
    /// Standstills take up to this longer, s.
    Standing(f64),
    /// All slides follow with a lag, time constant in s.
    FollowingAlike(f64),
    /// One of them, by its index, with another one.
    FollowingUnlike(f64, usize, f64),
}

/// One value of every factor, with the numbers that are drawn within them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Factors {
    pub(super) rate_hz: f64,
    pub(super) driven: Driven,
    pub(super) make: Make,
    pub(super) driving: Driving,
    /// Repeats of the test.
    pub(super) repeats: usize,
    pub(super) noise: Noise,
    pub(super) resolution_mm: f64,
    /// Real feed over that of the program.
    pub(super) feed_override: f64,
    /// Feeds of the repeats in turn, mm/min.
    pub(super) feeds_mm_min: [f64; 2],
    /// Length of the bar, mm.
    pub(super) bar_mm: f64,
}

/// Rates of readings, one a second.
const RATES_HZ: [f64; 4] = [10.0, 50.0, 250.0, 1000.0];
/// Feeds, mm/min.
const FEEDS_MM_MIN: [f64; 2] = [500.0, 3000.0];
/// Logs have at most some so many readings a run: what takes longer is driven faster.
const READINGS: f64 = 150e3;
/// Length of the path of 3D6 in radii: an equator and five half meridians, there and back.
const RADII_OF_SPHERE: f64 = 44.0;
/// Noise of a reading, mm.
const NOISE_MM: [f64; 2] = [0.05e-3, 1e-3];
/// What is more is a loud instrument, mm: the middle of the limits in the logarithm.
const LOUD_MM: f64 = 0.224e-3;

impl Factors {
    pub(super) fn drawn(chance: &mut Chance) -> Self {
        let rate_hz = chance.one_of(&RATES_HZ);
        let driven =
            chance.one_of(&[Driven::Plane, Driven::Planes, Driven::Sphere, Driven::TwoPlaces]);
        let make = chance.one_of(&[Make::Hu40t, Make::Vertical]);
        let lag_s = |chance: &mut Chance| chance.between([1e-3, 30e-3]);
        let driving = match chance.below(6) {
            0 => Driving::Planned,
            1 => Driving::Bell(chance.between([10e-3, 150e-3])),
            2 => Driving::Acceleration(chance.one_of(&[0.5, 2.0])),
            3 => Driving::Standing(chance.between([1e-3, 100e-3])),
            4 => Driving::FollowingAlike(lag_s(chance)),
            _ => {
                let (common_s, axis) = (lag_s(chance), chance.below(3));
                Driving::FollowingUnlike(common_s, axis, common_s * chance.between([0.9, 1.1]))
            }
        };
        let repeats = chance.one_of(&[1, 2, 5]);
        let size_mm = chance.log_between(NOISE_MM);
        let noise = match chance.below(3) {
            0 => Noise { white_mm: size_mm, ..Noise::OFF },
            1 => {
                let angle_rad = chance.between([0.2, 1.4]);
                Noise {
                    white_mm: size_mm * angle_rad.cos(),
                    correlated_mm: size_mm * angle_rad.sin(),
                    correlation_s: chance.log_between([0.05, 0.5]),
                }
            }
            _ => Noise { white_mm: 0.0, correlated_mm: size_mm, correlation_s: 1.0 },
        };
        let bar_mm = chance.one_of(&[100.0, 150.0]);
        let slowest_mm_min = RADII_OF_SPHERE * bar_mm * 60.0 * rate_hz / READINGS;
        let limits = [slowest_mm_min.clamp(FEEDS_MM_MIN[0], FEEDS_MM_MIN[1]), FEEDS_MM_MIN[1]];
        let feed = |chance: &mut Chance| (chance.log_between(limits) / 50.0).round() * 50.0;
        let first_mm_min = feed(chance);
        let second_mm_min = if chance.below(2) == 0 { first_mm_min } else { feed(chance) };
        Self {
            rate_hz,
            driven,
            make,
            driving,
            repeats,
            noise,
            resolution_mm: chance.one_of(&[0.1e-3, 1e-3]),
            feed_override: if chance.below(2) == 0 { 1.0 } else { chance.between([0.95, 1.05]) },
            feeds_mm_min: [first_mm_min, second_mm_min],
            bar_mm,
        }
    }

    /// Standard deviation of a reading, mm.
    pub(super) fn noise_mm(&self) -> f64 {
        self.noise.sigma_mm().hypot(self.resolution_mm / 12f64.sqrt())
    }

    /// Whether the feed really is that of the program.
    pub(super) fn feed_is_stated(&self) -> bool {
        self.feed_override.total_cmp(&1.0).is_eq()
    }

    /// The value of every factor.
    pub(super) fn strata(&self) -> Vec<(&'static str, String)> {
        let driven = match self.driven {
            Driven::Plane => "XY plane",
            Driven::Planes => "three planes",
            Driven::Sphere => "3D6",
            Driven::TwoPlaces => "3D6 at two places",
        };
        let make = match self.make {
            Make::Hu40t => "HU40-T",
            Make::Vertical => "vertical, zero at the end",
        };
        let driving = match self.driving {
            Driving::Planned => "as planned",
            Driving::Bell(_) => "bell-shaped",
            Driving::Acceleration(_) => "other acceleration",
            Driving::Standing(_) => "longer standstills",
            Driving::FollowingAlike(_) => "following alike",
            Driving::FollowingUnlike(..) => "following unlike",
        };
        let colour = match (self.noise.white_mm > 0.0, self.noise.correlated_mm > 0.0) {
            (true, false) => "white",
            (true, true) => "mixed",
            _ => "correlated over 1 s",
        };
        let loud = if self.noise.sigma_mm() > LOUD_MM { "above 0.22 um" } else { "up to 0.22 um" };
        let feed = if self.feed_is_stated() { "as stated" } else { "up to 5 % other" };
        let mut strata = vec![
            ("readings a second", format!("{}", self.rate_hz)),
            ("test", driven.to_owned()),
            ("machine", make.to_owned()),
            ("motion", driving.to_owned()),
            ("runs", self.repeats.to_string()),
            ("noise", colour.to_owned()),
            ("noise of a reading", loud.to_owned()),
            ("resolution", format!("{} um", 1e3 * self.resolution_mm)),
            ("feed", feed.to_owned()),
        ];
        // What one run does not tell of its noise hangs on the test.
        if self.repeats == 1 {
            strata.push(("one run of", driven.to_owned()));
        }
        strata
    }
}
