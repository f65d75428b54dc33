//! The rows of a fit: what every reading, every mark and the clock say of coefficients and times.

use rayon::prelude::*;

use super::fit::Fit;
use super::input::RunInput;
use super::timing::{self, View};
use crate::align::Sample;
use crate::error::Result;
use crate::solve::{Triangle, Truncation, Tsqr};

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
    fn floor(&self, rows: usize) -> f64 {
        let typical = SEEN_UM * 1e-3 / self.options.noise_mm * (rows as f64).sqrt();
        SEEN_SIGMAS / typical
    }

    /// One pass over the samples: rows of coefficients and time, in units of the noise.
    pub(super) fn factor(&self, detail: timing::Detail) -> Result<Triangle> {
        let mut rows = self.fold_runs(&|index, rows| {
            let run = &self.runs[index];
            let mut row = vec![0.0; rows.columns()];
            let stride = timing::stride(detail, run.samples().len());
            for (k, sample) in run.samples().iter().enumerate().step_by(stride) {
                if self.state.apart[index][k].is_some() {
                    continue;
                }
                let weight = self.weight(index, k);
                let view = timing::view(self.model, &self.state.values, run, sample, detail);
                self.fill_row(&mut row, index, sample, &view);
                let residual_mm = self.residual_mm(index, &view);
                rows.push_weighted(&row, residual_mm, weight.sqrt() / self.state.counts_mm());
            }
            self.each_time_row(&mut row, index, |row, value, sigma| {
                rows.push_weighted(row, value, 1.0 / sigma);
            });
        })?;
        self.push_plausible(&mut rows, &self.state.values);
        for (column, value, sigma) in self.driven() {
            rows.push_prior(column, -value, sigma);
        }
        rows.finish()
    }

    /// Rows of the runs, pushed side by side, each run's among its own columns, and joined in the order of the runs.
    pub(super) fn fold_runs(&self, push: &(dyn Fn(usize, &mut Tsqr) + Sync)) -> Result<Tsqr> {
        let of_run = |index: usize| {
            let places = self.columns.of_run(index);
            let mut rows = Tsqr::new(places.len());
            push(index, &mut rows);
            Ok((rows.finish()?, places))
        };
        let runs: Vec<Result<_>> = (0..self.runs.len()).into_par_iter().map(of_run).collect();
        let mut all = Tsqr::new(self.columns.total);
        for run in runs {
            let (triangle, places) = run?;
            all.push_among(&triangle, &places);
        }
        Ok(all)
    }

    /// The row of a sample: coefficients, then the times of its run.
    pub(super) fn fill_row(&self, row: &mut [f64], index: usize, sample: &Sample, view: &View) {
        row.fill(0.0);
        let run = &self.runs[index];
        let (pose, motion) = (&sample.pose, &sample.motion);
        let situation = if self.state.bent {
            self.model.situation_bent(&self.state.values, pose, motion, run.mounting)
        } else {
            self.model.situation(pose, motion, run.mounting)
        };
        self.model.row(&situation, &mut row[..self.columns.coefficients]);
        let map = &run.alignment.time_map;
        let at = |column: usize| self.columns.in_row(index, column);
        if let Some(offset) = self.columns.offset(index, sample.leg) {
            row[at(offset)] = -view.speed_mm_s;
        }
        row[at(self.columns.rate(index))] = view.speed_mm_s * (sample.log_s - map.pivot_s);
        row[at(self.columns.pace(index))] =
            view.speed_mm_s * map.from_middle_s(sample.log_s, sample.leg);
        if self.columns.as_planned {
            return;
        }
        row[at(self.columns.following(index))] = view.following_mm_s;
        for (column, contrast) in self.columns.delays(index).zip(&self.columns.delays[index]) {
            row[at(column)] =
                if self.columns.unlike { view.delayed_mm_s.dot(contrast) } else { 0.0 };
        }
        if let Some(column) = self.columns.cut(index) {
            row[at(column)] = 1.0;
        }
    }

    /// What is plausible, as rows: each parameter `0 ± its deviation`, seen from these values.
    fn push_plausible(&self, rows: &mut Tsqr, values: &[f64]) {
        for (column, (plausible, value)) in self.state.plausible.iter().zip(values).enumerate() {
            if let Some(sigma) = plausible {
                rows.push_prior(column, -value, *sigma);
            }
        }
    }

    /// Which directions a solution keeps: where what is plausible holds every parameter, all of them.
    pub(super) fn truncation(&self, rows: usize) -> Truncation {
        if self.state.knows() {
            Truncation::Relative(f64::EPSILON)
        } else {
            Truncation::Effect(self.floor(rows))
        }
    }

    /// Calls back with each row about the time map alone: row, right-hand side, standard deviation.
    pub(super) fn each_time_row(
        &self,
        row: &mut [f64],
        index: usize,
        mut push: impl FnMut(&[f64], f64, f64),
    ) {
        let run = &self.runs[index];
        let map = &run.alignment.time_map;
        let at = |column: usize| self.columns.in_row(index, column);
        let (rate, pace) = (at(self.columns.rate(index)), at(self.columns.pace(index)));
        for mark in &run.alignment.marks {
            let leg = map.leg_of(mark.program_s);
            let Some(offset) = self.columns.offset(index, leg) else { continue };
            row.fill(0.0);
            row[at(offset)] = 1.0;
            row[rate] = -(mark.log_s - map.pivot_s);
            row[pace] = -map.from_middle_s(mark.log_s, leg);
            push(row, map.on_leg_s(mark.log_s, leg) - mark.program_s, mark.sigma_s);
        }
        let legs = &self.columns.runs[index].1;
        for two in legs.windows(2).filter(|two| map.hang_together(two[0], two[1])) {
            let [Some(first), Some(second)] =
                [two[0], two[1]].map(|l| self.columns.offset(index, l))
            else {
                continue;
            };
            row.fill(0.0);
            (row[at(first)], row[at(second)]) = (-1.0, 1.0);
            let stood_s = map.offsets_s[two[1]] - map.offsets_s[two[0]];
            let [mean_s, sigma_s] = map.stands_s(two[0], two[1]);
            push(row, mean_s - stood_s, sigma_s);
        }
        row.fill(0.0);
        row[rate] = 1.0;
        push(row, -map.rate, self.options.clock_tolerance);
        row.fill(0.0);
        row[pace] = 1.0;
        push(row, -map.pace, map.pace_plausible);
    }

    /// What is plausible of how the control drives: column, value, and its standard deviation, of every run.
    pub(super) fn driven(&self) -> Vec<(usize, f64, f64)> {
        let mut driven = Vec::new();
        for (index, run) in self.runs.iter().enumerate() {
            let map = &run.alignment.time_map;
            let following_s =
                if self.state.at_once[index] { timing::AT_ONCE_S } else { timing::FOLLOWING_S };
            driven.push((self.columns.following(index), map.following_s, following_s));
            for (column, contrast) in self.columns.delays(index).zip(&self.columns.delays[index]) {
                driven.push((column, map.delays_s.dot(contrast), timing::FOLLOWING_S));
            }
            if let Some(column) = self.columns.cut(index) {
                let sigma_mm = timing::CUT * run.alignment.chord_sag_mm;
                driven.push((column, run.alignment.time_map.cut_mm, sigma_mm));
            }
        }
        driven
    }

    /// Observed minus computed at a sample of a run, mm.
    pub(super) fn residual_mm(&self, index: usize, view: &View) -> f64 {
        if self.columns.unlike {
            view.residual_mm
        } else {
            let delays_s = &self.runs[index].alignment.time_map.delays_s;
            view.residual_mm + view.delayed_mm_s.dot(delays_s)
        }
    }

    /// A sample as the fit sees it where all counts.
    pub(super) fn view(&self, run: &RunInput, sample: &Sample) -> View {
        timing::view(self.model, &self.state.values, run, sample, timing::Detail::Full)
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
        let length_mm = self.model.length_mm(values, &sample.pose, &sample.motion, run.mounting);
        length_mm + run.alignment.time_map.cut_mm - run.nominal_mm
    }

    /// Weight of a sample, 0 to 1.
    pub(super) fn weight(&self, run: usize, sample: usize) -> f64 {
        self.state.weights.as_ref().map_or(1.0, |weights| weights[run][sample])
    }
}
