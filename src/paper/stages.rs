//! How the paper prunes its columns: what it removes, in which order, and the figures that it prints.

/// One of the paper's lists of removals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pruning {
    /// Section 4: from 96 columns to the 56 that the volume needs.
    Volume,
    /// Table 3: from those to the 40 of 3D5, 3D6 and 3D10.
    Meridians,
    /// Section 5: from those to the 32 of the three planes.
    Planes,
}

/// A place where the paper stops to count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Number of columns that are left.
    pub columns: usize,
    /// What was removed since the stage before, names between blanks.
    pub removed: &'static str,
    /// Rank in the paper.
    pub rank: usize,
    /// Condition number in the paper, columns as they are; `None` where it prints none.
    pub raw_condition: Option<f64>,
    /// The same of columns that the paper calls normalized.
    pub condition: Option<f64>,
}

impl Stage {
    /// The names that were removed since the stage before.
    pub fn removed(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.removed.split_whitespace()
    }
}

const fn stage(
    columns: usize,
    removed: &'static str,
    rank: usize,
    raw_condition: Option<f64>,
    condition: Option<f64>,
) -> Stage {
    Stage { columns, removed, rank, raw_condition, condition }
}

const VOLUME: &[Stage] = &[
    stage(96, "", 59, Some(3.8e35), None),
    stage(93, "EXw EYw EZw", 59, Some(3.8e34), None),
    stage(
        77,
        "EXX0 EYX0 EZX0 EAX0 EBX0 ECX0 EXY0 EYY0 EZY0 EAY0 EBY0 ECY0 EXZ0 EYZ0 EZZ0 EBZ0",
        59,
        None,
        None,
    ),
    stage(
        65,
        "EAY1 EAY2 EAY3 EAYb EBY1 EBY2 EBY3 EBYb ECY1 ECY2 ECY3 ECYb",
        59,
        Some(2.9e26),
        None,
    ),
    stage(61, "EBZ1 EBZ2 EBZ3 EBZb", 59, Some(2.4e24), None),
    stage(60, "EXY1", 59, Some(2.5e24), None),
    stage(59, "EZY1", 59, Some(2.3e11), Some(387.0)),
    stage(56, "EYX1 EZX1 EYZ1", 56, None, Some(108.41)),
];

const MERIDIANS: &[Stage] = &[
    stage(56, "", 40, Some(3.3e26), None),
    stage(48, "EAX1 EAX2 EAX3 EAXb EBX1 EBX2 ECX1 ECX2", 40, Some(3.3e25), None),
    stage(44, "EAZ1 EAZ2 EAZ3 EAZb", 40, Some(5.4e23), None),
    stage(43, "EXX2", 40, Some(1.2e21), None),
    stage(42, "EYX3", 40, Some(1.9e15), None),
    stage(41, "EYY2", 40, Some(9.7e14), None),
    stage(40, "EZZ2", 40, Some(1.3e11), Some(1948.0)),
];

const PLANES: &[Stage] = &[
    stage(40, "", 33, None, None),
    stage(36, "ECZ1 ECZ2 ECZ3 ECZb", 33, Some(3.2e26), None),
    stage(35, "EZY3", 33, Some(2.1e26), None),
    stage(34, "EZX3", 33, Some(2.8e25), None),
    stage(32, "ECX3 ECXb", 32, Some(1.49e11), Some(2801.0)),
];

/// The stages of a list, in the paper's order; the first has removed nothing yet.
///
/// Conditions of [`Pruning::Meridians`] are those of 3D6; 3D5 and 3D10 end at 1950 and 1948.
pub fn stages(of: Pruning) -> &'static [Stage] {
    match of {
        Pruning::Volume => VOLUME,
        Pruning::Meridians => MERIDIANS,
        Pruning::Planes => PLANES,
    }
}

/// Everything that whole lists remove.
pub fn removed_by(lists: &[Pruning]) -> Vec<&'static str> {
    lists.iter().flat_map(|&list| stages(list)).flat_map(Stage::removed).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::identify::preference;
    use crate::model::{Coefficient, SetUp};

    #[test]
    fn every_stage_removes_what_its_number_of_columns_says() {
        for list in [Pruning::Volume, Pruning::Meridians, Pruning::Planes] {
            for pair in stages(list).windows(2) {
                assert_eq!(pair[0].columns - pair[1].removed().count(), pair[1].columns);
            }
            for name in removed_by(&[list]) {
                assert!(Coefficient::parse(name).is_some() || SetUp::parse(name).is_some());
            }
        }
    }

    /// The order of preference takes terms back as the paper gave them up, the last first.
    #[test]
    fn what_the_paper_keeps_longest_is_preferred() {
        let lists = [Pruning::Volume, Pruning::Meridians];
        let given_up: Vec<&Stage> = lists.iter().flat_map(|&list| stages(list)).collect();
        let stage_of = |name: &String| {
            let gone = given_up.iter().position(|s| s.removed().any(|removed| removed == name));
            gone.unwrap_or(given_up.len())
        };
        let order: Vec<usize> = preference(&[]).unwrap().iter().map(stage_of).collect();
        assert!(order.is_sorted_by(|before, after| before >= after), "{order:?}");
    }
}
