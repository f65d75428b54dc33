//! The way from times that are known to a second to the chords of the path.

use super::elsewhere::BETTER;
use super::facets::{self, Look};
use super::fit::{Fit, Outcome};
use super::state::State;
use super::timing::Detail;
use crate::align::TimeMap;
use crate::error::Result;

/// So often facets are looked for again.
const MOST_LOOKS: usize = 3;
/// Noise that counts for less than this is the noise of single readings: a chord that is found with the one is found with the other.
const MATTERS: f64 = 2.0;

/// Where a fit stood: state and times.
pub(super) type Kept = (State, Vec<TimeMap>);

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
    pub(super) fn kept(&self) -> Kept {
        let maps = self.runs.iter().map(|run| run.alignment.time_map.clone()).collect();
        (self.state.clone(), maps)
    }

    /// Goes back to where it stood.
    pub(super) fn back_to(&mut self, (state, maps): Kept) {
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
