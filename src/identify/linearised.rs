//! A settled fit as a linear problem: what any further column could explain.
//!
//! With the rows `B` of a fit (coefficients and times, weighed, the rows about time included) and
//! `Q = B D^-1 V_r S_r^-1` orthonormal over the directions that the fit keeps, a further column `c`
//! explains what is left of it,
//!
//! `c' = c - Q Q^T c`,
//!
//! and changes the parameters of the fit by `- F Q^T c` per unit, `F = D^-1 V_r S_r^-1`.

use super::fit::Fit;
use super::input::Options;
use super::residuals::Record;
use super::result::Identification;
use crate::align::{Place, Sample};
use crate::error::Result;
use crate::model::{Model, Situation};
use crate::solve::{Basis, Matrix, Truncation};

/// A sample that the fit used.
#[derive(Debug, Clone)]
pub struct LinearSample {
    /// Index of its run.
    pub run: usize,
    /// Index of its sample in the run.
    pub sample: usize,
    /// Index of the section of the program that it lies on.
    pub section: usize,
    /// Program time, s.
    pub program_s: f64,
    /// Where it was taken.
    pub situation: Situation,
    /// Root of its weight, 0 to 1.
    pub root_weight: f64,
    /// Measured minus predicted, mm, not weighed.
    pub residual_mm: f64,
}

/// A settled fit as a linear problem.
#[derive(Debug, Clone)]
pub struct Linearised {
    /// The samples, in the order of runs and time.
    pub samples: Vec<LinearSample>,
    /// `Q` at the samples.
    pub basis: Basis,
    /// `F`: parameters of the model (mm, rad) per unit of `Q^T c`, `c` in mm.
    pub factor: Matrix,
}

impl Identification {
    /// The fit that came out, as a linear problem; of long logs every so many samples, so that no run
    /// has more than `most`.
    ///
    /// # Errors
    /// When the fit's rows are not finite.
    pub fn linearised(&self, model: &Model, options: &Options, most: usize) -> Result<Linearised> {
        let mut fit = Fit::new(model, self.runs.clone(), options);
        fit.values = self.values();
        fit.sigma_mm = self.rms_mm.max(1e-9);
        // By the times as they settled, a sample that the fit used may lie just beyond the end of its arc.
        let on_arc = |sample: &Sample| matches!(sample.place, Place::Arc(_));
        fit.taking_part = self
            .runs
            .iter()
            .zip(&self.records)
            .map(|(run, records)| {
                let stride = records.len().div_ceil(most.max(1)).max(1);
                let pairs = run.alignment.samples.iter().zip(records).enumerate();
                pairs.map(|(k, (s, r))| r.used && on_arc(s) && k % stride == 0).collect()
            })
            .collect();
        let weight = |run: &Vec<Record>| run.iter().map(|r| r.weight).collect();
        fit.weights = Some(self.records.iter().map(weight).collect());
        let triangle = fit.triangle()?;
        let spectrum = fit.spectrum(&triangle)?;
        let rank = spectrum.retained(Truncation::Effect(fit.floor(triangle.rows())));
        let singular = spectrum.singular_values();
        let (v, scales) = (spectrum.right_singular_vectors(), spectrum.scales());
        let factor = Matrix::from_fn(fit.columns.total, rank, |k, i| match scales[k] {
            0.0 => 0.0,
            scale => v[(k, i)] / scale / singular[i],
        });
        let mut samples = Vec::new();
        let mut q = Vec::new();
        let mut row = vec![0.0; fit.columns.total];
        for (index, run) in fit.runs.iter().enumerate() {
            for (k, sample) in run.alignment.samples.iter().enumerate() {
                let (true, Place::Arc(section)) = (fit.taking_part[index][k], sample.place) else {
                    continue;
                };
                let record = &self.records[index][k];
                let speed_mm_s = fit.speed_mm_s(run, sample);
                fit.fill_row(&mut row, index, sample, speed_mm_s);
                let root_weight = record.weight.sqrt();
                let first = q.len();
                q.resize(first + rank, 0.0);
                let out = &mut q[first..];
                for (column, value) in row.iter().enumerate() {
                    let value = value * root_weight / fit.sigma_mm;
                    if value != 0.0 {
                        for (q, f) in out.iter_mut().zip(factor.row(column)) {
                            *q += value * f;
                        }
                    }
                }
                samples.push(LinearSample {
                    run: index,
                    sample: k,
                    section,
                    program_s: sample.program_s,
                    situation: model.situation(&sample.pose, &sample.motion, run.mounting),
                    root_weight,
                    residual_mm: record.residual_mm,
                });
            }
        }
        let sigma_mm = fit.sigma_mm;
        let factor =
            Matrix::from_fn(fit.columns.coefficients, rank, |k, i| factor[(k, i)] / sigma_mm);
        Ok(Linearised { samples, basis: Basis::new(rank, q), factor })
    }
}
