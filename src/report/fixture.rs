//! Results of the logs under `tests/data`, for the tests of this room.

use std::path::PathBuf;
use std::sync::LazyLock;

use super::{Analysis, Shown};
use crate::diagnose::{EffectsAt, diagnose};
use crate::identify::{Campaign, Failure, Identification};
use crate::machine::Machine;
use crate::plan::Test;

/// A test that was aligned and identified.
pub(super) struct Identified {
    pub(super) analysis: Analysis,
    pub(super) identifications: Vec<Identification>,
    /// The same without what was found.
    pub(super) before: Vec<Identification>,
    /// What each finding does to each reading.
    pub(super) effects: Vec<Vec<EffectsAt>>,
}

impl Identified {
    /// What curves are made of.
    pub(super) fn shown(&self) -> Shown<'_> {
        Shown { repeats: &self.identifications, before: &self.before, effects: &self.effects }
    }
}

/// The results of a set of `tests/data`, worked out once for all tests.
pub(super) fn identified(set: &str) -> &'static Identified {
    static CONTINUOUS: LazyLock<Identified> = LazyLock::new(|| work_out("hu40t"));
    static STOPS: LazyLock<Identified> = LazyLock::new(|| work_out("hu40t-stops"));
    static PLANAR: LazyLock<Identified> = LazyLock::new(|| work_out("planar"));
    match set {
        "hu40t" => &CONTINUOUS,
        "hu40t-stops" => &STOPS,
        _ => &PLANAR,
    }
}

/// What the model gets wrong on a set of `tests/data`, worked out once for all tests.
#[allow(clippy::unwrap_used)]
pub(super) fn diagnosed() -> &'static Identified {
    static CASE: LazyLock<Identified> = LazyLock::new(|| {
        let (test, machine, campaign) = campaign("case-a");
        let diagnosis = diagnose(&test, &machine, &campaign).unwrap();
        let analysis = Analysis::diagnosed(&test, &machine, &campaign, &diagnosis);
        let extended = diagnosis.extended.unwrap().campaign.repeats;
        let effects = diagnosis.effects;
        Identified { analysis, identifications: extended, before: campaign.repeats, effects }
    });
    &CASE
}

/// Aligns and identifies a set of `tests/data`.
pub(super) fn work_out(set: &str) -> Identified {
    let (test, machine, campaign) = campaign(set);
    let analysis = Analysis::new(&test, &machine, &campaign);
    Identified {
        analysis,
        identifications: campaign.repeats,
        before: Vec::new(),
        effects: Vec::new(),
    }
}

#[allow(clippy::unwrap_used)]
fn campaign(set: &str) -> (Test, Machine, Campaign) {
    // Relative, as `cargo test` runs in the package's folder: results must not depend on where that is.
    let test = Test::read(&PathBuf::from(format!("tests/data/{set}/test.toml"))).unwrap();
    let machine = test.machine().unwrap();
    let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
    (test, machine, campaign)
}
