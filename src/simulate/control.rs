//! How the control drives otherwise than the machine file says.

use std::sync::Arc;

use nalgebra::Vector3;

use super::clock::Clock;
use super::random::{Purpose, Stream};
use crate::error::{Error, Result};
use crate::log::Recording;
use crate::machine::Machine;
use crate::motion::{BlockKind, State, Trajectory};
use crate::nc::{Action, Program, Step};

/// How a real control differs from the planned one.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// Real accelerations, of what the machine file says, as a share of 1.
    pub acceleration: f64,
    /// In how much time the acceleration builds up, s; `None` for what the machine file says.
    pub acceleration_change_s: Option<f64>,
    /// Between what is drawn, for each standstill but an operator's, how much longer it takes than programmed, s: the
    /// control waits until the slides are in position.
    pub standing_s: [f64; 2],
    /// Time constants of first-order following of X, Y, Z, s.
    pub following_s: Vector3<f64>,
    /// How a real control drove the program: in place of the planned times, and of the operator's pauses.
    pub recorded: Option<Arc<Recording>>,
}

impl Control {
    /// As planned.
    pub const AS_PLANNED: Self = Self {
        acceleration: 1.0,
        acceleration_change_s: None,
        standing_s: [0.0; 2],
        following_s: Vector3::new(0.0, 0.0, 0.0),
        recorded: None,
    };

    /// The trajectory of a program as this control drives it.
    pub(super) fn trajectory(
        &self,
        program: &Program,
        machine: &Machine,
        feed_override: f64,
        seed: u64,
    ) -> Result<Trajectory> {
        if let Some(recorded) = &self.recorded {
            self.check_recorded(feed_override)?;
            return Trajectory::recorded(program, machine, recorded);
        }
        let machine =
            machine.clone().with_accelerations(self.acceleration, self.acceleration_change_s);
        let planned = Trajectory::new(program, &machine, feed_override);
        if self.standing_s[1] <= 0.0 {
            return Ok(planned);
        }
        let steps = self.steps(program, &planned, seed);
        Ok(Trajectory::new(&Program { steps, ..program.clone() }, &machine, feed_override))
    }

    /// Nothing but the slides may differ from a motion that was recorded.
    fn check_recorded(&self, feed_override: f64) -> Result<()> {
        let own = Self {
            following_s: self.following_s,
            recorded: self.recorded.clone(),
            ..Self::AS_PLANNED
        };
        if *self == own && (feed_override - 1.0).abs() < f64::EPSILON {
            return Ok(());
        }
        Err(Error::input("a motion that was recorded has its own feed, accelerations and standstills")
            .hint("leave `feed_override_percent` and, of `[motion]`, all but `following_ms` out of the scenario, and hide no `feed-override`"))
    }

    /// The steps with every standstill as long as it takes.
    fn steps(&self, program: &Program, planned: &Trajectory, seed: u64) -> Vec<Step> {
        let mut stream = Stream::new(seed, Purpose::Standstills);
        // What comes before the first move has no block, nor has a program's end.
        let (before, steps) = program.steps.split_at(program.first_move());
        let moving = steps.iter().filter(|step| step.action != Action::End);
        let blocks = planned.blocks();
        let mut longer = before.to_vec();
        for (index, (step, block)) in moving.zip(blocks).enumerate() {
            let stands_next = blocks
                .get(index + 1)
                .is_none_or(|next| matches!(next.kind, BlockKind::Dwell | BlockKind::Stop));
            let mut step = *step;
            let mut after_s = 0.0;
            match &mut step.action {
                Action::Dwell { seconds } => *seconds += stream.between(self.standing_s),
                Action::Move(_) if block.ends_at_rest() && !stands_next => {
                    after_s = stream.between(self.standing_s);
                }
                _ => {}
            }
            longer.push(step);
            if after_s > 0.0 {
                longer.push(Step { action: Action::Dwell { seconds: after_s }, ..step });
            }
        }
        longer
    }
}

/// How finely following is worked out, s: in so short a time, also while it accelerates, a slide goes straight on to
/// within nanometres. Behind a corner of 20 mm/s it is off by some 0.1 um for as long as its time constant.
const STEP_S: f64 = 1e-3;

/// Slides that follow their commands with a first-order lag: `following · d y / d t = command - y`.
#[derive(Debug)]
pub(super) struct Following {
    /// How far each slide is from its command every [`STEP_S`] on the machine's clock, mm; empty where none lags.
    lag_mm: Vec<Vector3<f64>>,
    /// Time constants, s.
    following_s: Vector3<f64>,
}

/// A slide that is nearer to its command than this has arrived, mm.
const ARRIVED_MM: f64 = 1e-9;

impl Following {
    pub(super) fn new(following_s: &Vector3<f64>, trajectory: &Trajectory, clock: &Clock) -> Self {
        if following_s.iter().all(|s| *s == 0.0) {
            return Self { lag_mm: Vec::new(), following_s: Vector3::zeros() };
        }
        let commanded =
            |step: usize| trajectory.at(clock.moment(step as f64 * STEP_S).program_s).position_mm;
        let steps = (clock.end_s() / STEP_S) as usize + 1;
        let mut lag_mm = vec![Vector3::zeros()];
        let mut before_mm = commanded(0);
        for step in 1..=steps {
            let now_mm = commanded(step);
            let last_mm = lag_mm[step - 1];
            // Exact for a command that is straight in between.
            lag_mm.push(Vector3::from_fn(|k, _| {
                if following_s[k] <= 0.0 {
                    return 0.0;
                }
                let steady_mm = -following_s[k] * (now_mm[k] - before_mm[k]) / STEP_S;
                steady_mm + (last_mm[k] - steady_mm) * (-STEP_S / following_s[k]).exp()
            }));
            before_mm = now_mm;
        }
        Self { lag_mm, following_s: *following_s }
    }

    /// Where the slides are while they are commanded to a state, since the program began on the machine's clock: they turn
    /// round when they have met their command, not when it turns.
    pub(super) fn followed(&self, machine_s: f64, commanded: &State) -> State {
        let mut state = *commanded;
        let lag_mm = self.lag_mm(machine_s);
        for slide in 0..3 {
            if self.following_s[slide] > 0.0 && lag_mm[slide].abs() > ARRIVED_MM {
                state.position_mm[slide] += lag_mm[slide];
                state.velocity_mm_s[slide] = -lag_mm[slide] / self.following_s[slide];
                state.sense[slide] = -lag_mm[slide].signum();
            }
        }
        state
    }

    /// How late each slide turns round, s.
    pub(super) fn late_s(&self) -> &Vector3<f64> {
        &self.following_s
    }

    /// How far each slide is from its command at a time since the program began on the machine's clock, mm.
    fn lag_mm(&self, machine_s: f64) -> Vector3<f64> {
        let place = machine_s.max(0.0) / STEP_S;
        let at = |step: usize| self.lag_mm.get(step).or(self.lag_mm.last()).copied();
        let (Some(before), Some(after)) = (at(place as usize), at(place as usize + 1)) else {
            return Vector3::zeros();
        };
        before.lerp(&after, place.fract())
    }
}
