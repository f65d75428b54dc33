//! What was measured already: an analysis as the beginning of a design.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::information::{Basis, SET_UPS};
use super::problem::add_information;
use crate::align;
use crate::error::{Error, Place, Result};
use crate::identify;
use crate::input;
use crate::machine::{Axis, Machine, Pivot};
use crate::model::Situation;
use crate::monitor::FORMATS;
use crate::nc;
use crate::plan::Test;
use crate::solve::{Matrix, NoiseModel, Tsqr};

/// The runs of an analysis, with the noise that it found.
#[derive(Debug)]
pub struct Measured {
    test: Test,
    /// Long-run variance of a reading, mm².
    variance_mm2: f64,
}

#[derive(Deserialize)]
struct RawAnalysis {
    format: String,
    test: RawFacts,
    repeats: Vec<RawRepeat>,
}

#[derive(Deserialize)]
struct RawFacts {
    file: PathBuf,
    sha256: String,
}

#[derive(Deserialize)]
struct RawRepeat {
    noise: RawNoise,
}

#[derive(Deserialize)]
struct RawNoise {
    innovation_um: f64,
    autoregressive: Vec<f64>,
}

/// Largest innovation of the noise, um: a bar that reads with more measures nothing.
const LARGEST_NOISE_UM: f64 = 1e4;
/// Most coefficients of the noise; an analysis has some ten.
const MOST_COEFFICIENTS: usize = 1000;
/// Largest of them: those of a stationary process are no larger than its binomials, and 20 of them have less.
const LARGEST_COEFFICIENT: f64 = 1e6;

impl Measured {
    /// Reads an `analysis.json` and the test file that it names.
    ///
    /// # Errors
    /// When the file is no analysis; when the test file is gone or has changed since.
    pub fn read(file: &Path) -> Result<Self> {
        let bytes = input::read(file, "analysis")?;
        let analysis: RawAnalysis = serde_json::from_slice(&bytes).map_err(|error| {
            Error::input(format!("this is not an analysis: {error}"))
                .at(Place::file(file))
                .hint("give the analysis.json that `ballbar analyse` wrote")
        })?;
        if !FORMATS.contains(&analysis.format.as_str()) {
            return Err(Error::input(format!("the format `{}` is unknown", analysis.format))
                .at(Place::file(file))
                .hint("analyse the test again with this version"));
        }
        // From the folder of the analysis; earlier versions named it as the command line did.
        let beside = file.parent().unwrap_or(Path::new("")).join(&analysis.test.file);
        let test_file = if beside.exists() { beside } else { analysis.test.file };
        let test = Test::read(&test_file)?;
        if test.hash() != analysis.test.sha256 {
            return Err(Error::input("the test file is not the one that was analysed")
                .at(Place::file(&test_file))
                .hint("analyse the test again, or put the old file back"));
        }
        let mut variances = Vec::new();
        for repeat in &analysis.repeats {
            let noise = &repeat.noise;
            let possible = (0.0..=LARGEST_NOISE_UM).contains(&noise.innovation_um)
                && noise.autoregressive.len() <= MOST_COEFFICIENTS
                && noise.autoregressive.iter().all(|phi| phi.abs() <= LARGEST_COEFFICIENT);
            if !possible {
                return Err(Error::input(format!(
                    "the noise of a repeat must have an `innovation_um` from 0 to {LARGEST_NOISE_UM} and at most {MOST_COEFFICIENTS} `autoregressive` coefficients from -{LARGEST_COEFFICIENT} to {LARGEST_COEFFICIENT}"
                ))
                .at(Place::file(file))
                .hint("analyse the test again"));
            }
            let model = NoiseModel::autoregressive(
                noise.autoregressive.clone(),
                noise.innovation_um * 1e-3,
            )
            .map_err(|error| error.at(Place::file(file)))?;
            variances.push(model.long_run_variance());
        }
        let variance_mm2 = variances.iter().sum::<f64>() / variances.len() as f64;
        let usable = variance_mm2.is_finite() && variance_mm2 > 0.0;
        if !usable {
            return Err(Error::input("the analysis states no noise")
                .at(Place::file(file))
                .hint("analyse the test again"));
        }
        Ok(Self { test, variance_mm2 })
    }

    /// The mounting of the last run: its balls are taken to be where they were.
    pub fn mounted(&self) -> Option<&str> {
        let last = self.test.runs().ok()?.last()?;
        self.test.mountings().get(last.mounting).map(|named| named.name.as_str())
    }

    /// Long-run variance of a reading as the analysis found it, mm².
    pub fn variance_mm2(&self) -> f64 {
        self.variance_mm2
    }

    /// What was measured on another machine says nothing about this one.
    ///
    /// # Errors
    /// When the test that was analysed names a machine of another name or kinematics.
    pub(super) fn belongs_to(&self, machine: &Machine) -> Result<()> {
        let other = self.test.machine()?;
        let kind = |machine: &Machine| {
            let pivots = Axis::ALL.map(|axis| machine.slide(axis).pivot);
            (machine.name().to_owned(), machine.topology().as_str().to_owned(), pivots)
        };
        if kind(&other) == kind(machine) {
            return Ok(());
        }
        let told = |machine: &Machine| {
            let pivots = Axis::ALL.map(|axis| match machine.slide(axis).pivot {
                Pivot::Carriage => "carriage",
                Pivot::Base => "base",
            });
            format!(
                "`{}` ({}, pivots {})",
                machine.name(),
                machine.topology().as_str(),
                pivots.join(" ")
            )
        };
        Err(Error::input(format!(
            "the analysis is of {}, the design for {}",
            told(&other),
            told(machine)
        ))
        .at(Place::file(self.test.file()))
        .hint("give an analysis of the same machine, or design without `--given`"))
    }

    /// The test that was analysed.
    pub fn test(&self) -> &Test {
        &self.test
    }

    /// Adds what the runs tell about the coefficients, the set-up errors of every run unknown.
    pub(super) fn add_to(
        &self,
        known: &mut Matrix,
        basis: &Basis,
        machine: &Machine,
    ) -> Result<()> {
        let mut done: Vec<(PathBuf, usize, Matrix)> = Vec::new();
        for run in self.test.runs()? {
            let same = done.iter().find(|(program, mounting, _)| {
                *program == run.program && *mounting == run.mounting
            });
            let information = match same {
                Some((.., information)) => information.clone(),
                None => self.of_run(&run.program, run.mounting, basis, machine)?,
            };
            for i in 0..known.rows() {
                for (sum, x) in known.row_mut(i).iter_mut().zip(information.row(i)) {
                    *sum += x;
                }
            }
            if same.is_none() {
                done.push((run.program.clone(), run.mounting, information));
            }
        }
        Ok(())
    }

    /// What one run of a program tells about the coefficients.
    fn of_run(
        &self,
        program: &Path,
        mounting: usize,
        basis: &Basis,
        machine: &Machine,
    ) -> Result<Matrix> {
        let named = &self.test.mountings()[mounting];
        let mut reading = nc::Reading::of(machine);
        reading.work_offsets_mm.insert(named.work_offset, named.mounting.coincidence_mm);
        let program = nc::read_file(program, &reading)?;
        let bar = self.test.bar_of(mounting);
        let rehearsed = identify::rehearse(&program, machine, &bar, mounting, named)?;
        let n = basis.coefficients.len();
        let mut rows = Tsqr::new(SET_UPS + n);
        let weight = self.variance_mm2.sqrt().recip();
        for sample in rehearsed.samples() {
            if !matches!(sample.part, align::Part::Arc(_)) {
                continue;
            }
            let at = Situation::new(machine, &named.mounting, 0, &sample.pose);
            let Some(at) = at else { continue };
            let row = basis.row(&at);
            // Set-up errors first: what is below them in the triangle is what they do not explain.
            let (coefficients, balls) = row.split_at(n);
            rows.push_weighted(&[balls, coefficients].concat(), 0.0, weight);
        }
        for k in 0..SET_UPS {
            rows.push_prior(k, 0.0, 1.0);
        }
        let triangle = rows.finish()?;
        let mut information = Matrix::zeros(n, n);
        let below = Matrix::from_fn(n, n, |i, k| triangle.r()[(SET_UPS + i, SET_UPS + k)]);
        add_information(&mut information, &below, 1.0);
        Ok(information)
    }
}
