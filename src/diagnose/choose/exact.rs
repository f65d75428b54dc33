//! Curves that a search hardly tells apart, held against each other through the exact chain.
//!
//! A search is linear about a fit that had none of them, and whose numbers and times what was missing has moved. A curve over
//! another variable may follow those as well, and explain more than the one over the right variable does. With each of them held
//! a fit has its own numbers and times, and what is left then is theirs alone.

use super::extend::{Extended, extend};
use super::found::{Chosen, Rival, Separation};
use super::price::Price;
use super::search::NOT_LINEAR;
use crate::diagnose::thresholds::UNDECIDED_SIGMAS;
use crate::error::Result;
use crate::identify::Campaign;
use crate::machine::Machine;
use crate::plan::Test;
use crate::residual::Beside;

/// Rivals of a curve that are held: those that explain most.
const CLOSELY: usize = 2;

/// The effects with another curve in the place of one, where it explains as much but for what is not linear and the model extended by
/// it is likelier than the one as it is `now`; `None` where none is.
pub(crate) fn likelier(
    test: &Test,
    machine: &Machine,
    (campaign, alone): (&Campaign, &Beside),
    chosen: &Chosen,
    now: &Extended,
) -> Result<Option<Chosen>> {
    let price = Price::of(&now.residuals.beside(&now.chosen.fitted.columns));
    let of_mm2 = |of: &Extended| price.of_mm2(of.left_mm(), of.numbers());
    let by_chance = |of: &Extended| price.by_chance_mm2(of.left_mm(), of.numbers());
    let both = |of: &Extended| (of_mm2(of), by_chance(of));
    let (mut least_mm2, mut by_chance_mm2) = both(now);
    let mut better = None;
    for effect in 0..chosen.fitted.elements.len() {
        for rival in close(chosen, effect) {
            let Some(instead) = chosen.instead(effect, rival, alone) else { continue };
            let Some(extended) = extend(test, machine, campaign, &instead)? else { continue };
            let mm2 = of_mm2(&extended);
            if mm2 < least_mm2 && at_the_same_feeds(&extended.campaign, &now.campaign) {
                (least_mm2, by_chance_mm2) = both(&extended);
                better = Some(instead);
            }
        }
    }
    // A curve bends to whatever times and other numbers make of what is missing, and a cause cannot. One that leaves less through the
    // exact chain, but for what the curve's numbers gain by chance, is what the curve describes.
    for causes in &chosen.nearly {
        let Some(extended) = extend(test, machine, campaign, causes)? else { continue };
        let mm2 = by_chance(&extended);
        if mm2 < by_chance_mm2 && at_the_same_feeds(&extended.campaign, &now.campaign) {
            (by_chance_mm2, better) = (mm2, Some(causes.clone()));
        }
    }
    Ok(better)
}

/// Whether all runs came to rest at the same feed. Where a fit lost the times of one, what it leaves is no matter of curves.
fn at_the_same_feeds(one: &Campaign, other: &Campaign) -> bool {
    let feeds = |of: &Campaign| -> Vec<[f64; 2]> {
        let runs = of.repeats.iter().flat_map(|repeat| &repeat.runs);
        runs.map(|run| [run.alignment.time_map.pace, run.alignment.time_map.pace_sigma]).collect()
    };
    let same = |([a, a_sigma], [b, b_sigma]): ([f64; 2], [f64; 2])| {
        (a - b).abs() <= UNDECIDED_SIGMAS * a_sigma.hypot(b_sigma)
    };
    feeds(one).into_iter().zip(feeds(other)).all(same)
}

/// Which rivals of an effect are held: curves in the place of a curve.
fn close(chosen: &Chosen, effect: usize) -> Vec<usize> {
    if chosen.fitted.elements[effect].curve().is_none() {
        return Vec::new();
    }
    let rivals = &chosen.rivals[effect];
    let is_close = |rival: &Rival| {
        let undecided = rival.separation == Separation::Undecided;
        rival.element.curve().is_some() && (undecided || rival.share > 1.0 - NOT_LINEAR)
    };
    let mut close: Vec<usize> = (0..rivals.len()).filter(|k| is_close(&rivals[*k])).collect();
    close.sort_by(|a, b| rivals[*b].share.total_cmp(&rivals[*a].share));
    close.truncate(CLOSELY);
    close
}
