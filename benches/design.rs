//! `design` over more than 200 candidate arcs in eight mountings, from the test file to the text of the
//! designed one; and the outlook on it.
//!
//! `cargo bench --bench design`

#![allow(clippy::unwrap_used)]
#![allow(missing_docs)]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use ballbar::design::{Designer, Outlook};
use ballbar::plan::Test;

fn main() {
    divan::main();
}

/// Eight corners of the room that a bar of 150 mm has in the travel of the HU40-T, 78 minutes.
fn wish() -> Test {
    let mut text = "name = \"bench\"\nmachine = \"machines/hu40t.toml\"\n\
        [ball_bar]\nlength_mm = 150.0\n[plan]\nfeed_mm_min = 500.0\n\
        [design]\nbudget_min = 78.0\nstep_deg = 14.0\nplaces = \"mountings\"\n"
        .to_owned();
    for k in 0..8_usize {
        let at = [[-108.0, 108.0], [-108.0, 108.0], [-195.0, 228.0]];
        let [x, y, z] = [0, 1, 2].map(|axis| at[axis][k >> axis & 1]);
        write!(
            text,
            "[[mounting]]\nname = \"M{k}\"\ncoincidence_mm = [{x:?}, {y:?}, {z:?}]\ntool_ball_mm = [0.0, 0.0, -200.0]\n"
        )
        .unwrap();
    }
    // Beside the directory `machines`; the designed test is written from the file itself.
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("wish.toml");
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("machines/hu40t.toml");
    let text = text.replace("machines/hu40t.toml", &machine.display().to_string());
    std::fs::write(&file, &text).unwrap();
    Test::read(&file).unwrap()
}

#[divan::bench(sample_count = 5)]
fn eight_mountings(bencher: divan::Bencher) {
    let test = wish();
    let machine = test.machine().unwrap();
    let designer = Designer::new(&test, &machine, None).unwrap();
    assert!(designer.candidates()[1] > 8 * 200, "{:?}", designer.candidates());
    bencher.bench(|| {
        let designer = Designer::new(&test, &machine, None).unwrap();
        designer.propose(&|| ()).unwrap().text.len()
    });
}

#[divan::bench(sample_count = 5)]
fn outlook_on_three_mountings(bencher: divan::Bencher) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/designed/test.toml");
    let test = Test::read(&file).unwrap();
    let machine = test.machine().unwrap();
    bencher.bench(|| Outlook::new(&test, &machine).unwrap().terms.len());
}
