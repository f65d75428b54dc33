//! Programs: blocks written, read back and checked a second, beside LinuxCNC's `rs274` on the same file
//! where it is installed; and a program of a million blocks, with the peak memory of the process.
//!
//! `cargo bench --bench programs`

#![allow(clippy::unwrap_used, clippy::print_stdout)]
#![allow(missing_docs)]

use std::path::Path as FilePath;
use std::sync::LazyLock;

use ballbar::machine::Machine;
use ballbar::nc::{self, Reading, Sphere};
use ballbar::plan::{Path, Test};
use divan::Bencher;
use divan::counter::ItemsCount;

struct Setting {
    test: Test,
    machine: Machine,
    path: Path,
    reading: Reading,
    sphere: Sphere,
    /// 3D10 in the finest chords, as it is written.
    program: String,
    /// Its equator there and back, again and again: a million blocks.
    million: String,
}

static SETTING: LazyLock<Setting> = LazyLock::new(|| {
    let file = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("machines/hu40t.toml");
    let machine = std::fs::read_to_string(&file).unwrap();
    let machine =
        Machine::parse(&machine.replace("sequence_step = 10", "sequence_step = 0"), &file).unwrap();
    let test = "name = \"B\"\nmachine = \"m.toml\"\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\nname = \"A\"\n\
        coincidence_mm = [20.0, -35.0, 40.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n[plan]\n\
        feed_mm_min = 500.0\nstrategy = \"3d10\"\nchord_sag_um = 0.1\n";
    let test = Test::parse(test, "t.toml".as_ref()).unwrap();
    let path = Path::plan(&test, &machine, 0).unwrap();
    let program = nc::write(&test, &machine, &path).unwrap();
    let mut reading = Reading::of(&machine);
    reading.work_offsets_mm.insert(54, test.mountings()[0].mounting.coincidence_mm);
    let at = |text: &str| program.find(text).unwrap();
    let (start, end) = (at("(EQUATOR CCW)"), at("(MERIDIAN 0 FORWARD)"));
    let circle = &program[start..end];
    let times = 1_000_000 / circle.lines().count() + 1;
    // Out again where the equator begins.
    let million = format!(
        "{}{}(RELEASE)\nG01 X151.500 Y0.000 Z0.000\nM30\n%\n",
        &program[..start],
        circle.repeat(times)
    );
    let sphere = Sphere::of(&test, 0).unwrap();
    Setting { test, machine, path, reading, sphere, program, million }
});

fn blocks(text: &str) -> ItemsCount {
    ItemsCount::new(text.lines().count())
}

fn main() {
    println!("{} blocks; a million: {}", blocks_of(&SETTING.program), blocks_of(&SETTING.million));
    divan::main();
    // The highest resident size that the process ever had, as Linux counts it.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    for line in status.lines().filter(|line| line.starts_with("VmHWM")) {
        println!("peak memory {}", line.trim_start_matches("VmHWM:").trim());
    }
}

fn blocks_of(text: &str) -> usize {
    text.lines().count()
}

#[divan::bench(sample_count = 20)]
fn write(bencher: Bencher) {
    let s = &*SETTING;
    bencher.counter(blocks(&s.program)).bench(|| nc::write(&s.test, &s.machine, &s.path).unwrap());
}

#[divan::bench(sample_count = 20)]
fn read(bencher: Bencher) {
    let s = &*SETTING;
    let read = || nc::read(&s.program, "O.nc".as_ref(), &s.reading).unwrap();
    bencher.counter(blocks(&s.program)).bench(read);
}

#[divan::bench(sample_count = 20)]
fn check(bencher: Bencher) {
    let s = &*SETTING;
    bencher.counter(blocks(&s.program)).bench(|| checked(&s.program));
}

#[divan::bench(sample_count = 5)]
fn check_a_million(bencher: Bencher) {
    let s = &*SETTING;
    bencher.counter(blocks(&s.million)).bench(|| checked(&s.million));
}

fn checked(program: &str) -> usize {
    let s = &*SETTING;
    let file = FilePath::new("O.nc");
    let checked = nc::check(program, file, &s.machine, &s.reading, Some(&s.sphere)).unwrap();
    assert_eq!(checked.findings, []);
    checked.blocks
}

/// The interpreter of LinuxCNC on the same file, its start included.
#[divan::bench(sample_count = 5)]
fn rs274(bencher: Bencher) {
    let s = &*SETTING;
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("p.ngc");
    // A dwell counts in seconds there, which does not matter here.
    std::fs::write(&file, &s.program).unwrap();
    let run = || {
        let canon = std::fs::File::create(directory.path().join("canon")).unwrap();
        std::process::Command::new("rs274")
            .arg("-g")
            .arg(&file)
            .stdout(canon)
            .stderr(std::process::Stdio::null())
            .status()
    };
    if !run().is_ok_and(|status| status.success()) {
        println!("rs274 is not installed");
        return;
    }
    bencher.counter(blocks(&s.program)).bench_local(|| run().unwrap());
}
