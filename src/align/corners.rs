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
    pub fn of<'a>(runs: impl Iterator<Item = &'a Alignment>) -> Option<Self> {
        let points: Vec<[f64; 3]> = runs.filter_map(point).collect();
        let sum = |of: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(of).sum::<f64>();
        let weight = |[_, _, sigma]: &[f64; 3]| sigma.powi(-2);
        let all = sum(&weight);
        let mean = |k: usize| sum(&|point| weight(point) * point[k]) / all;
        let [middle, constant] = [mean(0), mean(1)];
        let spread = sum(&|point| weight(point) * (point[0] - middle).powi(2));
        let rises =
            sum(&|point| weight(point) * (point[0] - middle) * (point[1] - constant)) / spread;
        (rises * spread.sqrt() > TOLD && rises.is_finite()).then_some(Self { squared: rises })
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
