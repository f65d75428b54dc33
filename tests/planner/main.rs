//! Estimated times against LinuxCNC's own task, interpreter and trajectory planner, run headless.
//!
//! `BALLBAR_UPDATE_DOCS=1` writes `docs/planner.md` anew.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

#[path = "programs/rs274.rs"]
#[allow(dead_code)]
mod rs274;

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use ballbar::machine::Machine;
use ballbar::motion::Trajectory;
use ballbar::nc::{self, Reading};
use ballbar::plan::{self, Test};
use nalgebra::Vector3;

/// What LinuxCNC makes of the 500 mm/s² of its configuration.
#[derive(Clone, Copy)]
enum Acceleration {
    /// All of it, between corners that it rounds by an arc.
    Whole,
    /// Half of it, where it may have to blend with a neighbour: single moves, chords that are nearly
    /// tangential, the last block before a stop.
    Half,
}
use Acceleration::{Half, Whole};

struct Run {
    what: &'static str,
    blocks: String,
    acceleration: Acceleration,
}

const HEAD: &str = "G21 G17 G90 G94 G40 G49 G80 G54\nG64 P0.01\nG00 X0. Y0. Z0.\n";

/// A quarter of a circle of 150 mm, or less, in chords.
fn arc(chord_mm: f64, feed: u32, sweep_deg: f64) -> String {
    let sweep_rad = sweep_deg.to_radians();
    let count = (sweep_rad * 150.0 / chord_mm).round();
    let mut text = format!("G01 F{feed}.\n");
    for k in 1..=count as usize {
        let (sine, cosine) = (sweep_rad * k as f64 / count).sin_cos();
        writeln!(text, "X{:.3} Y{:.3}", 150.0 * sine, 150.0 - 150.0 * cosine).unwrap();
    }
    text
}

/// Sixteen straight lines, each at this angle to the last.
fn corners(corner_deg: f64, feed: u32) -> String {
    let (mut x, mut y) = (0.0, 0.0);
    let mut text = format!("G01 F{feed}.\n");
    for k in 0..16 {
        let direction_rad = if k % 2 == 0 { 0.0 } else { corner_deg.to_radians() };
        x += 30.0 * direction_rad.cos();
        y += 30.0 * direction_rad.sin();
        writeln!(text, "X{x:.3} Y{y:.3}").unwrap();
    }
    text
}

/// The program that this tool writes for one meridian.
fn meridian(machine: &Machine) -> String {
    let test = "name = \"Meridian\"\nmachine = \"m.toml\"\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\n\
        name = \"A\"\ncoincidence_mm = [0.0, 0.0, 0.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n[plan]\n\
        feed_mm_min = 2000.0\n[[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = 36.0\n";
    let test = Test::parse(test, "t.toml".as_ref()).unwrap();
    let path = plan::Path::plan(&test, machine, 0).unwrap();
    let text = nc::write(&test, machine, &path).unwrap();
    let first = text.find("(APPROACH)").unwrap();
    let end = text[..text.rfind("M30").unwrap()].rfind('\n').unwrap();
    text[first..=end].to_owned()
}

fn runs(machine: &Machine) -> Vec<Run> {
    let run = |what, blocks: String, acceleration| Run { what, blocks, acceleration };
    let corner = |what, degrees, acceleration| run(what, corners(degrees, 2000), acceleration);
    vec![
        run("arc of 45 deg, chords of 0.5 mm, 500 mm/min", arc(0.5, 500, 45.0), Half),
        run("arc of 90 deg, chords of 0.5 mm, 2000 mm/min", arc(0.5, 2000, 90.0), Half),
        run("arc of 90 deg, chords of 0.5 mm, 6000 mm/min", arc(0.5, 6000, 90.0), Half),
        run("arc of 90 deg, chords of 3 mm, 2000 mm/min", arc(3.0, 2000, 90.0), Half),
        run("arc of 90 deg, chords of 3 mm, 6000 mm/min", arc(3.0, 6000, 90.0), Half),
        run(
            "two half circles by G02 and G03, 2000 mm/min",
            "G02 X150. Y-150. I0. J-150. F2000.\nG03 X0. Y0. I0. J150.\n".to_owned(),
            Half,
        ),
        corner("16 lines of 30 mm, corners of 5 deg, 2000 mm/min", 5.0, Whole),
        corner("16 lines of 30 mm, corners of 45 deg, 2000 mm/min", 45.0, Whole),
        corner("16 lines of 30 mm, corners of 90 deg, 2000 mm/min", 90.0, Whole),
        run(
            "lines of 50 mm with dwells of 1.5 and 0.5 s, 2000 mm/min",
            "G01 X50. F2000.\nG04 P1.5\nY50.\nG04 P0.5\nX0.\n".to_owned(),
            Half,
        ),
        run(
            "lines of 50 mm with an M00, 2000 mm/min",
            "G01 X50. F2000.\nM00\nY50.\nG04 P0.2\nX0.\n".to_owned(),
            Half,
        ),
        run(
            "a whole meridian there and back as written here, 2000 mm/min",
            meridian(machine),
            Half,
        ),
    ]
}

/// The limits of `planner/machine.ini`. LinuxCNC rounds corners within 0.01 mm (G64 P0.01), with 0.866 of
/// its acceleration across the arc: as much as 8.66 um with all of it.
fn machine(acceleration: Acceleration) -> Machine {
    let path = match acceleration {
        Whole => 500.0,
        Half => 250.0,
    };
    let mut text = "name = \"Planner\"\ntopology = \"wFXYZt\"\n".to_owned();
    for axis in ["X", "Y", "Z"] {
        write!(
            text,
            "[axes.{axis}]\ntravel_mm = [-500.0, 500.0]\nrapid_mm_min = 12000.0\n\
             acceleration_mm_s2 = 500.0\nmax_feed_mm_min = 12000.0\n"
        )
        .unwrap();
    }
    write!(
        text,
        "[controller]\ndialect = \"linuxcnc\"\npath_acceleration_mm_s2 = {path:.1}\n\
         corner_stop_deg = 180.0\ncorner_tolerance_um = 8.66\n"
    )
    .unwrap();
    Machine::parse(&text, "planner.toml".as_ref()).unwrap()
}

fn planned_s(program: &str, directory: &Path) -> (f64, u64) {
    let file = directory.join("program.ngc");
    let result = directory.join("result.json");
    std::fs::write(&file, program).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/planner/run");
    // Twenty times faster than time, its threads may starve where others compute: it may try again.
    let run = || {
        let output = Command::new("bash").arg(&script).args([&file, &result]).output().unwrap();
        let told = std::fs::read_to_string(&result).unwrap_or_default();
        (output.status.success(), told, String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (mut done, mut told, mut complaint) = run();
    for _ in 0..2 {
        if !done {
            (done, told, complaint) = run();
        }
    }
    assert!(done, "{told} {complaint}");
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    (told["motion_s"].as_f64().unwrap(), told["stops"].as_u64().unwrap())
}

#[test]
fn estimated_times_are_those_of_a_real_planner() {
    if !rs274::installed("linuxcnc") || !rs274::installed("faketime") {
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let mut table = String::new();
    let mut worst = 0.0_f64;
    for run in runs(&machine(Half)) {
        let machine = machine(run.acceleration);
        let program = format!("%\n{HEAD}{}M30\n%\n", run.blocks);
        let mut reading = Reading::of(&machine);
        reading.work_offsets_mm.insert(54, Vector3::zeros());
        let read = nc::read(&program, "p.ngc".as_ref(), &reading).unwrap();
        let trajectory = Trajectory::new(&read, &machine, 1.0);
        // Dwells after the last motion are not seen from outside.
        let last = trajectory.blocks().iter().rfind(|block| block.motion().is_some()).unwrap();
        let ours_s = last.start_s + last.duration_s;
        let (theirs_s, stops) = planned_s(&program, directory.path());
        assert_eq!(stops as usize, trajectory.duration().stops, "{}", run.what);
        let off = (ours_s / theirs_s - 1.0) * 100.0;
        worst = worst.max(off.abs());
        let acceleration = machine.controller().path_acceleration_mm_s2;
        writeln!(
            table,
            "| {} | {acceleration} | {theirs_s:.2} | {ours_s:.2} | {off:+.1} |",
            run.what
        )
        .unwrap();
    }
    println!("{table}worst {worst:.2} %");
    assert!(worst < 2.0, "{worst} %");
    if std::env::var_os("BALLBAR_UPDATE_DOCS").is_some() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/planner.md");
        let page = std::fs::read_to_string(&file).unwrap();
        let start = page.find("| --- |").unwrap();
        let start = start + page[start..].find('\n').unwrap() + 1;
        let end = start + page[start..].find("\n\n").unwrap() + 1;
        std::fs::write(&file, format!("{}{table}{}", &page[..start], &page[end..])).unwrap();
    }
}
