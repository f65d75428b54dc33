//! The covariance of a fit by the noises that may have left what it leaves.
//!
//! With the rows `J` of a fit, their weights `W`, `A = (J^T W J)^-1`, and the covariance of the noise `S`, that is `A M A`, `M = J^T W
//! S W J`. An autoregression of what is left has the `S` of all that changes faster than the fit can follow. What hangs together for
//! longer the fit takes out of short arcs, and correlations of residuals say nothing of it: of three planes in 15 s each,
//! which a noise of 0.24 um had moved by 0.65 um, they told 0.09. So as much is added as [`likely`] noises, white ones with the variance
//! `s (1 - share)` of a reading and `s share` of the mean of a cell of `n` readings times the root of `n` that hangs together, have
//! beyond it in the long run. With `p` their likelihoods, `v` their long-run variances, `l` that of what hangs together, and `v'` that
//! of the autoregression:
//!
//! ```text
//! M = J^T W S W J + f sum_i p_i s_i share_i / n  Z^T K_i Z,      f sum_i p_i l_i = d (sum_i p_i v_i - v')
//! ```
//!
//! where that is above 0, with `Z` the sums of the rows `W J` over each cell and `K_i` the correlations `exp(-t / tau_i)` of the cells
//! of a stretch. `d`, 1 at the most, is the share of what hangs together that the fit has taken out: as many directions as it has
//! over as many pieces as are independent. What is left of it tells the autoregression. It is never less than that alone has it.

use std::ops::Range;

use rayon::prelude::*;

use super::fit::Fit;
use super::follows::Follows;
use super::timing::Detail;
use crate::error::Result;
use crate::solve::{
    ArcOfMeans, BackwardFilter, BorderedCovariance, BorderedSolution, Likely, Matrix, Means,
    NoiseModel, Triangle, Tsqr, likely,
};

/// A cell is so long, s, or one reading.
const CELL_S: f64 = 0.1;
/// And longer where there were more of them than this: arcs last some hundred cells then, ten times as long as what a fit of them
/// bends in, and what noise does within one is white to it.
const MOST_CELLS: f64 = 2048.0;
/// Noise of readings hangs together for a second. What a fit has taken out is as likely to have lasted for longer, and the average
/// over all times has what there is in its middle: with a second for the longest, noise of a second comes to 0.92 of its sigmas. s.
const LONGEST_S: f64 = 2.0;
/// Less than this part of a variance changes no digit that is told.
const NEGLIGIBLE: f64 = 1e-9;

/// What a run says over cells of neighbouring readings.
struct Cells {
    /// Its rows `W J`, filtered by the autoregression.
    filtered: Triangle,
    /// Their sums over cells, a row each.
    rows: Vec<Vec<f64>>,
    /// What is left, weighed and summed alike, mm.
    left_mm: Vec<f64>,
    /// The cells of each stretch without a gap, and how many of them are whole.
    stretches: Vec<(Range<usize>, usize)>,
    /// Readings of a whole cell.
    size: usize,
    every_s: f64,
}

impl Fit<'_> {
    /// The covariance of a solution, by an autoregression of what is left and the noises that are likely beside it.
    pub(super) fn covariance(
        &self,
        solution: &BorderedSolution,
        left_mm: &[Vec<f64>],
        noise: &NoiseModel,
    ) -> Result<BorderedCovariance> {
        let all_s = (0..self.runs.len()).map(|index| {
            let readings: usize = self.segments(index).iter().map(Range::len).sum();
            readings as f64 * self.runs[index].alignment.sample_period_s
        });
        let cell_s = CELL_S.max(all_s.sum::<f64>() / MOST_CELLS);
        let runs = (0..self.runs.len()).into_par_iter();
        let cells = runs.map(|index| self.cells(index, &left_mm[index], cell_s, noise));
        let cells: Vec<Cells> = cells.collect::<Result<_>>()?;
        let means = [self.means(&cells, solution)];
        let noises = likely(&means, LONGEST_S);
        let taken_out = means[0].own as f64 / means[0].rows.columns().max(1) as f64;
        let filtered = cells.into_iter().map(|of| of.with_what_lasts(&noises, noise, taken_out));
        solution.covariance_sandwich(&filtered.collect::<Result<Vec<_>>>()?)
    }

    /// The rows `W J` of each run, filtered by a noise.
    pub(super) fn filtered(&self, noise: &NoiseModel) -> Result<Vec<Triangle>> {
        self.fold_runs(&|index, rows| self.push_filtered(index, noise, rows, |_, _| ()))
    }

    /// Pushes those of a run, calling back with each reading and its row before it is filtered.
    fn push_filtered(
        &self,
        index: usize,
        noise: &NoiseModel,
        rows: &mut Tsqr,
        mut each: impl FnMut(usize, &[f64]),
    ) {
        let mut row = vec![0.0; rows.columns()];
        let mut filter = BackwardFilter::new(noise, rows.columns());
        for segment in self.segments(index) {
            filter.begin(segment.len());
            let backward: Vec<usize> = segment.rev().collect();
            self.each_row(index, &backward, Detail::Full, |k, of_sample, _| {
                let weight = self.weight(index, k) / self.state.counts_mm().powi(2);
                row.iter_mut().zip(of_sample).for_each(|(to, of)| *to = of * weight);
                each(k, &row);
                rows.push(filter.push(&row), 0.0);
            });
        }
        self.each_time_row(&mut row, index, |row, _, sigma| {
            rows.push_weighted(row, 0.0, 1.0 / sigma);
        });
    }

    fn cells(
        &self,
        index: usize,
        left_mm: &[f64],
        cell_s: f64,
        noise: &NoiseModel,
    ) -> Result<Cells> {
        let period_s = self.runs[index].alignment.sample_period_s;
        let size = ((cell_s / period_s).round() as usize).max(1);
        let (mut stretches, mut count) = (Vec::new(), 0);
        let mut cell_of = vec![0; left_mm.len()];
        for segment in self.segments(index) {
            let of_segment = segment.len().div_ceil(size);
            stretches.push((count..count + of_segment, segment.len() / size));
            for (number, k) in segment.enumerate() {
                cell_of[k] = count + number / size;
            }
            count += of_segment;
        }
        let width = self.columns.own(index) + self.columns.coefficients;
        let mut rows = vec![vec![0.0; width]; count];
        let mut sums_mm = vec![0.0; count];
        let mut filtered = Tsqr::new(width);
        self.push_filtered(index, noise, &mut filtered, |k, row| {
            rows[cell_of[k]].iter_mut().zip(row).for_each(|(sum, of)| *sum += of);
            sums_mm[cell_of[k]] += self.weight(index, k) * left_mm[k];
        });
        let (filtered, every_s) = (filtered.finish()?, size as f64 * period_s);
        Ok(Cells { filtered, rows, left_mm: sums_mm, stretches, size, every_s })
    }

    /// What the fit has taken out of whole cells, and what it has left.
    fn means(&self, cells: &[Cells], solution: &BorderedSolution) -> Means {
        let follows = Follows::of(self, solution);
        let mut arcs = Vec::new();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut left_mm = Vec::new();
        for (index, of) in cells.iter().enumerate() {
            let root = (of.size as f64).sqrt();
            for (stretch, whole) in &of.stretches {
                let begin = columns.len();
                for cell in stretch.clone().take(*whole) {
                    let mut q = vec![0.0; follows.rank()];
                    follows.row(index, &of.rows[cell], self.state.counts_mm() / root, &mut q);
                    columns.push(q);
                    left_mm.push(of.left_mm[cell] / root);
                }
                arcs.push(ArcOfMeans { means: begin..columns.len(), every_s: of.every_s });
            }
        }
        let q = Matrix::from_fn(follows.rank(), columns.len(), |i, k| columns[k][i]);
        Means::of_fit(arcs, &q, &left_mm)
    }
}

impl Cells {
    /// The filtered rows, with those of what likely noises have beyond the autoregression; so many directions are taken out, of
    /// each mean.
    fn with_what_lasts(
        self,
        noises: &[Likely],
        noise: &NoiseModel,
        taken_out: f64,
    ) -> Result<Triangle> {
        let of_all = |of: &dyn Fn(&Likely) -> f64| -> f64 {
            noises.iter().map(|noise| noise.weight * noise.variance * of(noise)).sum()
        };
        let white_mm2 = of_all(&|noise| 1.0 - noise.colour.share);
        let lasting_mm2 = of_all(&|noise| noise.colour.long_run(self.every_s)) - white_mm2;
        let apart_mm2 = white_mm2 + lasting_mm2 - noise.long_run_variance();
        if apart_mm2 <= 0.0 || lasting_mm2 <= 0.0 {
            return Ok(self.filtered);
        }
        // Of what lasts as many means as this hang together.
        let together = lasting_mm2 / of_all(&|noise| noise.colour.share);
        let beyond_mm2 = (taken_out * together).min(1.0) * apart_mm2;
        let mut rows = Tsqr::of(&self.filtered);
        let one_time = |a: &Likely, b: &Likely| a.colour.time_s.total_cmp(&b.colour.time_s).is_eq();
        for of_time in noises.chunk_by(one_time) {
            let of = |noise: &Likely| noise.weight * noise.variance * noise.colour.share;
            let variance_mm2 = beyond_mm2 / lasting_mm2 * of_time.iter().map(of).sum::<f64>();
            if variance_mm2 < NEGLIGIBLE * beyond_mm2 {
                continue;
            }
            let next = of_time[0].colour.next(self.every_s);
            let new_mm2 = variance_mm2 / self.size as f64 * (1.0 - next * next);
            let lasting = NoiseModel::autoregressive(vec![next], new_mm2.sqrt())?;
            let mut filter = BackwardFilter::new(&lasting, rows.columns());
            for (stretch, _) in &self.stretches {
                filter.begin(stretch.len());
                for cell in stretch.clone().rev() {
                    rows.push(filter.push(&self.rows[cell]), 0.0);
                }
            }
        }
        rows.finish()
    }
}
