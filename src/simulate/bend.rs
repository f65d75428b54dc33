//! What bends the chain: from the state of the machine to the errors of its chain.

use super::{ClockMoment, Scenario};
use crate::machine::{Axis, ChainErrors, Pose};
use crate::motion::{State, Trajectory};

/// Short against everything a program does, long against the rounding of its times, s.
const JUST_BEFORE_S: f64 = 1e-9;

/// Where the slides stand at a moment, and which way they went last.
pub(super) fn state_at(trajectory: &Trajectory, moment: &ClockMoment) -> State {
    let mut state = trajectory.at(moment.program_s);
    if moment.in_pause {
        // The pause has no length in the trajectory, which is already at the move after it; the slides
        // still lean the way they came.
        state.sense = trajectory.at(moment.program_s - JUST_BEFORE_S).sense;
        state.velocity_mm_s.fill(0.0);
    } else if moment.program_s < 0.0 {
        state.sense.fill(0.0);
        state.velocity_mm_s.fill(0.0);
    }
    state
}

/// The errors of the chain in a state of the machine: each slide's error functions (paper, Eq. 3) and
/// the set-up errors of the two balls.
pub(super) fn bend(scenario: &Scenario, state: &State) -> ChainErrors {
    let pose = Pose { position_mm: state.position_mm, sense: state.sense };
    ChainErrors {
        slides: Axis::ALL.map(|slide| scenario.errors.slide_error(slide, &pose)),
        workpiece_ball_mm: scenario.workpiece_ball_mm,
        tool_ball_mm: scenario.tool_ball_mm,
    }
}
