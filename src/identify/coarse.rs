//! The way from times that are known to a second to the chords of the path.

use std::slice;

use super::facets::{self, Doubt, Look};
use super::fit::{Fit, Outcome};
use super::state::{State, apart};
use super::timing::Detail;
use crate::align::TimeMap;
use crate::error::Result;
use crate::solve::{Triangle, Tsqr};

/// So often facets are looked for again.
const MOST_LOOKS: usize = 3;
/// A doubtful leg is tried at so many other places.
const MOST_PLACES: usize = 4;
/// And stays there if the residual falls below this share of what it was.
const BETTER: f64 = 0.999;
/// A place is tried if a step foretells that no more than this is left there, of what is left before: of 150 places that were tried
/// to see, those that gained nothing were foretold to a hundredth, and those that gained were foretold to leave at most half a
/// hundredth more.
const WORTH_TRYING: f64 = 1.01;
/// Noise that counts for less than this is the noise of single readings: a chord that is found with the one is found with the other.
const MATTERS: f64 = 2.0;

/// Where a fit stood: state and times.
type Kept = (State, Vec<TimeMap>);

impl Fit<'_> {
    /// Whether any leg is known to no better than the facets of the path can tell apart.
    pub(super) fn coarse_legs(&self) -> bool {
        self.runs.iter().any(|run| {
            let map = &run.alignment.time_map;
            run.alignment
                .legs()
                .iter()
                .any(|&leg| map.offset_sigmas_s[leg] > facets::catch_s(map, leg))
        })
    }

    /// Whether the facets of any leg were found that were not before.
    pub(super) fn find_facets(&mut self, look: Look) -> bool {
        let mut found = false;
        for run in &mut self.runs {
            let before = run.alignment.time_map.clone();
            found |= facets::find(self.model, &self.state.values, run, look);
            if run.alignment.time_map != before {
                run.place();
            }
        }
        found
    }

    /// Fits again with every doubtful leg where else it could lie, and keeps what fits better.
    fn try_elsewhere(&mut self, mut best: Outcome) -> Outcome {
        let mut rows: Option<Vec<Triangle>> = None;
        for index in 0..self.runs.len() {
            let (values, apart) = (&self.state.values, &self.state.apart[index]);
            let doubts = facets::doubts(self.model, values, &self.runs[index], apart);
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

    /// With offsets known to a second, the facets of the chorded path only mislead: fits the smooth
    /// part first, then finds the facets, then fits all.
    ///
    /// What the smooth fit leaves pulls the times with the weight of as many readings as there are. Is it what the model
    /// does not explain, it has to count for what it is, and times that are plausible hold; is it chords, seen by
    /// readings that are too few for them, it says nothing of the noise, and times would stay too uncertain for
    /// chords to be found. What is left tells one from the other: where it matters both ways are gone.
    pub(super) fn find_times(&mut self, steps: &mut usize) -> Result<Outcome> {
        self.runs.iter_mut().for_each(|run| run.alignment.look_up_means());
        let outcome = self.iterate(Detail::Smooth)?;
        *steps += outcome.steps;
        if !self.state.knows() {
            let outcome = self.find_chords(f64::INFINITY)?;
            return Ok(self.try_elsewhere(outcome));
        }
        self.state.correlated = self.correlated(&self.left_in_mm(Detail::Smooth), &outcome)?;
        *steps += self.iterate(Detail::Smooth)?.steps;
        let smooth = self.kept();
        let weighed = self.find_chords(f64::INFINITY);
        if smooth.0.correlated < MATTERS {
            return Ok(self.try_elsewhere(weighed?));
        }
        let outcome = self.or_each_for_one(smooth, weighed)?;
        Ok(self.try_elsewhere(outcome))
    }

    /// Goes the way from the smooth fit again with every reading counted for one, and comes back to the weighed one
    /// unless, weighed alike in the end, less is left.
    fn or_each_for_one(&mut self, smooth: Kept, weighed: Result<Outcome>) -> Result<Outcome> {
        let there = self.kept();
        self.back_to(smooth);
        self.state.correlated = 1.0;
        let less_mm = if weighed.is_ok() { BETTER * there.0.sigma_mm } else { f64::INFINITY };
        let each_for_one = self.find_chords(less_mm).and_then(|_| {
            self.state.correlated = there.0.correlated;
            self.iterate(Detail::Full)
        });
        match each_for_one {
            Ok(outcome) if self.state.sigma_mm < less_mm => Ok(outcome),
            _ => {
                self.back_to(there);
                weighed
            }
        }
    }

    /// Where the fit stands.
    fn kept(&self) -> Kept {
        let maps = self.runs.iter().map(|run| run.alignment.time_map.clone()).collect();
        (self.state.clone(), maps)
    }

    /// Goes back to where it stood.
    fn back_to(&mut self, (state, maps): Kept) {
        self.state = state;
        for (run, map) in self.runs.iter_mut().zip(maps) {
            run.alignment.time_map = map;
        }
        self.place();
    }

    /// Fits all. The better times along a leg are known, the more legs show their facets; none are looked for again
    /// where more than this is left with the first.
    fn find_chords(&mut self, most_mm: f64) -> Result<Outcome> {
        self.find_facets(Look::First);
        let mut outcome = self.iterate_below(Detail::Full, most_mm)?;
        for _ in 0..MOST_LOOKS {
            if self.state.sigma_mm > most_mm {
                break;
            }
            let before = self.kept();
            if !self.find_facets(Look::Again) {
                // What this look told of legs is not in their offsets, and is not told.
                self.back_to(before);
                break;
            }
            outcome = self.iterate(Detail::Full)?;
        }
        Ok(outcome)
    }
}
