//! `--motion`: what a control recorded of its motion, in place of the estimate.

use std::fmt::Write as _;

use ballbar::machine::Machine;
use ballbar::motion::{BlockKind, Trajectory};
use ballbar::nc::{Reading, read_file};
use nalgebra::Vector3;

use crate::work::Work;

const PLAN: &str = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 2000.0\nrelease_between_arcs = false\nsettle_s = 0.5\ndwell_s = 0.7\n";
/// The control's clock goes fast, and shows this when the program begins.
const CONTROL: [f64; 2] = [1.000_06, 5000.0];
const PAUSE_S: f64 = 6.0;
const WAVER_MM: f64 = 0.3e-3;

/// A program written for the machine of the file, and driven by one with a third of its accelerations, whose servos
/// waver: where it was at a time since the program began, pauses included, and for how long.
struct Driven {
    trajectory: Trajectory,
    stops_s: Vec<f64>,
}

impl Driven {
    fn by_another_control(work: &Work) -> Self {
        work.machine("name", "name").test(PLAN);
        work.ballbar(&["program", "test.toml"]).done();
        std::fs::rename(work.path("results/O1001.nc"), work.path("O1001.nc")).unwrap();
        std::fs::remove_dir_all(work.path("results")).unwrap();
        let machine = Machine::read(&work.path("machine.toml")).unwrap();
        let mut reading = Reading::of(&machine);
        reading.work_offsets_mm.insert(54, [20.0, -35.0, 40.0].into());
        let program = read_file(&work.path("O1001.nc"), &reading).unwrap();
        let slow = machine.with_accelerations(0.33, Some(0.08));
        let trajectory = Trajectory::new(&program, &slow, 1.0);
        let stops = trajectory.blocks().iter().filter(|block| block.kind == BlockKind::Stop);
        let stops_s = stops.map(|block| block.start_s).collect();
        Self { trajectory, stops_s }
    }

    fn at_mm(&self, machine_s: f64) -> Vector3<f64> {
        let mut program_s = machine_s;
        for stop_s in &self.stops_s {
            program_s -= (program_s - stop_s).clamp(0.0, PAUSE_S);
        }
        self.trajectory.at(program_s.max(0.0)).position_mm
    }

    fn recording(&self) -> String {
        let end_s = self.trajectory.end_s() + PAUSE_S * self.stops_s.len() as f64 + 1.0;
        let mut text = "t [s]; X act [mm]; Y act [mm]; Z act [mm]; load [%]\n".to_owned();
        for k in 0..(500.0 * end_s) as usize {
            let machine_s = 0.002 * k as f64 - 0.5;
            let at = self.at_mm(machine_s);
            let waver = |slide: usize| WAVER_MM * ((k + 31 * slide) as f64 * 2.1).sin();
            let [x, y, z] = [0, 1, 2].map(|slide| at[slide] + waver(slide));
            let control_s = CONTROL[1] + machine_s * CONTROL[0];
            writeln!(text, "{control_s:.6};{x:.4};{y:.4};{z:.4};17").unwrap();
        }
        text
    }
}

/// Columns of a table, by their names; what is no number is none.
fn columns(text: &str, names: &[&str]) -> Vec<Vec<f64>> {
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let of = |name: &&str| header.iter().position(|other| other == name).unwrap();
    let at: Vec<usize> = names.iter().map(of).collect();
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        at.iter().map(|column| fields[*column].parse().unwrap_or(f64::NAN)).collect()
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn a_log_is_laid_over_the_motion_that_was_recorded() {
    let work = Work::new();
    let driven = Driven::by_another_control(&work);
    work.write("motion.csv", driven.recording());
    let scenario = "sample_rate_hz = 50.0\n[clock]\nstart_s = 3.0\nppm = -30.0\n[noise]\nwhite_um = 0.1\ncorrelated_um = 0.0\n";
    work.write("scenario.toml", scenario);
    let simulate =
        ["simulate", "test.toml", "--scenario", "scenario.toml", "--motion", "motion.csv"];
    work.ballbar(&simulate).done();
    std::fs::rename(work.path("results"), work.path("virtual")).unwrap();
    // On the path that was recorded. That a slide has left its place shows when it is farther away than it wavers: the
    // program of the simulation begins by so much later than that of the control.
    let off_mm = |samples: &str| {
        let rows = columns(samples, &["log_time_s", "x_mm", "y_mm", "z_mm"]);
        let at = |begins_s: f64| {
            let off = rows.iter().map(|row| {
                let machine_s = (row[0] * (1.0 - 30e-6) - 3.0) / CONTROL[0] + begins_s;
                (driven.at_mm(machine_s) - Vector3::new(row[1], row[2], row[3])).norm()
            });
            off.filter(|mm| mm.is_finite()).fold(0.0, f64::max)
        };
        (0..60).map(|k| at(0.5e-3 * f64::from(k))).fold(f64::INFINITY, f64::min)
    };
    let align = ["align", "virtual/test.toml", "--motion", "motion.csv"];
    work.ballbar(&align).done();
    let samples = std::fs::read_to_string(work.path("results/samples-run1.csv")).unwrap();
    let with_mm = off_mm(&samples);
    println!("{:.1} um from where the machine was", 1e3 * with_mm);
    // A millisecond at 33 mm/s.
    assert!(with_mm < 0.04, "{with_mm} mm");
    let analyse = ["analyse", "virtual/test.toml", "--motion", "motion.csv", "--json"];
    let analysis = work.ballbar(&analyse).done().stdout();
    let analysis: serde_json::Value = serde_json::from_str(&analysis).unwrap();
    let rms_um = analysis["repeats"][0]["residual_rms_um"].as_f64().unwrap();
    assert!(rms_um < 0.16, "{rms_um} um");
    assert_eq!(analysis["diagnosis"]["findings"].as_array().unwrap().len(), 0);
    // The file of the run names it as well.
    let test = std::fs::read_to_string(work.path("virtual/test.toml")).unwrap();
    let named = test.replace("log = ", "motion = \"../motion.csv\"\nlog = ");
    work.write("virtual/named.toml", named);
    work.ballbar(&["align", "virtual/named.toml"]).done();
    let again = std::fs::read_to_string(work.path("results/samples-run1.csv")).unwrap();
    assert_eq!(samples, again);
}

#[test]
fn a_motion_that_is_not_of_the_run_is_refused() {
    let work = Work::new();
    let driven = Driven::by_another_control(&work);
    let recording = driven.recording();
    work.write("motion.csv", &recording);
    let simulate = |motions: &[&str]| {
        let motions = motions.iter().flat_map(|motion| ["--motion", motion]);
        work.ballbar(&["simulate", "test.toml"].into_iter().chain(motions).collect::<Vec<_>>())
    };
    insta::assert_snapshot!(simulate(&["motion.csv", "motion.csv"]).refused(1));
    let scenario = "feed_override_percent = 90.0\n";
    work.write("scenario.toml", scenario);
    let otherwise =
        ["simulate", "test.toml", "--motion", "motion.csv", "--scenario", "scenario.toml"];
    insta::assert_snapshot!(work.ballbar(&otherwise).refused(1));
    let lines: Vec<&str> = recording.lines().collect();
    // Half of a test.
    work.write("half.csv", lines[..lines.len() / 2].join("\n"));
    insta::assert_snapshot!(simulate(&["half.csv"]).refused(3));
    // A second of it was lost.
    let lost = [&lines[..lines.len() / 2], &lines[lines.len() / 2 + 500..]].concat();
    work.write("lost.csv", lost.join("\n"));
    insta::assert_snapshot!(simulate(&["lost.csv"]).refused(1));
    // In inches.
    work.write("inch.csv", recording.replacen("[mm]", "[inch]", 3));
    insta::assert_snapshot!(simulate(&["inch.csv"]).refused(3));
}
