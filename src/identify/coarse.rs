//! The way from times that are known to a second to the chords of the path.

use super::facets::{self, Look};
use super::fit::{Fit, Outcome};
use super::timing::Detail;
use crate::align::TimeMap;
use crate::error::Result;

/// So often facets are looked for again.
const MOST_LOOKS: usize = 3;
/// A doubtful leg is tried at so many other places.
const MOST_PLACES: usize = 4;
/// And stays there if the residual falls below this share of what it was.
const BETTER: f64 = 0.999;

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

    fn find_facets(&mut self, look: Look) -> bool {
        let mut found = false;
        for run in &mut self.runs {
            found |= facets::find(self.model, &self.state.values, run, look);
            run.place();
        }
        found
    }

    /// Fits again with every doubtful leg where else it could lie, and keeps what fits better.
    fn try_elsewhere(&mut self, mut best: Outcome) -> Outcome {
        for index in 0..self.runs.len() {
            let doubts = facets::doubts(self.model, &self.state.values, &self.runs[index]);
            for doubt in doubts {
                for shift_s in doubt.shifts_s.into_iter().take(MOST_PLACES) {
                    let kept = self.state.clone();
                    let maps: Vec<TimeMap> =
                        self.runs.iter().map(|run| run.alignment.time_map.clone()).collect();
                    let run = &mut self.runs[index];
                    run.alignment.time_map.offsets_s[doubt.leg] -= shift_s;
                    run.place();
                    let better_mm = BETTER * kept.sigma_mm;
                    match self.iterate(Detail::Full) {
                        Ok(outcome) if self.state.sigma_mm < better_mm => {
                            best = outcome;
                            break;
                        }
                        _ => {}
                    }
                    self.state = kept;
                    for (run, map) in self.runs.iter_mut().zip(maps) {
                        run.alignment.time_map = map;
                        run.place();
                    }
                }
            }
        }
        best
    }

    /// With offsets known to a second, the facets of the chorded path only mislead: fits the smooth
    /// part first, then finds the facets, then fits all.
    pub(super) fn find_times(&mut self, steps: &mut usize) -> Result<Outcome> {
        self.runs.iter_mut().for_each(|run| run.alignment.look_up_means());
        let outcome = self.iterate(Detail::Smooth)?;
        *steps += outcome.steps;
        if self.state.knows() {
            // What the model does not explain yet pulls the times with the weight of as many readings as there are. Times that
            // were wrong leave little once they are right; a vibration stays, and counts for what it is.
            self.state.correlated = self.correlated(&outcome)?;
            *steps += self.iterate(Detail::Smooth)?.steps;
        }
        let outcome = self.find_chords()?;
        Ok(self.try_elsewhere(outcome))
    }

    /// Fits all. The better times along a leg are known, the more legs show their facets.
    fn find_chords(&mut self) -> Result<Outcome> {
        self.find_facets(Look::First);
        let mut outcome = self.iterate(Detail::Full)?;
        for _ in 0..MOST_LOOKS {
            if !self.find_facets(Look::Again) {
                break;
            }
            outcome = self.iterate(Detail::Full)?;
        }
        Ok(outcome)
    }
}
