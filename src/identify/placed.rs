//! Where the readings of a fit are laid, and which of them take part there.

use rayon::prelude::*;

use super::fit::Fit;
use super::input::RunInput;
use super::state::apart;
use super::timing;

impl Fit<'_> {
    /// Lays the samples of all runs anew, after their time maps have changed.
    pub(super) fn place(&mut self) {
        self.runs.par_iter_mut().for_each(RunInput::place);
    }

    /// The same of those that take part while a fit is sought: the others stay where they were.
    pub(super) fn place_taken(&mut self) {
        let taking = self.state.taking;
        self.runs.par_iter_mut().for_each(|run| {
            match timing::standing_for(run.samples().len(), taking) {
                (1, _) => run.place(),
                (_, taken) => run.place_some(&taken.collect::<Vec<_>>()),
            }
        });
    }

    /// Lays the readings that took no part while a fit was sought where those that did have put them, and chooses among them.
    pub(super) fn place_others(&mut self, guard_s: f64) {
        let taking = self.state.taking;
        let each = |run: &RunInput| timing::standing_for(run.samples().len(), taking).0;
        if self.runs.iter().all(|run| each(run) == 1) {
            return;
        }
        self.place();
        let mut chosen = apart(&self.runs, guard_s);
        for ((run, chosen), kept) in self.runs.iter().zip(&mut chosen).zip(&self.state.apart) {
            timing::standing_for(run.samples().len(), taking).1.for_each(|k| chosen[k] = kept[k]);
        }
        self.state.apart = chosen;
    }

    /// Chooses which samples take part as times are now: all anew, or none that was left out before.
    pub(super) fn choose(&mut self, guard_s: f64, anew: bool) {
        let chosen = apart(&self.runs, guard_s);
        if anew {
            self.state.apart = chosen;
        } else {
            self.state.leave_out(&chosen);
        }
    }

    /// Program time of every sample as it is laid now, s.
    pub(super) fn times_s(&self) -> Vec<f64> {
        self.runs.iter().flat_map(RunInput::samples).map(|sample| sample.program_s).collect()
    }

    /// The farthest that any sample has moved since it was laid at these times, s.
    pub(super) fn moved_s(&self, since_s: &[f64]) -> f64 {
        let samples = self.runs.iter().flat_map(RunInput::samples).zip(since_s);
        samples.map(|(now, since_s)| (now.program_s - since_s).abs()).fold(0.0, f64::max)
    }
}
