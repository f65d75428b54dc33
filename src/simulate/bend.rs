//! What bends the chain: from the state of the machine to the length that the bar spans.

use nalgebra::Vector3;

use super::clock::{Clock, ClockMoment};
use super::control::Following;
use super::hidden;
use super::scenario::{Coincidence, Scenario};
use crate::error::Result;
use crate::machine::{Axis, ChainErrors, Machine, Mounting, Pose};
use crate::model::{Ball, Effect, Motion, Reversal, Term};
use crate::motion::{Reversals, State, Trajectory};

/// Short against everything a program does, long against the rounding of its times, s.
const JUST_BEFORE_S: f64 = 1e-9;

/// Where the slides stand at a moment, and which way they went last.
fn state_at(trajectory: &Trajectory, moment: &ClockMoment) -> State {
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

/// A program on its way through a run.
pub(super) struct Drive {
    pub(super) trajectory: Trajectory,
    pub(super) clock: Clock,
    reversals: Reversals,
    following: Following,
}

impl Drive {
    pub(super) fn new(trajectory: Trajectory, clock: Clock, following_s: &Vector3<f64>) -> Self {
        let reversals = Reversals::of(&trajectory);
        let following = Following::new(following_s, &trajectory, &clock);
        Self { trajectory, clock, reversals, following }
    }
}

/// How the machine is at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Condition {
    /// Machine coordinates where X, Y, Z are but for `lag_mm`, mm.
    pub(super) position_mm: Vector3<f64>,
    /// Sense of their last motion.
    pub(super) sense: Vector3<f64>,
    /// Their velocity, mm/s.
    pub(super) velocity_mm_s: Vector3<f64>,
    /// Time since the program began, the operator's pauses included, s.
    pub(super) elapsed_s: f64,
    /// Time in the program, without them, s.
    pub(super) program_s: f64,
    /// Their last reversals.
    pub(super) reversals: [Option<Reversal>; 3],
    /// How far they are from there because of a hidden delay, mm: below 0 on the way up.
    pub(super) lag_mm: Vector3<f64>,
}

impl Condition {
    fn motion(&self) -> Motion {
        Motion {
            velocity_mm_s: self.velocity_mm_s,
            elapsed_s: self.elapsed_s,
            program_s: self.program_s,
            reversals: self.reversals,
            ..Motion::REST
        }
    }

    /// Before anything moved.
    pub(super) fn rest(position_mm: Vector3<f64>) -> Self {
        Self {
            position_mm,
            sense: Vector3::zeros(),
            velocity_mm_s: Vector3::zeros(),
            elapsed_s: 0.0,
            program_s: 0.0,
            reversals: [None; 3],
            lag_mm: Vector3::zeros(),
        }
    }
}

/// The machine and the balls of one run as they really are.
pub(super) struct Bent {
    /// What was asked for, with what the hidden effects and the operator make of it.
    pub(super) scenario: Scenario,
    /// The machine, with its real pivots.
    pub(super) machine: Machine,
    mounting: Mounting,
    /// How far the machine coordinates are from those the test file believes, mm.
    offset_mm: Vector3<f64>,
    delay_s: Vector3<f64>,
    hidden: Vec<Effect>,
}

impl Bent {
    /// Bends a machine and a mounting.
    ///
    /// # Errors
    /// When an effect cannot be.
    pub(super) fn new(machine: &Machine, mounting: &Mounting, asked: &Scenario) -> Result<Self> {
        hidden::check_all(&asked.hidden)?;
        let effects = hidden::of_run(asked);
        let mut bent = Self {
            scenario: hidden::settings_of(asked),
            machine: hidden::machine_of(machine, &effects),
            mounting: hidden::mounting_of(mounting, &effects),
            offset_mm: hidden::offset_mm(&effects, Ball::Workpiece),
            delay_s: hidden::delay_s(&effects),
            hidden: effects,
        };
        if asked.coincidence == Coincidence::Touched {
            bent.touch();
        }
        Ok(bent)
    }

    /// Puts the tool ball where the operator has put it: where he brought the balls together, the errors
    /// that the slides have there, cold and at rest, are part of the set-up.
    fn touch(&mut self) {
        let position_mm = self.mounting.coincidence_mm;
        let errors = ChainErrors {
            slides: self.errors(&Condition::rest(position_mm)).slides,
            ..ChainErrors::zero()
        };
        self.scenario.tool_ball_mm -=
            self.machine.ball_vector_mm(&self.mounting, &position_mm, &errors);
    }

    /// How the machine is at a log time, with the moment and the state as the test file has them.
    pub(super) fn at(&self, drive: &Drive, log_s: f64) -> (ClockMoment, State, Condition) {
        let machine_s = drive.clock.machine_s(log_s);
        let moment = drive.clock.moment(machine_s);
        let state = state_at(&drive.trajectory, &moment);
        // In a pause a slide that will turn round has not done so yet.
        let turned_by_s = moment.program_s - if moment.in_pause { JUST_BEFORE_S } else { 0.0 };
        let driven = drive.following.followed(machine_s, &state);
        let late_s = drive.following.late_s();
        let turned =
            |k: usize| drive.reversals.last(turned_by_s - late_s[k], &driven.position_mm, 0.0)[k];
        let condition = Condition {
            position_mm: driven.position_mm + self.offset_mm,
            sense: driven.sense,
            velocity_mm_s: driven.velocity_mm_s,
            elapsed_s: machine_s.max(0.0),
            program_s: moment.program_s,
            reversals: [0, 1, 2].map(turned),
            lag_mm: self.lag_mm(drive, machine_s, &moment, &driven),
        };
        (moment, state, condition)
    }

    /// How far every slide is from where it is driven, mm, because it is where it would have been some time ago on the machine's
    /// clock: in a pause it arrives late, and then stands where the others do.
    fn lag_mm(
        &self,
        drive: &Drive,
        machine_s: f64,
        moment: &ClockMoment,
        driven: &State,
    ) -> Vector3<f64> {
        let stands = moment.in_pause || moment.program_s < 0.0;
        Vector3::from(Axis::ALL.map(|slide| {
            let delay_s = self.delay_s[slide.index()];
            // A slide that leads does not know when the operator will press start.
            if delay_s == 0.0 || (delay_s < 0.0 && stands) {
                return 0.0;
            }
            let then_s = machine_s - delay_s;
            let commanded = state_at(&drive.trajectory, &drive.clock.moment(then_s));
            let was = drive.following.followed(then_s, &commanded);
            was.position_mm[slide.index()] - driven.position_mm[slide.index()]
        }))
    }

    /// The errors of the chain: each slide's error functions (paper, Eq. 3), the set-up errors of the
    /// two balls, and what the hidden effects add to both.
    fn errors(&self, now: &Condition) -> ChainErrors {
        let pose = Pose { position_mm: now.position_mm, sense: now.sense };
        let mut errors = ChainErrors {
            slides: Axis::ALL.map(|slide| self.scenario.errors.slide_error(slide, &pose)),
            workpiece_ball_mm: self.scenario.workpiece_ball_mm,
            tool_ball_mm: self.scenario.tool_ball_mm,
        };
        if let Some(place) = &self.scenario.place {
            for (slide, of_slide) in Axis::ALL.into_iter().zip(&mut errors.slides) {
                let error = place.slide_error(slide, &self.machine, &pose);
                of_slide.translation_mm += error.translation_mm;
                of_slide.rotation_rad += error.rotation_rad;
            }
        }
        hidden::add_to_slides(&self.hidden, now, &mut errors.slides);
        hidden::add_to_balls(&self.hidden, now, &mut errors);
        let motion = now.motion();
        for (curve, values) in &self.scenario.curves {
            curve.bend(values, &pose, &motion, 0, &mut errors);
        }
        errors
    }

    /// By how much the tool ball is displaced against the point of the workpiece that it touches, mm.
    pub(super) fn displaced_mm(&self, now: &Condition) -> Vector3<f64> {
        let touching = Mounting { coincidence_mm: now.position_mm, ..self.mounting };
        let vector = |errors| self.machine.ball_vector_mm(&touching, &now.position_mm, errors);
        vector(&self.errors(now)) - vector(&ChainErrors::zero())
    }

    /// Length that the bar reads through the exact chain, without noise, steps and range, mm.
    pub(super) fn length_mm(&self, now: &Condition) -> f64 {
        let place_mm = now.position_mm + now.lag_mm + hidden::displacement_mm(&self.hidden, now);
        let ball_mm = self.machine.ball_vector_mm(&self.mounting, &place_mm, &self.errors(now));
        let pose = Pose { position_mm: now.position_mm, sense: now.sense };
        let curves = self.scenario.curves.iter().map(|(curve, values)| {
            curve.lengthen(values, &pose, &now.motion(), 0, &ball_mm.normalize())
        });
        let curves_mm: f64 = curves.sum();
        ball_mm.norm() + hidden::reading_mm(&self.hidden, now, &ball_mm) + curves_mm
    }
}
