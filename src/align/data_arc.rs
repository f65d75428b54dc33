//! Which part of a pass over a circle is the data arc, and which is overshoot.

use std::f64::consts::TAU;

use crate::motion::{Block, Trajectory};
use crate::plan::OVERSHOOT;

/// Whether a comment says that what follows is driven beyond the data arc.
pub(super) fn is_overshoot(label: &str) -> bool {
    label.to_ascii_uppercase().contains(OVERSHOOT)
}

/// When the data arc of these blocks begins and ends, s of program time: as the comments of the program have it; of a
/// pass of more than a turn without such comments the turn in its middle; otherwise all of it.
pub(super) fn of(trajectory: &Trajectory, blocks: &[Block], sweep_rad: f64) -> [f64; 2] {
    let end_s = |block: &Block| block.start_s + block.duration_s;
    let ends_s = |of: &[Block]| {
        let (first, last) = (of.first(), of.last());
        [first.map_or(0.0, |block| block.start_s), last.map_or(0.0, end_s)]
    };
    let beyond = |block: &Block| is_overshoot(trajectory.label(block));
    let whole_s = ends_s(blocks);
    let first = blocks.iter().position(|block| !beyond(block));
    let last = blocks.iter().rposition(|block| !beyond(block));
    if let (Some(first), Some(last)) = (first, last)
        && blocks.iter().any(beyond)
    {
        return ends_s(&blocks[first..=last]);
    }
    if sweep_rad < TAU + MORE_THAN_A_TURN_RAD {
        return whole_s;
    }
    // The way along a circle is as long as its angle; looked at as often as every degree or so.
    let looks = (sweep_rad / TAU * LOOKS).ceil() as usize;
    let at_s = |look: usize| whole_s[0] + (whole_s[1] - whole_s[0]) * look as f64 / looks as f64;
    let place_mm = |look: usize| trajectory.at(at_s(look)).position_mm;
    let ways_mm: Vec<f64> =
        (0..looks).map(|look| (place_mm(look + 1) - place_mm(look)).norm()).collect();
    let share = 0.5 * (1.0 - TAU / sweep_rad);
    let overshoot_mm = share * ways_mm.iter().sum::<f64>();
    let step_s = (whole_s[1] - whole_s[0]) / looks as f64;
    let begun = crossed(ways_mm.iter(), overshoot_mm);
    let left = crossed(ways_mm.iter().rev(), overshoot_mm);
    [whole_s[0] + begun * step_s, whole_s[1] - left * step_s]
}

/// After how many ways, the last one in part, so much is covered.
fn crossed<'a>(ways_mm: impl Iterator<Item = &'a f64>, all_mm: f64) -> f64 {
    let mut before_mm = 0.0;
    let mut whole = 0.0;
    for way_mm in ways_mm {
        if before_mm + way_mm >= all_mm {
            return whole + (all_mm - before_mm) / way_mm.max(1e-12);
        }
        before_mm += way_mm;
        whole += 1.0;
    }
    whole
}

/// Looks a turn.
const LOOKS: f64 = 360.0;
/// A pass that is longer than a turn by less has an overlap at its end and no overshoot, rad: 6 degrees.
const MORE_THAN_A_TURN_RAD: f64 = 0.1;
