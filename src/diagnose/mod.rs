//! What the model gets wrong: show it, name the cause, extend the model, measure the gain.
//!
//! ```text
//! campaign ──> residuals, outside of what each fit spans ──> screen: every cause on every seat
//!                                                               │
//!   gain on runs left out <── joint fit of what was chosen <── choose, beside curves of any shape
//! ```
//!
//! Every repeat keeps its own coefficients, set-up and times; an effect is one for all repeats. A further
//! column `c` counts by what the fits of the model do not follow, `c' = c - Q Q^T c`, so a cause is never
//! credited with what a cubic explains, nor the model blamed for it.

mod account;
mod choose;
mod result;
mod seek;
mod thresholds;
mod views;

pub use account::arcs::ArcShare;
pub use account::gain::{ProgramGain, RunGain};
pub use account::left_out::LeftOut;
pub use account::moved::Moved;
pub use account::numbers::Number;
pub use account::times::{OffCause, OffTime};
pub use choose::found::{Rival, Told};
pub use choose::settings::WrongSetting;
pub use result::{Diagnosis, Finding, Verdict};
pub use views::feature::Feature;
pub use views::picture::{Picture, Point};
pub use views::view::{Bin, Kind, Subject, View};

use account::{arcs, gain, moved, numbers, times, unseen};
use choose::found::Chosen;
use choose::search::Search;
use choose::{extend, settings};
use seek::screen::Screen;
use views::{means, picture, sample, spectra};

use crate::error::Result;
use crate::identify::Campaign;
use crate::machine::Machine;
use crate::plan::Test;
use crate::residual::data::{Data, dot};
use crate::residual::noise::Noise;
use crate::residual::structure;
pub use crate::residual::{Element, Owner, Structure};

/// Looks for what the model of a campaign gets wrong, and does not yet extend it: no gain is measured, and the
/// numbers are those of a search that is linear about the first identification.
///
/// # Errors
/// When the rows of a fit are not finite numbers.
pub fn search(test: &Test, machine: &Machine, campaign: &Campaign) -> Result<Searched> {
    let (corrected, mut data) = settings::corrected(test, machine, campaign)?;
    let campaign = corrected.as_ref().map_or(campaign, |now| &now.campaign);
    let chosen = chosen(&mut data, campaign);
    let noise = Noise::of(&data);
    data.accept(&[]);
    let findings = findings(&data, chosen.as_ref(), &noise);
    Ok(Searched { findings, wrong_settings: corrected.map_or_else(Vec::new, |c| c.wrong) })
}

/// What a search alone finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Searched {
    /// Effects, the largest first.
    pub findings: Vec<Finding>,
    /// Settings that are stated wrong.
    pub wrong_settings: Vec<WrongSetting>,
}

fn chosen(data: &mut Data, campaign: &Campaign) -> Option<Chosen> {
    let mut screen = Screen::new(data, campaign);
    Search { data, screen: &mut screen, first: Vec::new() }.run()
}

fn findings(data: &Data, chosen: Option<&Chosen>, noise: &Noise) -> Vec<Finding> {
    let Some(Chosen { fitted, rivals }) = chosen else { return Vec::new() };
    let samples = data.samples().max(1) as f64;
    let each = fitted.elements.iter().enumerate().zip(rivals);
    each.map(|((k, element), rivals)| {
        let (effects, numbers) = numbers::told(data, fitted, k, noise.long_run_mm2);
        let left: f64 = fitted.part(k).effect(data).iter().map(|c| dot(c, c)).sum();
        Finding {
            element: element.clone(),
            effects,
            numbers,
            amplitudes: fitted.amplitudes[k].clone(),
            rms_mm: (left / samples).sqrt(),
            rivals: rivals.clone(),
        }
    })
    .collect()
}

/// Looks for what the model of a campaign gets wrong, extends it and measures the gain.
///
/// # Errors
/// When the rows of a fit are not finite numbers.
pub fn diagnose(test: &Test, machine: &Machine, campaign: &Campaign) -> Result<Diagnosis> {
    let (corrected, mut data) = settings::corrected(test, machine, campaign)?;
    let (test, machine, campaign) = match &corrected {
        Some(now) => (&now.test, &now.machine, &now.campaign),
        None => (test, machine, campaign),
    };
    let chosen = chosen(&mut data, campaign);
    let before = data.residuals_mm();
    let before_mm = (data.squares_without_mm2() / data.samples().max(1) as f64).sqrt();
    let structure_before = structure::structure(&data, &before, |_, _| true);
    let extended = match chosen {
        Some(chosen) => extend::extend(test, machine, campaign, &data, chosen)?,
        None => None,
    };
    let (chosen, extended) = match extended {
        Some(extended) => {
            data = extended.data;
            data.accept(&extended.chosen.fitted.columns);
            (Some(extended.chosen), Some(extended.campaign))
        }
        None => (None, None),
    };
    let noise = Noise::of(&data);
    let samples = data.samples();
    let mean = |columns: &[Vec<f64>]| {
        (columns.iter().map(|c| dot(c, c)).sum::<f64>() / samples.max(1) as f64).sqrt()
    };
    let left = data.left_mm.clone();
    // From here on, effects are fitted beside the model alone.
    data.accept(&[]);
    let fitted = chosen.as_ref().map(|chosen| &chosen.fitted);
    let (runs, by_arc) = gain::by_run(&data, &left, fitted);
    let explained = fitted.and_then(|_| gain::explained(&by_arc));
    let verdict = Verdict {
        before_mm,
        after_mm: mean(&left),
        structure_before,
        structure_after: structure::structure(&data, &left, |_, _| true),
        neighbours_mm: noise.neighbours_mm2.sqrt(),
        effective_samples: samples as f64 * noise.variance_mm2 / noise.long_run_mm2,
        samples,
        explained: explained.map(|explained| explained.0),
        explained_interval: explained.map(|explained| explained.1),
        smallest_mm: (thresholds::threshold_mm2(&data, &noise) / samples.max(1) as f64).sqrt(),
    };
    let programs = fitted.map_or_else(Vec::new, |fitted| gain::by_program(&data, fitted));
    let moved = match (fitted, &extended) {
        (Some(fitted), Some(extended)) => {
            moved::moved(&data, campaign, extended, fitted, noise.long_run_mm2)
        }
        _ => Vec::new(),
    };
    // About the extended model a few more samples, or fewer, take part.
    let shown = extended.as_ref().unwrap_or(campaign);
    let views = views(&data, shown, &left, noise.long_run_mm2);
    let arcs = arcs::arcs(&data, shown, &left);
    let pictures = fitted.map_or_else(Vec::new, |fitted| {
        let of = |k| picture::picture(&data, fitted, k, &left, noise.long_run_mm2);
        (0..fitted.elements.len()).map(of).collect()
    });
    let findings = findings(&data, chosen.as_ref(), &noise);
    Ok(Diagnosis {
        verdict,
        findings,
        runs,
        programs,
        moved,
        unseen: unseen::unseen(&data, campaign),
        views,
        pictures,
        arcs,
        off_times: times::off(test, campaign),
        wrong_settings: corrected.as_ref().map_or_else(Vec::new, |now| now.wrong.clone()),
        left_out: campaign.left_out.iter().map(|(run, error)| LeftOut::of(run, error)).collect(),
        extended,
    })
}

/// The residual before and after against everything, what holds most structure first.
fn views(data: &Data, campaign: &Campaign, left_mm: &[Vec<f64>], long_run_mm2: f64) -> Vec<View> {
    let (seen, circles) = sample::seen(data, campaign, left_mm);
    let mut views = means::views(&seen, &circles, long_run_mm2);
    views.extend(spectra::views(&seen, long_run_mm2));
    let score = |view: &View| view.share_before.max(view.share_after);
    views.sort_by(|a, b| score(b).total_cmp(&score(a)));
    views
}
