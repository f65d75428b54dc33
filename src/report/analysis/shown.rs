//! The identifications that tables and curves are made of.

use crate::diagnose::EffectsAt;
use crate::identify::{Identification, IdentifiedRun};

/// The repeats of a test as they are shown.
#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    /// With what was found.
    pub repeats: &'a [Identification],
    /// The same without it, drawn in grey; none where nothing was found.
    pub before: &'a [Identification],
    /// What each finding does to each reading, repeat after repeat; none where nothing was found.
    pub effects: &'a [Vec<EffectsAt>],
}

impl<'a> Shown<'a> {
    /// Repeats in which nothing was found.
    pub fn alone(repeats: &'a [Identification]) -> Self {
        Self { repeats, before: &[], effects: &[] }
    }

    /// Every run with the same as it was without what was found.
    pub fn runs(self) -> impl Iterator<Item = (&'a IdentifiedRun, Option<&'a IdentifiedRun>)> {
        let before = self.before.iter().flat_map(|repeat| &repeat.runs).map(Some);
        let runs = self.repeats.iter().flat_map(|repeat| &repeat.runs);
        runs.zip(before.chain(std::iter::repeat(None)))
    }
}
