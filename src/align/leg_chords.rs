//! What the chords of a leg tell of its time.

/// A leg whose chords are not told counts by its mean over so many standard deviations of its time.
const PLAUSIBLE: f64 = 4.0;
/// And over so many chords at the most.
const MOST_CHORDS: f64 = 1000.0;

/// The chords of a leg, and whether they are told.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[expect(clippy::struct_field_names, reason = "every f64 says its unit")]
pub struct LegChords {
    /// How long a chord takes, s; 0 of a leg without any.
    pub lasts_s: f64,
    /// Over how long the path of the leg counts in its mean, s: where its time does not tell its chords; else 0.
    pub blur_s: f64,
    /// What chords and reversals tell of the offset where no single chord is told, and the standard deviation of that, s.
    pub told_s: Option<[f64; 2]>,
    /// Standard deviation that the offset has besides, because chords that look alike could be taken for each other, s.
    pub ambiguity_s: f64,
}

impl LegChords {
    /// Of a leg whose chords take so long, s.
    pub(super) fn that_last(lasts_s: f64) -> Self {
        Self { lasts_s, ..Self::default() }
    }

    /// Whether its arcs are made of chords.
    pub fn there_are(&self) -> bool {
        self.lasts_s > 0.0
    }

    /// Each chord counts from now on where it is.
    pub fn see(&mut self) {
        (self.blur_s, self.told_s) = (0.0, None);
    }

    /// No chord is told of an offset with this standard deviation, s, but what all of them tell of it: the path counts in its mean over
    /// a whole number of chords, and as long as the times of readings are uncertain.
    pub fn blur(&mut self, sigma_s: f64, told_s: Option<[f64; 2]>) {
        if self.there_are() {
            let chords = (PLAUSIBLE * sigma_s / self.lasts_s).clamp(1.0, MOST_CHORDS).ceil();
            self.blur_s = self.lasts_s * chords;
        }
        (self.told_s, self.ambiguity_s) = (told_s, 0.0);
    }

    /// By what an offset with this standard deviation would be less without what chords and reversals told of it, and its
    /// standard deviation then, s.
    pub fn untold_s(&self, offset_s: f64, sigma_s: f64) -> [f64; 2] {
        let Some([told_s, told_sigma_s]) = self.told_s else { return [0.0, sigma_s] };
        let told = told_sigma_s.powi(2).recip();
        // What is told is less than all that is known; rounding could make it more.
        let others = (sigma_s.powi(2).recip() - told).max(1e-6 * told);
        [(told_s - offset_s) * told / others, others.recip().sqrt()]
    }
}
