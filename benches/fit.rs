//! Rows a second of the fit: columns built from poses, factored, one thread.
//!
//! `cargo bench --bench fit`, then `python3 benches/numpy_fit.py` for the same matrix in `NumPy`.

#![allow(clippy::unwrap_used)]
#![allow(missing_docs)]

use std::io::Write;
use std::path::Path;

use ballbar::identify::MeasuredRun;
use ballbar::machine::{Machine, Mounting, Pose};
use ballbar::model::{self, Model};
use ballbar::plan::Test;
use ballbar::solve::Tsqr;

/// Some 100 000 rows: every measured sample on an arc, of all five runs, more than twice.
const ROWS: usize = 100_000;
const COLUMNS: usize = 40;

fn main() {
    let measured = Measured::new();
    measured.write_matrix();
    divan::main();
}

struct Measured {
    machine: Machine,
    mounting: Mounting,
    poses: Vec<Pose>,
    deviations_mm: Vec<f64>,
}

impl Measured {
    fn new() -> Self {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/hu40t/test.toml");
        let test = Test::read(&file).unwrap();
        let machine = test.machine().unwrap();
        let mounting = test.mountings()[0].mounting;
        let (mut poses, mut deviations_mm) = (Vec::new(), Vec::new());
        for run in test.runs().unwrap() {
            let measured = MeasuredRun::read(&test, run).unwrap();
            for sample in measured.aligned(&test, &machine).unwrap().samples() {
                if matches!(sample.part, ballbar::align::Part::Arc(_)) {
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

    fn rows(&self, model: &Model, mut push: impl FnMut(&[f64], f64)) {
        let mut row = vec![0.0; COLUMNS];
        for (pose, deviation_mm) in self.poses.iter().zip(&self.deviations_mm) {
            model.row(&model.situation(pose, &model::Motion::REST, 0), &mut row);
            push(&row, *deviation_mm);
        }
    }

    /// The matrix for `NumPy`: rows of 40 columns and the right-hand side, f64, little endian.
    fn write_matrix(&self) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/fit_matrix.f64");
        let mut out = std::io::BufWriter::new(std::fs::File::create(file).unwrap());
        self.rows(&self.model(), |row, rhs| {
            for value in row.iter().chain([&rhs]) {
                out.write_all(&value.to_le_bytes()).unwrap();
            }
        });
    }
}

#[divan::bench(sample_count = 20)]
fn columns_built_and_factored(bencher: divan::Bencher) {
    let measured = Measured::new();
    let model = measured.model();
    assert_eq!(model.parameters().len(), COLUMNS);
    bencher.counter(divan::counter::ItemsCount::new(ROWS)).bench_local(|| {
        let mut rows = Tsqr::new(COLUMNS);
        measured.rows(&model, |row, rhs| rows.push(row, rhs));
        rows.finish().unwrap()
    });
}

#[divan::bench(sample_count = 20)]
fn columns_built(bencher: divan::Bencher) {
    let measured = Measured::new();
    let model = measured.model();
    bencher.counter(divan::counter::ItemsCount::new(ROWS)).bench_local(|| {
        let mut sum = 0.0;
        measured.rows(&model, |row, rhs| sum += row[7] * rhs);
        sum
    });
}
