//! Times the blocks of a program, stretch after stretch.

use nalgebra::Vector3;

use super::bell;
use super::block::{Block, BlockKind, HAIR, turned};
use super::limits::{self, Limits};
use super::profile::Profile;
use crate::machine::Machine;
use crate::nc::Move;

/// Blocks as they come, each after the one before.
pub(super) struct Builder<'a> {
    machine: &'a Machine,
    feed_override: f64,
    pub(super) blocks: Vec<Block>,
    pub(super) now_s: f64,
    feed_s: f64,
    sense: Vector3<f64>,
    at_mm: Vector3<f64>,
}

impl<'a> Builder<'a> {
    /// Nothing yet, with room for as many blocks, on a machine with its feeds multiplied by `feed_override`.
    pub(super) fn new(machine: &'a Machine, feed_override: f64, blocks: usize) -> Self {
        Self {
            machine,
            feed_override,
            blocks: Vec::with_capacity(blocks),
            now_s: 0.0,
            feed_s: 0.0,
            sense: Vector3::zeros(),
            at_mm: Vector3::zeros(),
        }
    }

    pub(super) fn stand(&mut self, kind: BlockKind, duration_s: f64, line: usize, label: usize) {
        self.blocks.push(Block {
            kind,
            start_s: self.now_s,
            duration_s,
            line,
            label,
            feed_before_s: self.feed_s,
            start_mm: self.at_mm,
            motion: None,
            length_mm: 0.0,
            sense: self.sense,
            ends_at_rest: true,
        });
        self.now_s += duration_s;
    }

    /// Times a stretch of moves that begins and ends at rest.
    pub(super) fn drive(&mut self, stretch: &mut Vec<(usize, usize, Move)>) {
        let count = stretch.len();
        let lengths: Vec<f64> = stretch.iter().map(|(_, _, motion)| motion.length_mm()).collect();
        let limits: Vec<Limits> = stretch
            .iter()
            .zip(&lengths)
            .map(|((_, _, motion), length_mm)| {
                limits::of(self.machine, motion, *length_mm, self.feed_override)
            })
            .collect();
        // Squared speed at the beginning of each block, and at the very end.
        let mut squared = vec![0.0_f64; count + 1];
        for k in 1..count {
            let corner = limits::at_corner(self.machine, &stretch[k - 1].2, &stretch[k].2);
            squared[k] = corner.min(limits[k - 1].speed_mm_s).min(limits[k].speed_mm_s).powi(2);
        }
        let gain = |k: usize| 2.0 * limits[k].acceleration_mm_s2 * lengths[k];
        for k in 0..count {
            squared[k + 1] = squared[k + 1].min(squared[k] + gain(k));
        }
        for k in (0..count).rev() {
            squared[k] = squared[k].min(squared[k + 1] + gain(k));
        }
        let mut profiles: Vec<Profile> = (0..count)
            .map(|k| {
                Profile::fastest(
                    lengths[k],
                    squared[k].sqrt(),
                    squared[k + 1].sqrt(),
                    limits[k].speed_mm_s,
                    limits[k].acceleration_mm_s2,
                )
            })
            .collect();
        let change_s = self.machine.controller().acceleration_change_s;
        if change_s > 0.0 {
            let mut start = 0;
            for k in 0..count {
                if squared[k + 1] == 0.0 {
                    let range = start..=k;
                    let filtered =
                        bell::filtered(&profiles[range.clone()], &lengths[range.clone()], change_s);
                    profiles.splice(range, filtered);
                    start = k + 1;
                }
            }
        }
        for (((line, label, motion), profile), length_mm) in
            stretch.drain(..).zip(profiles).zip(lengths)
        {
            let duration_s = profile.duration_s();
            self.blocks.push(Block {
                kind: if motion.rapid { BlockKind::Rapid } else { BlockKind::Feed },
                start_s: self.now_s,
                duration_s,
                line,
                label,
                feed_before_s: self.feed_s,
                start_mm: motion.start_mm,
                ends_at_rest: profile.at(f64::INFINITY).1 < 1e-9,
                motion: Some((motion, profile)),
                length_mm,
                sense: self.sense,
            });
            // An arc may turn a slide round on its way: how it comes to its end decides.
            self.sense = turned(self.sense, &motion.at(1.0 - HAIR).1);
            self.at_mm = motion.end_mm;
            self.now_s += duration_s;
            if !motion.rapid {
                self.feed_s += duration_s;
            }
        }
    }
}
