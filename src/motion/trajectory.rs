//! A program with its times.

use nalgebra::Vector3;

use super::Profile;
use crate::machine::{Axis, Machine};
use crate::nc::{Action, Move, Program};

/// What a block of the trajectory is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockKind {
    /// Positioning.
    Rapid,
    /// Motion at feed.
    Feed,
    /// Standstill of known length.
    Dwell,
    /// Standstill until the operator presses start; length zero here.
    Stop,
}

/// A block with its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// What it is.
    pub kind: BlockKind,
    /// When it begins, s of program time, operator's pauses counted as zero.
    pub start_s: f64,
    /// How long it takes, s.
    pub duration_s: f64,
    /// Line of the program.
    pub line: usize,
    /// Index of its label in the program.
    pub label: usize,
    /// Time spent at feed before this block, s: what a feed override stretches.
    pub feed_before_s: f64,
    /// Where it begins, machine coordinates, mm.
    pub start_mm: Vector3<f64>,
    motion: Option<(Move, Profile)>,
    sense: Vector3<f64>,
}

/// Where the machine is at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Machine coordinates, mm.
    pub position_mm: Vector3<f64>,
    /// Velocity, mm/s.
    pub velocity_mm_s: Vector3<f64>,
    /// Sense of the last motion of each slide.
    pub sense: Vector3<f64>,
    /// Index of the block.
    pub block: usize,
}

/// Time by kind, s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Duration {
    /// Positioning.
    pub rapid_s: f64,
    /// Motion at feed.
    pub feed_s: f64,
    /// Dwells.
    pub dwell_s: f64,
    /// Number of operator's pauses, whose length nobody knows beforehand.
    pub stops: usize,
}

impl Duration {
    /// All that is known, s.
    pub fn known_s(&self) -> f64 {
        self.rapid_s + self.feed_s + self.dwell_s
    }
}

/// A program as the machine drives it, from its first fully known position.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    blocks: Vec<Block>,
    labels: Vec<String>,
    end_s: f64,
}

impl Trajectory {
    /// Times a program on a machine, its feeds multiplied by `feed_override`.
    pub fn new(program: &Program, machine: &Machine, feed_override: f64) -> Self {
        let mut builder = Builder {
            machine,
            feed_override,
            blocks: Vec::with_capacity(program.steps.len()),
            now_s: 0.0,
            feed_s: 0.0,
            sense: Vector3::zeros(),
            at_mm: Vector3::zeros(),
        };
        let mut stretch: Vec<(usize, usize, Move)> = Vec::new();
        for step in &program.steps {
            match step.action {
                Action::Move(motion) => stretch.push((step.line, step.label, motion)),
                Action::Dwell { seconds } => {
                    builder.drive(&mut stretch);
                    builder.stand(BlockKind::Dwell, seconds, step.line, step.label);
                }
                Action::Stop => {
                    builder.drive(&mut stretch);
                    builder.stand(BlockKind::Stop, 0.0, step.line, step.label);
                }
                Action::End => {}
            }
        }
        builder.drive(&mut stretch);
        Self { end_s: builder.now_s, blocks: builder.blocks, labels: program.labels.clone() }
    }

    /// The blocks in order.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// The comment that a block stands under.
    pub fn label(&self, block: &Block) -> &str {
        self.labels.get(block.label).map_or("", String::as_str)
    }

    /// When the program ends, s, operator's pauses counted as zero.
    pub fn end_s(&self) -> f64 {
        self.end_s
    }

    /// Index of the block that runs at a time.
    pub fn block_at(&self, time_s: f64) -> usize {
        self.blocks.partition_point(|block| block.start_s <= time_s).saturating_sub(1)
    }

    /// Where the machine is at a time; before the beginning and after the end it stands still.
    pub fn at(&self, time_s: f64) -> State {
        let index = self.block_at(time_s);
        match self.blocks.get(index) {
            Some(block) => block.at(time_s, index),
            None => State {
                position_mm: Vector3::zeros(),
                velocity_mm_s: Vector3::zeros(),
                sense: Vector3::zeros(),
                block: 0,
            },
        }
    }

    /// Time spent at feed until a time, s: `d t / d ln(override)` of everything that happens then.
    pub fn feed_elapsed_s(&self, time_s: f64) -> f64 {
        self.blocks.get(self.block_at(time_s)).map_or(0.0, |block| {
            let inside = (time_s - block.start_s).clamp(0.0, block.duration_s);
            block.feed_before_s + if block.kind == BlockKind::Feed { inside } else { 0.0 }
        })
    }

    /// Moments at which a slide turns round, in order, s: the first motion after a standstill in the
    /// other sense, or the middle of an arc where the tangent leaves the slide's direction.
    pub fn reversals_s(&self) -> Vec<f64> {
        let mut times: Vec<f64> = Vec::new();
        for block in &self.blocks {
            let Some((motion, profile)) = &block.motion else { continue };
            let begins = turned(block.sense, &motion.at(0.0).1);
            if begins != block.sense {
                times.push(block.start_s);
            }
            for share in motion.extreme_shares() {
                times.push(block.start_s + profile.time_of_s(share * motion.length_mm()));
            }
        }
        times.sort_by(f64::total_cmp);
        times
    }

    /// Time by kind.
    pub fn duration(&self) -> Duration {
        let mut total = Duration::default();
        for block in &self.blocks {
            match block.kind {
                BlockKind::Rapid => total.rapid_s += block.duration_s,
                BlockKind::Feed => total.feed_s += block.duration_s,
                BlockKind::Dwell => total.dwell_s += block.duration_s,
                BlockKind::Stop => total.stops += 1,
            }
        }
        total
    }
}

impl Block {
    /// The move, if the block moves.
    pub fn motion(&self) -> Option<&Move> {
        self.motion.as_ref().map(|(motion, _)| motion)
    }

    /// Whether the machine stands still at its end.
    pub fn ends_at_rest(&self) -> bool {
        self.motion.as_ref().is_none_or(|(_, profile)| profile.at(f64::INFINITY).1 < 1e-9)
    }

    fn at(&self, time_s: f64, index: usize) -> State {
        let still = State {
            position_mm: self.start_mm,
            velocity_mm_s: Vector3::zeros(),
            sense: self.sense,
            block: index,
        };
        let Some((motion, profile)) = &self.motion else { return still };
        let (distance_mm, speed_mm_s) = profile.at(time_s - self.start_s);
        let (position_mm, tangent) = motion.at(distance_mm / motion.length_mm());
        State {
            position_mm,
            velocity_mm_s: tangent * speed_mm_s,
            sense: turned(self.sense, &tangent),
            block: index,
        }
    }
}

/// Senses after moving along a direction: slides that stand still keep theirs.
fn turned(sense: Vector3<f64>, along: &Vector3<f64>) -> Vector3<f64> {
    // Of an arc's tangent, what is left of a component by rounding is not motion.
    sense.zip_map(along, |before, v| if v.abs() > 1e-12 { v.signum() } else { before })
}

struct Builder<'a> {
    machine: &'a Machine,
    feed_override: f64,
    blocks: Vec<Block>,
    now_s: f64,
    feed_s: f64,
    sense: Vector3<f64>,
    at_mm: Vector3<f64>,
}

impl Builder<'_> {
    fn stand(&mut self, kind: BlockKind, duration_s: f64, line: usize, label: usize) {
        self.blocks.push(Block {
            kind,
            start_s: self.now_s,
            duration_s,
            line,
            label,
            feed_before_s: self.feed_s,
            start_mm: self.at_mm,
            motion: None,
            sense: self.sense,
        });
        self.now_s += duration_s;
    }

    /// Cruise speed (mm/s) and acceleration (mm/s²) along a move.
    fn limits(&self, motion: &Move) -> (f64, f64) {
        if !motion.rapid {
            let controller = self.machine.controller();
            return (motion.feed_mm_s * self.feed_override, controller.path_acceleration_mm_s2);
        }
        let along = motion.at(0.0).1;
        let slowest = |limit: &dyn Fn(Axis) -> f64| {
            Axis::ALL
                .into_iter()
                .filter(|axis| along[axis.index()].abs() > 1e-12)
                .map(|axis| limit(axis) / along[axis.index()].abs())
                .fold(f64::INFINITY, f64::min)
        };
        (
            slowest(&|axis| self.machine.slide(axis).rapid_mm_s),
            slowest(&|axis| self.machine.slide(axis).acceleration_mm_s2),
        )
    }

    /// Whether the machine stops between two moves.
    fn stops_between(&self, before: &Move, after: &Move) -> bool {
        let cosine = before.at(1.0).1.dot(&after.at(0.0).1).clamp(-1.0, 1.0);
        before.rapid
            || after.rapid
            || before.exact_stop
            || cosine.acos() > self.machine.controller().corner_stop_rad
    }

    /// Times a stretch of moves that begins and ends at rest.
    fn drive(&mut self, stretch: &mut Vec<(usize, usize, Move)>) {
        let count = stretch.len();
        let lengths: Vec<f64> = stretch.iter().map(|(_, _, motion)| motion.length_mm()).collect();
        let limits: Vec<(f64, f64)> =
            stretch.iter().map(|(_, _, motion)| self.limits(motion)).collect();
        // Squared speed at the beginning of each block, and at the very end.
        let mut squared = vec![0.0_f64; count + 1];
        for k in 1..count {
            if !self.stops_between(&stretch[k - 1].2, &stretch[k].2) {
                squared[k] = limits[k - 1].0.min(limits[k].0).powi(2);
            }
        }
        for k in 0..count {
            squared[k + 1] = squared[k + 1].min(squared[k] + 2.0 * limits[k].1 * lengths[k]);
        }
        for k in (0..count).rev() {
            squared[k] = squared[k].min(squared[k + 1] + 2.0 * limits[k].1 * lengths[k]);
        }
        for (k, (line, label, motion)) in stretch.drain(..).enumerate() {
            let (cruise, acceleration) = limits[k];
            let profile = Profile::fastest(
                lengths[k],
                squared[k].sqrt(),
                squared[k + 1].sqrt(),
                cruise,
                acceleration,
            );
            let duration_s = profile.duration_s();
            self.blocks.push(Block {
                kind: if motion.rapid { BlockKind::Rapid } else { BlockKind::Feed },
                start_s: self.now_s,
                duration_s,
                line,
                label,
                feed_before_s: self.feed_s,
                start_mm: motion.start_mm,
                motion: Some((motion, profile)),
                sense: self.sense,
            });
            self.sense = turned(self.sense, &motion.at(1.0).1);
            // An arc may turn a slide round on its way without ending on it: the tangent at the end decides.
            self.at_mm = motion.end_mm;
            self.now_s += duration_s;
            if !motion.rapid {
                self.feed_s += duration_s;
            }
        }
    }
}
