//! A program with its times.

use std::sync::Arc;

use nalgebra::Vector3;

use super::block::{Block, BlockKind, HAIR, State, turned};
use super::builder::Builder;
use super::driven::Driven;
use super::matched::{Matched, matched};
use super::slides::Slides;
use super::times::Times;
use super::turning::{Turn, TurningCorner};
use crate::error::Result;
use crate::log::Recording;
use crate::machine::Machine;
use crate::model::{Corner, Motion};
use crate::nc::{Action, Move, Path, Program};

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

/// A control that rounds a corner has done so within this before and after it, s.
const CORNER_S: f64 = 0.01;

/// A program as the machine drives it, from its first fully known position.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    blocks: Vec<Block>,
    labels: Vec<String>,
    /// Operator's pauses before the first move.
    stops_before: usize,
    end_s: f64,
    /// How it was driven, where that was recorded.
    driven: Option<Arc<Driven>>,
    /// How long each operator's pause was that was recorded, s.
    pauses_s: Vec<f64>,
}

impl Trajectory {
    /// Times a program on a machine, its feeds multiplied by `feed_override`.
    pub fn new(program: &Program, machine: &Machine, feed_override: f64) -> Self {
        let (before, steps) = program.steps.split_at(program.first_move());
        let mut builder = Builder::new(machine, feed_override, steps.len());
        let mut stretch: Vec<(usize, usize, Move)> = Vec::new();
        for step in steps {
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
        Self {
            end_s: builder.now_s,
            blocks: builder.blocks,
            stops_before: before.iter().filter(|step| step.action == Action::Stop).count(),
            labels: program.labels.clone(),
            driven: None,
            pauses_s: Vec::new(),
        }
    }

    /// The same program as a control has recorded that it drove it: the blocks have the times at which the recording comes to
    /// their ends, and the slides are where it has them. Operator's pauses have no length here either.
    ///
    /// # Errors
    /// When the recording is not one of this program.
    pub fn recorded(program: &Program, machine: &Machine, recording: &Recording) -> Result<Self> {
        let planned = Self::new(program, machine, 1.0);
        let slides = Slides::of(recording.rows());
        let Matched { blocks_s, cuts } =
            matched(&planned.blocks, recording, &slides, &program.file)?;
        let driven = Driven::new(recording.rows(), slides, &cuts);
        let mut feed_s = 0.0;
        let mut blocks = planned.blocks;
        for (block, recorded_s) in blocks.iter_mut().zip(blocks_s) {
            let [start_s, end_s] = recorded_s.map(|at_s| cuts.program_s(at_s));
            // Rounding may make nothing less than nothing.
            (block.start_s, block.duration_s) = (start_s, (end_s - start_s).max(0.0));
            block.feed_before_s = feed_s;
            block.sense = driven.at(start_s, 0).sense;
            if block.kind == BlockKind::Feed {
                feed_s += block.duration_s;
            }
        }
        let stands = |block: &Block| matches!(block.kind, BlockKind::Dwell | BlockKind::Stop);
        for k in 0..blocks.len() {
            let end_s = blocks[k].start_s + blocks[k].duration_s;
            let waits = blocks.get(k + 1).is_none_or(stands);
            blocks[k].ends_at_rest = stands(&blocks[k]) || waits || driven.rests(end_s);
        }
        Ok(Self {
            end_s: blocks.last().map_or(0.0, |last| last.start_s + last.duration_s),
            blocks,
            pauses_s: cuts.pauses_s.iter().map(|[from_s, to_s]| to_s - from_s).collect(),
            driven: Some(Arc::new(driven)),
            ..planned
        })
    }

    /// Whether its times were recorded, and how long each operator's pause was then, s.
    pub fn recorded_pauses_s(&self) -> Option<&[f64]> {
        self.driven.as_ref().map(|_| self.pauses_s.as_slice())
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
        self.in_block(time_s, self.block_at(time_s))
    }

    /// The same at a time near that of a block, by its index: much sooner found than by [`at`](Self::at).
    pub fn at_near(&self, time_s: f64, near: usize) -> State {
        self.in_block(time_s, self.block_near(time_s, near))
    }

    fn in_block(&self, time_s: f64, index: usize) -> State {
        if let Some(driven) = &self.driven {
            return driven.at(time_s, index);
        }
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

    /// Machine coordinates at a time near that of a block, by its index, mm: much sooner found than by [`at`](Self::at).
    pub fn position_near_mm(&self, time_s: f64, near: usize) -> Vector3<f64> {
        if let Some(driven) = &self.driven {
            return driven.position_mm(time_s);
        }
        let index = self.block_near(time_s, near);
        self.blocks.get(index).map_or_else(Vector3::zeros, |block| block.position_mm(time_s))
    }

    /// Index of the block that runs at a time near that of another, sought in ever longer steps from there.
    fn block_near(&self, time_s: f64, near: usize) -> usize {
        let count = self.blocks.len();
        let began = |block: &Block| block.start_s <= time_s;
        let mut low = near.min(count.saturating_sub(1));
        let (mut high, mut step) = (low + 1, 1);
        while low > 0 && !began(&self.blocks[low]) {
            (low, high) = (low.saturating_sub(step), low);
            step *= 2;
        }
        while high < count && began(&self.blocks[high]) {
            (low, high) = (high, (high + step).min(count));
            step *= 2;
        }
        let within = self.blocks.get(low..high.min(count)).unwrap_or_default();
        (low + within.partition_point(began)).saturating_sub(1)
    }

    /// Mean of machine coordinates at so many times, evenly spaced, near that of a block, mm.
    ///
    /// Between two vertices a chord is driven at constant speed: its mean is where it is at its mean time. An arc is a curve of
    /// third degree there, see [`Times::node_s`].
    pub fn mean_position_mm(&self, times: &Times, near: usize) -> Vector3<f64> {
        let mut sum_mm = Vector3::zeros();
        let mut at = 0;
        while at < times.count {
            let index = self.block_near(times.at_s(at as f64), near);
            let ends_s = match (&self.driven, self.blocks.get(index + 1)) {
                (None, Some(next)) => next.start_s,
                (None, None) => f64::INFINITY,
                // What was recorded is straight from one row to the next only.
                (Some(_), _) => f64::NEG_INFINITY,
            };
            let more = times.count - at - 1;
            let within =
                1 + (1..=more).take_while(|k| times.at_s((at + k) as f64) < ends_s).count();
            let inside = Times { first_s: times.at_s(at as f64), count: within, ..*times };
            let at_mm = |aside_s: f64| self.position_near_mm(inside.middle_s() + aside_s, index);
            let motion = self.blocks.get(index).and_then(Block::motion);
            let bends = motion.is_some_and(|motion| matches!(motion.path, Path::Arc { .. }));
            let mean_mm = if within > 1 && bends {
                let node_s = inside.node_s();
                (at_mm(-node_s) + at_mm(0.0) + at_mm(node_s)) / 3.0
            } else {
                at_mm(0.0)
            };
            sum_mm += within as f64 * mean_mm;
            at += within;
        }
        sum_mm / times.count.max(1) as f64
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
        if let Some(driven) = &self.driven {
            return driven.turns_s();
        }
        let mut times: Vec<f64> = Vec::new();
        for block in &self.blocks {
            let Some((motion, profile)) = &block.motion else { continue };
            let begins = turned(block.sense, &motion.at(HAIR).1);
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

    /// The end of a block, as seen from a time in it.
    pub fn corner(&self, time_s: f64, block: usize) -> Corner {
        let Some(now) = self.blocks.get(block) else { return Motion::REST.corner };
        let end_s = now.start_s + now.duration_s;
        if let Some(driven) = &self.driven {
            let [before, after] = [-CORNER_S, CORNER_S].map(|s| driven.velocity_mm_s(end_s + s));
            return Corner { ahead_s: (end_s - time_s).max(0.0), jump_mm_s: after - before };
        }
        let after = self
            .blocks
            .get(block + 1)
            .map_or_else(Vector3::zeros, |next| next.at(next.start_s, block + 1).velocity_mm_s);
        let jump_mm_s = after - now.at(end_s, block).velocity_mm_s;
        Corner { ahead_s: (end_s - time_s).max(0.0), jump_mm_s }
    }

    /// When (s) and where (mm) one slide begins to move against its last motion, in order.
    pub(super) fn turns(&self, slide: usize) -> Vec<Turn> {
        if let Some(driven) = &self.driven {
            let turns = driven.reversals(slide);
            return turns.map(|(at_s, at_mm)| Turn { at_s, at_mm, corner: None }).collect();
        }
        let mut turns = Vec::new();
        let mut sense = 0.0;
        let mut meet = |now: f64, turn: Turn| {
            if now * sense < 0.0 {
                turns.push(turn);
            }
            sense = now;
        };
        for (index, block) in self.blocks.iter().enumerate() {
            let Some((motion, profile)) = &block.motion else { continue };
            // The tangent of an arc leaves a slide's direction at its extremes only.
            let mut shares = motion.extreme_shares();
            shares.sort_by(f64::total_cmp);
            let ends: Vec<f64> = shares.iter().copied().chain([1.0]).collect();
            let begins = std::iter::once(0.0).chain(shares);
            for (begin, end) in begins.zip(ends) {
                let along = motion.at(0.5 * (begin + end)).1[slide];
                if along.abs() > 1e-12 {
                    let at_mm = motion.at(begin).0[slide];
                    let turn = if begin > 0.0 {
                        let into_s = profile.time_of_s(begin * motion.length_mm());
                        Turn { at_s: block.start_s + into_s, at_mm, corner: None }
                    } else {
                        let corner = self.turning_corner(index, slide);
                        Turn { at_s: block.start_s, at_mm, corner }
                    };
                    meet(along.signum(), turn);
                }
            }
        }
        turns
    }

    /// The corner between two straight blocks, the second of this index, at which a slide turns without a stop.
    fn turning_corner(&self, index: usize, slide: usize) -> Option<TurningCorner> {
        let (before, after) = (self.blocks.get(index.checked_sub(1)?)?, self.blocks.get(index)?);
        let straight = |block: &Block| block.motion().is_some_and(|of| of.path == Path::Line);
        let runs_on = straight(before) && straight(after) && !before.ends_at_rest;
        let along_mm_s = |block: &Block| {
            let middle_s = block.start_s + 0.5 * block.duration_s;
            block.at(middle_s, index).velocity_mm_s[slide]
        };
        runs_on.then(|| TurningCorner {
            speeds_mm_s: [before, after].map(along_mm_s),
            lasts_s: before.duration_s.min(after.duration_s),
        })
    }

    /// Time by kind.
    pub fn duration(&self) -> Duration {
        let mut total = Duration { stops: self.stops_before, ..Duration::default() };
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
