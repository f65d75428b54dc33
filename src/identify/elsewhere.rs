//! Where else legs could lie, a chord or more off, and whether they fit better there.

use std::slice;

use super::facets::{STEPS_A_CATCH, catch_s, peaks};
use super::fit::{Fit, Outcome};
use super::input::RunInput;
use super::record::Apart;
use super::state::apart;
use super::timing::{Detail, stride, view};
use crate::align::MarkKind;
use crate::error::Result;
use crate::machine::Pose;
use crate::model::Model;
use crate::solve::{Triangle, Tsqr};

/// A doubtful leg is tried at so many other places.
const MOST_PLACES: usize = 4;
/// And stays there if the residual falls below this share of what it was.
pub(super) const BETTER: f64 = 0.999;
/// A place is tried if a step foretells that no more than this is left there, of what is left before: of 150 places that were tried
/// to see, those that gained nothing were foretold to a hundredth, and those that gained were foretold to leave at most half a
/// hundredth more.
const WORTH_TRYING: f64 = 1.01;
/// A leg that leaves this many times the mean square of the others did not find its facets.
const SUSPICIOUS: f64 = 1.5;

impl Fit<'_> {
    /// Fits again with every doubtful leg where else it could lie, and keeps what fits better.
    pub(super) fn try_elsewhere(&mut self, mut best: Outcome) -> Outcome {
        let mut rows: Option<Vec<Triangle>> = None;
        for index in 0..self.runs.len() {
            let (values, apart) = (&self.state.values, &self.state.apart[index]);
            let doubts = doubts(self.model, values, &self.runs[index], apart);
            for doubt in doubts {
                match self.try_leg(index, &doubt, &mut rows) {
                    Ok(Some(outcome)) => best = outcome,
                    Ok(None) => {}
                    Err(_) => return best,
                }
            }
        }
        best
    }

    /// Fits again with a leg where else it could lie, and stays where it fits better. Rows of all runs are kept as long as it stays
    /// where it was.
    fn try_leg(
        &mut self,
        index: usize,
        doubt: &Doubt,
        rows: &mut Option<Vec<Triangle>>,
    ) -> Result<Option<Outcome>> {
        if doubt.shifts_s.is_empty() {
            return Ok(None);
        }
        let here = match rows.take() {
            Some(here) => here,
            None => self.rows_of_runs(Detail::Full)?,
        };
        let left = self.left_by(here.clone())?;
        let others = self.fold_run(index, |index, rows| {
            self.push_samples(index, Detail::Full, |leg| leg != doubt.leg, rows);
        })?;
        for shift_s in doubt.shifts_s.iter().take(MOST_PLACES) {
            let kept = self.kept();
            let better_mm = BETTER * kept.0.sigma_mm;
            let foretold = self.left_elsewhere(index, (doubt.leg, *shift_s), &here, &others);
            if foretold.is_ok_and(|foretold| foretold < WORTH_TRYING * left) {
                match self.iterate_below(Detail::Full, better_mm) {
                    Ok(outcome) if self.state.sigma_mm < better_mm => return Ok(Some(outcome)),
                    _ => {}
                }
            }
            self.back_to(kept);
        }
        *rows = Some(here);
        Ok(None)
    }

    /// What the linear problem of all runs leaves, in units of the noise.
    fn left_by(&self, rows: Vec<Triangle>) -> Result<f64> {
        let rows = self.joined(rows)?;
        Ok(rows.shared().residual_norm() / self.counted(&rows).sqrt())
    }

    /// Moves a leg by so much, s, and what the linear problem of all runs leaves there, whose rows were these before, and those of
    /// other legs of the run these: all that answers to the place of a leg answers in it. A step of one leg takes a hundredth of the
    /// time that a fit takes.
    fn left_elsewhere(
        &mut self,
        index: usize,
        (leg, shift_s): (usize, f64),
        before: &[Triangle],
        others: &Triangle,
    ) -> Result<f64> {
        let run = &mut self.runs[index];
        run.alignment.time_map.offsets_s[leg] -= shift_s;
        run.place();
        // What takes part in both places.
        let there = apart(slice::from_ref(&self.runs[index]), Detail::Full.guard_s());
        let both = self.state.apart[index].iter_mut().zip(there.into_iter().flatten());
        both.for_each(|(here, there)| *here = here.or(there));
        let mut there = Tsqr::of(others);
        self.push_samples(index, Detail::Full, |of| of == leg, &mut there);
        self.push_times(index, &mut there);
        let mut rows = before.to_vec();
        rows[index] = there.finish()?;
        self.left_by(rows)
    }
}

/// A leg that may lie some chords off, and where else it could lie.
struct Doubt {
    leg: usize,
    /// Shifts of the leg, s, the best first.
    shifts_s: Vec<f64>,
}

/// Legs without a ramp whose chords were found and that fit worse than the others do, now that the coefficients are known, by the
/// samples that take part: why the others do not is told. A leg that counts by its mean lies on no chord.
///
/// The coefficients have adapted to a wrong leg as well as they could, so a better place need not look
/// better before they are fitted again: the caller tries each.
fn doubts(model: &Model, values: &[f64], run: &RunInput, apart: &[Option<Apart>]) -> Vec<Doubt> {
    let stride = stride(run.samples().len());
    let of_leg = |leg: usize| {
        let taken = run.samples().iter().zip(apart).step_by(stride);
        taken
            .filter(move |(sample, apart)| sample.leg == leg && apart.is_none())
            .map(|taken| taken.0)
    };
    let left_mm2 = |leg: usize| {
        let left_mm2 = of_leg(leg)
            .map(|sample| view(model, values, run, sample, Detail::Full).residual_mm.powi(2));
        left_mm2.sum::<f64>() / of_leg(leg).count().max(1) as f64
    };
    let misfit = |leg: usize, shift_s: f64| {
        let misfits = of_leg(leg).map(|sample| {
            let state = run.alignment.trajectory.at_near(sample.program_s + shift_s, sample.block);
            let pose = Pose { position_mm: state.position_mm, sense: state.sense };
            let length_mm = model.length_mm(values, &pose, &sample.motion, run.mounting);
            (sample.deviation_mm - (length_mm - run.nominal_mm)).powi(2)
        });
        misfits.sum::<f64>()
    };
    let map = &run.alignment.time_map;
    let mut legs = run.alignment.legs();
    legs.retain(|leg| map.chords[*leg].blur_s <= 0.0);
    let found: Vec<f64> = legs.iter().map(|&leg| left_mm2(leg)).collect();
    let mut sorted = found.clone();
    sorted.sort_by(f64::total_cmp);
    let Some(usual) = sorted.get(sorted.len() / 2) else { return Vec::new() };
    // A ramp tells the time of its leg.
    let coarse = |leg: usize| {
        let marks = &mut run.alignment.marks.iter();
        !marks.any(|m| m.kind != MarkKind::Standstill && map.leg_of(m.program_s) == leg)
    };
    let suspicious = legs
        .iter()
        .zip(&found)
        .filter(|(leg, found)| coarse(**leg) && **found > SUSPICIOUS * usual);
    suspicious
        .map(|(&leg, _)| {
            let catch_s = catch_s(map, leg);
            let step_s = 2.0 * catch_s / STEPS_A_CATCH;
            let reach = (10.0 * catch_s / step_s) as i32;
            let curve: Vec<(f64, f64)> = (-reach..=reach)
                .map(|k| f64::from(k) * step_s)
                .map(|shift_s| (shift_s, misfit(leg, shift_s)))
                .collect();
            let lowest_near = |peak: &(f64, f64)| {
                let near = curve.iter().filter(|one| (one.0 - peak.0).abs() < 2.0 * catch_s);
                near.fold(f64::INFINITY, |lowest, one| lowest.min(one.1)) >= peak.1
            };
            let mut elsewhere = peaks(&curve);
            // Places of a leg are a chord apart: what lies nearer to a lower one is noise.
            elsewhere.retain(|peak| peak.0.abs() > catch_s && lowest_near(peak));
            elsewhere.sort_by(|a, b| a.1.total_cmp(&b.1));
            Doubt { leg, shifts_s: elsewhere.iter().map(|peak| peak.0).collect() }
        })
        .collect()
}
