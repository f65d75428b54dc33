//! Which part of a recorded motion is which block of a program.
//!
//! The blocks are followed one by one along the way of the tool: a block ends where the recording comes nearest to its end, at
//! about as long a way behind the end of the one before as the block is long. Where the program waits, the recording stands.
//! Times are not compared: what the recording has in place of the estimate is the times.

use std::cell::Cell;
use std::ops::Range;

use nalgebra::Vector3;

use super::block::{Block, BlockKind};
use super::driven::Cuts;
use super::slides::Slides;
use crate::error::{Error, Kind, Place, Result};
use crate::log::{Recording, Stand};

/// The way may differ from the program's by so much a block, mm, and by so much of its length: corners are cut, slides follow.
const SLACK_MM: f64 = 1.0;
const SLACK: f64 = 0.02;
/// A recording that comes no nearer to the end of a block at feed, or to where the program waits, is of another program, mm.
const NEAR_MM: f64 = 2.0;
/// So many distances are looked at, which a recording of an hour with a row a millisecond needs a hundredth of.
const MOST_LOOKS: usize = 400_000_000;
/// Beginnings that are tried: each may be the end of an arc of an earlier run.
const MOST_TRIES: usize = 64;

/// When every block of a program ends, and what is no time of the program.
pub(super) struct Matched {
    /// When each block begins and ends, s of the recording.
    pub(super) blocks_s: Vec<[f64; 2]>,
    pub(super) cuts: Cuts,
}

/// Lays the blocks of a program over a recording of it.
///
/// # Errors
/// When it is no recording of that program, with the block and the place.
pub(super) fn matched(
    blocks: &[Block],
    recording: &Recording,
    slides: &Slides,
    program: &std::path::Path,
) -> Result<Matched> {
    let walk = Walk { blocks, rows: recording.rows(), slides, looks: Cell::new(0) };
    let mut farthest: Option<Lost> = None;
    for begin in walk.begins().into_iter().take(MOST_TRIES) {
        match walk.follow(begin) {
            Ok(matched) => return Ok(matched),
            Err(lost) if farthest.as_ref().is_none_or(|far| far.block < lost.block) => {
                farthest = Some(lost);
            }
            Err(_) => {}
        }
    }
    let told = |what: String| {
        Err(Error::new(Kind::Mismatch, what).at(Place::file(recording.file())).hint(format!(
            "record the run of {} from before it begins until it has ended, in machine coordinates, the commanded positions of X, Y and Z",
            program.display()
        )))
    };
    match farthest.and_then(|lost| Some((blocks.get(lost.block)?, lost))) {
        Some((block, lost)) => told(format!(
            "the recorded motion is not that of the program: at {:.3} s it should come to X {:.3} Y {:.3} Z {:.3} (line {}), and comes no nearer than {:.3} mm",
            lost.at_s, lost.to_mm.x, lost.to_mm.y, lost.to_mm.z, block.line, lost.apart_mm
        )),
        None => told("the recorded motion never comes to where the program begins".to_owned()),
    }
}

/// A block that the recording does not follow.
struct Lost {
    block: usize,
    to_mm: Vector3<f64>,
    at_s: f64,
    apart_mm: f64,
}

struct Walk<'a> {
    blocks: &'a [Block],
    rows: &'a [Stand],
    slides: &'a Slides,
    /// Distances that were looked at.
    looks: Cell<usize>,
}

impl Walk<'_> {
    /// Rows at which the first block may be that has to be found: the first standstill of the program or, without one, its beginning.
    fn begins(&self) -> Vec<[usize; 2]> {
        let Some(first) = self.blocks.get(self.anchor()) else { return Vec::new() };
        let near = |row: usize| (self.rows[row].position_mm - first.start_mm).norm() < NEAR_MM;
        let rests = self.slides.rests.iter().copied().filter(|rest| near(rest[0]));
        let rests: Vec<[usize; 2]> = if stands(first) { rests.collect() } else { Vec::new() };
        if !rests.is_empty() {
            return rests;
        }
        let mut begins: Vec<[usize; 2]> = Vec::new();
        for row in (0..self.rows.len()).filter(|row| near(*row)) {
            match begins.last_mut() {
                Some(last) if last[1] + 1 == row => last[1] = row,
                _ => begins.push([row, row]),
            }
        }
        let nearest = |[from, to]: [usize; 2]| {
            let apart_mm = |row: &usize| (self.rows[*row].position_mm - first.start_mm).norm();
            let row =
                (from..=to).min_by(|a, b| apart_mm(a).total_cmp(&apart_mm(b))).unwrap_or(from);
            [row, row]
        };
        begins.into_iter().map(nearest).collect()
    }

    /// Index of the block that is looked for first.
    fn anchor(&self) -> usize {
        self.blocks.iter().position(stands).unwrap_or(0)
    }

    /// Follows the program from a standstill on, or from a row.
    fn follow(&self, begin: [usize; 2]) -> std::result::Result<Matched, Lost> {
        let anchor = self.anchor();
        let time_s = |row: usize| self.rows[row].time_s;
        let arrived_s = time_s(begin[0]);
        let mut blocks_s = self.approach(begin[0]).unwrap_or_else(|| {
            // What was driven before is as long as it was planned: nothing is read there.
            let earlier_s = arrived_s - self.blocks.get(anchor).map_or(0.0, |block| block.start_s);
            let planned =
                |block: &Block| [0.0, block.duration_s].map(|s| earlier_s + block.start_s + s);
            self.blocks[..anchor].iter().map(planned).collect()
        });
        let mut pauses_s = Vec::new();
        let mut here = begin[0];
        let mut rest = Some(begin);
        let mut next = anchor;
        while let Some(block) = self.blocks.get(next) {
            if !stands(block) {
                let [found, leaves] = self.end_of(next, here)?;
                rest = Some([found, leaves]);
                let arrives = found.max(here);
                // Where the program goes on at once, a standstill on the way is a part of the next block.
                blocks_s.push([time_s(here), time_s(arrives)]);
                here = arrives;
                next += 1;
                continue;
            }
            let count = self.blocks[next..].iter().take_while(|block| stands(block)).count();
            let leaves = rest.take().map_or(here, |rest| rest[1].max(here));
            let standing = &self.blocks[next..next + count];
            stand(standing, [time_s(here), time_s(leaves)], &mut blocks_s, &mut pauses_s);
            here = leaves;
            next += count;
        }
        let begins_s = blocks_s.first().map_or(arrived_s, |block| block[0]);
        Ok(Matched { blocks_s, cuts: Cuts { begins_s, pauses_s } })
    }

    /// When the blocks begin and end by which the program comes to a row; `None` where the recording begins later, or has its
    /// beginning elsewhere.
    fn approach(&self, arrives: usize) -> Option<Vec<[f64; 2]>> {
        let blocks = &self.blocks[..self.anchor()];
        let first_mm = blocks.first()?.start_mm;
        let lengths_mm = blocks.iter().map(|block| [block.length_mm, longest_mm(block)]);
        let [least_mm, most_mm] = lengths_mm
            .fold([0.0, 0.0], |[least, most], [short, long]| [least + short, most + long]);
        let slack_mm = blocks.len() as f64 * SLACK_MM + SLACK * most_mm;
        let way_mm = &self.slides.ways_mm;
        let [from, to] = [most_mm + slack_mm, least_mm - slack_mm].map(|behind_mm| {
            way_mm[..arrives].partition_point(|way| *way < way_mm[arrives] - behind_mm)
        });
        let apart_mm = |row: &usize| (self.rows[*row].position_mm - first_mm).norm();
        let nearest = (from..to).min_by(|a, b| apart_mm(a).total_cmp(&apart_mm(b)))?;
        if apart_mm(&nearest) > NEAR_MM {
            return None;
        }
        let mut here =
            self.rests(nearest..nearest + 1).last().map_or(nearest, |rest| rest[1]).min(arrives);
        let mut blocks_s = Vec::with_capacity(self.blocks.len());
        for index in 0..blocks.len() {
            let [found, _] = self.end_of(index, here).ok()?;
            let ends = if index + 1 == blocks.len() { arrives } else { found.clamp(here, arrives) };
            blocks_s.push([here, ends].map(|row| self.rows[row].time_s));
            here = ends;
        }
        Some(blocks_s)
    }

    /// The row at which a block ends that begins at a row, and the last one of the standstill there.
    fn end_of(&self, index: usize, begins: usize) -> std::result::Result<[usize; 2], Lost> {
        let block = &self.blocks[index];
        let Some(motion) = block.motion() else { return Ok([begins, begins]) };
        let way_mm = &self.slides.ways_mm;
        let slack_mm = SLACK_MM + SLACK * block.length_mm;
        let from_mm = way_mm[begins] + (block.length_mm - slack_mm).max(0.0);
        let to_mm = way_mm[begins] + longest_mm(block) + slack_mm;
        let from =
            begins + way_mm[begins..].partition_point(|way| *way < from_mm).saturating_sub(1);
        // And a row to either side: at 100 mm/s rows of every 20 ms are farther apart than most blocks are long.
        let beyond = begins + way_mm[begins..].partition_point(|way| *way <= to_mm) + 1;
        let to = beyond.min(self.rows.len());
        let from = from.min(self.rows.len() - 1);
        let apart_mm = |row: usize| (self.rows[row].position_mm - motion.end_mm).norm();
        let waits = self.blocks.get(index + 1).is_some_and(stands);
        // Where the program waits, the longest standstill there.
        let waited =
            self.rests(from.max(begins + 1)..to).filter(|rest| apart_mm(rest[0]) < NEAR_MM);
        let longest = waited.max_by_key(|rest| rest[1] - rest[0]);
        if let Some(rest) = longest.filter(|_| waits) {
            return Ok(rest);
        }
        self.looks.set(self.looks.get() + to.saturating_sub(from));
        let nearest = (from..to).min_by(|a, b| apart_mm(*a).total_cmp(&apart_mm(*b)));
        let row = nearest.filter(|_| self.looks.get() < MOST_LOOKS).unwrap_or(from);
        // Controls round the corners between two rapids.
        if apart_mm(row) > NEAR_MM && (waits || !motion.rapid) {
            let at_s = self.rows[row].time_s;
            return Err(Lost { block: index, to_mm: motion.end_mm, at_s, apart_mm: apart_mm(row) });
        }
        let rest = self.rests(row..row + 1).next();
        Ok(rest.map_or([row, row], |rest| [rest[0].max(begins), rest[1]]))
    }

    /// The standstills that reach into a range of rows.
    fn rests(&self, within: Range<usize>) -> impl Iterator<Item = [usize; 2]> {
        let rests = &self.slides.rests;
        let first = rests.partition_point(|rest| rest[1] < within.start);
        rests[first..].iter().copied().take_while(move |rest| rest[0] < within.end)
    }
}

/// Shares a standstill out between the blocks that wait in it: dwells take what the program says, the operator the rest.
fn stand(
    blocks: &[Block],
    [from_s, to_s]: [f64; 2],
    blocks_s: &mut Vec<[f64; 2]>,
    pauses_s: &mut Vec<[f64; 2]>,
) {
    let dwells_s: f64 = blocks.iter().map(|block| block.duration_s).sum();
    let operators = blocks.iter().filter(|block| block.kind == BlockKind::Stop).count();
    let stood_s = to_s - from_s;
    let paused_s = if operators > 0 { (stood_s - dwells_s).max(0.0) } else { 0.0 };
    let longer = if dwells_s > 0.0 { (stood_s - paused_s) / dwells_s } else { 1.0 };
    let mut now_s = from_s;
    for block in blocks {
        let lasts_s = match block.kind {
            BlockKind::Stop => paused_s / operators as f64,
            _ => block.duration_s * longer,
        };
        let end_s = (now_s + lasts_s).min(to_s);
        if block.kind == BlockKind::Stop {
            pauses_s.push([now_s, end_s]);
        }
        blocks_s.push([now_s, end_s]);
        now_s = end_s;
    }
}

/// The longest way of a block, mm: positioning may go along a dog-leg.
fn longest_mm(block: &Block) -> f64 {
    let rapid = block.motion().filter(|motion| motion.rapid);
    rapid.map_or(block.length_mm, |motion| (motion.end_mm - motion.start_mm).lp_norm(1))
}

/// Whether a block waits.
fn stands(block: &Block) -> bool {
    matches!(block.kind, BlockKind::Dwell | BlockKind::Stop)
}
