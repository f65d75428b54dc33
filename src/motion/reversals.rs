//! When and where every slide turned round.

use super::trajectory::Trajectory;
use crate::machine::Axis;
use crate::model::Reversal;

/// One slide turns round.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    /// When, s of program time.
    at_s: f64,
    /// Where, machine coordinate of the slide, mm.
    at_mm: f64,
}

/// All reversals of a trajectory, by slide.
///
/// A slide reverses when it begins to move against its last motion; its first motion is no reversal.
#[derive(Debug, Clone, PartialEq)]
pub struct Reversals {
    of: [Vec<Turn>; 3],
}

impl Reversals {
    /// The reversals of a trajectory.
    pub fn of(trajectory: &Trajectory) -> Self {
        let of = Axis::ALL.map(|axis| {
            let turns = trajectory.turns(axis.index());
            turns.into_iter().map(|(at_s, at_mm)| Turn { at_s, at_mm }).collect()
        });
        Self { of }
    }

    /// The last reversal of every slide at a time and place of the program.
    pub fn last(
        &self,
        program_s: f64,
        position_mm: &nalgebra::Vector3<f64>,
    ) -> [Option<Reversal>; 3] {
        [0, 1, 2].map(|slide| {
            let turns = &self.of[slide];
            let turn = turns[..turns.partition_point(|turn| turn.at_s <= program_s)].last()?;
            let ago_mm = (position_mm[slide] - turn.at_mm).abs();
            Some(Reversal { ago_s: program_s - turn.at_s, ago_mm })
        })
    }
}
