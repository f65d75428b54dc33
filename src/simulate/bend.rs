//! What bends the chain: from the state of the machine to the errors of its chain.

use nalgebra::Vector3;

use super::{ClockMoment, Coincidence, Scenario};
use crate::machine::{Axis, ChainErrors, Machine, Mounting, Pose};
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

/// The scenario with the tool ball where the operator has put it: where he brought the balls together, the
/// errors of the machine there are part of the set-up.
pub(super) fn set_up(scenario: &Scenario, machine: &Machine, mounting: &Mounting) -> Scenario {
    let mut scenario = scenario.clone();
    if scenario.coincidence == Coincidence::Touched {
        let position_mm = mounting.coincidence_mm;
        let pose = Pose { position_mm, sense: Vector3::zeros() };
        let slides = Axis::ALL.map(|slide| scenario.errors.slide_error(slide, &pose));
        let errors = ChainErrors { slides, ..ChainErrors::zero() };
        scenario.tool_ball_mm -= machine.ball_vector_mm(mounting, &position_mm, &errors);
    }
    scenario
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
