//! Is anything wrong? The verdict, a sentence an entry.

use super::facts::{DiagnosisFacts, WrongSettingFacts};
use crate::diagnose::{OffCause, OffTime, Structure};
use crate::report::text::numbers::{fixed, many, percent};

/// Structure of less than so many of its standard deviations may be chance.
const BEYOND_CHANCE: f64 = 3.0;

/// Sentences are in um.
const UM: f64 = 1e3;

/// The verdict, the gravest first.
pub(super) fn of(facts: &DiagnosisFacts) -> Vec<String> {
    let mut told = vec![first(facts)];
    told.extend(facts.wrong_settings.iter().map(setting));
    told.extend(facts.off_times.iter().map(off_time));
    if !facts.findings.is_empty() {
        told.push(found(facts));
        if let (Some(share), Some([low, high])) =
            (facts.of_all.explained, facts.of_all.explained_interval)
        {
            told.push(format!(
                "Explained on {}: {} % of what repeats, 95 % interval {} to {} %.",
                if facts.runs.len() > 1 { "runs that took no part" } else { "the run itself" },
                percent(share),
                percent(low),
                percent(high)
            ));
        }
        told.push(format!(
            "Compensated or repaired, the residual of {} um rms would be {} um.",
            fixed(facts.of_all.before_mm * UM, 3),
            fixed(facts.of_all.after_mm * UM, 3)
        ));
    }
    told.push(format!(
        "Residual noise {} um, of neighbouring readings {} um; effects below {} um rms would not have been named.",
        fixed(facts.of_all.after_mm * UM, 3),
        fixed(facts.of_all.neighbours_mm * UM, 3),
        fixed(facts.of_all.smallest_mm * UM, 3)
    ));
    told
}

fn first(facts: &DiagnosisFacts) -> String {
    match (&facts.of_all.structure_before, facts.findings.is_empty()) {
        (None, true) => format!(
            "Nothing found that the model does not explain; of the {} um rms that it leaves, no repeat tells what is noise.",
            fixed(facts.of_all.before_mm * UM, 3)
        ),
        (None, false) => format!(
            "The model leaves {} um rms, the extended model {} um; no repeat tells what of it is noise.",
            fixed(facts.of_all.before_mm * UM, 3),
            fixed(facts.of_all.after_mm * UM, 3)
        ),
        (Some(before), true) if significant(before) => format!(
            "{} um rms of structure repeats that the model does not explain, too little to name its cause.",
            rms(before)
        ),
        (Some(before), true) => {
            format!("The model explains all but {} um of what repeats.", rms(before))
        }
        (Some(before), false) => {
            let after = facts.of_all.structure_after.unwrap_or(*before);
            format!(
                "{} um rms of structure repeats that the model does not explain; the extended model leaves {} um.",
                rms(before),
                rms(&after)
            )
        }
    }
}

fn setting(of: &WrongSettingFacts) -> String {
    format!(
        "{}. So the residual is {} um rms instead of {} um; all that follows is with it put right.",
        of.told,
        fixed(of.setting.after_mm * UM, 3),
        fixed(of.setting.before_mm * UM, 3)
    )
}

fn off_time(of: &OffTime) -> String {
    let percent = format!("{} +- {} %", fixed(of.percent, 2), fixed(of.sigma_percent, 2));
    let stated = fixed(of.stated_percent, 0);
    let ppm = fixed(of.clock_ppm, 0);
    if of.cause == OffCause::FeedOverride {
        format!(
            "Time of {}: the feed override stood at {percent}, not at {stated} % as the test file has it: say `feed_override_percent = {}` in the run. A clock that is off by {ppm} ppm would do the same.",
            of.run,
            fixed(of.percent, 1),
        )
    } else {
        format!(
            "Time of {}: the clock is off by {ppm} ppm, more than the test file allows: say `clock_ppm` of the ball bar as it is. A feed override of {percent} would do the same.",
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
        return format!("at most {}", fixed(least_mm * UM, 3));
    }
    fixed(of.rms_mm() * UM, 3)
}

fn found(facts: &DiagnosisFacts) -> String {
    let named = facts.findings.iter().filter(|finding| finding.named).count();
    let unexplained = facts.findings.len() - named;
    let mut parts = Vec::new();
    if named > 0 {
        parts.push(format!("{} named", many(named, "cause")));
    }
    if unexplained > 0 {
        parts.push(format!("{} without a cause", many(unexplained, "curve")));
    }
    format!("Found: {}.", parts.join(", "))
}
