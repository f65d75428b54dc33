//! Is anything wrong? The verdict, a sentence an entry.

use serde::{Serialize, Serializer};

use super::settings::WrongSettingFacts;
use crate::diagnose::{Diagnosis, Finding, OffCause, OffTime, Owner, Structure, Verdict};
use crate::identify::Identification;
use crate::report::text::numbers::{fixed, many, percent};

/// Structure of less than so many of its standard deviations may be chance.
const BEYOND_CHANCE: f64 = 3.0;
/// Where an effect has to be so many times what is left to be named, a test is too short to name any.
const TOO_SHORT: f64 = 10.0;
/// Two residuals are told apart that differ by more than this share: less is rounding and samples at the ends of arcs.
const UNLIKE: f64 = 0.02;

/// The verdict, sentence by sentence, in the order in which they are read: the gravest first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VerdictFacts {
    /// How much of the residual repeats, or is left.
    pub structure: String,
    /// Where slides follow unlike, what the fit that lets them leaves; `None` where it leaves the same.
    pub following: Option<String>,
    /// What the machine file or the test file states wrong, a sentence a setting.
    pub wrong_settings: Vec<String>,
    /// Runs whose feed or clock is not as stated, a sentence a run.
    pub off_times: Vec<String>,
    /// How many effects were found; `None` where there are none.
    pub found: Option<String>,
    /// Why none of them is sure, where little is explained of a run.
    pub doubt: Option<String>,
    /// What share they explain; `None` where nothing was found or the share is not known.
    pub explained: Option<String>,
    /// What the residual would be without them; `None` where there are none.
    pub repaired: Option<String>,
    /// What is left, and what would not have been seen.
    pub noise: String,
}

/// What the fits of a campaign left.
#[derive(Debug, Clone)]
struct Left {
    /// Root mean square, mm.
    fit_mm: f64,
    /// How many times chance it is, at most; `None` where all leave little more.
    beyond_chance: Option<f64>,
}

impl Left {
    fn of(fits: &[Identification]) -> Self {
        let used: usize = fits.iter().map(|of| of.used).sum();
        let squares_mm2: f64 = fits.iter().map(|of| of.rms_mm.powi(2) * of.used as f64).sum();
        Self {
            fit_mm: (squares_mm2 / used.max(1) as f64).sqrt(),
            beyond_chance: fits.iter().filter_map(|of| of.beyond_chance).reduce(f64::max),
        }
    }
}

/// What is said of causes where the model by itself explains little of a run and they do not explain the rest: its log may be wrong. What
/// leaves no more than chance is of its program.
fn doubt(fits: &[Identification], diagnosis: &Diagnosis) -> Option<String> {
    let with_causes = &diagnosis.extended.as_ref()?.campaign.repeats;
    if with_causes.iter().all(|of| of.beyond_chance.is_none()) {
        return None;
    }
    let little = fits.iter().flat_map(|of| &of.little_explained);
    let runs: Vec<&str> = little.map(|of| of.run.as_str()).collect();
    (!runs.is_empty()).then(|| {
        format!(
            "Of {} the model by itself explains little, and with what was found it leaves more than chance: no cause is sure until each log is known to be of its run and its program.",
            runs.join(", ")
        )
    })
}

impl VerdictFacts {
    /// The verdict on a diagnosis with the settings that are stated wrong, in words, and what the fits that were diagnosed left.
    pub(super) fn new(
        diagnosis: &Diagnosis,
        wrong_settings: &[WrongSettingFacts],
        fits: &[Identification],
    ) -> Self {
        let (all, left) = (&diagnosis.verdict, &Left::of(fits));
        let something = !diagnosis.findings.is_empty();
        Self {
            structure: structure(all, left, something),
            following: following(all, left.fit_mm).filter(|_| wrong_settings.is_empty()),
            wrong_settings: wrong_settings.iter().map(setting).collect(),
            off_times: diagnosis.off_times.iter().map(off_time).collect(),
            found: something.then(|| found(&diagnosis.findings)),
            doubt: doubt(fits, diagnosis).filter(|_| something),
            explained: explained(all).filter(|_| something && shared(diagnosis)),
            repaired: something.then(|| {
                format!(
                    "After compensation or repair, the residual of {} um rms would be {} um rms.",
                    um(all.before_mm),
                    um(all.after_mm)
                )
            }),
            noise: format!(
                "Residual noise: {} um rms; between neighbouring readings: {} um rms. {}",
                um(all.after_mm),
                um(all.neighbours_mm),
                least(all)
            ),
        }
    }

    /// All sentences.
    pub fn sentences(&self) -> impl Iterator<Item = &str> {
        let gain = [&self.explained, &self.repaired].into_iter().flatten();
        self.what_is_wrong().chain(gain.map(String::as_str)).chain([self.noise.as_str()])
    }

    /// The sentences of a summary: what is wrong, and what share of it is explained.
    pub(super) fn in_short(&self) -> impl Iterator<Item = &str> {
        let gain = self.explained.as_deref().or(self.repaired.as_deref());
        self.what_is_wrong().chain(gain)
    }

    fn what_is_wrong(&self) -> impl Iterator<Item = &str> {
        let stated = self.wrong_settings.iter().chain(&self.off_times).map(String::as_str);
        let structure = [self.structure.as_str()].into_iter().chain(self.following.as_deref());
        structure.chain(stated).chain(self.found.as_deref()).chain(self.doubt.as_deref())
    }
}

/// A list of its sentences.
impl Serialize for VerdictFacts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.sentences())
    }
}

/// A length in um with three decimals.
fn um(mm: f64) -> String {
    fixed(mm * 1e3, 3)
}

fn structure(all: &Verdict, left: &Left, something_found: bool) -> String {
    if let Some(times) = left.beyond_chance.filter(|_| !something_found) {
        let repeats = all.structure_before.as_ref().map_or_else(
            || "No program ran twice: its repeatable part is unknown.".to_owned(),
            |of| format!("Its repeatable part is {} um rms.", rms(of)),
        );
        return format!(
            "The model leaves {} um rms, which is {} times what one reading differs from the next by chance, and no cause was found for it. {repeats}",
            um(left.fit_mm),
            fixed(times, 0)
        );
    }
    match (&all.structure_before, something_found) {
        (None, false) => format!(
            "Nothing was found that the model does not explain. The residual is {} um rms. No program ran twice: its repeatable part is unknown.",
            um(all.before_mm)
        ),
        (None, true) => format!(
            "The residual is {} um rms with the model and {} um rms with the extended model. No program ran twice: its repeatable part is unknown.",
            um(all.before_mm),
            um(all.after_mm)
        ),
        (Some(before), false) if significant(before) => format!(
            "The repeatable part of the residual is {} um rms. It is too small to name its cause.",
            rms(before)
        ),
        (Some(before), false) => {
            format!(
                "The model explains the readings: the repeatable part of the residual is {} um rms.",
                rms(before)
            )
        }
        (Some(before), true) => {
            let after = all.structure_after.unwrap_or(*before);
            format!(
                "The repeatable part of the residual is {} um rms. With the extended model it is {} um rms.",
                rms(before),
                rms(&after)
            )
        }
    }
}

/// Whether all that was found is in all runs alike: of what is one run's own nothing repeats.
fn shared(diagnosis: &Diagnosis) -> bool {
    diagnosis.findings.iter().all(|finding| finding.owner() == Owner::All)
}

/// `None` where no run was foretold from others, or nobody knows what repeats.
fn explained(all: &Verdict) -> Option<String> {
    let [low, high] = all.explained_interval?;
    all.structure_before?;
    Some(format!(
        "Explained on runs that were not fitted: {} % of the repeatable part of the residual (95 % interval {} to {} %).",
        percent(all.explained?),
        percent(low),
        percent(high)
    ))
}

fn following(all: &Verdict, fit_mm: f64) -> Option<String> {
    let apart = all.before_mm - fit_mm;
    (apart > UNLIKE * all.before_mm).then(|| {
        format!(
            "The residual of {} um rms counts a slide that follows later than another as an error. The fit lets them follow unlike and leaves {} um rms.",
            um(all.before_mm),
            um(fit_mm)
        )
    })
}

fn setting(of: &WrongSettingFacts) -> String {
    format!(
        "{}. With this correction the residual is {} um rms instead of {} um rms. All that follows includes the correction.",
        of.in_words,
        um(of.setting.after_mm),
        um(of.setting.before_mm)
    )
}

fn off_time(of: &OffTime) -> String {
    let percent = format!("{} +- {} %", fixed(of.percent, 2), fixed(of.sigma_percent, 2));
    let stated = fixed(of.stated_percent, 0);
    let ppm = fixed(of.clock_ppm, 0);
    if of.cause == OffCause::FeedOverride {
        format!(
            "Time of {}: the feed override was {percent}, not {stated} % as the test file states. Write `feed_override_percent = {}` in the run. A clock error of {ppm} ppm would have the same effect.",
            of.run,
            fixed(of.percent, 1),
        )
    } else {
        format!(
            "Time of {}: the clock is off by {ppm} ppm, more than the test file allows. Write the real `clock_ppm` of the ball bar. A feed override of {percent} would have the same effect.",
            of.run
        )
    }
}

/// Whether the structure is more than chance and large enough to matter.
fn significant(of: &Structure) -> bool {
    of.variance_mm2 > BEYOND_CHANCE * of.sigma_mm2
}

/// With as many decimals as keep it from being none, and at the least what two sigma of chance would be.
fn rms(of: &Structure) -> String {
    if of.variance_mm2 < 2.0 * of.sigma_mm2 {
        let least_mm = (2.0 * of.sigma_mm2).max(0.0).sqrt();
        return format!("at most {}", um(least_mm));
    }
    um(of.rms_mm())
}

/// How large an effect would have been named.
fn least(all: &Verdict) -> String {
    if all.smallest_mm > TOO_SHORT * all.after_mm {
        return format!(
            "What is left changes so slowly that its {} count for {:.0} independent ones: no effect of its size would have been named.",
            many(all.samples, "reading"),
            all.effective_samples.max(1.0)
        );
    }
    format!("Effects below {} um rms would not have been named.", um(all.smallest_mm))
}

fn found(findings: &[Finding]) -> String {
    let named = findings.iter().filter(|finding| finding.named()).count();
    let unexplained = findings.len() - named;
    let mut parts = Vec::new();
    if named > 0 {
        parts.push(format!("{} named", many(named, "cause")));
    }
    if unexplained > 0 {
        parts.push(format!("{} without a cause", many(unexplained, "curve")));
    }
    format!("Found: {}.", parts.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_far_beyond_chance_is_not_said_to_be_explained() {
        let repeats = Structure { variance_mm2: 1e-4, sigma_mm2: 1e-6 };
        for before in [None, Some(repeats), Some(Structure { sigma_mm2: 1e-3, ..repeats })] {
            let verdict = Verdict {
                before_mm: 0.016,
                after_mm: 0.016,
                structure_before: before,
                structure_after: before,
                neighbours_mm: 1e-4,
                effective_samples: 10.0,
                samples: 1000,
                explained: None,
                explained_interval: None,
                smallest_mm: 1e-4,
            };
            let of = |beyond_chance| {
                let left = Left { fit_mm: 0.016, beyond_chance };
                structure(&verdict, &left, false)
            };
            let told = of(Some(108.0));
            assert!(
                told.starts_with("The model leaves 16.000 um rms, which is 108 times"),
                "{told}"
            );
            assert!(told.contains("no cause was found for it"), "{told}");
            assert!(!of(None).contains("no cause was found for it"));
        }
    }
}
