//! A compensation in sentences.

use std::fmt::Write as _;

use super::{Compensated, changed_between_repeats};
use crate::compensate::{Control, OnePoint};
use crate::report::text::numbers::{fixed, signed};

pub(super) fn um(mm: f64) -> String {
    fixed(1e3 * mm, 2)
}

fn signed_um(mm: f64) -> String {
    signed(1e3 * mm, 1)
}

fn place(of: impl Into<[f64; 3]>) -> String {
    of.into().map(|mm| fixed(mm, 1)).join(", ")
}

/// What the files do.
pub(super) fn verdict(told: &Compensated) -> Vec<String> {
    let of = told.of;
    let left = &of.left;
    let mut sentences = vec![
        format!(
            "Over what was measured the tool is off by {} um rms, {} um at the most. With these files, read back as the control reads them, {} um rms are left, {} um at the most.",
            um(left.before.rms_mm),
            um(left.before.largest_mm),
            um(left.after.rms_mm),
            um(left.after.largest_mm)
        ),
        format!(
            "That is by what is known. Of the machine's own vector {} um rms are noise, and {} um with what this test cannot tell from other plausible faults.",
            um(told.unknown.noise),
            um(told.unknown.all)
        ),
        format!(
            "{} of {} directions of the errors are smaller than their uncertainty and were shrunk, which changes the whole by {} um rms.",
            told.shrunk.directions,
            told.shrunk.of,
            um((told.shrunk_mm[1] - told.shrunk_mm[0]).abs())
        ),
        format!(
            "The functions hold for a tool whose tip is at {} mm, and for each slide with the others at X, Y, Z {} mm: angles act with both. Beyond what was measured they keep the value of its end; nobody has looked there.",
            place(of.asked.tool_ball_mm),
            place(of.asked.place_mm)
        ),
        active(told),
    ];
    sentences.extend(told.changed.map(changed_between_repeats));
    if left.after.rms_mm > 0.9 * left.before.rms_mm {
        sentences.push("This control takes hardly anything of it.".into());
    }
    sentences
}

/// Whether the numbers are all, or on top.
fn active(told: &Compensated) -> String {
    match (&told.active, told.of.asked.existing.is_empty()) {
        (None, true) => "The test file does not say which compensation was active when it was measured (`compensation` in `[record]`). If none was, these files are all; if one was, name its files with `--on-top`, or measure again without it.".into(),
        (Some(active), true) => format!("Active when it was measured: {active}. These files are what is needed beside that. If that is a table in the same place, name it with `--on-top`: a table that is loaded takes the place of the old one."),
        (active, false) => format!(
            "These files hold what was active when it was measured and what is needed on top: they take its place.{}",
            active.as_ref().map(|active| format!(" The test file says: {active}.")).unwrap_or_default()
        ),
    }
}

/// How a sign is seen.
pub(super) fn point(of: &OnePoint, control: Control, before: bool) -> String {
    let (over, along) = (of.over, of.along);
    let mut told = format!(
        "Send {over} from {} to {} mm (machine coordinates), both times the last 5 mm in the positive direction, the other slides where they are above. Along {along} the tool goes by {} um {} than commanded, as a laser or an indicator on a straight edge shows{}; with the files by {} um. If it is {} um, the sign is wrong.",
        fixed(of.from_mm, 0),
        fixed(of.to_mm, 0),
        signed_um(of.off_mm),
        if over == along { "farther" } else { "more" },
        if before { " with the files of before" } else { " without the files" },
        signed_um(of.left_mm),
        signed_um(of.wrong_mm),
    );
    if control == Control::Linuxcnc && over == along {
        let _ = write!(
            told,
            " Without any instrument: joint.{}.motor-pos-cmd changes by {} mm less than the position.",
            over.index(),
            fixed(of.off_mm - of.left_mm, 4)
        );
    }
    told
}
