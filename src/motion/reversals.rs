//! When and where every slide turned round.

use super::trajectory::Trajectory;
use super::turning::Turn;
use crate::machine::Axis;
use crate::model::Reversal;

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
        Self { of: Axis::ALL.map(|axis| trajectory.turns(axis.index())) }
    }

    /// The whiles between corners at which slides turn and when they do so where this share of them is rounded out, s.
    pub fn rounded_s(&self, share: f64) -> impl Iterator<Item = [f64; 2]> {
        let corners = self.of.iter().flatten().filter_map(|turn| Some((turn.at_s, turn.corner?)));
        corners.map(move |(at_s, corner)| {
            let turns_s = at_s + corner.later_s(share);
            [at_s.min(turns_s), at_s.max(turns_s)]
        })
    }

    /// The last reversal of every slide at a time and place of the program, of whose corners a share is rounded out.
    pub fn last(
        &self,
        program_s: f64,
        position_mm: &nalgebra::Vector3<f64>,
        rounded: f64,
    ) -> [Option<Reversal>; 3] {
        let turns_s =
            |turn: &Turn| turn.at_s + turn.corner.map_or(0.0, |corner| corner.later_s(rounded));
        [0, 1, 2].map(|slide| {
            let turns = &self.of[slide];
            let turn = turns[..turns.partition_point(|turn| turns_s(turn) <= program_s)].last()?;
            let ago_mm = (position_mm[slide] - turn.at_mm).abs();
            Some(Reversal { ago_s: program_s - turns_s(turn), ago_mm })
        })
    }
}
