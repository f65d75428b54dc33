//! What stands: what is stated wrong put right, the model extended by the effects that a search found, looked at again, and
//! held against runs that took no part.

use super::account::costs;
use super::account::gain::{self, Gains};
use super::choose::exact;
use super::choose::extend::{self, Extended};
use super::choose::found::Chosen;
use super::choose::price::Price;
use super::choose::run::{self, Again};
use super::choose::settings::{self, Corrected, WrongSetting};
use super::choose::tidy::fallen;
use super::result::ExtendedModel;
use crate::error::Result;
use crate::identify::Campaign;
use crate::machine::Machine;
use crate::plan::Test;
use crate::residual::{self, Beside, Residuals};

/// The extended model is looked at again so often, at most, for effects that are no more or that it uncovers.
const MOST_LOOKS: usize = 2;
/// A fit with effects leaves so much of what it leaves without them, at the most: one that follows as well without, as it does a slide
/// that is late, is as good but for rounding. One that leaves more has lost its times.
const AS_WELL: f64 = 1.02;
/// How often [`Standing::of`] says that something is done: the settings, the search, the extended model, the gain.
pub(super) const STEPS: usize = 4;

/// What of a diagnosis all the rest is told about.
pub(super) struct Standing {
    /// The campaign as it is with what is stated wrong put right; `None` where nothing is.
    pub(super) corrected: Option<Corrected>,
    /// Linear about that, or about the campaign as it was identified.
    pub(super) searched: Residuals,
    /// The model with what was found; `None` where nothing was.
    pub(super) extended: Option<Extended>,
    /// What it explains of runs that took no part.
    pub(super) gains: Gains,
}

impl Standing {
    /// # Errors
    /// When the rows of a fit are not finite numbers.
    pub(super) fn of(
        test: &Test,
        machine: &Machine,
        campaign: &Campaign,
        step: &dyn Fn(),
    ) -> Result<Self> {
        let (corrected, searched) = settings::corrected(test, machine, campaign)?;
        step();
        let standing = Self::about(test, machine, campaign, (corrected, searched), step)?;
        if standing.corrected.is_none() {
            return Ok(standing);
        }
        // A setting may explain more than any one effect does and less than two: what stands with the files as they are written.
        let searched = Residuals::of(test, machine, campaign)?;
        let stated = Self::about(test, machine, campaign, (None, searched), &|| ())?;
        Ok(if stated.is_likelier_than(&standing) { stated } else { standing })
    }

    /// What stands with some settings put right, or none.
    fn about(
        test: &Test,
        machine: &Machine,
        campaign: &Campaign,
        (corrected, searched): (Option<Corrected>, Residuals),
        step: &dyn Fn(),
    ) -> Result<Self> {
        let (test, machine, campaign) = match &corrected {
            Some(now) => (&now.test, &now.machine, &now.campaign),
            None => (test, machine, campaign),
        };
        let mut chosen = run::chosen(&searched, campaign);
        step();
        let mut looks = 0;
        // What left the least by itself, and how much; looks may lead from there to nothing.
        let mut least: Option<(f64, Chosen)> = None;
        let mut looking = true;
        let mut held_against_rivals = false;
        let mut settled = false;
        loop {
            let extended = match &chosen {
                Some(chosen) => extend::extend(test, machine, campaign, chosen)?,
                None => None,
            };
            let left_mm = extended.as_ref().map_or(f64::INFINITY, Extended::left_mm);
            // With them it must leave less than without, and the fit, which lets slides follow unlike, no more than before.
            let extended = extended.filter(|now| {
                left_mm < searched.rms_mm(searched.model_mm2())
                    && now.campaign.rms_mm() < AS_WELL * campaign.rms_mm()
            });
            if let (Some(from), Some(_)) = (&chosen, &extended)
                && least.as_ref().is_none_or(|(least_mm, _)| left_mm < *least_mm)
            {
                least = Some((left_mm, from.clone()));
            }
            // Effects that cannot be together: the largest first, so the last goes.
            if let (Some(astray), None) = (&chosen, &extended) {
                let last = astray.fitted.elements.len() - 1;
                chosen = astray.without(last, &searched.alone());
                continue;
            }
            if let Some(now) = extended.as_ref().filter(|_| looking && looks < MOST_LOOKS) {
                match run::again(&now.residuals, &now.campaign, &now.chosen) {
                    Again::Other(other) => {
                        looks += 1;
                        chosen = other;
                        continue;
                    }
                    Again::Same(nearly) => {
                        if let Some(chosen) = &mut chosen {
                            chosen.nearly = nearly;
                        }
                    }
                }
            }
            // The last look may have left what no longer stands about the model that it led to.
            if (!looking || looks == MOST_LOOKS)
                && let Some(Extended { residuals, chosen: now, .. }) = &extended
                && let Some((index, _)) =
                    fallen(residuals, &now.fitted, &|all| residual::fit(&residuals.alone(), all))
            {
                chosen = now.without(index, &searched.alone());
                continue;
            }
            // Where looks led to nothing, what left the least stands if it stands by itself.
            if chosen.is_none()
                && let Some((_, best)) = least.take().filter(|_| looking)
            {
                (chosen, looking) = (Some(best), false);
                continue;
            }
            if let (Some(from), Some(now)) = (&chosen, &extended)
                && !std::mem::replace(&mut held_against_rivals, true)
                && let Some(likelier) =
                    exact::likelier(test, machine, (campaign, &searched.alone()), from, now)?
            {
                chosen = Some(likelier);
                continue;
            }
            // What a run that took no part speaks against is taken out, and all is extended again: one step.
            if !std::mem::replace(&mut settled, true) {
                step();
            }
            let (residuals, now) = now(&searched, extended.as_ref());
            let beside = beside(residuals, now);
            let fitted = now.map(|chosen| &chosen.fitted);
            let gains = gain::by_run(&searched, &residuals.alone(), &beside.left_mm, fitted);
            let (Some(harmful), Some(now)) = (gains.harmful, now) else {
                let long_run_mm2 = beside.noise_alone().long_run_mm2;
                drop(beside);
                let mut extended = extended;
                if let Some(Extended { campaign, residuals, chosen }) = &mut extended {
                    costs::count(campaign, residuals, &chosen.fitted, long_run_mm2);
                }
                step();
                return Ok(Self { corrected, searched, extended, gains });
            };
            chosen = now.without(harmful, &searched.alone());
            least = None;
        }
    }

    /// Whether it costs less than with settings put right.
    fn is_likelier_than(&self, other: &Self) -> bool {
        let (residuals, chosen) = other.now();
        let price = Price::of(&beside(residuals, chosen));
        let of_mm2 = |of: &Self| price.of_mm2(of.left_mm(), of.numbers());
        of_mm2(self) < of_mm2(other)
    }

    /// What is left beside what was found, mm rms.
    fn left_mm(&self) -> f64 {
        let alone = || self.searched.rms_mm(self.searched.model_mm2());
        self.extended.as_ref().map_or_else(alone, Extended::left_mm)
    }

    /// How many numbers say what was found.
    fn numbers(&self) -> usize {
        let settings = self.corrected.as_ref().map_or(0, |now| now.wrong.len());
        settings + self.extended.as_ref().map_or(0, Extended::numbers)
    }

    /// The residuals that the effects are told about, and the effects. About the extended model a few more samples, or
    /// fewer, take part.
    pub(super) fn now(&self) -> (&Residuals, Option<&Chosen>) {
        now(&self.searched, self.extended.as_ref())
    }

    /// The extended model, what is not known of the effects counted in its numbers; `None` where nothing is wrong.
    pub(super) fn into_model(self, test: &Test, machine: &Machine) -> Option<ExtendedModel> {
        let campaign = self.extended.map(|now| now.campaign);
        let Some(now) = self.corrected else {
            let (test, machine) = (test.clone(), machine.clone());
            return campaign.map(|campaign| ExtendedModel { test, machine, campaign });
        };
        let campaign = campaign.unwrap_or(now.campaign);
        Some(ExtendedModel { test: now.test, machine: now.machine, campaign })
    }

    /// What was stated wrong.
    pub(super) fn wrong_settings(&self) -> Vec<WrongSetting> {
        self.corrected.as_ref().map_or_else(Vec::new, |now| now.wrong.clone())
    }
}

fn now<'a>(
    searched: &'a Residuals,
    extended: Option<&'a Extended>,
) -> (&'a Residuals, Option<&'a Chosen>) {
    extended.map_or((searched, None), |now| (&now.residuals, Some(&now.chosen)))
}

/// What is left beside the effects.
pub(super) fn beside<'a>(residuals: &'a Residuals, chosen: Option<&Chosen>) -> Beside<'a> {
    residuals.beside(chosen.map_or(&[], |chosen| &chosen.fitted.columns))
}
