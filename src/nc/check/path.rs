//! Rules for the path as such: travel, and what each axis can do at feed.

use super::findings::Findings;
use crate::machine::{Axis, Machine};
use crate::nc::listing::{Block, Listing};
use crate::nc::program::{Action, Move, Step};
use crate::nc::run::Ran;
use crate::nc::word::Fault;

/// A coordinate may stand on the end of the travel, mm.
const ON_THE_END_MM: f64 = 1e-6;

pub(super) fn check(
    listing: &Listing,
    ran: &Ran,
    machine: &Machine,
    placed: bool,
    findings: &mut Findings,
) {
    let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    let mut first = true;
    for step in &ran.steps {
        if findings.are_too_many() {
            return;
        }
        let Action::Move(motion) = &step.action else { continue };
        // No move led to the start of the first one: the positioning from wherever the machine stood.
        if std::mem::take(&mut first) {
            let line = listing.positioned_before(step.line);
            for axis in Axis::ALL {
                let at = motion.start_mm[axis.index()];
                extent[axis.index()] = [at, at];
                if placed {
                    travel(listing, line, machine, axis, [at, at], findings);
                }
            }
        }
        for (axis, low, high) in reach(motion) {
            let [from, to] = &mut extent[axis.index()];
            (*from, *to) = (from.min(low), to.max(high));
            if placed {
                travel(listing, step.line, machine, axis, [low, high], findings);
            }
        }
        if !motion.rapid {
            feed(listing, step, motion, machine, findings);
        }
    }
    if !placed && single_offset(listing) {
        for axis in Axis::ALL {
            let [from, to] = extent[axis.index()];
            let [low, high] = machine.slide(axis).travel_mm;
            if to - from > high - low + ON_THE_END_MM {
                let what = format!(
                    "axis {axis} moves over {:.3} mm, and its travel is {:.3} mm",
                    to - from,
                    high - low
                );
                findings.error(
                    "travel",
                    listing.whole(what).hint("no work offset makes room for this path"),
                );
            }
        }
    }
}

/// Lowest and highest coordinate of a move on each axis, its start left out.
fn reach(motion: &Move) -> [(Axis, f64, f64); 3] {
    let between: Vec<_> =
        motion.extreme_shares().into_iter().map(|share| motion.at(share).0).collect();
    Axis::ALL.map(|axis| {
        let k = axis.index();
        let all = between.iter().map(|point| point[k]).chain([motion.end_mm[k]]);
        all.fold((axis, f64::INFINITY, f64::NEG_INFINITY), |(axis, low, high), at| {
            (axis, low.min(at), high.max(at))
        })
    })
}

fn travel(
    listing: &Listing,
    line: usize,
    machine: &Machine,
    axis: Axis,
    [from, to]: [f64; 2],
    findings: &mut Findings,
) {
    let [low, high] = machine.slide(axis).travel_mm;
    let beyond = if from < low - ON_THE_END_MM {
        from
    } else if to > high + ON_THE_END_MM {
        to
    } else {
        return;
    };
    let what = format!("axis {axis} would go to {beyond:.3} mm in machine coordinates");
    findings.error_of("travel", what, |what| {
        let hint =
            format!("its travel is {low} to {high} mm: check the coordinate and the work offset");
        listing.at_word(line, b"XYZ"[axis.index()], what).hint(hint)
    });
}

/// No axis is asked for more than its fastest feed, and none for more than its rapid traverse.
fn feed(listing: &Listing, step: &Step, motion: &Move, machine: &Machine, findings: &mut Findings) {
    let fastest =
        |axis: Axis| machine.slide(axis).max_feed_mm_s.min(machine.slide(axis).rapid_mm_s);
    if Axis::ALL.into_iter().all(|axis| motion.feed_mm_s <= fastest(axis)) {
        return;
    }
    let (_, along) = motion.at(0.5);
    for axis in Axis::ALL {
        let speed = along[axis.index()].abs() * motion.feed_mm_s;
        if speed > fastest(axis) * (1.0 + 1e-9) {
            let what = format!(
                "axis {axis} would feed at {:.0} mm/min, and its fastest is {:.0}",
                speed * 60.0,
                fastest(axis) * 60.0
            );
            let place = listing.at_word(step.line, b'F', what);
            let error = place.hint("the control slows down or refuses: lower F");
            if speed > machine.slide(axis).rapid_mm_s * (1.0 + 1e-9) {
                findings.error("feed", error);
            } else {
                findings.warning("feed", error);
            }
        }
    }
}

/// Whether all coordinates count from one zero.
fn single_offset(listing: &Listing) -> bool {
    let mut offsets = [false; 60];
    for word in listing.blocks.iter().flat_map(|block| listing.words(block)) {
        if word.letter == b'G' && (53.0..60.0).contains(&word.value) {
            offsets[word.value as usize] = true;
        }
    }
    !offsets[53] && offsets.iter().filter(|used| **used).count() <= 1
}

impl Listing<'_> {
    /// The last line before this one that names a coordinate, or this one.
    fn positioned_before(&self, line: usize) -> usize {
        let end = self.blocks.partition_point(|block| block.line.number < line);
        let names = |block: &&Block| {
            self.words(block).iter().any(|word| matches!(word.letter, b'X'..=b'Z'))
        };
        self.blocks[..end].iter().rfind(names).map_or(line, |block| block.line.number)
    }

    /// An error of the word with this letter in a line, or of the line if it has none.
    fn at_word(&self, line: usize, letter: u8, what: String) -> crate::Error {
        let Some(block) = self.block_of(line) else { return self.whole(what) };
        let word = self.words(block).iter().find(|word| word.letter == letter);
        let fault = match word {
            Some(word) => Fault::word(word, what),
            None => Fault::line(what),
        };
        self.locate(block.line, fault)
    }
}
