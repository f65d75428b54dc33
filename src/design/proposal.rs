//! From a request to a test: the problem is put, solved, and its time held against the real programs.

use rayon::prelude::*;

use super::candidates::{SetUpCandidate, candidate_arcs, set_up_candidates};
use super::choosable::{basis, drivable, excluded, volume_mm};
use super::given::Measured;
use super::information::{ArcInformation, Basis};
use super::ordering;
use super::planned::PlannedProgram;
use super::problem::{Chosen, Objective, Problem};
use super::proposed::ProposedSetUp;
use super::volume::Volume;
use super::written;
use crate::error::{Error, Kind, Place, Result};
use crate::identify;
use crate::machine::Machine;
use crate::model::{COMPLETE, Coefficient};
use crate::plan::{Arc, BAR_STOPS, Criterion, DesignRequest, Test};
use crate::solve::Matrix;

/// Points an axis over the volume: for the mean, and for the worst point.
const MEAN_STEPS: usize = 5;
const WORST_STEPS: usize = 3;
/// From one arc to the next on the sphere, on average, rad, until the real ways are known.
const TRANSIT_RAD: f64 = 0.6;
/// Approach and release take about this, s, until the real programs are known.
const APPROACH_S: f64 = 12.0;
/// So often the budget is corrected by what the real programs take.
const CORRECTIONS: usize = 4;
/// While it is corrected, so many gains are looked at.
const CORRECTED_LOOKS: usize = 8_000;
/// Spare time that another search is not worth, s.
const LITTLE_S: f64 = 20.0;
/// So many of the best next arcs are told.
const NEXT: usize = 5;

/// An arc that would tell most next.
#[derive(Debug, Clone, PartialEq)]
pub struct NextArc {
    /// The set-up that it is driven in.
    pub set_up: String,
    /// Its name.
    pub arc: String,
    /// What it takes, with the set-up if that is new, s.
    pub seconds: f64,
    /// The criterion after it; see [`Proposal::value`].
    pub value: f64,
}

/// A designed test.
#[derive(Debug, Clone)]
pub struct Proposal {
    /// Set-ups in the order in which an operator would make them.
    pub set_ups: Vec<ProposedSetUp>,
    /// How many set-ups and arcs there were to choose from.
    pub candidates: [usize; 2],
    /// The coefficients that are estimated.
    pub basis: Vec<Coefficient>,
    /// Those of them that are wanted.
    pub wanted: Vec<Coefficient>,
    /// The criterion before the test and after: for A and G the standard deviation of the volumetric
    /// error, rms or worst, mm; for D the mean logarithm of what is left of the size of a coefficient.
    pub value: [f64; 2],
    /// No test of the same set-ups, candidate arcs and time has a lower criterion than this.
    pub bound: f64,
    /// Time of the test, the operator's included, s.
    pub total_s: f64,
    /// Text of the test file.
    pub text: String,
    /// After measurements: what would tell most next, the best first.
    pub next: Vec<NextArc>,
}

/// A request with everything that there is to choose from.
pub struct Designer<'a> {
    test: &'a Test,
    machine: &'a Machine,
    request: &'a DesignRequest,
    set_ups: Vec<SetUpCandidate>,
    arcs: Vec<Arc>,
    basis: Basis,
    wanted: Vec<Coefficient>,
    problem: Problem,
}

impl<'a> Designer<'a> {
    /// Gathers the candidates and what each of them tells.
    ///
    /// # Errors
    /// A mounting outside the travel, a bar longer than the space, a wanted coefficient that no candidate
    /// can see.
    pub fn new(test: &'a Test, machine: &'a Machine, measured: Option<&Measured>) -> Result<Self> {
        let request = test.design()?;
        let plan = test.plan()?;
        if !plan.both_directions {
            return Err(Error::input("a designed test drives every arc both ways")
                .at(Place::file(test.file()))
                .hint("take `both_directions = false` out of `[plan]`"));
        }
        let [feed_mm_s] = plan.feeds_mm_s[..] else {
            return Err(Error::input("a designed test is driven at one feed")
                .at(Place::file(test.file()))
                .hint("write one number as `feed_mm_min`; the test that comes out may be driven at others, too"));
        };
        let arcs = candidate_arcs(request.step_rad);
        let set_ups = set_up_candidates(test, request, machine)?;
        let drivable = drivable(test, machine, &set_ups, &arcs, plan.feed_in_mm)?;
        let (basis, wanted) = basis(test, request, machine, &set_ups, &arcs, &drivable)?;
        let first = &test.mountings()[0].mounting;
        let range_mm = volume_mm(test, request, machine)?;
        let bar = test.ball_bar();
        // As it was found, where something was measured, or as it is stated.
        let variance_mm2 = match measured {
            Some(measured) => measured.variance_mm2(),
            None => identify::stated_noise(bar).long_run_variance(),
        };
        let mut of_arcs: Vec<ArcInformation> = drivable
            .par_iter()
            .map(|&(set_up, arc)| {
                let bar_mm = set_ups[set_up].bar_mm;
                let circle_mm = arcs[arc].circle_radius_mm(bar_mm) * arcs[arc].sweep_rad.abs();
                let moving_mm = 2.0 * circle_mm + TRANSIT_RAD * bar_mm;
                ArcInformation {
                    set_up,
                    arc,
                    seconds: moving_mm / feed_mm_s + 3.0 * plan.dwell_s,
                    factor: basis.information(
                        machine,
                        &set_ups[set_up],
                        &arcs[arc],
                        bar.sample_rate_hz,
                        feed_mm_s,
                        variance_mm2,
                    ),
                }
            })
            .collect();
        of_arcs.sort_by_key(|arc| (arc.set_up, arc.arc));
        let operator = test.operator();
        let mounted = measured.and_then(Measured::mounted);
        let set_up_s = set_ups
            .iter()
            .map(|set_up| {
                // Balls that are still where they were need nobody to place them.
                let stays =
                    mounted.is_some_and(|name| set_up.given.is_some() && set_up.name == name);
                let placing_s = if stays { 0.0 } else { operator.set_up_s };
                placing_s + operator.fit_bar_s + APPROACH_S
            })
            .collect();
        let mut known = Matrix::identity(basis.coefficients.len());
        if let Some(measured) = measured {
            measured.belongs_to(machine)?;
            measured.add_to(&mut known, &basis, machine)?;
        }
        let is_wanted = |k: usize| wanted.contains(&basis.coefficients[k]);
        let fields = |steps: usize| {
            let mut volume = Volume::new(machine, first, range_mm, steps, &basis.coefficients);
            // What is not wanted counts for nothing.
            let sizes = basis.sizes.iter().enumerate();
            let counted: Vec<f64> =
                sizes.map(|(k, &size)| if is_wanted(k) { size } else { 0.0 }).collect();
            volume.scale(&counted);
            volume
        };
        let objective = Objective {
            criterion: request.criterion,
            wanted: (0..basis.coefficients.len()).filter(|&k| is_wanted(k)).collect(),
            mean_square: fields(MEAN_STEPS).mean_square(),
            points: match request.criterion {
                Criterion::G => {
                    let volume = fields(WORST_STEPS);
                    (0..volume.points()).map(|point| volume.rows_at(point)).collect()
                }
                _ => Vec::new(),
            },
        };
        let problem = Problem {
            coefficients: basis.coefficients.len(),
            objective,
            arcs: of_arcs,
            set_up_s,
            known,
            most_set_ups: request.most_mountings,
        };
        Ok(Self { test, machine, request, set_ups, arcs, basis, wanted, problem })
    }

    /// Number of candidate set-ups and of candidate arcs that can be driven in one or another of them.
    pub fn candidates(&self) -> [usize; 2] {
        [self.set_ups.len(), self.problem.arcs.len()]
    }

    /// Number of coefficients that the candidates can tell apart.
    #[cfg(test)]
    pub(super) fn told_apart(&self) -> usize {
        self.basis.coefficients.len()
    }

    /// How often [`propose`](Self::propose) says at the most that a choice is made.
    pub const CHOICES: usize = CORRECTIONS;

    /// The best test that fits into the budget; `step` is called after each choice.
    ///
    /// # Errors
    /// When the budget is shorter than the shortest test.
    pub fn propose(&self, step: &dyn Fn()) -> Result<Proposal> {
        let budget_s = self.request.budget_s;
        let mut asked_s = budget_s;
        let mut found = self.problem.solve(asked_s);
        let mut best: Option<(Chosen, Vec<ProposedSetUp>, f64, String)> = None;
        let mut least_s = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            step();
            let Some(chosen) = found.filter(|chosen| !chosen.arcs.is_empty()) else { break };
            let set_ups = ordering::ordered(&chosen, &self.problem.arcs, &self.set_ups, &self.arcs);
            let text = written::test_file(self.test, &set_ups, &self.terms())?;
            let total_s = self.total_s(&text)?;
            least_s = least_s.min(total_s);
            let spare_s = budget_s - total_s;
            let better = best.as_ref().is_none_or(|(b, ..)| chosen.value < b.value);
            // A set-up that no arc fell to is not made, and its time belongs to the others.
            let driven = |set_up: &&usize| {
                chosen.arcs.iter().any(|&arc| self.problem.arcs[arc].set_up == **set_up)
            };
            let of_set_ups: Vec<usize> = chosen.set_ups.iter().filter(driven).copied().collect();
            if spare_s >= 0.0 && better {
                best = Some((chosen, set_ups, total_s, text));
            }
            if (0.0..LITTLE_S).contains(&spare_s) {
                break;
            }
            asked_s += if spare_s >= 0.0 { 0.9 * spare_s } else { 1.05 * spare_s };
            found = Some(self.problem.fill(&of_set_ups, asked_s, CORRECTED_LOOKS));
        }
        let (chosen, set_ups, total_s, text) = best.ok_or_else(|| self.nothing_fits(least_s))?;
        Ok(Proposal {
            set_ups,
            candidates: self.candidates(),
            wanted: self.wanted.clone(),
            basis: self.basis.coefficients.clone(),
            value: [self.problem.value_before(), chosen.value].map(|value| self.told(value)),
            bound: self.told(chosen.bound),
            total_s,
            text,
            next: Vec::new(),
        })
    }

    /// What would tell most next.
    pub fn next(&self) -> Vec<NextArc> {
        let next = self.problem.next_arcs().into_iter().take(NEXT);
        next.map(|(index, value)| {
            let arc = &self.problem.arcs[index];
            NextArc {
                set_up: self.set_ups[arc.set_up].name.clone(),
                arc: self.arcs[arc.arc].name.clone(),
                seconds: self.problem.set_up_s[arc.set_up] + arc.seconds,
                value: self.told(value),
            }
        })
        .collect()
    }

    /// The criterion as people read it.
    fn told(&self, value: f64) -> f64 {
        match self.request.criterion {
            Criterion::A | Criterion::G => value.max(0.0).sqrt(),
            Criterion::D => 0.5 * value / self.wanted.len() as f64,
        }
    }

    /// The terms of the test file: the same set as that of the design.
    fn terms(&self) -> Vec<String> {
        std::iter::once(COMPLETE.to_owned()).chain(excluded(self.request)).collect()
    }

    /// Time of the test by its real programs, s.
    fn total_s(&self, text: &str) -> Result<f64> {
        let test = Test::parse(text, self.test.file())?;
        let operator = test.operator();
        let times: Vec<Result<f64>> = (0..test.mountings().len())
            .into_par_iter()
            .map(|mounting| {
                let program = PlannedProgram::new(&test, self.machine, mounting)?;
                let time = program.trajectory.duration();
                let between = time.stops.saturating_sub(BAR_STOPS) as f64;
                Ok(time.known_s()
                    + operator.set_up_s
                    + operator.fit_bar_s
                    + between * operator.stop_s)
            })
            .collect();
        times.into_iter().sum()
    }

    /// Why there is no test; `least_s` is what the shortest takes that was found, s.
    pub(super) fn nothing_fits(&self, least_s: f64) -> Error {
        let budget_s = self.request.budget_s;
        let operator = self.test.operator();
        let shortest_s = if least_s.is_finite() { least_s } else { self.problem.shortest_s() };
        let error = if shortest_s > budget_s {
            Error::new(
                Kind::Undetermined,
                format!(
                    "a budget of {:.1} min is shorter than the shortest test of {:.1} min, of which the operator takes {:.1} min",
                    budget_s / 60.0,
                    shortest_s / 60.0,
                    (operator.set_up_s + operator.fit_bar_s) / 60.0
                ),
            )
            .hint("give more time, or say in `[operator]` that he is faster")
        } else {
            Error::new(
                Kind::Undetermined,
                format!(
                    "within {:.1} min no arc tells anything about what is wanted, with readings of a standard deviation of {} um",
                    budget_s / 60.0,
                    crate::toml_text::short(self.test.ball_bar().noise_mm * 1e3)
                ),
            )
            .hint("check `noise_um` in `[ball_bar]`, and `wanted`")
        };
        error.at(Place::file(self.test.file()))
    }
}
