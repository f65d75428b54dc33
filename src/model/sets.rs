//! Named sets of terms.

use std::sync::Arc;

use super::coefficient::{Ball, Coefficient, SetUp};
use super::local_frame::{LocalFrame, LocalTerm};
use super::shape::Shape;
use super::term::SetUpTerm;
use super::term::Term;
use crate::error::{Error, Result};
use crate::machine::{Axis, Plausible};

/// The errors of the machine where it was measured, with what is plausible for them: see [`local_terms`].
pub const LOCAL: &str = "local";

/// The set that is chosen by what a test can see; as a list of names it stands for all.
pub const COMPLETE: &str = "complete";

/// The sets that have a name, with what they are.
pub const NAMED_SETS: [(&str, &str); 7] = [
    (
        LOCAL,
        "the default: 24 errors of each slide about the middle of the test and 3 set-up errors a mounting, each as large as is plausible for the machine; effects may stand beside it, other terms may not",
    ),
    (
        COMPLETE,
        "the largest set that the test can tell apart, on this machine and in these mountings; terms named beside it are preferred to others",
    ),
    (
        "paper37",
        "the 37 coefficients and 3 set-up errors of the paper's Table 5; full rank only with the pivot of X on the base",
    ),
    (
        "observable35",
        "what 3D6 sees in one mounting with the pivots on the carriages: 35 coefficients and 3 set-up errors",
    ),
    (
        "planar27",
        "what the three coordinate planes see in one mounting: 27 coefficients and 3 set-up errors",
    ),
    (
        "volume53",
        "what the error of the whole volume needs and three mountings see: 53 coefficients and 3 set-up errors a mounting",
    ),
    ("all", "all 90 coefficients and 6 set-up errors, by minimum norm"),
];

/// Common to the paper's 37 and to the observable 35.
const SHARED: &str = "EXX1 EXX3 EXXb EYX2 EYXb EZX2 EZX3 EZXb \
    EXY2 EXY3 EXYb EYY1 EYY3 EYYb EZY2 EZY3 EZYb \
    EXZ1 EXZ2 EXZ3 EXZb EYZ2 EYZ3 EYZb EZZ1 EZZ3 EZZb \
    EAZ0 ECZ0 ECZ1 ECZ2 ECZ3 ECZb";

/// Of what the volume needs, what 3D6 cannot see in one mounting, whatever the pivots.
const NEEDS_MOUNTINGS: &str = "EXX2 EAX1 EAX2 EAX3 EAXb EBX1 EBX2 EBX3 EBXb ECX1 ECX2 ECX3 ECXb \
    EYX3 EYY2 EAZ1 EAZ2 EAZ3 EAZb EZZ2";

/// Of those, what needs a meridian between the coordinate planes.
const NEEDS_MERIDIANS: &str = "EZX3 EZY3 ECZ1 ECZ2 ECZ3 ECZb";

fn parse_all(names: &str) -> Vec<Coefficient> {
    names.split_whitespace().filter_map(Coefficient::parse).collect()
}

/// The coefficients of a named set, in the order of Table 1; `None` for an unknown name.
pub fn coefficients(set: &str) -> Option<Vec<Coefficient>> {
    let mut of_set = match set {
        "paper37" => [parse_all(SHARED), parse_all("EBX3 EBXb ECX3 ECXb")].concat(),
        "observable35" => [parse_all(SHARED), parse_all("EAZ3 EAZb")].concat(),
        "planar27" => {
            let meridians = parse_all(NEEDS_MERIDIANS);
            parse_all(SHARED).into_iter().filter(|c| !meridians.contains(c)).collect()
        }
        "volume53" => parse_all(&[SHARED, NEEDS_MOUNTINGS].join(" ")),
        "all" | COMPLETE => Coefficient::all().collect(),
        _ => return None,
    };
    of_set.sort();
    Some(of_set)
}

/// Five times the whole model: what a list needs that names and leaves out each and adds effects.
const MOST_NAMES: usize = 500;

/// The terms that a list of names asks for, in the order of Table 1, set-up errors last.
///
/// Each entry is the name of a set, of a coefficient or of a set-up error; `-NAME` leaves one out
/// again. A named set brings the set-up errors of the tool ball, `all` also those of the workpiece
/// ball. `mountings` names the mountings; each has set-up errors of its own, and `EXt@A` is the one of
/// mounting `A` alone. An effect is a term, too, by its cause: `cyclic:on=EXX,period_mm=10` estimates the
/// amplitudes of that period; see [`Shape::parse`].
///
/// # Errors
/// An unknown name, with the nearest names in the hint; an empty selection; more than 500 names.
pub fn terms(names: &[String], mountings: &[String]) -> Result<Vec<Box<dyn Term>>> {
    if names.len() > MOST_NAMES {
        return Err(Error::input(format!(
            "{} terms are named, and {MOST_NAMES} are the most",
            names.len()
        ))
        .hint("the whole model has 96, which `all` names at once"));
    }
    let mut chosen: Vec<Coefficient> = Vec::new();
    // Each for all mountings or for one.
    let mut set_ups: Vec<(SetUp, usize)> = Vec::new();
    let everywhere = |set_up: SetUp| (0..mountings.len()).map(move |mounting| (set_up, mounting));
    let mut effects: Vec<Shape> = Vec::new();
    for name in names {
        if name.contains(':') {
            effects.push(Shape::parse(name)?);
            continue;
        }
        if let Some(of_set) = coefficients(name) {
            chosen.extend(of_set);
            let brought =
                SetUp::all().filter(|s| name == "all" || name == COMPLETE || s.ball == Ball::Tool);
            set_ups.extend(brought.flat_map(everywhere));
            continue;
        }
        if let Some((set_up, mounting)) = of_one_mounting(name, mountings) {
            set_ups.push((set_up, mounting));
            continue;
        }
        let (leave_out, bare) = match name.strip_prefix('-') {
            Some(bare) => (true, bare),
            None => (false, name.as_str()),
        };
        match (Coefficient::parse(bare), SetUp::parse(bare)) {
            (Some(coefficient), _) if leave_out => chosen.retain(|c| *c != coefficient),
            (_, Some(set_up)) if leave_out => {
                set_ups.retain(|(s, _)| *s != set_up);
            }
            (Some(coefficient), _) => chosen.push(coefficient),
            (_, Some(set_up)) => set_ups.extend(everywhere(set_up)),
            (None, None) => {
                let sets: Vec<&str> = NAMED_SETS.iter().map(|(set, _)| *set).collect();
                return Err(Error::input(format!("unknown term `{name}`")).hint(format!(
                    "terms are named as in the paper, such as `EXX1`, `EYYb`, `EAZ0` or `EXt`; sets are `{}`",
                    sets.join("`, `")
                )));
            }
        }
    }
    chosen.sort();
    chosen.dedup();
    set_ups.sort_by_key(|&(set_up, mounting)| (mounting, set_up));
    set_ups.dedup();
    if chosen.is_empty() && set_ups.is_empty() && effects.is_empty() {
        return Err(Error::input("no terms are chosen")
            .hint("name a set such as `observable35`, or coefficients"));
    }
    let mut terms: Vec<Box<dyn Term>> = Vec::new();
    for coefficient in chosen {
        terms.push(Box::new(coefficient));
    }
    for (set_up, mounting) in set_ups {
        let mounting_name =
            if mountings.len() > 1 { mountings[mounting].clone() } else { String::new() };
        terms.push(Box::new(SetUpTerm { set_up, mounting, mounting_name, plausible_mm: None }));
    }
    for (index, effect) in effects.iter().enumerate() {
        if !effects[..index].contains(effect) {
            terms.push(Box::new(effect.clone()));
        }
    }
    Ok(terms)
}

/// The errors of each slide about the middle of a test, without what a slide that stood still cannot show, and the
/// set-up errors of the tool ball in each mounting; all with what is plausible for the machine.
pub fn local_terms(
    frame: &Arc<LocalFrame>,
    plausible: &Plausible,
    mountings: &[String],
) -> Vec<Box<dyn Term>> {
    let mut terms: Vec<Box<dyn Term>> = Vec::new();
    for slide in Axis::ALL {
        terms.push(Box::new(LocalTerm::new(slide, frame, plausible)));
    }
    for (mounting, name) in mountings.iter().enumerate() {
        let mounting_name = if mountings.len() > 1 { name.clone() } else { String::new() };
        for set_up in SetUp::all().filter(|set_up| set_up.ball == Ball::Tool) {
            terms.push(Box::new(SetUpTerm {
                set_up,
                mounting,
                mounting_name: mounting_name.clone(),
                plausible_mm: Some(plausible.set_up_mm),
            }));
        }
    }
    terms
}

/// `EXt@A`: a set-up error of one mounting, with the index of the mounting.
fn of_one_mounting(name: &str, mountings: &[String]) -> Option<(SetUp, usize)> {
    let (set_up, mounting) = name.split_once('@')?;
    Some((SetUp::parse(set_up)?, mountings.iter().position(|m| m == mounting)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sets_have_the_sizes_in_their_names() {
        for (set, size) in
            [("paper37", 37), ("observable35", 35), ("planar27", 27), ("volume53", 53), ("all", 90)]
        {
            assert_eq!(coefficients(set).unwrap().len(), size);
        }
        let one = terms(&["observable35".into()], &["A".into()]).unwrap();
        assert_eq!(one.len(), 38);
        let two = terms(&["observable35".into()], &["A".into(), "B".into()]).unwrap();
        assert_eq!(two.len(), 41);
        assert_eq!(two[40].parameters()[0].name, "EZt@B");
        let one_of_two = terms(&["EXt@B".into()], &["A".into(), "B".into()]).unwrap();
        assert_eq!(one_of_two.len(), 1);
        assert_eq!(one_of_two[0].parameters()[0].name, "EXt@B");
        assert!(terms(&["EXt@C".into()], &["A".into(), "B".into()]).is_err());
        let wave = terms(&["cyclic:on=EXX,period_mm=10".into()], &["A".into()]).unwrap();
        let names: Vec<String> = wave[0].parameters().into_iter().map(|p| p.name).collect();
        assert_eq!(names, ["cyclic EXX 10 mm sin", "cyclic EXX 10 mm cos"]);
        assert!(terms(&["cyclic:on=EXX".into()], &["A".into()]).is_err(), "no period");
        assert!(terms(&["clock:ppm=10".into()], &["A".into()]).is_err(), "no column");
    }

    #[test]
    fn a_minus_leaves_out_and_an_unknown_name_is_told() {
        let names = ["observable35".to_owned(), "-EAZ3".to_owned(), "EBX3".to_owned()];
        assert_eq!(terms(&names, &["A".into()]).unwrap().len(), 38);
        let error = terms(&["EXX9".into()], &["A".into()]).unwrap_err();
        assert!(error.what.contains("EXX9"));
    }
}
