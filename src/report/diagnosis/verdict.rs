//! Is anything wrong? The verdict, a sentence an entry.

use super::facts::{DiagnosisFacts, OffTimeFacts, StructureFacts, WrongSettingFacts};
use crate::report::text::numbers::{fixed, many, percent};

/// Structure of less than so many of its standard deviations may be chance.
const BEYOND_CHANCE: f64 = 3.0;

/// The verdict, the gravest first.
pub(super) fn of(facts: &DiagnosisFacts) -> Vec<String> {
    let mut told = vec![first(facts)];
    told.extend(facts.wrong_settings.iter().map(setting));
    told.extend(facts.off_times.iter().map(off_time));
    if !facts.findings.is_empty() {
        told.push(found(facts));
        if let (Some(share), Some([low, high])) = (facts.explained, facts.explained_interval) {
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
            fixed(facts.before_um, 3),
            fixed(facts.after_um, 3)
        ));
    }
    told.push(format!(
        "Residual noise {} um, of neighbouring readings {} um; effects below {} um rms would not have been named.",
        fixed(facts.after_um, 3),
        fixed(facts.neighbours_um, 3),
        fixed(facts.smallest_um, 3)
    ));
    told
}

fn first(facts: &DiagnosisFacts) -> String {
    match (&facts.structure_before, facts.findings.is_empty()) {
        (None, true) => format!(
            "Nothing found that the model does not explain; of the {} um rms that it leaves, no repeat tells what is noise.",
            fixed(facts.before_um, 3)
        ),
        (None, false) => format!(
            "The model leaves {} um rms, the extended model {} um; no repeat tells what of it is noise.",
            fixed(facts.before_um, 3),
            fixed(facts.after_um, 3)
        ),
        (Some(before), true) if significant(before) => format!(
            "{} um rms of structure repeats that the model does not explain, too little to name its cause.",
            rms(before)
        ),
        (Some(before), true) => {
            format!("The model explains all but {} um of what repeats.", rms(before))
        }
        (Some(before), false) => {
            let after = facts.structure_after.unwrap_or(*before);
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
        fixed(of.after_um, 3),
        fixed(of.before_um, 3)
    )
}

fn off_time(of: &OffTimeFacts) -> String {
    let percent = format!("{} +- {} %", fixed(of.percent, 2), fixed(of.sigma_percent, 2));
    let stated = fixed(of.stated_percent, 0);
    let ppm = fixed(of.clock_ppm, 0);
    if of.cause == "feed-override" {
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
fn significant(of: &StructureFacts) -> bool {
    of.variance_um2 > BEYOND_CHANCE * of.sigma_um2
}

/// With as many decimals as keep it from being none, and at the least what two sigma of chance would be.
fn rms(of: &StructureFacts) -> String {
    let least = (2.0 * of.sigma_um2).max(0.0).sqrt();
    if of.variance_um2 < 2.0 * of.sigma_um2 {
        return format!("at most {}", fixed(least, 3));
    }
    fixed(of.rms_um, 3)
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
