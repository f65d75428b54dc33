//! What the model gets wrong: show it, name the cause, extend the model, measure the gain.
//!
//! ```text
//! campaign ──> residuals, outside of what each fit spans ──> screen: every cause on every seat
//!                                                               │
//!   gain on runs left out <── joint fit of what was chosen <── choose, beside curves of any shape
//! ```
//!
//! Every repeat keeps its own coefficients, set-up and times; an effect is one for all repeats, and counts by
//! what the fits of the model do not follow ([`residual`](crate::residual)).

mod account;
mod choose;
mod model_file;
mod result;
mod seek;
mod stand;
mod thresholds;
mod views;

pub use account::arcs::ArcShare;
pub use account::effects::EffectsAt;
pub use account::gain::{ProgramGain, RunGain};
pub use account::left_out::LeftOut;
pub use account::moved::Moved;
pub use account::numbers::Number;
pub use account::times::{OffCause, OffTime};
pub use choose::found::{Rival, Separation};
pub use choose::settings::WrongSetting;
pub use result::{Diagnosis, ExtendedModel, Finding, Verdict};
pub use views::feature::Feature;
pub use views::picture::{Picture, Point};
pub use views::view::{Bin, Subject, View, ViewKind};

use account::{arcs, effects, gain, moved, numbers, times, unseen};
use choose::found::Chosen;
use stand::Standing;
use views::{means, picture, sample, spectra};

use crate::error::Result;
use crate::identify::Campaign;
use crate::machine::Machine;
use crate::plan::Test;
use crate::residual::{Beside, Column, Noise, Residuals, structure};
pub use crate::residual::{Element, Owner, Structure};

/// Looks for what the model of a campaign gets wrong, and says no more than what it is.
///
/// # Errors
/// When the rows of a fit are not finite numbers.
pub fn search(test: &Test, machine: &Machine, campaign: &Campaign) -> Result<Searched> {
    let standing = Standing::of(test, machine, campaign, &|| ())?;
    let (residuals, chosen) = standing.now();
    let findings = findings(&stand::beside(residuals, chosen), chosen);
    let wrong_settings = standing.wrong_settings();
    Ok(Searched { findings, wrong_settings, extended: standing.into_model(test, machine) })
}

/// What was found.
#[derive(Debug)]
pub struct Searched {
    /// Effects, the largest first.
    pub findings: Vec<Finding>,
    /// Settings that are stated wrong.
    pub wrong_settings: Vec<WrongSetting>,
    /// The model with both; `None` where there is neither.
    pub extended: Option<ExtendedModel>,
}

fn findings(beside: &Beside, chosen: Option<&Chosen>) -> Vec<Finding> {
    let Some(Chosen { fitted, rivals, .. }) = chosen else { return Vec::new() };
    let residuals = beside.residuals;
    let long_run_mm2 = beside.noise_alone().long_run_mm2;
    let each = fitted.elements.iter().enumerate().zip(rivals);
    each.map(|((k, element), rivals)| {
        let (effects, numbers) = numbers::told(residuals, fitted, k, long_run_mm2);
        let outside = fitted.part(k).outside_of_fits(residuals);
        Finding {
            element: element.clone(),
            effects,
            numbers,
            amplitudes: fitted.amplitudes[k].clone(),
            rms_mm: residuals.rms_mm(outside.product(&outside)),
            rivals: rivals.clone(),
        }
    })
    .collect()
}

/// Settings put right, effects searched for, the model extended, its gain, all of it told.
pub const STEPS: usize = stand::STEPS + 1;

/// Looks for what the model of a campaign gets wrong, extends it and measures the gain.
///
/// # Errors
/// When the rows of a fit are not finite numbers.
pub fn diagnose(test: &Test, machine: &Machine, campaign: &Campaign) -> Result<Diagnosis> {
    watched(test, machine, campaign, &|| ())
}

/// The same; `step` is called [`STEPS`] times on the way.
///
/// # Errors
/// When the rows of a fit are not finite numbers.
pub fn watched(
    test: &Test,
    machine: &Machine,
    campaign: &Campaign,
    step: &dyn Fn(),
) -> Result<Diagnosis> {
    let standing = Standing::of(test, machine, campaign, step)?;
    let (of_test, campaign) = match &standing.corrected {
        Some(now) => (&now.test, &now.campaign),
        None => (test, campaign),
    };
    let (residuals, chosen) = standing.now();
    let (searched, gains) = (&standing.searched, &standing.gains);
    let fitted = chosen.map(|chosen| &chosen.fitted);
    let (alone, beside) = (residuals.alone(), stand::beside(residuals, chosen));
    let (noise, left_mm) = (&beside.noise_alone(), &beside.left_mm);
    let explained = fitted.and_then(|_| gain::explained(&gains.arcs));
    let samples = residuals.samples();
    let smallest_mm2 = thresholds::stands_beside_mm2(&beside);
    let verdict = Verdict {
        before_mm: searched.rms_mm(searched.model_mm2()),
        after_mm: residuals.rms_mm(left_mm.product(left_mm)),
        structure_before: structure(searched, &searched.model_mm, |_| true),
        structure_after: structure(residuals, left_mm, |_| true),
        neighbours_mm: noise.neighbours_mm2.sqrt(),
        effective_samples: samples as f64 * noise.variance_mm2 / noise.long_run_mm2,
        samples,
        explained: explained.map(|explained| explained.share),
        explained_interval: explained.and_then(|explained| explained.interval),
        smallest_mm: residuals.rms_mm(smallest_mm2),
    };
    let pictures = fitted.map_or_else(Vec::new, |fitted| {
        let of = |k| picture::picture(residuals, fitted, k, left_mm, noise.long_run_mm2);
        (0..fitted.elements.len()).map(of).collect()
    });
    let effects = fitted.map_or_else(Vec::new, |fitted| effects::at_readings(residuals, fitted));
    let shown = standing.extended.as_ref().map_or(campaign, |now| &now.campaign);
    let diagnosis = Diagnosis {
        verdict,
        findings: findings(&beside, chosen),
        runs: gains.runs.clone(),
        programs: fitted.map_or_else(Vec::new, |fitted| gain::by_program(searched, &alone, fitted)),
        moved: Vec::new(),
        unseen: unseen::unseen(
            &alone,
            campaign,
            verdict.structure_before.is_some(),
            fitted.is_some(),
        ),
        views: views(residuals, shown, left_mm, noise),
        pictures,
        effects,
        arcs: arcs::arcs((searched, campaign), (residuals, shown), left_mm),
        off_times: times::off(of_test, shown),
        wrong_settings: standing.wrong_settings(),
        left_out: campaign.left_out.iter().map(|(run, error)| LeftOut::of(run, error)).collect(),
        extended: None,
    };
    let moved = standing.extended.as_ref().map(|now| moved::moved(campaign, &now.campaign));
    drop(beside);
    let extended = standing.into_model(test, machine);
    step();
    Ok(Diagnosis { extended, moved: moved.unwrap_or_default(), ..diagnosis })
}

/// The residual before and after against everything, what holds most structure first.
fn views(residuals: &Residuals, campaign: &Campaign, left_mm: &Column, noise: &Noise) -> Vec<View> {
    let (shown, circles) = sample::shown(residuals, campaign, left_mm);
    let mut views = means::views(&shown, &circles, noise.long_run_mm2);
    views.extend(spectra::views(&shown, noise.long_run_mm2));
    let score = |view: &View| view.share_before.max(view.share_after);
    views.sort_by(|a, b| score(b).total_cmp(&score(a)));
    views
}
