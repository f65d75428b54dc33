//! The extended model: every repeat identified again with the effects held, and the effects fitted again
//! about that.
//!
//! The search is linear about the first identification. Coefficients and times that were biased by what was
//! missing move here through the exact chain, and the effects with them.

use rayon::prelude::*;

use super::found::Chosen;
use crate::error::Result;
use crate::identify::Campaign;
use crate::machine::Machine;
use crate::model::{Form, HeldEffect};
use crate::plan::Test;
use crate::residual::{self, Beside, Column, Element, Fitted, Noise, Owner, Residuals};

/// A delay in common that gains this share more is another one.
const SETTLED: f64 = 1e-3;
/// A round leaves so much of what the one before left, at the most: one that leaves more has gone astray.
const AS_WELL: f64 = 1.02;
/// Identified anew so often at most.
const MOST_ROUNDS: usize = 3;

/// What came of it.
pub(crate) struct Extended {
    pub(crate) campaign: Campaign,
    /// Linear about the extended model, its residuals those without the effects.
    pub(crate) residuals: Residuals,
    pub(crate) chosen: Chosen,
}

impl Extended {
    /// What is left beside the effects, mm rms.
    pub(crate) fn left_mm(&self) -> f64 {
        let columns = &self.chosen.fitted.columns;
        self.residuals.rms_mm(self.residuals.beside(columns).left_mm2())
    }

    /// How many numbers the effects have.
    pub(crate) fn numbers(&self) -> usize {
        self.chosen.fitted.columns.len()
    }
}

/// Identifies with the effects held, and fits the effects again, until nothing moves or more is left than before: what a test hardly
/// sees of a roundness may go astray with the places that it is held at. `None` where no identification comes to rest with them.
pub(crate) fn extend(
    test: &Test,
    machine: &Machine,
    campaign: &Campaign,
    chosen: &Chosen,
) -> Result<Option<Extended>> {
    let mut now: Option<Extended> = None;
    let mut least_mm = f64::INFINITY;
    for _ in 0..MOST_ROUNDS {
        let fitted = now.as_ref().map_or(&chosen.fitted, |now| &now.chosen.fitted);
        let held = held(campaign, fitted);
        let extended = match &now {
            // What the first identification did not know moved its times; what the second does not moves none.
            None => campaign.with_held(test, machine, held),
            Some(now) => now.campaign.with_held_anew(test, machine, held),
        };
        let Ok(extended) = extended else { break };
        let about = Residuals::of(test, machine, &extended)?;
        let mut moved = sum(fitted, &about);
        let about = about.plus(&moved);
        let alone = about.alone();
        let Some(again) = fit(&alone, &fitted.elements) else { break };
        let left_mm = again.left_mm(&alone);
        let rms_mm = about.rms_mm(left_mm.square());
        if rms_mm > AS_WELL * least_mm {
            break;
        }
        least_mm = rms_mm.min(least_mm);
        moved.add(-1.0, &again.sum(&about));
        let moved_mm2 = moved.product(&about.outside(&moved));
        let noise = Noise::of(&about, &left_mm);
        drop(alone);
        let rivals = chosen.rivals.clone();
        let chosen = Chosen { fitted: again, rivals, nearly: Vec::new() };
        now = Some(Extended { campaign: extended, residuals: about, chosen });
        if moved_mm2 < noise.long_run_mm2 {
            break;
        }
    }
    Ok(now)
}

/// What a delay in common is multiplied by to see whether another fits better.
const FACTORS: [f64; 6] = [0.7, 0.85, 0.95, 1.05, 1.18, 1.4];

/// The effects fitted to data about themselves. The time of a log moves with the delay that all slides have
/// in common, so this is found in steps, with the times fitted between them.
fn fit(about: &Beside, elements: &[Element]) -> Option<Fitted> {
    let fitted = residual::fit(about, elements.to_vec())?;
    let Some(common) = elements.iter().position(Element::is_common_delay) else {
        return Some(fitted);
    };
    let tried = FACTORS.par_iter().filter_map(|factor| {
        let mut elements = elements.to_vec();
        if let Form::Cause(shape) = &mut elements[common].form {
            shape.inner = shape.inner.map(|delay_s| delay_s * factor);
        }
        residual::fit(about, elements)
    });
    let tried: Vec<Fitted> = tried.collect();
    let best = tried.into_iter().max_by(|a, b| a.gain_mm2.total_cmp(&b.gain_mm2));
    // One that explains no more stays as the model has it.
    let least_mm2 = fitted.gain_mm2 * (1.0 + SETTLED);
    Some(best.filter(|best| best.gain_mm2 > least_mm2).unwrap_or(fitted))
}

/// The effects with their amplitudes at the samples of other residuals than they were fitted to, mm.
fn sum(fitted: &Fitted, about: &Residuals) -> Column {
    let mut sum = about.zeros();
    for (element, amplitudes) in fitted.elements.iter().zip(&fitted.amplitudes) {
        for (amplitude, column) in amplitudes.iter().zip(element.columns(about)) {
            sum.add(*amplitude, &column);
        }
    }
    sum
}

/// The effects as each repeat has them.
fn held(campaign: &Campaign, fitted: &Fitted) -> Vec<Vec<HeldEffect>> {
    let mut held: Vec<Vec<HeldEffect>> = vec![Vec::new(); campaign.repeats.len()];
    for (element, amplitudes) in fitted.elements.iter().zip(&fitted.amplitudes) {
        let mut hold = |repeat: usize, run: Option<usize>, amplitudes: &[f64]| {
            let form = element.in_run(repeat, run.unwrap_or(0));
            let earlier_s = run.map_or(0.0, |run| element.earlier.in_s(repeat, run));
            let amplitudes = amplitudes.to_vec();
            held[repeat].push(HeldEffect { form, amplitudes, run, earlier_s });
        };
        let runs = || {
            let runs = campaign.repeats.iter().enumerate();
            runs.flat_map(|(k, repeat)| (0..repeat.runs.len()).map(move |run| (k, run)))
        };
        match element.owner {
            Owner::All if element.earlier.tells() => {
                runs().for_each(|(k, run)| hold(k, Some(run), amplitudes));
            }
            Owner::All => (0..campaign.repeats.len()).for_each(|k| hold(k, None, amplitudes)),
            Owner::One { repeat, run } => hold(repeat, Some(run), amplitudes),
            Owner::EachRun => {
                let own = amplitudes.chunks(element.term().parameter_count());
                runs().zip(own).for_each(|((k, run), own)| hold(k, Some(run), own));
            }
        }
    }
    held
}
