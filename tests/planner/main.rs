//! Estimated times against LinuxCNC's own task, interpreter and trajectory planner.
//!
//! What the planner did with twelve programs is recorded in `tests/data/planner`, and the estimates are held
//! against that. A long test runs the planner itself, headless, and holds the recordings against it; with
//! `BALLBAR_UPDATE_DOCS=1` it records anew. After that the other test, asked the same, writes the table of
//! `docs/planner.md`.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

#[path = "../programs/outside.rs"]
mod outside;
mod programs;
mod recording;

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use ballbar::motion::{Block, Trajectory};
use programs::{Run, runs};
use recording::{Recording, Row, rests};

/// How much faster than time the planner is driven, one attempt after the other. Where others compute, its task
/// may feed its queue too late: the path stops inside an arc, and that attempt counts for nothing.
const SPEEDUPS: [u32; 6] = [50, 20, 5, 2, 1, 1];

/// Duration of all motion (s), from the first to the last: dwells after it are not seen from outside.
fn motion_s(trajectory: &Trajectory) -> f64 {
    let last = trajectory.blocks().iter().rfind(|block| block.motion().is_some()).unwrap();
    last.start_s + last.duration_s
}

#[test]
fn estimated_times_are_those_of_a_real_planner() {
    let mut table = String::new();
    for run in runs() {
        let (trajectory, rows) = (run.trajectory(), Recording::read(run.name));
        let (ours_s, theirs_s) = (motion_s(&trajectory), rows[rows.len() - 1].time_s);
        let off = (ours_s / theirs_s - 1.0) * 100.0;
        let apart_mm = |row: &Row| (trajectory.at(row.time_s).position_mm - row.position_mm).norm();
        let apart_mm = rows.iter().map(apart_mm).fold(0.0, f64::max);
        let acceleration = run.machine().controller().path_acceleration_mm_s2;
        writeln!(
            table,
            "| {} | {acceleration} | {theirs_s:.2} | {ours_s:.2} | {off:+.1} | {apart_mm:.2} |",
            run.what
        )
        .unwrap();
        assert!(off.abs() < 1.5, "{}: {off} %", run.what);
    }
    println!("{table}");
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/planner.md");
    let page = std::fs::read_to_string(&file).unwrap().replace("\r\n", "\n");
    let start = page.find("| --- |").unwrap();
    let start = start + page[start..].find('\n').unwrap() + 1;
    let end = start + page[start..].find("\n\n").unwrap() + 1;
    if std::env::var_os("BALLBAR_UPDATE_DOCS").is_some() {
        std::fs::write(&file, format!("{}{table}{}", &page[..start], &page[end..])).unwrap();
    } else {
        assert_eq!(page[start..end], table, "BALLBAR_UPDATE_DOCS=1 writes docs/planner.md anew");
    }
}

/// So far the planner goes past a corner, mm: `G64 P0.01`, and as much again for the digits of the recording.
const CUT_MM: f64 = 0.02;

#[test]
fn the_blocks_of_a_program_are_found_in_what_a_planner_did() {
    for run in runs() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR"));
        let file = file.join(format!("tests/data/planner/{}.csv.gz", run.name));
        let recording = ballbar::log::Recording::read(&file).unwrap();
        let trajectory = Trajectory::recorded(&run.read_back(), &run.machine(), &recording);
        let trajectory = trajectory.unwrap_or_else(|error| panic!("{}: {error}", run.name));
        // From its first row to its last: rows are 20 ms apart.
        let rows = Recording::read(run.name);
        let off_s = motion_s(&trajectory) - rows[rows.len() - 1].time_s;
        let apart_mm = |block: &Block| {
            let at_mm = trajectory.at(block.start_s + block.duration_s).position_mm;
            block.motion().map_or(0.0, |motion| (at_mm - motion.end_mm).norm())
        };
        let farthest_mm = trajectory.blocks().iter().map(apart_mm).fold(0.0, f64::max);
        println!("{}: {off_s:+.3} s, ends of blocks within {farthest_mm:.3} mm", run.what);
        assert!(off_s.abs() < 0.05, "{}: {off_s} s", run.what);
        // A block ends at a row: not farther away than half the way to the next one, 1 mm at 6000 mm/min, and by what corners are cut.
        let apart_mm =
            recording.rows().windows(2).map(|two| (two[1].position_mm - two[0].position_mm).norm());
        let nearest_mm = 0.5 * apart_mm.fold(0.0, f64::max) + CUT_MM;
        assert!(farthest_mm < nearest_mm, "{}: {farthest_mm} of {nearest_mm} mm", run.what);
    }
}

/// The planner's own motion, when its queue never ran dry: it stood still where the program says and nowhere else, and
/// `right` has nothing against it.
fn driven(run: &Run, right: impl Fn(&Recording) -> Result<(), String>) -> Recording {
    let directory = tempfile::tempdir().unwrap();
    let (file, motion) = (directory.path().join("p.ngc"), directory.path().join("motion.txt"));
    // An output tells the recording from when to when the operator is waited for.
    let program: String = run
        .program()
        .lines()
        .map(|line| {
            if line.contains("M00") {
                format!("M64 P0\n{line}\nM65 P0\n")
            } else {
                format!("{line}\n")
            }
        })
        .collect();
    std::fs::write(&file, program).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/planner/run");
    let rests = rests(&run.trajectory());
    let mut told = String::new();
    for speedup in SPEEDUPS {
        let speedup = speedup.to_string();
        let mut command = Command::new("bash");
        let output = command.arg(&script).args([&file, &motion]).arg(&speedup).output().unwrap();
        let recording = match std::fs::read_to_string(&motion) {
            Ok(text) if output.status.success() => Recording::of_motion(&text, &rests),
            _ => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
        };
        match recording.and_then(|recording| right(&recording).map(|()| recording)) {
            Ok(recording) => return recording,
            Err(error) => told = error,
        }
        println!("{}, {speedup} times faster than time: {told}", run.name);
        let _ = std::fs::remove_file(&motion);
    }
    panic!("{}: {told}", run.what);
}

/// How much later or earlier than recorded the planner may be, in periods of 1 ms: where two rapids meet it stands for a
/// period or for several, as its task feeds its queue.
const PERIODS: usize = 10;

/// Whether the planner did what it had done when it was recorded.
fn same(live: &Recording, kept: &[Row]) -> Result<(), String> {
    let (live_s, kept_s) = (live.rows[live.rows.len() - 1].time_s, kept[kept.len() - 1].time_s);
    let apart_mm = |row: &Row| {
        let at = (row.time_s * 1e3).round() as usize;
        let last = live.rows.len() - 1;
        let around = at.saturating_sub(PERIODS).min(last)..=(at + PERIODS).min(last);
        let apart_mm =
            live.rows[around].iter().map(|live| (live.position_mm - row.position_mm).norm());
        apart_mm.fold(f64::INFINITY, f64::min)
    };
    let apart_mm = kept.iter().map(apart_mm).fold(0.0, f64::max);
    let told = format!("{live_s:.3} s, recorded {kept_s:.3} s, {apart_mm:.4} mm apart");
    println!("{told}");
    // Rapids cover 0.2 mm in a period: half of that, and by what corners are cut.
    let right = (live_s - kept_s).abs() < PERIODS as f64 * 1e-3 && apart_mm < 0.1 + CUT_MM;
    if right { Ok(()) } else { Err(told) }
}

#[test]
#[ignore = "long: `cargo test --release -- --ignored` runs it, and .ci/run does"]
fn the_recordings_are_what_the_planner_does() {
    if !outside::installed("linuxcnc") || !outside::installed("faketime") {
        return;
    }
    let update = std::env::var_os("BALLBAR_UPDATE_DOCS").is_some();
    for run in runs() {
        if update {
            driven(&run, |_| Ok(())).write(run.name);
        } else {
            let kept = Recording::read(run.name);
            driven(&run, |live| same(live, &kept));
        }
    }
}
