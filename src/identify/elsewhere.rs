//! Where else legs could lie, a chord or more off, and whether they fit better there.

use std::slice;

use nalgebra::Vector3;

use super::facets::{STEPS_A_CATCH, catch_s, peaks};
use super::fit::{Fit, Outcome};
use super::input::RunInput;
use super::record::Apart;
use super::state::apart;
use super::timing::{Detail, stride, view};
use crate::align::{MarkKind, Sample, TimeMap};
use crate::error::Result;
use crate::machine::Pose;
use crate::model::Model;
use crate::solve::{Triangle, Tsqr};

/// So often doubtful legs are looked for in a run, two chords at a time: of what neighbours of a place gain, one that is ten off is told.
const MOST_LOOKS: usize = 12;
/// A doubtful leg is tried at so many other places.
const MOST_PLACES: usize = 4;
/// And stays there if the residual falls below this share of what it was.
pub(super) const BETTER: f64 = 0.999;
/// A place is tried if a step foretells that no more than this is left there, of what is left before: of 150 places that were tried
/// to see, those that gained nothing were foretold to a hundredth, and those that gained were foretold to leave at most half a
/// hundredth more.
const WORTH_TRYING: f64 = 1.01;
/// A leg that leaves this many times the mean square of the others, or of what neighbours differ by where there is no third, did not
/// find its facets.
const SUSPICIOUS: f64 = 1.5;
/// So few legs are no measure for each other.
const FEW: usize = 2;
/// They are tried so many chords off either way; on a smooth path, so many catches of a reversal more.
const CHORDS_OFF: [f64; 4] = [1.0, -1.0, 2.0, -2.0];

impl Fit<'_> {
    /// Fits again with doubtful legs where else they could lie, and keeps what fits better.
    pub(super) fn try_elsewhere(&mut self, mut best: Outcome) -> Outcome {
        let mut rows: Option<Vec<Triangle>> = None;
        for index in 0..self.runs.len() {
            // What a leg leaves tells of the others once it lies where it should.
            for _ in 0..MOST_LOOKS {
                let (values, apart) = (&self.state.values, &self.state.apart[index]);
                let doubts = doubts(self.model, values, &self.runs[index], apart);
                let mut moved = false;
                for doubt in doubts {
                    match self.try_legs(index, doubt, &mut rows) {
                        Ok(Some(outcome)) => (best, moved) = (outcome, true),
                        Ok(None) => {}
                        Err(_) => return best,
                    }
                }
                if !moved {
                    break;
                }
            }
        }
        best
    }

    /// Fits again with legs where else they could lie, the likeliest place first, and stays where it fits better. Rows of all runs are
    /// kept as long as it stays where it was.
    fn try_legs(
        &mut self,
        index: usize,
        Doubt { legs, places_s }: Doubt,
        rows: &mut Option<Vec<Triangle>>,
    ) -> Result<Option<Outcome>> {
        if places_s.is_empty() {
            return Ok(None);
        }
        let here = match rows.take() {
            Some(here) => here,
            None => self.rows_of_runs(Detail::Full)?,
        };
        let left = self.left_by(here.clone())?;
        let others = self.fold_run(index, |index, rows| {
            self.push_samples(index, Detail::Full, |leg| !legs.contains(&leg), rows);
        })?;
        let kept = self.kept();
        let better_mm = BETTER * kept.0.sigma_mm;
        let mut foretold = Vec::with_capacity(places_s.len());
        for place_s in places_s {
            let left = self.left_elsewhere(index, (&legs, &place_s), &here, &others);
            foretold.extend(left.ok().map(|left| (left, place_s)));
            self.back_to(kept.clone());
        }
        foretold.retain(|(there, _)| *there < WORTH_TRYING * left);
        foretold.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, place_s) in foretold.iter().take(MOST_PLACES) {
            self.move_legs(index, &legs, place_s);
            match self.iterate_below(Detail::Full, better_mm) {
                Ok(outcome) if self.state.sigma_mm < better_mm => return Ok(Some(outcome)),
                _ => self.back_to(kept.clone()),
            }
        }
        *rows = Some(here);
        Ok(None)
    }

    /// What the linear problem of all runs leaves, in units of the noise.
    fn left_by(&self, rows: Vec<Triangle>) -> Result<f64> {
        let rows = self.joined(rows)?;
        Ok(rows.shared().residual_norm() / self.counted(&rows).sqrt())
    }

    /// Moves legs by so much, s, and what the linear problem of all runs leaves there, whose rows were these before, and those of
    /// other legs of the run these: all that answers to the place of a leg answers in it. A step of one leg takes a hundredth of the
    /// time that a fit takes.
    fn left_elsewhere(
        &mut self,
        index: usize,
        (legs, place_s): (&[usize], &[f64]),
        before: &[Triangle],
        others: &Triangle,
    ) -> Result<f64> {
        self.move_legs(index, legs, place_s);
        let mut there = Tsqr::of(others);
        self.push_samples(index, Detail::Full, |leg| legs.contains(&leg), &mut there);
        self.push_times(index, &mut there);
        let mut rows = before.to_vec();
        rows[index] = there.finish()?;
        self.left_by(rows)
    }

    /// Moves legs of a run by so much, s; what takes part in both places does.
    fn move_legs(&mut self, index: usize, legs: &[usize], place_s: &[f64]) {
        let run = &mut self.runs[index];
        for (leg, shift_s) in legs.iter().zip(place_s) {
            run.alignment.time_map.offsets_s[*leg] -= shift_s;
        }
        run.place();
        let there = apart(slice::from_ref(&self.runs[index]), Detail::Full.guard_s());
        let both = self.state.apart[index].iter_mut().zip(there.into_iter().flatten());
        both.for_each(|(here, there)| *here = here.or(there));
    }
}

/// Legs that may lie some chords off, and where else they could lie.
struct Doubt {
    legs: Vec<usize>,
    /// Shifts of each of them, s.
    places_s: Vec<Vec<f64>>,
}

/// Legs whose chords were found and that fit worse than the others do, now that the coefficients are known, by the samples that take
/// part: why the others do not is told. A leg that counts by its mean lies on no chord.
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
    let left_mm = |leg: usize| -> Vec<f64> {
        let left_mm = |sample| view(model, values, run, sample, Detail::Full).residual_mm;
        of_leg(leg).map(left_mm).collect()
    };
    // What neighbours differ by, as the noise that would make them.
    let by_chance = |leg: usize| {
        let two = |k: usize| (&run.samples()[k], &run.samples()[k + 1]);
        let here = (1..run.samples().len()).step_by(stride).map(|k| k - 1);
        let taken = here.filter(|&k| apart[k].is_none() && apart[k + 1].is_none());
        let of_leg = taken.map(two).filter(|(one, next)| one.leg == leg && next.leg == leg);
        let left_mm = |sample| view(model, values, run, sample, Detail::Full).residual_mm;
        0.5 * square(of_leg.map(|(one, next)| left_mm(next) - left_mm(one)))
    };
    let map = &run.alignment.time_map;
    let mut legs = run.alignment.legs();
    legs.retain(|leg| of_leg(*leg).next().is_some());
    if legs.len() <= FEW {
        let left = |leg: usize| square(left_mm(leg).into_iter());
        let suspicious = legs.iter().any(|leg| left(*leg) > SUSPICIOUS * by_chance(*leg));
        let turning: Vec<Vector3<f64>> = legs.iter().map(|leg| turning(of_leg(*leg))).collect();
        return suspicious.then(|| of_few(map, legs, &turning)).into_iter().collect();
    }
    let legs: Vec<usize> = legs.into_iter().filter(|leg| map.chords[*leg].blur_s <= 0.0).collect();
    let found: Vec<f64> = legs.iter().map(|leg| square(left_mm(*leg).into_iter())).collect();
    let mut sorted = found.clone();
    sorted.sort_by(f64::total_cmp);
    let Some(usual) = sorted.get(sorted.len() / 2) else { return Vec::new() };
    // A ramp tells the time of its leg.
    let coarse = |leg: usize| {
        let marks = &mut run.alignment.marks.iter();
        !marks.any(|m| m.kind != MarkKind::Standstill && map.leg_of(m.program_s) == leg)
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
            let places_s = elsewhere.iter().take(MOST_PLACES).map(|peak| vec![peak.0]).collect();
            Doubt { legs: vec![leg], places_s }
        })
        .collect()
}

/// Where two legs could lie, or one: some chords off, one of them, or the path of both turned about its middle. Chords and what bends
/// slowly look the same there, and only where slides turn round is it seen. On a smooth path a single leg finds its place by itself.
fn of_few(map: &TimeMap, legs: Vec<usize>, turning: &[Vector3<f64>]) -> Doubt {
    let chorded =
        legs.iter().all(|leg| map.chords[*leg].there_are() && map.chords[*leg].blur_s <= 0.0);
    let chord_s = |leg: usize| {
        if chorded { map.chords[leg].lasts_s } else { 2.0 * catch_s(map, leg) }
    };
    let along = |k: usize| if turning[0].dot(&turning[k]) < 0.0 { -1.0 } else { 1.0 };
    let turned: Vec<f64> =
        legs.iter().enumerate().map(|(k, leg)| along(k) * chord_s(*leg)).collect();
    let mut ways = vec![turned.clone()];
    if chorded && legs.len() > 1 {
        let alone =
            |k: usize| (0..legs.len()).map(|of| if of == k { turned[k] } else { 0.0 }).collect();
        ways.extend((0..legs.len()).map(alone));
    }
    let times = |off: f64| ways.iter().map(move |way| way.iter().map(|s| off * s).collect());
    Doubt { places_s: CHORDS_OFF.into_iter().flat_map(times).collect(), legs }
}

/// Which way a path turns: the sum of the products of velocities that follow each other.
fn turning<'a>(samples: impl Iterator<Item = &'a Sample>) -> Vector3<f64> {
    let velocities: Vec<Vector3<f64>> = samples.map(|sample| sample.motion.velocity_mm_s).collect();
    velocities.windows(2).map(|two| two[0].cross(&two[1])).sum()
}

/// Mean square; 0 of nothing.
fn square(of: impl Iterator<Item = f64>) -> f64 {
    let [sum, count] = of.fold([0.0, 0.0], |[sum, count], x| [sum + x * x, count + 1.0]);
    sum / f64::max(count, 1.0)
}
