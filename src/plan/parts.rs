//! What a test is made of: the instrument, the mountings, the path, the identification, the runs.

use std::path::PathBuf;

use super::arc::Arc;
use super::leg::{Interpolation, Leg};
use super::planar::Planar;
use super::plane::Plane;
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
    /// Standard uncertainty of its length, mm; `None` where nothing is stated.
    pub length_sigma_mm: Option<f64>,
    /// Standard uncertainty of the scale of its transducer, as a share of what it reads.
    pub scale_sigma: f64,
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
    pub(super) planar: Option<Planar>,
    pub(super) free_arcs: Vec<FreeArc>,
    /// Feeds on the arcs, mm/s, at least one: every arc is driven at each.
    pub feeds_mm_s: Vec<f64>,
    /// How arcs are written.
    pub interpolation: Interpolation,
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
    /// Feed out and in again between two arcs.
    pub release_between_arcs: bool,
    /// Program number of the first mounting; the next mountings count on.
    pub program_number: u32,
}

impl PathPlan {
    /// The arcs of a mounting, by its index, in forward sense with what is driven beyond them: those of the strategy, then
    /// the free ones.
    pub fn arcs(&self, mounting: usize) -> Vec<Arc> {
        let data = self.data_arcs(mounting).into_iter();
        data.map(|(arc, overshoot_rad)| arc.beyond(overshoot_rad)).collect()
    }

    /// The data arcs, each with its overshoot, rad.
    ///
    /// An arc that is listed again has a number behind its name: program and report tell the two apart.
    fn data_arcs(&self, mounting: usize) -> Vec<(Arc, f64)> {
        let free = self.free_arcs.iter().filter(|free| free.mountings.contains(&mounting));
        let of_sphere = self.strategy.map_or_else(Vec::new, Strategy::arcs).into_iter();
        let of_planes = self.planar.iter().flat_map(Planar::arcs);
        let others = of_sphere.chain(free.map(|free| free.arc.clone())).map(|arc| (arc, 0.0));
        let mut arcs: Vec<(Arc, f64)> = Vec::new();
        for (mut arc, overshoot_rad) in of_planes.chain(others) {
            let taken = |name: &str| arcs.iter().any(|(before, _)| before.name == name);
            if taken(&arc.name) {
                let mut numbered = (2..).map(|pass| format!("{} {pass}", arc.name));
                arc.name = numbered.find(|name| !taken(name)).unwrap_or_default();
            }
            arcs.push((arc, overshoot_rad));
        }
        arcs
    }

    /// The passes of a mounting, by its index, in order: every arc at every feed, there and back.
    pub(super) fn passes(&self, mounting: usize) -> Vec<Leg> {
        let mut passes = Vec::new();
        for (arc, overshoot_rad) in self.data_arcs(mounting) {
            for &feed_mm_s in &self.feeds_mm_s {
                let ways = directions_of_travel(&arc, self.planar.is_some());
                let feed = if self.feeds_mm_s.len() > 1 {
                    format!(" F{}", (feed_mm_s * 6e4).round() / 1e3)
                } else {
                    String::new()
                };
                let [there, back] = ways.map(|way| format!("{}{feed} {way}", arc.name));
                let pass = |arc| Leg { arc, overshoot_rad, feed_mm_s, transit: false };
                passes.push(pass(Arc { name: there, ..arc.clone() }));
                if self.both_directions {
                    passes.push(pass(arc.reversed(&back)));
                }
            }
        }
        passes
    }

    /// The lowest feed, mm/s.
    pub fn slowest_mm_s(&self) -> f64 {
        self.feeds_mm_s.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The highest feed, mm/s.
    pub fn fastest_mm_s(&self) -> f64 {
        self.feeds_mm_s.iter().copied().fold(0.0, f64::max)
    }

    /// What the strategy is called.
    pub fn strategy_name(&self) -> &'static str {
        let planes = self.planar.map(|planar| planar.planes.name());
        planes.or(self.strategy.map(Strategy::name)).unwrap_or("free")
    }
}

/// The two directions of an arc: that of a whole circle or in a coordinate plane is CCW or CW, of another forward or
/// backward.
fn directions_of_travel(arc: &Arc, planes: bool) -> [&'static str; 2] {
    let plane = Plane::of(arc).filter(|_| planes);
    match plane.map(|plane| arc.sweep_rad * arc.normal[plane.normal()] > 0.0) {
        Some(true) => ["CCW", "CW"],
        Some(false) => ["CW", "CCW"],
        None if arc.is_closed() => ["CCW", "CW"],
        None => ["FORWARD", "BACKWARD"],
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
    /// What the control recorded of its motion, in place of the estimate.
    pub motion: Option<PathBuf>,
    /// Index of the mounting.
    pub mounting: usize,
    /// Where the override knob stood, as a share of 1.
    pub feed_override: f64,
    /// Runs of the same repeat are identified together.
    pub repeat: u32,
    /// Line of the test file where the run begins.
    pub line: usize,
}
