//! `analyse` of the five measured runs: time, and peak memory of the process.
//!
//! `cargo bench --bench analyse`

#![allow(clippy::unwrap_used, clippy::print_stdout)]
#![allow(missing_docs)]

use std::path::Path;

use ballbar::identify::{Campaign, Failure};
use ballbar::plan::Test;
use ballbar::report::{self, Analysis, Shown};

fn main() {
    divan::main();
    // The highest resident size that the process ever had, as Linux counts it.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    for line in status.lines().filter(|line| line.starts_with("VmHWM")) {
        println!("peak memory {}", line.trim_start_matches("VmHWM:").trim());
    }
}

/// From the test file to the bytes of report, JSON and samples.
#[divan::bench(sample_count = 20)]
fn five_runs_reports_included() -> usize {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/hu40t/test.toml");
    let test = Test::read(&file).unwrap();
    let machine = test.machine().unwrap();
    let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
    let repeats = &campaign.repeats;
    let analysis = Analysis::new(&test, &machine, &campaign);
    let mut bytes = analysis.to_json().unwrap().len();
    bytes += report::html::render(&analysis, Shown::alone(repeats)).unwrap().len();
    for repeat in repeats {
        for run in &repeat.runs {
            let mut text = Vec::new();
            report::write_samples(&mut text, run, None).unwrap();
            bytes += text.len();
        }
    }
    bytes
}
