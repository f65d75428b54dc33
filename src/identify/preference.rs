//! Which terms to prefer where not all can be told apart.
//!
//! The default order is the paper's: what it removes last is kept first. Within one of its stages, and
//! for everything that it does not decide, geometric sense does: squareness before the slope of a
//! straightness, displacement before rotation, low degree before high, hysteresis after the linear part.

use super::stages::{Pruning, Stage, removed_by, stages};
use crate::error::{Error, Result};
use crate::model::{Ball, Coefficient, Power, SetUp};

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
        let planes = removed_by(&[Pruning::Planes]).contains(&name.as_str());
        (by_user, stages_to_removal(name), by_geometry(name), planes)
    });
    Ok(names)
}

/// 0 for what the paper keeps, more the earlier it removes a term.
///
/// Its list for the three planes does not count here: it gives up straightness for the sake of rotations that
/// the meridians then show to be the same thing.
fn stages_to_removal(name: &str) -> usize {
    // From the last list to the first and in each from its end: the order in which one would add.
    let lists = [Pruning::Meridians, Pruning::Volume];
    let backward = lists.iter().flat_map(|&list| stages(list).iter().rev());
    let mut stages = backward.enumerate();
    let of_name = |stage: &Stage| stage.removed().any(|removed| removed == name);
    stages.find(|(_, stage)| of_name(stage)).map_or(0, |(index, _)| index + 1)
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
