//! The rows of a fit: what every reading, every mark and the clock say of coefficients and times.

use rayon::prelude::*;

use super::fit::Fit;
use super::input::RunInput;
use super::timing::{self, View};
use crate::align::{FOLLOWING_S, Part, Sample};
use crate::error::{Error, Kind, Result};
use crate::solve::{Bordered, Triangle, Truncation, Tsqr};

/// A direction is observed when a combination of errors of this size each (rms over the measured
/// sphere, um) would show by more than `SEEN_SIGMAS` standard deviations of the stated noise.
pub const SEEN_UM: f64 = 25.0;
/// See [`SEEN_UM`].
const SEEN_SIGMAS: f64 = 3.0;

/// Rows that are worked out before they are folded: few enough to be still at hand then.
const AT_ONCE: usize = 512;

impl Fit<'_> {
    /// Norms against which the column of a coefficient may vanish by cancellation: the longest of the same unit.
    pub(super) fn references(&self, rows: &Bordered) -> Vec<f64> {
        let parameters = self.model.parameters();
        let longest = |unit: &str| {
            let of_unit = parameters.iter().zip(rows.norms()).filter(|(p, _)| p.unit == unit);
            of_unit.map(|(_, norm)| *norm).fold(0.0, f64::max)
        };
        parameters.iter().map(|parameter| longest(parameter.unit)).collect()
    }

    /// Singular values below this are not observed.
    fn floor(&self, rows: usize) -> f64 {
        let typical = SEEN_UM * 1e-3 / self.options.noise_mm * (rows as f64).sqrt();
        SEEN_SIGMAS / typical
    }

    /// One pass over the samples: rows of coefficients and time, in units of the noise.
    pub(super) fn factor(&self, detail: timing::Detail) -> Result<Bordered> {
        self.joined(self.rows_of_runs(detail)?)
    }

    /// The triangle of each run.
    pub(super) fn rows_of_runs(&self, detail: timing::Detail) -> Result<Vec<Triangle>> {
        self.fold_runs(&|index, rows| self.push_run(index, detail, rows))
    }

    /// The rows of a run.
    pub(super) fn push_run(&self, index: usize, detail: timing::Detail, rows: &mut Tsqr) {
        self.push_samples(index, detail, |_| true, rows);
        self.push_times(index, rows);
    }

    /// Those of its samples, of some legs.
    pub(super) fn push_samples(
        &self,
        index: usize,
        detail: timing::Detail,
        of_leg: impl Fn(usize) -> bool,
        rows: &mut Tsqr,
    ) {
        let samples = self.runs[index].samples();
        let (each, taken) = timing::standing_for(samples.len(), self.state.taking);
        let taken =
            taken.filter(|k| of_leg(samples[*k].leg) && self.state.apart[index][*k].is_none());
        self.each_row(index, &taken.collect::<Vec<_>>(), detail, |k, row, residual_mm| {
            let weight = each as f64 * self.weight(index, k);
            rows.push_weighted(row, residual_mm, weight.sqrt() / self.state.counts_mm());
        });
    }

    /// Those about its times alone.
    pub(super) fn push_times(&self, index: usize, rows: &mut Tsqr) {
        let mut row = vec![0.0; rows.columns()];
        self.each_time_row(&mut row, index, |row, value, sigma| {
            rows.push_weighted(row, value, 1.0 / sigma);
        });
        for (column, value, sigma) in self.driven(index) {
            rows.push_prior(column, -value, sigma);
        }
    }

    /// All rows, from the triangles of the runs.
    pub(super) fn joined(&self, runs: Vec<Triangle>) -> Result<Bordered> {
        let own = (0..).map(|index| self.columns.own(index));
        Bordered::new(own.zip(runs).collect(), self.plausible()?)
    }

    /// Refuses a fit to no reading at all.
    pub(super) fn refuse_none(&self) -> Result<()> {
        if self.state.apart.iter().flatten().any(Option::is_none) {
            return Ok(());
        }
        let on_arcs = |run: &RunInput| {
            run.samples().iter().filter(|s| matches!(s.part, Part::Arc(_))).count()
        };
        Err(Error::new(
            Kind::Undetermined,
            format!(
                "of {} readings on arcs none is so far from a reversal and from an end of its arc that it is known which way each axis goes",
                self.runs.iter().map(on_arcs).sum::<usize>()
            ),
        )
        .hint("drive slower, log faster, or take a longer bar"))
    }

    /// Calls back with each of some samples of a run, by their indices, one after the other: index, row, and what was
    /// observed minus what is computed, mm. The rows themselves are worked out side by side.
    pub(super) fn each_row(
        &self,
        index: usize,
        taken: &[usize],
        detail: timing::Detail,
        mut push: impl FnMut(usize, &[f64], f64),
    ) {
        let run = &self.runs[index];
        let width = self.columns.own(index) + self.columns.coefficients;
        let mut rows = vec![0.0; AT_ONCE.min(taken.len()) * width];
        let mut residuals_mm = [0.0; AT_ONCE];
        for batch in taken.chunks(AT_ONCE) {
            let to = rows.par_chunks_exact_mut(width).zip(&mut residuals_mm);
            to.zip(batch).with_min_len(AT_ONCE / 8).for_each(|((row, residual_mm), k)| {
                let sample = &run.samples()[*k];
                let view = timing::view(self.model, &self.state.values, run, sample, detail);
                self.fill_row(row, index, sample, &view);
                *residual_mm = self.residual_mm(index, &view);
            });
            let done = rows.chunks_exact(width).zip(&residuals_mm);
            batch.iter().zip(done).for_each(|(k, (row, residual_mm))| push(*k, row, *residual_mm));
        }
    }

    /// For how many readings and other rows those of [`Self::factor`] stand.
    pub(super) fn counted(&self, rows: &Bordered) -> f64 {
        let more = |(index, run): (usize, &RunInput)| {
            let (each, taken) = timing::standing_for(run.samples().len(), self.state.taking);
            (each - 1) * taken.filter(|k| self.state.apart[index][*k].is_none()).count()
        };
        (rows.rows() + self.runs.iter().enumerate().map(more).sum::<usize>()) as f64
    }

    /// The triangle of each run, folded side by side: its own columns, then the coefficients.
    pub(super) fn fold_runs(
        &self,
        push: &(dyn Fn(usize, &mut Tsqr) + Sync),
    ) -> Result<Vec<Triangle>> {
        (0..self.runs.len()).into_par_iter().map(|index| self.fold_run(index, push)).collect()
    }

    /// The triangle of one run.
    pub(super) fn fold_run(
        &self,
        index: usize,
        push: impl FnOnce(usize, &mut Tsqr),
    ) -> Result<Triangle> {
        let mut rows = Tsqr::new(self.columns.own(index) + self.columns.coefficients);
        push(index, &mut rows);
        rows.finish()
    }

    /// The row of a sample: the times of its run, then the coefficients.
    pub(super) fn fill_row(&self, row: &mut [f64], index: usize, sample: &Sample, view: &View) {
        row.fill(0.0);
        let run = &self.runs[index];
        let (pose, motion) = (&sample.pose, &sample.motion);
        let situation = if self.state.bent {
            self.model.situation_bent(&view.errors, pose, motion, run.mounting)
        } else {
            self.model.situation(pose, motion, run.mounting)
        };
        let (own, coefficients) = row.split_at_mut(self.columns.own(index));
        self.model.row(&situation, coefficients);
        let map = &run.alignment.time_map;
        if let Some(offset) = self.columns.offset(index, sample.leg) {
            own[offset] = -view.speed_mm_s;
        }
        own[self.columns.rate(index)] = view.speed_mm_s * (sample.log_s - map.pivot_s);
        own[self.columns.pace(index)] =
            view.speed_mm_s * map.from_middle_s(sample.log_s, sample.leg);
        if self.columns.as_planned {
            return;
        }
        own[self.columns.following(index)] = view.following_mm_s;
        for (column, contrast) in self.columns.delays(index).zip(&self.columns.delays[index]) {
            own[column] = if self.columns.unlike { view.delayed_mm_s.dot(contrast) } else { 0.0 };
        }
        for (column, contrast) in self.columns.longer(index).zip(&self.columns.longer[index]) {
            own[column] = view.longer_mm.dot(contrast);
        }
        if let Some(column) = self.columns.cut(index) {
            own[column] = 1.0;
        }
        if let Some(column) = self.columns.rounded(index) {
            own[column] = self.rounding_mm(run, sample, view);
        }
    }

    /// By how much longer the bar were at a sample if corners of chords were wholly rounded out, mm. Until the fit is near chords are
    /// driven: what is rounded out of them tells no time, and times are what it still looks for.
    fn rounding_mm(&self, run: &RunInput, sample: &Sample, view: &View) -> f64 {
        let alignment = &run.alignment;
        let chords = &alignment.time_map.chords[sample.leg];
        let counts = chords.there_are() && chords.blur_s <= 0.0;
        if !self.state.bent || !counts || !matches!(sample.part, Part::Arc(_)) {
            return 0.0;
        }
        view.rounding_mm.unwrap_or_else(|| {
            let now = (sample.leg, sample.program_s, sample.block);
            alignment.rounding_mm(&run.following[0], now, &sample.motion.velocity_mm_s)
        })
    }

    /// What is plausible, as rows: each parameter `0 ± its deviation`, seen from where the fit stands.
    fn plausible(&self) -> Result<Triangle> {
        let mut rows = Tsqr::new(self.columns.coefficients);
        let known = self.state.plausible.iter().zip(&self.state.values).enumerate();
        for (column, (plausible, value)) in known {
            if let Some(sigma) = plausible {
                rows.push_prior(column, -value, *sigma);
            }
        }
        rows.finish()
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
        let (rate, pace) = (self.columns.rate(index), self.columns.pace(index));
        for mark in &run.alignment.marks {
            let leg = map.leg_of(mark.program_s);
            let Some(offset) = self.columns.offset(index, leg) else { continue };
            row.fill(0.0);
            row[offset] = 1.0;
            row[rate] = -(mark.log_s - map.pivot_s);
            row[pace] = -map.from_middle_s(mark.log_s, leg);
            push(row, map.on_leg_s(mark.log_s, leg) - mark.program_s, mark.sigma_s);
        }
        let legs = &self.columns.legs[index];
        for &leg in legs {
            let (Some(offset), Some([told_s, sigma_s])) =
                (self.columns.offset(index, leg), map.chords[leg].told_s)
            else {
                continue;
            };
            row.fill(0.0);
            row[offset] = 1.0;
            push(row, told_s - map.offsets_s[leg], sigma_s);
        }
        for two in legs.windows(2).filter(|two| map.hang_together(two[0], two[1])) {
            let [Some(first), Some(second)] =
                [two[0], two[1]].map(|l| self.columns.offset(index, l))
            else {
                continue;
            };
            row.fill(0.0);
            (row[first], row[second]) = (-1.0, 1.0);
            let stood_s = map.offsets_s[two[1]] - map.offsets_s[two[0]];
            let [mean_s, sigma_s] = map.stands_s(two[0], two[1]);
            push(row, mean_s - stood_s, sigma_s);
        }
        row.fill(0.0);
        row[rate] = 1.0;
        push(row, -map.rate, self.options.clock_tolerance);
        row.fill(0.0);
        row[pace] = 1.0;
        let [told, sigma] = map.pace_told();
        push(row, told - map.pace, sigma);
    }

    /// What is plausible of how the control drives in a run: column, value, and its standard deviation.
    pub(super) fn driven(&self, index: usize) -> Vec<(usize, f64, f64)> {
        let alignment = &self.runs[index].alignment;
        let map = &alignment.time_map;
        // All runs of a machine have the same lag: what is plausible of it counts once, and not once a run.
        let once_s = FOLLOWING_S * (self.runs.len() as f64).sqrt();
        // What is held is held where it is.
        let following = if self.state.at_once[index] {
            (0.0, timing::AT_ONCE_S)
        } else {
            (map.following_s, once_s)
        };
        let mut driven = vec![(self.columns.following(index), following.0, following.1)];
        for (column, contrast) in self.columns.delays(index).zip(&self.columns.delays[index]) {
            driven.push((column, map.delays_s.dot(contrast), FOLLOWING_S));
        }
        for (column, contrast) in self.columns.longer(index).zip(&self.columns.longer[index]) {
            driven.push((column, map.longer.dot(contrast), timing::LONGER));
        }
        if let Some(column) = self.columns.cut(index) {
            driven.push((column, map.cut_mm, timing::CUT * alignment.chord_sag_mm));
        }
        if let Some(column) = self.columns.rounded(index) {
            driven.push((column, map.rounded, timing::ROUNDED));
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

    /// Observed minus computed at every sample of every run, mm.
    pub(super) fn left_mm(&self) -> Vec<Vec<f64>> {
        let of =
            |run: &RunInput, sample: &Sample| sample.deviation_mm - self.computed_mm(run, sample);
        self.runs.iter().map(|run| run.samples().iter().map(|s| of(run, s)).collect()).collect()
    }

    /// Observed minus computed at every sample of every run where only so much of the path counts, mm.
    pub(super) fn left_in_mm(&self, detail: timing::Detail) -> Vec<Vec<f64>> {
        let of = |index: usize, sample: &Sample| {
            let run = &self.runs[index];
            let view = timing::view(self.model, &self.state.values, run, sample, detail);
            self.residual_mm(index, &view)
        };
        let of_run = |(index, run): (usize, &RunInput)| {
            run.samples().par_iter().map(|sample| of(index, sample)).collect()
        };
        self.runs.iter().enumerate().map(of_run).collect()
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
