//! What a test is made of: the instrument, the mountings, the path, the identification, the runs.

use std::path::PathBuf;

use super::arc::Arc;
use super::strategy::Strategy;
use crate::machine::Mounting;
use crate::model::{COMPLETE, Empirical, LOCAL, ModelFile};
use crate::solve::Loss;

/// The instrument.
#[derive(Debug, Clone, PartialEq)]
pub struct BallBar {
    /// Nominal length, mm; see [`Test::bar_of`](super::Test::bar_of) for that of a mounting.
    pub length_mm: f64,
    /// It reads up to this much either way and nothing beyond, mm.
    pub range_mm: f64,
    /// Smallest step of a reading, mm.
    pub resolution_mm: f64,
    /// Standard deviation of one reading, mm.
    pub noise_mm: f64,
    /// Standard deviation of that part of the noise which is correlated from one reading to the next,
    /// mm; 0 where all of it is white.
    pub correlated_mm: f64,
    /// Time in which its correlation falls to 1/e, s.
    pub correlation_s: f64,
    /// Samples a second.
    pub sample_rate_hz: f64,
    /// How far its clock may run fast or slow, as a share of 1.
    pub clock_tolerance: f64,
}

/// A mounting and its name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedMounting {
    /// The name.
    pub name: String,
    /// Where the balls are.
    pub mounting: Mounting,
    /// The work offset whose zero is the workpiece ball: 54 for G54.
    pub work_offset: u8,
    /// Nominal length of the bar between the balls, mm.
    pub bar_length_mm: f64,
}

/// An arc of a test file, and the mountings, by their indices, that drive it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FreeArc {
    pub(super) arc: Arc,
    pub(super) mountings: Vec<usize>,
}

/// How the path is driven.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPlan {
    pub(super) strategy: Option<Strategy>,
    pub(super) free_arcs: Vec<FreeArc>,
    /// Feed on the arcs, mm/s.
    pub feed_mm_s: f64,
    /// Largest sagitta of a chord, mm.
    pub chord_sag_mm: f64,
    /// Dwell between arcs, s.
    pub dwell_s: f64,
    /// Dwell before the feed-in and after the feed-out, s.
    pub settle_s: f64,
    /// Length of the radial feed-in and feed-out, mm; longer than the bar's range.
    pub feed_in_mm: f64,
    /// Drive every arc forward and backward.
    pub both_directions: bool,
    /// M00 instead of a dwell after every arc.
    pub stop_between_arcs: bool,
    /// Program number of the first mounting; the next mountings count on.
    pub program_number: u32,
}

impl PathPlan {
    /// The arcs of a mounting, by its index, in forward sense: those of the strategy, then the free ones.
    ///
    /// An arc that is listed again has a number behind its name: program and report tell the two apart.
    pub fn arcs(&self, mounting: usize) -> Vec<Arc> {
        let free = self.free_arcs.iter().filter(|free| free.mountings.contains(&mounting));
        let of_strategy = self.strategy.map_or_else(Vec::new, Strategy::arcs);
        let mut arcs: Vec<Arc> = Vec::new();
        for mut arc in of_strategy.into_iter().chain(free.map(|free| free.arc.clone())) {
            let taken = |name: &str| arcs.iter().any(|before| before.name == name);
            if taken(&arc.name) {
                let mut numbered = (2..).map(|pass| format!("{} {pass}", arc.name));
                arc.name = numbered.find(|name| !taken(name)).unwrap_or_default();
            }
            arcs.push(arc);
        }
        arcs
    }

    /// What the strategy is called.
    pub fn strategy_name(&self) -> &'static str {
        self.strategy.map_or("free", Strategy::name)
    }
}

/// What the identification does unless the command line says otherwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimation {
    /// Names of sets and of terms; see [`crate::model::terms`].
    pub terms: Vec<String>,
    /// How far-off samples are weighted.
    pub loss: Loss,
    /// Take the shortest of all solutions where the terms are confounded, instead of refusing.
    pub minimum_norm: bool,
    /// Curves that are held beside the terms, with their values at the knots.
    pub curves: Vec<(Empirical, Vec<f64>)>,
}

impl Estimation {
    /// Whether the machine is described where it is measured.
    pub fn is_local(&self) -> bool {
        self.terms.iter().any(|name| name == LOCAL)
    }

    /// The terms as coefficients of the paper: where the machine is described where it is measured, all that the test
    /// can tell apart.
    pub fn coefficients(&self) -> Vec<String> {
        if self.is_local() { vec![COMPLETE.to_owned()] } else { self.terms.clone() }
    }

    /// Takes the terms and the curves of a model file instead.
    pub fn take(&mut self, model: &ModelFile) {
        self.terms.clone_from(&model.terms);
        self.curves.clone_from(&model.curves);
    }
}

/// One measured run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What it is called: the log's file name without its ending.
    pub name: String,
    /// The program that ran.
    pub program: PathBuf,
    /// The log.
    pub log: PathBuf,
    /// Index of the mounting.
    pub mounting: usize,
    /// Where the override knob stood, as a share of 1.
    pub feed_override: f64,
    /// Runs of the same repeat are identified together.
    pub repeat: u32,
    /// Line of the test file where the run begins.
    pub line: usize,
}
