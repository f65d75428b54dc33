//! What two tests have in common, and what they differ in.

use super::past::{MountingThen, Past};
use super::thresholds::{SAME_NOMINAL, SAME_PLACE};

/// What may be compared of two tests.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Circumstances {
    /// What differs, in sentences.
    pub(super) differences: Vec<String>,
    /// Whether both were driven at the same place with the same bar.
    pub(super) same_place: bool,
    /// Whether what one test cannot tell from other faults the other cannot either.
    pub(super) equal: bool,
    /// Whether nothing says that the bars are two.
    pub(super) same_bar: bool,
}

impl Circumstances {
    pub(super) fn of(before: &Past, after: &Past) -> Self {
        let mut differences = Vec::new();
        let mut differ = |same: bool, sentence: String| {
            if !same {
                differences.push(sentence);
            }
            same
        };
        let same_machine = differ(
            before.machine == after.machine,
            format!(
                "These are two machines, `{}` and `{}`: what differs is between machines, not over time.",
                before.machine, after.machine
            ),
        );
        let same_serial = differ(
            stated_alike(before.machine_serial.as_ref(), after.machine_serial.as_ref()),
            format!(
                "The serial numbers of the machines differ, {} and {}: what differs is between machines, not over time.",
                or_none(before.machine_serial.as_ref()),
                or_none(after.machine_serial.as_ref())
            ),
        );
        let same_kinematics = differ(
            before.kinematics == after.kinematics,
            format!("The machine files differ: {} and {}.", before.kinematics, after.kinematics),
        );
        let same_bar = differ(
            stated_alike(before.bar_serial.as_ref(), after.bar_serial.as_ref()),
            format!(
                "The bars are two, {} and {}.",
                or_none(before.bar_serial.as_ref()),
                or_none(after.bar_serial.as_ref())
            ),
        );
        differ(
            before.compensation == after.compensation,
            format!(
                "The compensation differs: {} and {}.",
                or_none(before.compensation.as_ref()),
                or_none(after.compensation.as_ref())
            ),
        );
        let places = places(&before.mountings, &after.mountings);
        let same_place = places.is_none();
        differences.extend(places);
        let same_arcs = before.arcs == after.arcs;
        if !same_arcs {
            differences.push(arcs(before, after));
        }
        let same_terms = before.terms == after.terms;
        if !same_terms {
            differences.push(format!(
                "The terms differ: {} and {}.",
                before.terms.join(", "),
                after.terms.join(", ")
            ));
        }
        if before.readings_sha256.is_some() && before.readings_sha256 == after.readings_sha256 {
            differences.insert(
                0,
                "Both are analyses of the same readings: what differs is the analysis.".into(),
            );
        }
        let equal =
            same_machine && same_serial && same_kinematics && same_place && same_arcs && same_terms;
        Self { differences, same_place, equal, same_bar }
    }
}

/// Whether two texts are the same, or one is not stated.
fn stated_alike(before: Option<&String>, after: Option<&String>) -> bool {
    before.zip(after).is_none_or(|(before, after)| before == after)
}

fn or_none(stated: Option<&String>) -> String {
    stated.map_or_else(|| "none stated".to_owned(), |stated| format!("`{stated}`"))
}

/// What differs in where the balls were and with which bar.
fn places(before: &[MountingThen], after: &[MountingThen]) -> Option<String> {
    if before.len() != after.len() {
        return Some(format!(
            "The numbers of mountings differ: {} and {}.",
            before.len(),
            after.len()
        ));
    }
    for (one, other) in before.iter().zip(after) {
        let lengths = [one.bar_length_mm, other.bar_length_mm];
        if !same_nominal(lengths[0], lengths[1]) {
            return Some(format!(
                "The bars are of two lengths, {} and {} mm: ranges and circular tests are not compared.",
                lengths[0], lengths[1]
            ));
        }
        let near_mm = SAME_PLACE * lengths[0];
        for (a, b, what) in [
            (one.coincidence_mm, other.coincidence_mm, "places"),
            (one.tool_ball_mm, other.tool_ball_mm, "tool balls"),
        ] {
            if distance_mm(a, b) > near_mm {
                return Some(format!(
                    "The {what} differ, {} and {} mm: ranges and circular tests are not compared.",
                    told(a),
                    told(b)
                ));
            }
        }
    }
    None
}

/// The arcs that one test has and the other has not.
fn arcs(before: &Past, after: &Past) -> String {
    let some = |one: &Past, other: &Past| {
        let mut only: Vec<&str> = one.arcs.difference(&other.arcs).map(String::as_str).collect();
        let more = only.len().saturating_sub(3);
        only.truncate(3);
        match (only.is_empty(), more) {
            (true, _) => "nothing".to_owned(),
            (_, 0) => only.join(", "),
            _ => format!("{} and {more} more", only.join(", ")),
        }
    };
    format!(
        "The tests drive other arcs: {} only before, {} only after.",
        some(before, after),
        some(after, before)
    )
}

pub(super) fn same_nominal(one: f64, other: f64) -> bool {
    (one - other).abs() <= SAME_NOMINAL * one.abs().max(other.abs())
}

pub(super) fn distance_mm(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn told(at: [f64; 3]) -> String {
    let [x, y, z] = at;
    format!("({x}, {y}, {z})")
}
