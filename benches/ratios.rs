//! How fast the parts of an analysis are against what everybody has, as ratios in one run: factoring and building the rows of a
//! fit against `numpy.linalg.lstsq`, reading a log against `polars.read_csv`, an analysis against reading its bytes; and memory.
//!
//! `cargo bench --bench ratios`, with a Python that has numpy and polars (`BALLBAR_PYTHON`, or else `python3`). Both sides have two
//! threads, work on the same files, and take turns; of each the fastest time counts, as what else the machine does only adds.

#![allow(clippy::unwrap_used, clippy::print_stdout)]
#![allow(missing_docs)]

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use ballbar::align::Part;
use ballbar::identify::{Campaign, Failure, MeasuredRun};
use ballbar::log::{self, Format};
use ballbar::machine::{Machine, Mounting, Pose};
use ballbar::model::{self, Model, Motion};
use ballbar::plan::Test;
use ballbar::report::{self, Analysis, Shown};
use ballbar::solve::{Solution, Triangle, Truncation, Tsqr, solve};

/// Every measured sample on an arc, of all five runs, more than twice.
const ROWS: usize = 100_000;
const COLUMNS: usize = 40;
const THREADS: usize = 2;
/// Rows of the log: a quarter of an hour at 1000 readings a second.
const READINGS: usize = 1_000_000;
/// So often both sides take their turn, and so often each does its work then.
const TURNS: usize = 3;
const TIMES: usize = 7;

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(THREADS).build_global().unwrap();
    let measured = Measured::new();
    let model = measured.model();
    assert_eq!(model.parameters().len(), COLUMNS);
    let data = measured.rows(&model);
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (matrix, csv) = (scratch.join("ratios.f64"), scratch.join("ratios.csv"));
    std::fs::write(&matrix, data.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>())
        .unwrap();
    std::fs::write(&csv, long_log()).unwrap();

    let mut fastest = Fastest::default();
    for _ in 0..TURNS {
        fastest.time("factored", || factored(&data));
        fastest.time("built and factored", || measured.built_and_factored(&model));
        fastest.time("log", || log::read(&csv, &Format::default()).unwrap().readings().len());
        fastest.python(&matrix, &csv);
    }
    let rows = |name: &str| ROWS as f64 / fastest.s(name) / 1e6;
    let readings = |name: &str| READINGS as f64 / fastest.s(name) / 1e6;
    println!(
        "| what, two threads | here | there | ratio | bound |\n| --- | --- | --- | --- | --- |"
    );
    for (what, here, there, bound) in [
        (
            "rows of the fit factored, `numpy.linalg.lstsq`, M rows/s",
            rows("factored"),
            rows("lstsq"),
            4.0,
        ),
        (
            "columns built and factored, the same, M rows/s",
            rows("built and factored"),
            rows("lstsq"),
            2.0,
        ),
        ("a log read, `polars.read_csv`, M readings/s", readings("log"), readings("polars"), 1.0),
    ] {
        println!("| {what} | {here:.2} | {there:.2} | {:.2} | {bound} |", here / there);
    }
    for set in ["hu40t", "rate250"] {
        let Analysed { readings, to_report_s, bytes_s, peak_kb } = Analysed::of(set);
        println!(
            "| `{set}`, {readings} readings: raw logs to report, and reading their bytes | {:.0} ms | {:.2} ms | {:.0} | |",
            1e3 * to_report_s,
            1e3 * bytes_s,
            to_report_s / bytes_s
        );
        println!(
            "| the same, memory of the process at most | {:.0} MB | | {:.2} kB a reading | |",
            peak_kb / 1e3,
            peak_kb / readings as f64
        );
    }
}

/// The fastest of the times of each work, s.
#[derive(Default)]
struct Fastest(HashMap<String, f64>);

impl Fastest {
    fn note(&mut self, name: &str, s: f64) {
        let fastest = self.0.entry(name.to_owned()).or_insert(s);
        *fastest = fastest.min(s);
    }

    fn time<T>(&mut self, name: &str, work: impl Fn() -> T) {
        for _ in 0..TIMES {
            let start = Instant::now();
            std::hint::black_box(work());
            self.note(name, start.elapsed().as_secs_f64());
        }
    }

    /// The other side's times, a name and seconds a line.
    fn python(&mut self, matrix: &Path, csv: &Path) {
        let python = std::env::var("BALLBAR_PYTHON").unwrap_or_else(|_| "python3".to_owned());
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/ratios.py");
        let mut command = Command::new(python);
        command
            .arg(script)
            .args([matrix, csv])
            .args([COLUMNS, THREADS, TIMES].map(|n| n.to_string()));
        let output = command.stderr(std::process::Stdio::inherit()).output().unwrap();
        assert!(output.status.success(), "numpy and polars are needed: set BALLBAR_PYTHON");
        for line in String::from_utf8(output.stdout).unwrap().lines() {
            let (name, s) = line.split_once(' ').unwrap();
            self.note(name, s.parse().unwrap());
        }
    }

    fn s(&self, name: &str) -> f64 {
        self.0[name]
    }
}

/// The samples of the measured runs.
struct Measured {
    machine: Machine,
    mounting: Mounting,
    poses: Vec<Pose>,
    deviations_mm: Vec<f64>,
}

impl Measured {
    fn new() -> Self {
        let test = Test::read(&test_file("hu40t")).unwrap();
        let machine = test.machine().unwrap();
        let mounting = test.mountings()[0].mounting;
        let (mut poses, mut deviations_mm) = (Vec::new(), Vec::new());
        for run in test.runs().unwrap() {
            let measured = MeasuredRun::read(&test, run).unwrap();
            for sample in measured.aligned(&test, &machine).unwrap().samples() {
                if matches!(sample.part, Part::Arc(_)) {
                    poses.push(sample.pose);
                    deviations_mm.push(sample.deviation_mm);
                }
            }
        }
        let poses = poses.iter().copied().cycle().take(ROWS).collect();
        let deviations_mm = deviations_mm.iter().copied().cycle().take(ROWS).collect();
        Self { machine, mounting, poses, deviations_mm }
    }

    /// 40 columns: the observable 38, and two more that are linear of the second kind.
    fn model(&self) -> Model<'_> {
        let names = ["observable35", "EAX1", "EAZ1"].map(str::to_owned);
        let terms = model::terms(&names, &["A".into()]).unwrap();
        Model::new(&self.machine, vec![self.mounting], terms)
    }

    /// Hands over some of the rows, each with its right-hand side.
    fn each(&self, model: &Model, part: std::ops::Range<usize>, mut take: impl FnMut(&[f64], f64)) {
        let mut row = vec![0.0; COLUMNS];
        for (pose, deviation_mm) in self.poses[part.clone()].iter().zip(&self.deviations_mm[part]) {
            model.row(&model.situation(pose, &Motion::REST, 0), &mut row);
            take(&row, *deviation_mm);
        }
    }

    /// All rows, each with its right-hand side at its end.
    fn rows(&self, model: &Model) -> Vec<f64> {
        let mut data = Vec::with_capacity(ROWS * (COLUMNS + 1));
        self.each(model, 0..ROWS, |row, rhs| {
            data.extend_from_slice(row);
            data.push(rhs);
        });
        data
    }

    fn built_and_factored(&self, model: &Model) -> Solution {
        solved(|part| {
            let mut rows = Tsqr::new(COLUMNS);
            self.each(model, part, |row, rhs| rows.push(row, rhs));
            rows.finish().unwrap()
        })
    }
}

fn factored(data: &[f64]) -> Solution {
    const WIDTH: usize = COLUMNS + 1;
    solved(|part| {
        let mut rows = Tsqr::new(COLUMNS);
        for row in data[part.start * WIDTH..part.end * WIDTH].chunks_exact(WIDTH) {
            rows.push(&row[..COLUMNS], row[COLUMNS]);
        }
        rows.finish().unwrap()
    })
}

/// Both halves of the rows on a thread each, joined in their order, as runs are, and solved.
fn solved(triangle: impl Fn(std::ops::Range<usize>) -> Triangle + Sync) -> Solution {
    let (first, second) = rayon::join(|| triangle(0..ROWS / 2), || triangle(ROWS / 2..ROWS));
    let mut both = Tsqr::of(&first);
    both.push_triangle(&second);
    solve(&both.finish().unwrap(), Truncation::Relative(1e-10)).unwrap()
}

/// A log as instruments write it, out of range for a second of each twenty.
fn long_log() -> String {
    let mut text = String::with_capacity(20 * READINGS);
    text.push_str("time_s,deviation_um\n");
    for k in 0..READINGS {
        let (time_s, um) = (1e-3 * k as f64, 30.0 * (1e-4 * k as f64).sin());
        let _ = match k / 1000 % 20 {
            0 => writeln!(text, "{time_s:.4},"),
            _ => writeln!(text, "{time_s:.4},{um:.1}"),
        };
    }
    text
}

fn test_file(set: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(set).join("test.toml")
}

/// What an analysis of a set of measured data takes.
struct Analysed {
    readings: usize,
    /// From the test file to the bytes of report, JSON and samples, s.
    to_report_s: f64,
    /// Reading the files of logs and programs, s.
    bytes_s: f64,
    /// Of a process that does nothing else.
    peak_kb: f64,
}

impl Analysed {
    fn of(set: &str) -> Self {
        let test = Test::read(&test_file(set)).unwrap();
        let runs = test.runs().unwrap();
        let files: Vec<&PathBuf> = runs.iter().flat_map(|run| [&run.program, &run.log]).collect();
        let readings = runs.iter().map(|run| {
            log::read(&run.log, &test.log_format_of(run.mounting)).unwrap().readings().len()
        });
        let readings = readings.sum();
        let mut fastest = Fastest::default();
        fastest.time("analysed", || analysed(set));
        fastest.time("bytes", || {
            files.iter().map(|file| std::fs::read(file).unwrap().len()).sum::<usize>()
        });
        let peak_kb = peak_kb(set);
        Self { readings, to_report_s: fastest.s("analysed"), bytes_s: fastest.s("bytes"), peak_kb }
    }
}

fn analysed(set: &str) -> usize {
    let test = Test::read(&test_file(set)).unwrap();
    let machine = test.machine().unwrap();
    let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
    let repeats = &campaign.repeats;
    let analysis = Analysis::new(&test, &machine, &campaign);
    let mut bytes = analysis.to_json().unwrap().len();
    bytes += report::html::render(&analysis, Shown::alone(repeats)).unwrap().len();
    for run in repeats.iter().flat_map(|repeat| &repeat.runs) {
        let mut text = Vec::new();
        report::write_samples(&mut text, run, None).unwrap();
        bytes += text.len();
    }
    bytes
}

/// The highest resident size of an analysis by the program, as Linux counts it, kB; 0 elsewhere.
fn peak_kb(set: &str) -> f64 {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("ratios-out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_ballbar"));
    command.args(["analyse", "--quiet", "--overwrite", "-o"]).args([&out, &test_file(set)]);
    let mut child = command.stdout(std::process::Stdio::null()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak_kb = 0.0_f64;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kb = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
        peak_kb = peak_kb.max(kb.unwrap_or(0.0));
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    peak_kb
}
