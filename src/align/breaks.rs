//! Where one leg of a program ends and the next begins: the machine comes to rest, and moves on.

use std::ops::Range;

use crate::motion::{BlockKind, Trajectory};
use crate::nc::Path;

/// Where one leg ends and the next begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Break {
    /// Program time, s: of an operator's pause when it begins, else when the machine moves on.
    pub program_s: f64,
    /// Since when the machine stands there, s of program time.
    pub since_s: f64,
    /// Whether the machine stands there until the operator presses start.
    pub operator: bool,
}

/// The middle of each leg, s.
pub(super) fn middles_s(breaks: &[Break], trajectory: &Trajectory) -> Vec<f64> {
    let ends_s = breaks.iter().map(|at| at.program_s).chain([trajectory.end_s()]);
    let mut begin_s = 0.0;
    let middle_s = |end_s: f64| 0.5 * (std::mem::replace(&mut begin_s, end_s) + end_s);
    ends_s.map(middle_s).collect()
}

/// How long a straight block of feed of each leg takes, s, the median of them: a chord, where an arc is driven in chords; 0 of a leg
/// without one, and of a leg that is driven in arcs for the most part.
pub(super) fn chords_s(breaks: &[Break], trajectory: &Trajectory) -> Vec<f64> {
    let mut of_leg = vec![(Vec::new(), 0.0); breaks.len() + 1];
    for block in trajectory.blocks().iter().filter(|block| block.kind == BlockKind::Feed) {
        let leg = breaks.partition_point(|at| at.program_s <= block.start_s);
        let (lines_s, arcs_s) = &mut of_leg[leg];
        match block.motion().map(|motion| &motion.path) {
            Some(Path::Arc { .. }) => *arcs_s += block.duration_s,
            _ => lines_s.push(block.duration_s),
        }
    }
    let median_s = |(mut lines_s, arcs_s): (Vec<f64>, f64)| {
        lines_s.sort_by(f64::total_cmp);
        let middle_s = lines_s.get(lines_s.len() / 2).copied();
        middle_s.filter(|_| lines_s.iter().sum::<f64>() > arcs_s).unwrap_or(0.0)
    };
    of_leg.into_iter().map(median_s).collect()
}

/// Every operator's pause, and of other standstills those while the bar reads or between: the machine comes to rest,
/// and moves on. How long those took is known of a motion that was recorded, and how long an operator's pause was in the log of
/// another run is not.
pub(super) fn breaks(trajectory: &Trajectory, engaged_s: &Range<f64>) -> Vec<Break> {
    let mut breaks: Vec<Break> = Vec::new();
    let recorded = trajectory.recorded_pauses_s().is_some();
    // Since when the machine stands, and whether the operator has it.
    let (mut stands_s, mut operator) = (None, false);
    for block in trajectory.blocks() {
        match block.kind {
            BlockKind::Stop => {
                let program_s = block.start_s;
                let since_s = stands_s.unwrap_or(program_s);
                breaks.push(Break { program_s, since_s, operator: true });
                (stands_s, operator) = (Some(since_s), true);
            }
            BlockKind::Dwell => stands_s = stands_s.or(Some(block.start_s)),
            BlockKind::Rapid | BlockKind::Feed => {
                let program_s = block.start_s;
                if let Some(since_s) =
                    stands_s.filter(|_| !operator && !recorded && engaged_s.contains(&program_s))
                {
                    breaks.push(Break { program_s, since_s, operator: false });
                }
                stands_s = block.ends_at_rest().then_some(block.start_s + block.duration_s);
                operator = false;
            }
        }
    }
    breaks
}
