//! Where a slide turns round, and when of a corner that is rounded out.

/// One slide turns round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    /// When, s of program time.
    pub(super) at_s: f64,
    /// Where, machine coordinate of the slide, mm.
    pub(super) at_mm: f64,
    /// Between which chords; `None` where it turns on an arc or from a standstill.
    pub(super) corner: Option<TurningCorner>,
}

/// Two chords, to the end of one of which a slide goes in one sense, and on from there in the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TurningCorner {
    /// Its speed on the first and on the second, of different signs, mm/s.
    pub(super) speeds_mm_s: [f64; 2],
    /// How long the shorter of the two lasts, s.
    pub(super) lasts_s: f64,
}

impl TurningCorner {
    /// By how much later the slide turns of which a share `r` of the corner is rounded out, s.
    ///
    /// Rounded out, a path is its mean over a chord `T`, whose speed goes evenly from `v` to `w` within `T` about the corner; with the
    /// corner's own step it is `v + r (w - v) (1/2 + t / T)` before it, and `w - r (w - v) (1/2 - t / T)` behind.
    pub(super) fn later_s(&self, share: f64) -> f64 {
        let Self { speeds_mm_s: [v, w], lasts_s } = *self;
        let share = share.clamp(0.0, 1.0);
        let changes_mm_s = share * (w - v);
        if changes_mm_s.abs() <= f64::EPSILON * v.abs().max(w.abs()) {
            return 0.0;
        }
        let sooner_s = lasts_s * (-v / changes_mm_s - 0.5);
        let later_s = lasts_s * (0.5 - w / changes_mm_s);
        sooner_s.min(0.0) + later_s.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the farthest place of the path itself: chords, and their mean over one of them.
    #[test]
    fn a_rounded_corner_turns_where_its_path_does() {
        let lasts_s = 0.052;
        for (v, w) in [(4.0, -4.0), (4.0, -0.5), (0.3, -5.0), (-3.0, 1.0), (-2.0, 1e-6)] {
            let corner = TurningCorner { speeds_mm_s: [v, w], lasts_s };
            let chords_mm = |s: f64| if s < 0.0 { v * s } else { w * s };
            let step_s = lasts_s / 2000.0;
            for share in [0.0, 0.3, 0.8, 1.0] {
                let path_mm = |s: f64| {
                    let window = (-1000..=1000).map(|k| chords_mm(s + f64::from(k) * step_s));
                    (1.0 - share) * chords_mm(s) + share * window.sum::<f64>() / 2001.0
                };
                let farthest = (-1000..=1000).map(|k| f64::from(k) * step_s).max_by(|a, b| {
                    (v.signum() * path_mm(*a)).total_cmp(&(v.signum() * path_mm(*b)))
                });
                let off_s = farthest.map_or(f64::NAN, |s| s - corner.later_s(share));
                assert!(off_s.abs() < 2.0 * step_s, "{v} {w} {share}: {off_s}");
            }
        }
    }
}
