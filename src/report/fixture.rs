//! Results of the logs under `tests/data`, for the tests of this room.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::LazyLock;

use super::{Analysis, DiagnosisFacts};
use crate::diagnose::diagnose;
use crate::identify::{Campaign, Failure, Identification, Options, RunInput, identify};
use crate::plan::{Run, Test};
use crate::{align, log, model, nc};

/// A test that was aligned and identified.
pub(super) struct Identified {
    pub(super) analysis: Analysis,
    pub(super) identifications: Vec<Identification>,
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
        let test = Test::read(&PathBuf::from("tests/data/case-a/test.toml")).unwrap();
        let machine = test.machine().unwrap();
        let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
        let diagnosis = diagnose(&test, &machine, &campaign).unwrap();
        let mut analysis = Analysis::new(&test, &machine, &campaign.repeats);
        let facts = DiagnosisFacts::new(&machine, &campaign.repeats, &diagnosis);
        analysis.diagnosis = Some(facts);
        Identified { analysis, identifications: campaign.repeats }
    });
    &CASE
}

/// Aligns and identifies a set of `tests/data`.
#[allow(clippy::unwrap_used)]
pub(super) fn work_out(set: &str) -> Identified {
    // Relative, as `cargo test` runs in the package's folder: results must not depend on where that is.
    let test = Test::read(&PathBuf::from(format!("tests/data/{set}/test.toml"))).unwrap();
    let machine = test.machine().unwrap();
    let mountings: Vec<_> = test.mountings().iter().map(|named| named.mounting).collect();
    let names: Vec<String> = test.mountings().iter().map(|named| named.name.clone()).collect();
    let mut repeats: BTreeMap<u32, Vec<&Run>> = BTreeMap::new();
    for run in test.runs().unwrap() {
        repeats.entry(run.repeat).or_default().push(run);
    }
    let mut reading = nc::Reading::default();
    for named in test.mountings() {
        reading.work_offsets_mm.insert(named.work_offset, named.mounting.coincidence_mm);
    }
    let options = Options {
        noise_mm: test.ball_bar().noise_mm,
        clock_tolerance: test.ball_bar().clock_tolerance,
        loss: test.estimation().loss,
        minimum_norm: test.estimation().minimum_norm,
    };
    let terms = || model::terms(&test.estimation().terms, &names).unwrap();
    let model = model::Model::new(&machine, mountings.clone(), terms());
    let identifications: Vec<Identification> = repeats
        .values()
        .map(|runs| {
            let inputs = runs
                .iter()
                .map(|run| RunInput {
                    name: run.name.clone(),
                    mounting: run.mounting,
                    nominal_mm: test.bar_of(run.mounting).length_mm,
                    alignment: align::align(&align::Run {
                        log: &log::read(&run.log, &test.log_format_of(run.mounting)).unwrap(),
                        program: &nc::read_file(&run.program, &reading).unwrap(),
                        rig: align::Rig {
                            machine: &machine,
                            mounting: &mountings[run.mounting],
                            bar: &test.bar_of(run.mounting),
                        },
                        feed_override: run.feed_override,
                    })
                    .unwrap(),
                })
                .collect();
            identify(&model, inputs, &options).unwrap()
        })
        .collect();
    Identified { analysis: Analysis::new(&test, &machine, &identifications), identifications }
}
