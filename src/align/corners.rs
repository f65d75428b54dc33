//! What a control rounds the corners of chords by, told from the lag of its slides.
//!
//! A planner that brakes for one chord while it speeds up for the next goes round the corner in `v / a`: its path is the mean of
//! the chords over that while, and a mean over `B` smooths as much as a lag of the first order of `B / √12`. One feed therefore shows
//!
//! `T² = T_s² + v² / (12 a²)`
//!
//! and does not tell its parts; runs at two feeds do, because the lag `T_s` of slides is the same in both.

use super::samples::Alignment;

/// Corners of chords, rounded with an acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corners {
    /// `1 / (12 a²)`, s⁴/mm².
    squared: f64,
}

/// So many of its standard deviations tell that corners are rounded.
const TOLD: f64 = 3.0;

impl Corners {
    /// From runs of one machine; `None` where they do not tell it.
    ///
    /// A straight line of `T²` over `v²` by least squares. Where it would have slides lag by less than nothing at rest it goes
    /// through zero, and is told if it still says more than no slope does: runs at nearly one feed say nothing of it, however
    /// much their lags differ.
    pub fn of<'a>(runs: impl Iterator<Item = &'a Alignment>) -> Option<Self> {
        Self::through(&runs.filter_map(point).collect::<Vec<_>>())
    }

    fn through(points: &[[f64; 3]]) -> Option<Self> {
        let sum = |of: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(of).sum::<f64>();
        let weight = |[_, _, sigma]: &[f64; 3]| sigma.powi(-2);
        let all = sum(&weight);
        let mean = |k: usize| sum(&|point| weight(point) * point[k]) / all;
        let [middle, constant] = [mean(0), mean(1)];
        let spread = sum(&|point| weight(point) * (point[0] - middle).powi(2));
        let rises =
            sum(&|point| weight(point) * (point[0] - middle) * (point[1] - constant)) / spread;
        let at_rest = (constant - rises * middle).min(0.0);
        let lost = at_rest.powi(2) / (all.recip() + middle.powi(2) / spread);
        let told = rises > 0.0 && rises.powi(2) * spread - lost > TOLD * TOLD;
        let through_zero = sum(&|point| weight(point) * point[0] * point[1])
            / sum(&|point| weight(point) * point[0].powi(2));
        let squared = if at_rest < 0.0 { through_zero } else { rises };
        (told && squared.is_finite()).then_some(Self { squared })
    }

    /// The acceleration with which corners are rounded, mm/s².
    pub fn acceleration_mm_s2(&self) -> f64 {
        (12.0 * self.squared).sqrt().recip()
    }

    /// How long the control takes round a corner of the chords of this run, s; 0 where it has none.
    pub fn last_s(&self, run: &Alignment) -> f64 {
        if run.chord_sag_mm > 0.0 { speed_mm_s(run) / self.acceleration_mm_s2() } else { 0.0 }
    }

    /// The time constant of the slides alone, s.
    pub fn following_s(&self, run: &Alignment) -> f64 {
        let of_corners_s2 = self.last_s(run).powi(2) / 12.0;
        (run.time_map.following_s.powi(2) - of_corners_s2).max(0.0).sqrt()
    }
}

/// Square of the speed (mm²/s²), of the time constant (s²), and the standard deviation of that, of a run along chords.
fn point(run: &Alignment) -> Option<[f64; 3]> {
    let map = &run.time_map;
    let sigma_s2 = 2.0 * map.following_s * map.following_sigma_s;
    // Three standard deviations of the square are six of its root.
    let told = map.following_sigma_s > 0.0 && map.following_s > 6.0 * map.following_sigma_s;
    let told = told && run.chord_sag_mm > 0.0;
    told.then(|| [speed_mm_s(run).powi(2), map.following_s.powi(2), sigma_s2])
}

/// Speed along the arcs, mm/s.
fn speed_mm_s(run: &Alignment) -> f64 {
    let middle_s = run.sections.iter().map(|arc| 0.5 * (arc.start_s + arc.end_s));
    middle_s.map(|s| run.trajectory.at(s).velocity_mm_s.norm()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `v²` and `T²` of a lag of 8 ms and corners rounded with 500 mm/s², at so many mm/s, known to so much (s).
    fn at(speed_mm_s: f64, sigma_s: f64) -> [f64; 3] {
        let squared_s2 = 0.008_f64.powi(2) + speed_mm_s.powi(2) / (12.0 * 500.0_f64.powi(2));
        [speed_mm_s.powi(2), squared_s2, 2.0 * squared_s2.sqrt() * sigma_s]
    }

    #[test]
    fn two_feeds_tell_corners_from_slides() {
        let corners = Corners::through(&[at(20.0, 1e-4), at(60.0, 1e-4)]);
        let told_mm_s2 = corners.map(|corners| corners.acceleration_mm_s2());
        assert!(told_mm_s2.is_some_and(|told| (told - 500.0).abs() < 1e-6), "{told_mm_s2:?}");
    }

    /// Lags that differ by ten standard deviations at speeds that differ by a thousandth would be corners of 8 s.
    #[test]
    fn one_feed_does_not() {
        let [speed, squared_s2, sigma_s2] = at(30.03, 1e-5);
        assert_eq!(Corners::through(&[at(30.0, 1e-5), [speed, squared_s2 + 1e-6, sigma_s2]]), None);
        assert_eq!(Corners::through(&[at(30.0, 1e-5)]), None);
        assert_eq!(Corners::through(&[]), None);
    }
}
