//! Which terms to prefer where not all can be told apart.
//!
//! The default order is the paper's: what it removes last is kept first. Within one of its stages, and
//! for everything that it does not decide, geometric sense does: squareness before the slope of a
//! straightness, displacement before rotation, low degree before high, hysteresis after the linear part.

use crate::error::{Error, Result};
use crate::model::{Ball, Coefficient, Power, SetUp};

/// What the paper gives up for its meridians and before that for the volume, the last given up first: the
/// order in which one would take terms back.
const GIVEN_UP: [&str; 13] = [
    "EZZ2",
    "EYY2",
    "EYX3",
    "EXX2",
    "EAZ1 EAZ2 EAZ3 EAZb",
    "EAX1 EAX2 EAX3 EAXb EBX1 EBX2 ECX1 ECX2",
    "EYX1 EZX1 EYZ1",
    "EZY1",
    "EXY1",
    "EBZ1 EBZ2 EBZ3 EBZb",
    "EAY1 EAY2 EAY3 EAYb EBY1 EBY2 EBY3 EBYb ECY1 ECY2 ECY3 ECYb",
    "EXX0 EYX0 EZX0 EAX0 EBX0 ECX0 EXY0 EYY0 EZY0 EAY0 EBY0 ECY0 EXZ0 EYZ0 EZZ0 EBZ0",
    "EXw EYw EZw",
];
/// What it gives up for the three planes.
const FOR_PLANES: &str = "ECZ1 ECZ2 ECZ3 ECZb EZY3 EZX3 ECX3 ECXb";

/// The names of all 90 coefficients and the six set-up errors, the most wanted first.
///
/// `first` are preferred to all others, in their own order.
///
/// # Errors
/// A name that is neither a coefficient's nor a set-up error's.
pub fn preference(first: &[String]) -> Result<Vec<String>> {
    for name in first {
        if Coefficient::parse(name).is_none() && SetUp::parse(name).is_none() {
            return Err(Error::input(format!("unknown term `{name}`")).hint(
                "preferred terms are single coefficients and set-up errors, such as `EXX2` or `EXt`",
            ));
        }
    }
    let mut names: Vec<String> = Coefficient::all()
        .map(|c| c.to_string())
        .chain(SetUp::all().map(|s| s.to_string()))
        .collect();
    // Stable: what the key leaves open stays in the order of the paper's Table 1.
    names.sort_by_key(|name| {
        let by_user = first.iter().position(|f| f == name).unwrap_or(first.len());
        // What the paper gives up for the three planes decides only between equals.
        let planes = FOR_PLANES.split_whitespace().any(|given_up| given_up == name);
        (by_user, place_of_return(name), by_geometry(name), planes)
    });
    Ok(names)
}

/// 0 for what the paper keeps, more the earlier it gives up a term.
///
/// Its list for the three planes does not count here: it gives up straightness for the sake of rotations that
/// the meridians then show to be the same thing.
fn place_of_return(name: &str) -> usize {
    let returns = |group: &&str| group.split_whitespace().any(|given_up| given_up == name);
    GIVEN_UP.iter().position(returns).map_or(0, |place| place + 1)
}

/// What is easier to give a meaning comes first.
fn by_geometry(name: &str) -> (usize, usize) {
    let Some(c) = Coefficient::parse(name) else {
        let of_tool = SetUp::parse(name).is_some_and(|set_up| set_up.ball == Ball::Tool);
        return (0, usize::from(!of_tool));
    };
    let angular = usize::from(c.component.is_angular());
    match c.power {
        // A constant angle between slides is a squareness; a constant displacement is nothing of its own.
        Power::P0 if c.component.is_angular() => (1, 0),
        Power::P1 => (2, angular),
        Power::B => (3, angular),
        Power::P2 => (4, angular),
        Power::P3 => (5, angular),
        Power::P0 => (6, 0),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn squareness_comes_before_the_slope_of_a_straightness_and_the_user_before_all() {
        let names = preference(&["EXX2".to_owned()]).unwrap();
        assert_eq!(names.len(), 96);
        let place = |name: &str| names.iter().position(|n| n == name).unwrap();
        assert_eq!(place("EXX2"), 0);
        assert!(place("EXt") < place("EXw"));
        assert!(place("EAZ0") < place("EZY1") && place("ECZ0") < place("EXY1"));
        assert!(place("EYYb") < place("EYY3") && place("EXX3") < place("EBX3"));
        assert!(place("EXX1") < place("EBX1"));
    }

    #[test]
    fn a_set_is_no_single_term() {
        let error = preference(&["observable35".to_owned()]).unwrap_err();
        assert!(error.what.contains("observable35"));
    }
}
