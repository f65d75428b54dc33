//! The rows of a fit: what every reading, every mark and the clock say of coefficients and times.

use super::fit::Fit;
use super::input::RunInput;
use super::timing;
use crate::align::Sample;
use crate::error::Result;
use crate::solve::{Triangle, Tsqr};

/// A direction is observed when a combination of errors of this size each (rms over the measured
/// sphere, um) would show by more than `SEEN_SIGMAS` standard deviations of the stated noise.
pub const SEEN_UM: f64 = 25.0;
/// See [`SEEN_UM`].
const SEEN_SIGMAS: f64 = 3.0;

impl Fit<'_> {
    /// Norms against which a column may vanish by cancellation: the longest of the same unit. Columns of
    /// time stand for themselves.
    pub(super) fn references(&self, triangle: &Triangle) -> Vec<f64> {
        let norms = triangle.r().column_norms();
        let parameters = self.model.parameters();
        let longest = |unit: &str| {
            let of_unit = parameters.iter().zip(&norms).filter(|(p, _)| p.unit == unit);
            of_unit.map(|(_, norm)| *norm).fold(0.0, f64::max)
        };
        let mut references = vec![0.0; self.columns.total];
        for (reference, parameter) in references.iter_mut().zip(parameters) {
            *reference = longest(parameter.unit);
        }
        references
    }

    /// Singular values below this are not observed.
    pub(super) fn floor(&self, rows: usize) -> f64 {
        let typical = SEEN_UM * 1e-3 / self.options.noise_mm * (rows as f64).sqrt();
        SEEN_SIGMAS / typical
    }

    /// One pass over the samples: rows of coefficients and time, in units of the noise.
    pub(super) fn factor(&self, detail: timing::Detail) -> Result<Triangle> {
        let mut rows = Tsqr::new(self.columns.total);
        let mut row = vec![0.0; self.columns.total];
        for (index, run) in self.runs.iter().enumerate() {
            let stride = timing::stride(detail, run.samples().len());
            for (k, sample) in run.samples().iter().enumerate().step_by(stride) {
                if self.state.apart[index][k].is_some() {
                    continue;
                }
                let weight = self.weight(index, k);
                let view = timing::view(self.model, &self.state.values, run, sample, detail);
                self.fill_row(&mut row, index, sample, view.speed_mm_s);
                rows.push_weighted(&row, view.residual_mm, weight.sqrt() / self.state.sigma_mm);
            }
            self.push_time(&mut rows, &mut row, index, run);
        }
        rows.finish()
    }

    pub(super) fn fill_row(&self, row: &mut [f64], index: usize, sample: &Sample, speed_mm_s: f64) {
        row.fill(0.0);
        let run = &self.runs[index];
        let situation = self.model.situation(&sample.pose, &sample.motion, run.mounting);
        self.model.row(&situation, &mut row[..self.columns.coefficients]);
        if let Some(offset) = self.columns.offset(index, sample.leg) {
            row[offset] = -speed_mm_s;
        }
        row[self.columns.rate(index)] =
            speed_mm_s * (sample.log_s - run.alignment.time_map.pivot_s);
    }

    /// Rows of the marks and of the clock's tolerance.
    fn push_time(&self, rows: &mut Tsqr, row: &mut [f64], index: usize, run: &RunInput) {
        self.each_time_row(row, index, run, |row, value, sigma| {
            rows.push_weighted(row, value, 1.0 / sigma);
        });
    }

    /// Calls back with each row about the time map alone: row, right-hand side, standard deviation.
    pub(super) fn each_time_row(
        &self,
        row: &mut [f64],
        index: usize,
        run: &RunInput,
        mut push: impl FnMut(&[f64], f64, f64),
    ) {
        let map = &run.alignment.time_map;
        for mark in &run.alignment.marks {
            let leg = map.leg_of(mark.program_s);
            let Some(offset) = self.columns.offset(index, leg) else { continue };
            row.fill(0.0);
            row[offset] = 1.0;
            row[self.columns.rate(index)] = -(mark.log_s - map.pivot_s);
            push(row, map.on_leg_s(mark.log_s, leg) - mark.program_s, mark.sigma_s);
        }
        row.fill(0.0);
        row[self.columns.rate(index)] = 1.0;
        push(row, -map.rate, self.options.clock_tolerance);
    }

    /// Change of the predicted length with program time at a sample, mm/s.
    pub(super) fn speed_mm_s(&self, run: &RunInput, sample: &Sample) -> f64 {
        timing::view(self.model, &self.state.values, run, sample, timing::Detail::Full).speed_mm_s
    }

    /// Observed minus computed at every sample of every run, mm.
    pub(super) fn left_mm(&self) -> Vec<Vec<f64>> {
        let of =
            |run: &RunInput, sample: &Sample| sample.deviation_mm - self.computed_mm(run, sample);
        self.runs.iter().map(|run| run.samples().iter().map(|s| of(run, s)).collect()).collect()
    }

    /// The deviation that the model computes at a sample, mm.
    pub(super) fn computed_mm(&self, run: &RunInput, sample: &Sample) -> f64 {
        let values = &self.state.values;
        self.model.length_mm(values, &sample.pose, &sample.motion, run.mounting) - run.nominal_mm
    }

    /// Weight of a sample, 0 to 1.
    pub(super) fn weight(&self, run: usize, sample: usize) -> f64 {
        self.state.weights.as_ref().map_or(1.0, |weights| weights[run][sample])
    }
}
