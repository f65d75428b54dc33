//! The residuals of all repeats, with what the model already spans.

use rayon::prelude::*;

use crate::align::Place;
use crate::error::Result;
use crate::identify::{Campaign, LinearSample, Options};
use crate::machine::Machine;
use crate::plan::Test;
use crate::solve::Matrix;

/// Samples of a run that are looked at; of longer logs every so many.
const MOST: usize = 12_000;

/// One repeat.
#[derive(Debug)]
pub(crate) struct Block {
    /// The samples that the fit used.
    pub(crate) samples: Vec<LinearSample>,
    /// What is left of each, mm, times the root of its weight; not yet without the accepted effects.
    pub(crate) residual_mm: Vec<f64>,
    /// Program time of each, s.
    pub(crate) program_s: Vec<f64>,
    /// Number of the arc of each, counted over all blocks: what is left out together.
    pub(crate) arcs: Vec<usize>,
    /// What the fit spans, row after row; see [`crate::identify::Linearised`].
    pub(crate) q: Vec<f64>,
    /// Columns of `q`.
    pub(crate) rank: usize,
    /// Parameters of the model per unit of `q`.
    pub(crate) factor: Matrix,
    /// Where each run begins and ends in the samples.
    pub(crate) runs: Vec<std::ops::Range<usize>>,
    /// By which factor a vibration is faster in each run: no source, and no clock, keeps its frequency to a
    /// turn in ten thousand.
    pub(crate) tuned: Vec<f64>,
    /// Standard deviation of when the program of each run began, s.
    pub(crate) began_sigma_s: Vec<f64>,
    /// Name of each run.
    pub(crate) names: Vec<String>,
    /// What each run drove: runs with the same number drove the same program in the same mounting.
    pub(crate) programs: Vec<usize>,
}

/// A column over all blocks; empty in the blocks where it is zero.
pub(crate) type Column = Vec<Vec<f64>>;

/// All repeats, and what has been accepted so far.
#[derive(Debug)]
pub(crate) struct Data {
    pub(crate) blocks: Vec<Block>,
    /// Whether vibrations differ from run to run.
    pub(crate) tuned: bool,
    /// How far each slide went, mm.
    pub(crate) way_mm: [f64; 3],
    /// How many arcs there are.
    pub(crate) arcs: usize,
    /// Orthonormal columns of the accepted effects, orthogonal to what the fits span.
    pub(crate) span: Vec<Column>,
    /// What is left after them, mm, times the root of the weight.
    pub(crate) left_mm: Vec<Vec<f64>>,
}

impl Data {
    pub(crate) fn new(test: &Test, machine: &Machine, campaign: &Campaign) -> Result<Self> {
        let options = Options::of(test);
        let linear = campaign
            .repeats
            .par_iter()
            .enumerate()
            .map(|(index, repeat)| {
                repeat.linearised(&campaign.model(test, machine, index)?, &options, MOST)
            })
            .collect::<Result<Vec<_>>>()?;
        let mut arcs = 0_usize;
        let mut blocks: Vec<Block> = Vec::new();
        let mut programs: Vec<(usize, f64, usize)> = Vec::new();
        for (repeat, linear) in campaign.repeats.iter().zip(linear) {
            let mut of_arc = Vec::with_capacity(linear.samples.len());
            let mut last = None;
            for sample in &linear.samples {
                let place = repeat.runs[sample.run].alignment.samples[sample.sample].place;
                let now = Some((sample.run, place));
                if now != last && matches!(place, Place::Arc(_)) {
                    arcs += 1;
                    last = now;
                }
                of_arc.push(arcs.saturating_sub(1));
            }
            let runs = (0..repeat.runs.len())
                .map(|run| {
                    let first = linear.samples.partition_point(|s| s.run < run);
                    first..linear.samples.partition_point(|s| s.run <= run)
                })
                .collect();
            let of_runs = repeat.runs.iter().map(|run| {
                let trajectory = &run.alignment.trajectory;
                let this = (run.mounting, trajectory.end_s(), trajectory.blocks().len());
                let same = |other: &(usize, f64, usize)| {
                    other.0 == this.0
                        && (other.1 - this.1).abs() < 1e-6 * this.1
                        && other.2 == this.2
                };
                programs.iter().position(same).unwrap_or_else(|| {
                    programs.push(this);
                    programs.len() - 1
                })
            });
            let of_runs = of_runs.collect();
            blocks.push(Block {
                tuned: vec![1.0; repeat.runs.len()],
                began_sigma_s: repeat.runs.iter().map(|run| run.alignment.began_sigma_s).collect(),
                names: repeat.runs.iter().map(|run| run.name.clone()).collect(),
                programs: of_runs,
                residual_mm: linear.samples.iter().map(|s| s.residual_mm * s.root_weight).collect(),
                program_s: linear
                    .samples
                    .iter()
                    .map(|s| repeat.runs[s.run].alignment.samples[s.sample].program_s)
                    .collect(),
                arcs: of_arc,
                q: linear.q,
                rank: linear.rank,
                factor: linear.factor,
                samples: linear.samples,
                runs,
            });
        }
        let left_mm = blocks.iter().map(|block| block.residual_mm.clone()).collect();
        let way_mm = [0, 1, 2].map(|slide| {
            let samples = blocks.iter().flat_map(|block: &Block| &block.samples);
            let at = samples.map(|s| s.situation.pose.position_mm[slide]);
            let (low, high) =
                at.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            (high - low).max(0.0)
        });
        Ok(Self { blocks, tuned: false, way_mm, arcs, span: Vec::new(), left_mm })
    }

    /// How long the longest run is, s.
    pub(crate) fn longest_s(&self) -> f64 {
        let ends = self.blocks.iter().flat_map(|block| {
            block.runs.iter().filter_map(|run| {
                let of_run = block.samples.get(run.clone())?;
                let (first, last) = (of_run.first()?, of_run.last()?);
                Some(last.situation.motion.elapsed_s - first.situation.motion.elapsed_s)
            })
        });
        ends.fold(1.0, f64::max)
    }

    /// The same tuning of vibrations as another.
    pub(crate) fn tune_as(&mut self, other: &Self) {
        self.tuned = other.tuned;
        for (block, of) in self.blocks.iter_mut().zip(&other.blocks) {
            block.tuned.clone_from(&of.tuned);
        }
    }

    /// What the model leaves, of every block, mm.
    pub(crate) fn residuals_mm(&self) -> Vec<Vec<f64>> {
        self.blocks.iter().map(|block| block.residual_mm.clone()).collect()
    }

    /// Sum of squares of what the model leaves, mm².
    pub(crate) fn squares_without_mm2(&self) -> f64 {
        self.blocks.iter().map(|block| dot(&block.residual_mm, &block.residual_mm)).sum()
    }

    /// How many samples.
    pub(crate) fn samples(&self) -> usize {
        self.blocks.iter().map(|block| block.samples.len()).sum()
    }

    /// Sum of squares of what is left, mm².
    pub(crate) fn squares_mm2(&self) -> f64 {
        self.left_mm.iter().flatten().map(|e| e * e).sum()
    }

    /// Forgets the accepted effects and accepts these columns instead.
    pub(crate) fn accept(&mut self, columns: &[Column]) {
        self.span.clear();
        for column in columns {
            if let Some(unit) = self.outside(column) {
                self.span.push(unit);
            }
        }
        self.left_mm = self.blocks.iter().map(|block| block.residual_mm.clone()).collect();
        for unit in &self.span {
            let along: f64 = unit.iter().zip(&self.left_mm).map(|(u, e)| dot(u, e)).sum();
            for (u, e) in unit.iter().zip(&mut self.left_mm) {
                for (e, u) in e.iter_mut().zip(u) {
                    *e -= along * u;
                }
            }
        }
    }

    /// What of a column lies outside of what is spanned, of unit length; `None` if next to nothing does.
    fn outside(&self, column: &Column) -> Option<Column> {
        let raw = norm2(column);
        let mut rest = self.projected(column);
        // Twice: once leaves the rounding of the first time.
        for unit in self.span.iter().chain(&self.span) {
            let along: f64 = unit.iter().zip(&rest).map(|(u, c)| dot(u, c)).sum();
            for (u, c) in unit.iter().zip(&mut rest) {
                for (c, u) in c.iter_mut().zip(u) {
                    *c -= along * u;
                }
            }
        }
        let length = norm2(&rest);
        if length < NOTHING_LEFT * raw {
            return None;
        }
        let scale = length.sqrt().recip();
        rest.iter_mut().flatten().for_each(|value| *value *= scale);
        Some(rest)
    }

    /// A column without its part in what the fits span.
    pub(crate) fn projected(&self, column: &Column) -> Column {
        let blocks = column.par_iter().zip(&self.blocks);
        blocks
            .map(|(c, block)| {
                if c.is_empty() {
                    return Vec::new();
                }
                let along = block.along(&[c]).remove(0);
                let rows = block.q.chunks_exact(block.rank.max(1));
                c.iter().zip(rows).map(|(c, row)| c - dot(row, &along)).collect()
            })
            .collect()
    }
}

/// A column of which the span leaves less than this share of its square adds nothing but rounding.
const NOTHING_LEFT: f64 = 1e-7;

impl Block {
    /// `Q^T c` of several columns in one pass; of an empty one zeros.
    pub(crate) fn along(&self, columns: &[&[f64]]) -> Vec<Vec<f64>> {
        let mut along = vec![vec![0.0; self.rank]; columns.len()];
        for (k, row) in self.q.chunks_exact(self.rank.max(1)).enumerate() {
            for (along, column) in along.iter_mut().zip(columns) {
                let c = column.get(k).copied().unwrap_or(0.0);
                if c != 0.0 {
                    for (a, q) in along.iter_mut().zip(row) {
                        *a += c * q;
                    }
                }
            }
        }
        along
    }
}

/// `a · b`, summed in four lanes: always the same four, so always the same bits.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 4];
    let (fours_a, fours_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest = fours_a.remainder().iter().zip(fours_b.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in fours_a.zip(fours_b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    lanes[0] + lanes[1] + (lanes[2] + lanes[3]) + rest
}

pub(crate) fn norm2(column: &Column) -> f64 {
    column.iter().flatten().map(|c| c * c).sum()
}
