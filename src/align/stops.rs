//! Operator's pauses inside an engagement: nobody wrote down how long they were, but the reading stands
//! still in them.

use std::ops::Range;

use crate::log::Log;

/// More cells than this for the sum of all pauses are merged: the search is quadratic in it.
const MOST_CELLS: f64 = 6000.0;

/// Lengths of the pauses between stretches of known duration, s of log time.
///
/// The stretches take `stretches_s` (one more than there are pauses) and what the log lasts longer is
/// pause. Of all ways to distribute it, the one is taken in whose pauses the reading scatters least
/// about its mean; because the sum is fixed, every wrong distribution puts some motion into a pause.
/// Exact minimum by dynamic programming over (pause, time spent in pauses so far).
pub(super) fn pauses_s(
    log: &Log,
    engaged: &Range<usize>,
    start_s: f64,
    stretches_s: &[f64],
    end_s: f64,
) -> Vec<f64> {
    let pauses = stretches_s.len() - 1;
    let spare_s = (end_s - start_s - stretches_s.iter().sum::<f64>()).max(0.0);
    let cell_s = log.sample_period_s().max(spare_s / MOST_CELLS);
    // No pause reaches beyond the first and the last stretch, but a cell may: where a feed-out follows
    // the last pause at once, one sample of it outweighs everything else.
    let period_s = log.sample_period_s();
    let last_stretch_s = stretches_s.last().copied().unwrap_or(0.0);
    let inner_s = start_s + stretches_s[0] + period_s..end_s - last_stretch_s - period_s;
    let scatter = Scatter::new(log, engaged, start_s, end_s, cell_s, &inner_s);
    let cells = (spare_s / cell_s).round() as usize;

    let mut best = vec![f64::INFINITY; cells + 1];
    best[0] = 0.0;
    let mut came_from = vec![vec![0_usize; cells + 1]; pauses];
    let mut elapsed_s = 0.0;
    for pause in 0..pauses {
        elapsed_s += stretches_s[pause];
        let begin = (elapsed_s / cell_s).round() as usize;
        let mut next = vec![f64::INFINITY; cells + 1];
        for (before, so_far) in best.iter().enumerate().filter(|(_, cost)| cost.is_finite()) {
            // The last pause takes all that is left.
            let first = if pause + 1 == pauses { cells } else { before };
            for after in first..=cells {
                let cost = so_far + scatter.of(begin + before, begin + after);
                if cost < next[after] {
                    next[after] = cost;
                    came_from[pause][after] = before;
                }
            }
        }
        best = next;
    }
    let mut lengths_s = vec![0.0; pauses];
    let mut spent = cells;
    for pause in (0..pauses).rev() {
        let before = came_from[pause][spent];
        lengths_s[pause] = (spent - before) as f64 * cell_s;
        spent = before;
    }
    lengths_s
}

/// Sums over cells, so that the scatter of any stretch costs three differences.
struct Scatter {
    count: Vec<f64>,
    sum: Vec<f64>,
    squares: Vec<f64>,
}

impl Scatter {
    fn new(
        log: &Log,
        engaged: &Range<usize>,
        start_s: f64,
        end_s: f64,
        cell_s: f64,
        inner_s: &Range<f64>,
    ) -> Self {
        let cells = ((end_s - start_s) / cell_s).ceil() as usize + 2;
        let mut of = Self {
            count: vec![0.0; cells + 1],
            sum: vec![0.0; cells + 1],
            squares: vec![0.0; cells + 1],
        };
        for reading in &log.readings()[engaged.clone()] {
            let Some(value) = reading.deviation_mm.filter(|_| inner_s.contains(&reading.time_s))
            else {
                continue;
            };
            let cell = ((reading.time_s - start_s) / cell_s).floor().max(0.0) as usize;
            let cell = cell.min(cells - 1) + 1;
            of.count[cell] += 1.0;
            of.sum[cell] += value;
            of.squares[cell] += value * value;
        }
        for k in 1..=cells {
            of.count[k] += of.count[k - 1];
            of.sum[k] += of.sum[k - 1];
            of.squares[k] += of.squares[k - 1];
        }
        of
    }

    /// Sum of squares about the mean over cells `from..to`, mm².
    fn of(&self, from: usize, to: usize) -> f64 {
        let last = self.count.len() - 1;
        let (from, to) = (from.min(last), to.min(last));
        let count = self.count[to] - self.count[from];
        if count < 1.0 {
            return 0.0;
        }
        let sum = self.sum[to] - self.sum[from];
        (self.squares[to] - self.squares[from] - sum * sum / count).max(0.0)
    }
}
