//! `diagnose` of five runs, 42 000 samples, with a cyclic error in them; and what goes before.
//!
//! `cargo bench --bench diagnose`

#![allow(clippy::unwrap_used)]
#![allow(missing_docs)]

use std::path::Path;

use ballbar::diagnose::diagnose;
use ballbar::identify::{Campaign, Failure};
use ballbar::machine::Machine;
use ballbar::plan::Test;

fn main() {
    divan::main();
}

fn case() -> (Test, Machine) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/case-a/test.toml");
    let test = Test::read(&file).unwrap();
    let machine = test.machine().unwrap();
    (test, machine)
}

/// From the logs to the findings.
#[divan::bench(sample_count = 5)]
fn five_runs_identified_and_diagnosed() -> usize {
    let (test, machine) = case();
    let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
    diagnose(&test, &machine, &campaign).unwrap().findings.len()
}

/// The search alone.
#[divan::bench(sample_count = 5)]
fn five_runs_diagnosed(bencher: divan::Bencher<'_, '_>) {
    let (test, machine) = case();
    let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
    bencher.bench(|| diagnose(&test, &machine, &campaign).unwrap().findings.len());
}
