//! The residuals of all repeats, and what the fits already follow.

use std::ops::Range;
use std::sync::OnceLock;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::column::Column;
use crate::error::Result;
use crate::identify::{Campaign, Identification, IdentifiedRun, LinearSample, Linearised, Options};
use crate::machine::Machine;
use crate::motion::Block;
use crate::plan::Test;
use crate::solve::{Basis, Matrix, dot};

/// Programs whose durations differ by less than this share are one: a feed that was found differs by less from repeat to
/// repeat, and feeds that somebody compares by more.
const SAME_DURATION: f64 = 0.01;
/// Where a block is looked at, as a share of it: two circles of two planes have opposite ends in common.
const INTO: f64 = 0.3;
/// Slides nearer than this are at one place there, mm: another feed begins and ends otherwise by some hundredths.
const SAME_PLACE_MM: f64 = 0.1;

/// A reading that a fit used; its arc is counted over all runs of all repeats.
pub type Sample = LinearSample;

/// One run of a repeat.
#[derive(Debug, Clone)]
pub struct Run {
    /// Its name.
    pub name: String,
    /// Its samples among those of the repeat.
    pub samples: Range<usize>,
    /// What it drove: runs with the same number drove the same program in the same mounting.
    pub program: usize,
    /// Standard deviation of when its program began, s.
    pub began_sigma_s: f64,
}

/// One repeat: runs that were identified together.
#[derive(Debug)]
pub struct Repeat {
    /// The samples that the fit used, in the order of runs and time.
    pub samples: Vec<Sample>,
    /// What the fit follows at these samples.
    pub basis: Basis,
    /// Faults per unit of `Q^T c`, `c` in mm, and what is plausible of each; see [`Linearised`].
    pub factor: Matrix,
    /// See [`Linearised`].
    pub deviations: Vec<f64>,
    /// The runs.
    pub runs: Vec<Run>,
}

/// What the model leaves of all repeats. It never changes: what is there beside effects is a
/// [`Beside`](super::Beside).
#[derive(Debug)]
pub struct Residuals {
    /// The repeats.
    pub repeats: Vec<Repeat>,
    /// Measured minus predicted, mm, times the root of the weight.
    pub model_mm: Column,
    /// How far each slide went, mm.
    pub way_mm: [f64; 3],
    /// About which the errors of each slide are told, mm in machine coordinates.
    pub middle_mm: [f64; 3],
    /// How fast each slide went at the most, mm/s.
    pub fastest_mm_s: [f64; 3],
    /// How many arcs there are.
    pub arcs: usize,
    /// Whether effects were held in the fits: then nothing but noise is left beside them.
    pub held: bool,
    /// How many samples' worth of slow noise the fits have taken out, once somebody has asked.
    pub(super) taken_out: OnceLock<f64>,
}

/// A program that was driven: mounting, duration and the way of its blocks tell one from another. Three planes with the
/// same arcs take the same time, and the same path may be driven at two feeds.
struct Driven {
    mounting: usize,
    duration_s: f64,
    way_mm: Vec<Vector3<f64>>,
}

impl Driven {
    fn of(run: &IdentifiedRun) -> Self {
        let trajectory = &run.alignment.trajectory;
        let on_mm =
            |block: &Block| trajectory.at(block.start_s + INTO * block.duration_s).position_mm;
        Self {
            mounting: run.mounting,
            duration_s: trajectory.end_s(),
            way_mm: trajectory.blocks().iter().map(on_mm).collect(),
        }
    }

    fn is(&self, other: &Self) -> bool {
        let near = |(a, b): (&Vector3<f64>, &Vector3<f64>)| (a - b).norm() < SAME_PLACE_MM;
        self.mounting == other.mounting
            && (self.duration_s - other.duration_s).abs() < SAME_DURATION * other.duration_s
            && self.way_mm.len() == other.way_mm.len()
            && self.way_mm.iter().zip(&other.way_mm).all(near)
    }
}

impl Residuals {
    /// Of a campaign as it was identified.
    ///
    /// # Errors
    /// When the rows of a fit are not finite.
    pub fn of(test: &Test, machine: &Machine, campaign: &Campaign) -> Result<Self> {
        let options = Options::of(test);
        let linear = campaign
            .repeats
            .par_iter()
            .enumerate()
            .map(|(index, repeat)| {
                repeat.linearised(&campaign.model(test, machine, index)?, &options)
            })
            .collect::<Result<Vec<_>>>()?;
        let mut arcs = 0;
        let mut programs = Vec::new();
        let (mut repeats, mut model_mm) = (Vec::new(), Vec::new());
        for (identified, linear) in campaign.repeats.iter().zip(linear) {
            model_mm.push(linear.samples.iter().map(|s| s.left_mm * s.root_weight).collect());
            repeats.push(Repeat::of(identified, linear, &mut arcs, &mut programs));
        }
        let ends_mm = [0, 1, 2].map(|slide| {
            let samples = repeats.iter().flat_map(|repeat: &Repeat| &repeat.samples);
            let at = samples.map(|s| s.situation.pose.position_mm[slide]);
            at.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
        });
        let way_mm = ends_mm.map(|(low, high)| (high - low).max(0.0));
        let middle_mm = match &campaign.frame {
            Some(frame) => frame.middle_mm.into(),
            None => ends_mm.map(|(low, high)| 0.5 * (low + high)),
        };
        let fastest_mm_s = [0, 1, 2].map(|slide| {
            let samples = repeats.iter().flat_map(|repeat: &Repeat| &repeat.samples);
            samples.map(|s| s.situation.motion.velocity_mm_s[slide].abs()).fold(0.0, f64::max)
        });
        let model_mm = Column::from(model_mm);
        let held = campaign.held.iter().any(|held| !held.is_empty());
        let taken_out = OnceLock::new();
        Ok(Self { repeats, model_mm, way_mm, middle_mm, fastest_mm_s, arcs, held, taken_out })
    }

    /// The same samples with something added to what the model leaves, mm, as far as the fits do not follow
    /// it.
    #[must_use]
    pub fn plus(mut self, column: &Column) -> Self {
        let outside = self.outside(column);
        self.model_mm.add(1.0, &outside);
        self
    }

    /// How long the longest run is, s.
    pub fn longest_s(&self) -> f64 {
        let ends = self.repeats.iter().flat_map(|repeat| {
            repeat.runs.iter().filter_map(|run| {
                let of_run = repeat.samples.get(run.samples.clone())?;
                let (first, last) = (of_run.first()?, of_run.last()?);
                Some(last.elapsed_s() - first.elapsed_s())
            })
        });
        ends.fold(1.0, f64::max)
    }

    /// How many samples.
    pub fn samples(&self) -> usize {
        self.repeats.iter().map(|repeat| repeat.samples.len()).sum()
    }

    /// Repeat and run of every run, in order.
    pub fn runs(&self) -> impl Iterator<Item = (usize, usize)> {
        let of_repeat = |(index, repeat): (usize, &Repeat)| {
            (0..repeat.runs.len()).map(move |run| (index, run)).collect::<Vec<_>>()
        };
        self.repeats.iter().enumerate().flat_map(of_repeat)
    }

    /// Sum of squares of what the model leaves, mm².
    pub fn model_mm2(&self) -> f64 {
        self.model_mm.iter().map(|of_repeat| dot(of_repeat, of_repeat)).sum()
    }

    /// Root of the mean square over all samples, mm, of a sum of squares.
    pub fn rms_mm(&self, squares_mm2: f64) -> f64 {
        (squares_mm2 / self.samples().max(1) as f64).sqrt()
    }

    /// Zero at every sample.
    pub fn zeros(&self) -> Column {
        self.repeats.iter().map(|repeat| vec![0.0; repeat.samples.len()]).collect()
    }

    /// A column without its part in what the fits follow.
    pub fn outside(&self, column: &Column) -> Column {
        let repeats = column.par_iter().zip(&self.repeats);
        let outside: Vec<_> = repeats.map(|(c, repeat)| repeat.basis.outside(c)).collect();
        Column::from(outside)
    }
}

impl Repeat {
    /// The samples of each arc, and how far they are apart, s; 0 where an arc has but one.
    pub(super) fn arcs(&self) -> Vec<(Range<usize>, f64)> {
        let mut arcs = Vec::new();
        for run in self.runs.iter().map(|run| &run.samples) {
            let mut first = run.start;
            for of_arc in self.samples[run.clone()].chunk_by(|a, b| a.arc == b.arc) {
                let lasts_s = of_arc[of_arc.len() - 1].elapsed_s() - of_arc[0].elapsed_s();
                arcs.push((first..first + of_arc.len(), lasts_s / of_arc.len() as f64));
                first += of_arc.len();
            }
        }
        arcs
    }

    /// Counts its arcs and its programs on from those of the repeats before.
    fn of(
        identified: &Identification,
        linear: Linearised,
        arcs: &mut usize,
        programs: &mut Vec<Driven>,
    ) -> Self {
        let Linearised { mut samples, basis, factor, deviations } = linear;
        for sample in &mut samples {
            sample.arc += *arcs;
        }
        *arcs = samples.last().map_or(*arcs, |sample| sample.arc + 1);
        let runs = identified.runs.iter().enumerate().map(|(index, run)| {
            let this = Driven::of(run);
            let known = programs.iter().position(|other| other.is(&this));
            let program = known.unwrap_or_else(|| {
                programs.push(this);
                programs.len() - 1
            });
            let first = samples.partition_point(|s| s.run < index);
            Run {
                name: run.name.clone(),
                samples: first..samples.partition_point(|s| s.run <= index),
                program,
                began_sigma_s: run.alignment.began_sigma_s,
            }
        });
        let runs = runs.collect();
        Self { samples, basis, factor, deviations, runs }
    }
}
