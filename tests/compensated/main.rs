//! The loop that a user closes: LinuxCNC drives a ball-bar program, the machine errs, its log is analysed, `compensate` writes what LinuxCNC
//! takes, LinuxCNC drives the same program with it, and the log of the same machine is analysed again. And without any table, with the
//! program that `correct` has made right beforehand.
//!
//! LinuxCNC's own task, interpreter, planner and compensation move the motors; the errors of the machine are put on
//! through the exact chain.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

#[path = "../programs/outside.rs"]
mod outside;
#[path = "../planner/recording.rs"]
#[expect(dead_code, reason = "nothing is kept here")]
mod recording;

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use ballbar::machine::{Axis, ChainErrors, Machine, Mounting, Pose};
use ballbar::model::{Coefficient, ErrorFunctions};
use ballbar::motion::Trajectory;
use ballbar::nc::{self, Reading};
use nalgebra::{Matrix3, Vector3};
use recording::{Recording, rests};
use serde_json::Value;

/// How much faster than time LinuxCNC is driven, one attempt after the other: where its queue runs dry an attempt counts for nothing.
/// It computes little: the first attempt leaves a processor all but idle.
const SPEEDUPS: [&str; 6] = ["50", "20", "5", "2", "1", "1"];
/// A planner is foretold to 1.5 % (`tests/planner`); what differs by more was not driven as it would be on a machine.
const SLOWER: f64 = 0.03;
const LENGTH_MM: f64 = 100.0;
const RATE_HZ: f64 = 20.0;
const NOISE_UM: f64 = 0.1;
/// Sagitta of the chords of the program, um: on the average they lie two thirds of it within the sphere, which no correction changes.
const SAG_UM: f64 = 0.1;
const TOOL_MM: [f64; 3] = [0.0, 0.0, -150.0];
/// Where the workpiece ball is, of each mounting. About one place alone a bow of positioning and one of straightness are the same.
const BALLS_MM: [[f64; 3]; 2] = [[0.0, 0.0, 0.0], [100.0, 100.0, 100.0]];

/// X and Y carry the workpiece; the limits are those of `machine.ini`.
fn machine_file() -> String {
    let mut text = "name = \"Planner\"\ntopology = \"wXYFZt\"\n".to_owned();
    for axis in ["X", "Y", "Z"] {
        write!(
            text,
            "[axes.{axis}]\ntravel_mm = [-500.0, 500.0]\nrapid_mm_min = 12000.0\n\
             acceleration_mm_s2 = 500.0\nmax_feed_mm_min = 12000.0\n"
        )
        .unwrap();
    }
    text.push_str(
        "[controller]\ndialect = \"linuxcnc\"\npath_acceleration_mm_s2 = 250.0\ndecimals = 5\n\
         corner_stop_deg = 180.0\ncorner_tolerance_um = 8.66\n",
    );
    text
}

/// Scale, bow, S and lost motion of three slides, and a squareness.
fn errors(machine: &Machine) -> ErrorFunctions {
    let mut errors = ErrorFunctions::default();
    for (axis, scale, bow, s, lost_mm) in [
        (Axis::X, 90e-6, 3e-7, 2e-9, 5e-3),
        (Axis::Y, -70e-6, 4e-7, -3e-9, 8e-3),
        (Axis::Z, 110e-6, -5e-7, 2.5e-9, 6e-3),
    ] {
        let side = machine.topology().side(axis).sign();
        for (shape, value) in [("1", scale), ("2", bow), ("3", s), ("b", -0.5 * lost_mm)] {
            let name = format!("E{axis}{axis}{shape}");
            errors.set(Coefficient::parse(&name).unwrap(), side * value);
        }
    }
    // No table of positioning holds a squareness: it stays, and shows when the machine was where.
    errors
        .set(Coefficient::parse("EXY1").unwrap(), machine.topology().side(Axis::Y).sign() * 80e-6);
    errors
}

fn test_file() -> String {
    let mut text =
        "name = \"Loop\"\nmachine = \"machine.toml\"\n\n[ball_bar]\nlength_mm = 100.0\n\n"
            .to_owned();
    for (name, ball) in ["A", "B"].iter().zip(BALLS_MM) {
        write!(
            text,
            "[[mounting]]\nname = \"{name}\"\ncoincidence_mm = {ball:?}\ntool_ball_mm = {TOOL_MM:?}\n\n"
        )
        .unwrap();
    }
    text.push_str("[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 2000.0\nchord_sag_um = 0.1\n");
    text
}

fn ballbar(at: &Path, arguments: &[&str]) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_ballbar")).args(arguments).current_dir(at).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Where LinuxCNC had the motors, every millisecond, the operator's time left out.
fn driven(
    at: &Path,
    program: &str,
    ball_mm: [f64; 3],
    machine: &Machine,
    ini: Option<&Path>,
) -> Recording {
    let mut reading = Reading::of(machine);
    reading.work_offsets_mm.insert(54, ball_mm.into());
    // LinuxCNC begins at its zero; a program alone does not say where it begins, nor where the ball is.
    let program = program.replacen("(APPROACH)", "G00 G53 X0. Y0. Z0.\n(APPROACH)", 1);
    let read = nc::read(&program, "p.ngc".as_ref(), &reading).unwrap();
    let trajectory = Trajectory::new(&read, machine, 1.0);
    let rests = rests(&trajectory);
    let planned_s: f64 = trajectory.blocks().iter().map(|block| block.duration_s).sum();
    let told_to_wait = program.lines().fold(String::new(), |all, line| {
        if line.contains("M00") {
            format!("{all}M64 P0\n{line}\nM65 P0\n")
        } else {
            format!("{all}{line}\n")
        }
    });
    let [x, y, z] = ball_mm;
    let offset = format!("G10 L2 P1 X{x} Y{y} Z{z}\n(APPROACH)");
    let told_to_wait = told_to_wait.replacen("(APPROACH)", &offset, 1);
    let (file, motion) = (at.join("p.ngc"), at.join("motion.txt"));
    std::fs::write(&file, told_to_wait).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/planner/run");
    let mut told = String::new();
    for speedup in SPEEDUPS {
        let mut command = Command::new("bash");
        command.arg(&script).args([&file, &motion]).arg(speedup);
        if let Some(ini) = ini {
            command.env("MACHINE_INI", ini);
        }
        let output = command.output().unwrap();
        let recording = match std::fs::read_to_string(&motion) {
            Ok(text) if output.status.success() => {
                Recording::of_motion(&text, &rests).and_then(|recording| {
                    // Where its queue runs dry it slows down without standing still.
                    let took_s = recording.rows.len() as f64 * 1e-3;
                    println!("{took_s:.1} s of {planned_s:.1} planned");
                    let as_planned = (took_s / planned_s - 1.0).abs() < SLOWER;
                    as_planned.then_some(recording).ok_or(format!("it took {took_s} s"))
                })
            }
            _ => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
        };
        match recording {
            Ok(recording) => return recording,
            Err(error) => told = error,
        }
        println!("{speedup} times faster than time: {told}");
        let _ = std::fs::remove_file(&motion);
    }
    panic!("{told}");
}

/// What the bar reads while the motors go there, on a machine with these errors.
fn log(
    recording: &Recording,
    ball_mm: [f64; 3],
    machine: &Machine,
    errors: &ErrorFunctions,
) -> String {
    let balls = Mounting { coincidence_mm: ball_mm.into(), tool_ball_mm: TOOL_MM.into() };
    let every = (1e3 / RATE_HZ) as usize;
    let mut drawn: u64 = 7;
    let mut uniform = || {
        drawn =
            drawn.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (drawn >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut text = "time_s,deviation_um\n".to_owned();
    let mut sense = Vector3::zeros();
    let mut before = recording.rows[0].position_mm;
    for (k, row) in recording.rows.iter().enumerate() {
        let way = row.position_mm - before;
        before = row.position_mm;
        sense = way
            .zip_map(&sense, |way: f64, sense| if way.abs() > 1e-9 { way.signum() } else { sense });
        if k % every != 0 {
            continue;
        }
        let pose = Pose { position_mm: row.position_mm, sense };
        let slides = Axis::ALL.map(|axis| errors.slide_error(axis, &pose));
        let bent = ChainErrors { slides, ..ChainErrors::zero() };
        let length_mm = machine.ball_vector_mm(&balls, &pose.position_mm, &bent).norm();
        let noise_um = NOISE_UM * 3.0_f64.sqrt() * (0..4).map(|_| uniform()).sum::<f64>();
        let read_um = 1e3 * (length_mm - LENGTH_MM) + noise_um;
        write!(text, "{:.4},", k as f64 * 1e-3 + 3.0).unwrap();
        if read_um.abs() < 1000.0 {
            write!(text, "{read_um:.1}").unwrap();
        }
        text.push('\n');
    }
    text
}

/// `TXX1` and the others of an analysis, um, with the standard deviation of each by noise and by all.
fn own_errors(at: &Path) -> Vec<(String, f64, [f64; 2])> {
    let analysis: Value =
        serde_json::from_slice(&std::fs::read(at.join("analysis.json")).unwrap()).unwrap();
    let model = &analysis["error_model"];
    let parameters = model["parameters"].as_array().unwrap();
    let variance = |of: &str, k: usize| model[of][(k + 1) * (k + 2) / 2 - 1].as_f64().unwrap();
    let of = parameters.iter().enumerate().filter_map(|(k, parameter)| {
        let name = parameter["name"].as_str().unwrap();
        let own = ["TXX", "TYY", "TZZ"].iter().any(|start| name.starts_with(start));
        let noise = variance("noise_covariance", k);
        let all = noise + variance("open_covariance", k);
        let value_um = 1e3 * parameter["value"].as_f64().unwrap();
        own.then(|| (name.to_owned(), value_um, [noise, all].map(|of| 1e3 * of.sqrt())))
    });
    of.collect()
}

/// What the bar reads on the arcs, um, without where the ball was put and without the chords of the program.
fn bar_rms_um(samples: &Path) -> f64 {
    let text = std::fs::read_to_string(samples).unwrap();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let [used, x, y, z, read] =
        ["used", "ball_x_mm", "ball_y_mm", "ball_z_mm", "deviation_um"].map(column);
    let rows = lines.map(|line| line.split(',').collect::<Vec<_>>()).filter(|row| row[used] == "1");
    let rows: Vec<(Vector3<f64>, f64)> = rows
        .map(|row| {
            let number = |k: usize| row[k].parse::<f64>().unwrap();
            let u = Vector3::new(number(x), number(y), number(z)).normalize();
            (u, number(read) + SAG_UM * 2.0 / 3.0)
        })
        .collect();
    assert!(rows.len() > 300, "{}", rows.len());
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (u, read) in &rows {
        normal += u * u.transpose();
        right += u * *read;
    }
    let centre = normal.lu().solve(&right).unwrap();
    let mut left: Vec<f64> = rows.iter().map(|(u, read)| (read - u.dot(&centre)).abs()).collect();
    // A reading in the very block in which a slide takes up its lost motion is on the way there: two in a thousand.
    left.sort_by(f64::total_cmp);
    left.truncate(rows.len() - rows.len() / 500);
    (left.iter().map(|um| um * um).sum::<f64>() / left.len() as f64).sqrt()
}

/// The INI file of the planner with the lines of another one in the sections of its joints.
fn with_lines(lines: &str) -> String {
    let ini = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/planner/machine.ini");
    let mut ini = std::fs::read_to_string(ini).unwrap();
    for section in lines.split("[JOINT_").skip(1) {
        let (joint, lines) = section.split_once("]\n").unwrap();
        let head = format!("[JOINT_{joint}]\n");
        assert!(ini.contains(&head));
        ini = ini.replace(&head, &format!("{head}{lines}"));
    }
    ini
}

#[test]
#[ignore = "long: `cargo test --release -- --ignored` runs it, and .ci/run does"]
fn linuxcnc_with_its_tables_or_a_corrected_program_leaves_little() {
    if !outside::installed("linuxcnc") || !outside::installed("faketime") {
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    std::fs::write(at.join("machine.toml"), machine_file()).unwrap();
    let machine = Machine::parse(&machine_file(), "machine.toml".as_ref()).unwrap();
    let errors = errors(&machine);
    std::fs::write(at.join("test.toml"), test_file()).unwrap();
    ballbar(at, &["program", "test.toml", "-o", "."]);
    let programs = ["O1001.nc", "O1002.nc"];
    let analysed = |name: &str, ini: Option<&Path>| {
        let mut test = test_file();
        for ((program, ball_mm), mounting) in programs.iter().zip(BALLS_MM).zip(["A", "B"]) {
            let text = std::fs::read_to_string(at.join(program)).unwrap();
            let recording = driven(at, &text, ball_mm, &machine, ini);
            let log_name = format!("{name}-{mounting}.csv");
            std::fs::write(at.join(&log_name), log(&recording, ball_mm, &machine, &errors))
                .unwrap();
            write!(
                test,
                "\n[[run]]\nrepeat = 1\nmounting = \"{mounting}\"\nprogram = \"{program}\"\nlog = \"{log_name}\"\n"
            )
            .unwrap();
        }
        std::fs::write(at.join(format!("{name}.toml")), test).unwrap();
        ballbar(at, &["analyse", &format!("{name}.toml"), "-o", name]);
        own_errors(&at.join(name))
    };
    let before = analysed("before", None);
    ballbar(at, &["compensate", "before", "--for", "linuxcnc", "-o", "tables"]);
    let tables = at.join("tables");
    let lines = std::fs::read_to_string(tables.join("compensation.ini")).unwrap();
    std::fs::write(tables.join("machine.ini"), with_lines(&lines)).unwrap();
    let after = analysed("after", Some(&tables.join("machine.ini")));
    assert_eq!(before.len(), 12);
    for ((name, was, _), (_, is, [noise, all])) in before.iter().zip(&after) {
        println!("{name}: {was:+.3} um before, {is:+.3} after, noise {noise:.3}, all {all:.3}");
    }
    for ((name, was, _), (_, is, [noise, all])) in before.iter().zip(&after) {
        let bound = (0.03 * was.abs()).max(3.0 * noise);
        assert!(is.abs() < bound, "{name}: {was} before, {is} after, noise {noise}, all {all}");
    }

    ballbar(
        at,
        &[
            "correct",
            "O1001.nc",
            "--analysis",
            "before",
            "--test",
            "test.toml",
            "--mounting",
            "A",
            "-o",
            "corrected",
        ],
    );
    let corrected = "corrected/O1001-corrected.nc";
    let text = std::fs::read_to_string(at.join(corrected)).unwrap();
    let recording = driven(at, &text, BALLS_MM[0], &machine, None);
    std::fs::write(at.join("again.csv"), log(&recording, BALLS_MM[0], &machine, &errors)).unwrap();
    let run =
        format!("\n[[run]]\nmounting = \"A\"\nprogram = \"{corrected}\"\nlog = \"again.csv\"\n");
    std::fs::write(at.join("again.toml"), format!("{}{run}", test_file())).unwrap();
    ballbar(at, &["analyse", "again.toml", "-o", "again"]);
    let analysis: Value =
        serde_json::from_slice(&std::fs::read(at.join("before/analysis.json")).unwrap()).unwrap();
    let noise = analysis["repeats"][0]["residual_rms_um"].as_f64().unwrap();
    let [was, is] = ["before/samples-before-A.csv", "again/samples-again.csv"]
        .map(|samples| bar_rms_um(&at.join(samples)));
    println!("bar: {was:.2} um before, {is:.4} with the corrected program, noise {noise:.4}");
    assert!(is < 1.1 * noise, "{was} before, {is} corrected, noise {noise}");
}
