//! Everything about a test that can be said before it is run.

use rayon::prelude::*;

use super::information::SET_UP_MM;
use super::planned::PlannedProgram;
use super::volume::{Volume, VolumeSigma, of_coefficients};
use crate::error::{Error, Result};
use crate::identify::{
    self, Answer, Driven, Gather, Options, POINTS, Prediction, RunInput, SEEN_UM, Sight,
};
use crate::machine::{Axis, Machine, Mounting};
use crate::model::{self, COMPLETE, Coefficient, Model, Parameter};
use crate::plan::{BAR_STOPS, BallBar, LeastClearance, NamedMounting, Operator, Test};
use crate::solve::NullDirection;

/// Points an axis of the grid over the working volume.
const VOLUME_STEPS: usize = 7;

/// Time by kind, s. What the operator takes is the test file's assumption; the rest is the machine's.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TimeByKind {
    /// On the arcs.
    pub arcs_s: f64,
    /// On the sphere from one arc to the next.
    pub transits_s: f64,
    /// At feed elsewhere: approach, engagement, release.
    pub other_feed_s: f64,
    /// In dwells.
    pub dwell_s: f64,
    /// At rapid traverse.
    pub rapid_s: f64,
    /// Assumed for the operator: placing the balls, fitting the bar, pressing start.
    pub operator_s: f64,
    /// How often the program waits for him.
    pub stops: usize,
}

impl TimeByKind {
    /// What the machine takes, s.
    pub fn machine_s(&self) -> f64 {
        self.arcs_s + self.transits_s + self.other_feed_s + self.dwell_s + self.rapid_s
    }

    /// All of it, s.
    pub fn total_s(&self) -> f64 {
        self.machine_s() + self.operator_s
    }

    fn plus(self, other: &Self) -> Self {
        Self {
            arcs_s: self.arcs_s + other.arcs_s,
            transits_s: self.transits_s + other.transits_s,
            other_feed_s: self.other_feed_s + other.other_feed_s,
            dwell_s: self.dwell_s + other.dwell_s,
            rapid_s: self.rapid_s + other.rapid_s,
            operator_s: self.operator_s + other.operator_s,
            stops: self.stops + other.stops,
        }
    }
}

/// One mounting of a test.
#[derive(Debug, Clone)]
pub struct MountingOutlook {
    /// The mounting.
    pub named: NamedMounting,
    /// Its program.
    pub program: PlannedProgram,
    /// Length of the path on arcs, mm.
    pub arcs_mm: f64,
    /// Length of the path from one arc to the next, mm.
    pub transits_mm: f64,
    /// Time by kind.
    pub time: TimeByKind,
    /// Samples on arcs.
    pub samples: usize,
    /// Lowest and highest machine coordinate of X, Y and Z on the path, mm.
    pub used_mm: [[f64; 2]; 3],
    /// How near the bodies behind the balls come to each other; `None` where the machine file does not
    /// name them.
    pub clearance: Option<LeastClearance>,
}

/// Something that a test cannot tell, and what would.
#[derive(Debug, Clone, PartialEq)]
pub struct Unseen {
    /// The term that was left out, or the first of the group.
    pub name: String,
    /// How it is confounded, in words.
    pub reason: String,
    /// What would separate it, from little trouble to much; empty where nothing that was tried does.
    pub remedies: Vec<String>,
}

/// What a test is, what it takes and what it will see.
#[derive(Debug)]
pub struct Outlook {
    /// The test's name.
    pub name: String,
    /// `3d6`, or `free`.
    pub strategy: &'static str,
    /// Feeds on the arcs, mm/s.
    pub feeds_mm_s: Vec<f64>,
    /// The instrument.
    pub bar: BallBar,
    /// What is assumed of the operator.
    pub operator: Operator,
    /// The mountings.
    pub mountings: Vec<MountingOutlook>,
    /// What it will know of what people ask, where the machine is described where it is measured.
    pub at_the_place: Vec<Answer>,
    /// The terms that will be estimated; where the machine is described where it is measured, all that can be told apart.
    pub terms: Vec<String>,
    /// Whether they were chosen for this test (`complete`) rather than named.
    pub chosen: bool,
    /// Rank of the chosen terms on ideal arcs.
    pub ideal_rank: usize,
    /// Terms that were left out of a complete set, or groups among the named terms.
    pub unseen: Vec<Unseen>,
    /// How well the terms will be known.
    pub prediction: Prediction,
    /// Standard deviation over the working volume that the noise makes, by the chosen terms.
    pub volume_noise: VolumeSigma,
    /// What the test leaves unknown of the volumetric error: the standard deviation over the working
    /// volume if every coefficient may displace the tool by [`unknown_mm`](Self::unknown_mm).
    pub volume_unseen: VolumeSigma,
    /// Root mean square displacement over the working volume that any one coefficient is trusted with
    /// beforehand, mm.
    pub unknown_mm: f64,
}

impl Outlook {
    /// Rehearses a test and looks at what it will give.
    ///
    /// # Errors
    /// When the test has no plan, leaves the travel or does not engage; an unknown term.
    pub fn new(test: &Test, machine: &Machine) -> Result<Self> {
        Self::watched(test, machine, &|| ())
    }

    /// How often [`watched`](Self::watched) calls back.
    pub fn steps(test: &Test) -> usize {
        test.mountings().len() + 2
    }

    /// The same, with a call after every step that takes a while.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn watched(test: &Test, machine: &Machine, step: &(dyn Fn() + Sync)) -> Result<Self> {
        let programs: Vec<Result<(PlannedProgram, RunInput)>> = (0..test.mountings().len())
            .into_par_iter()
            .map(|mounting| {
                let planned = PlannedProgram::new(test, machine, mounting)?;
                let (bar, named) = (test.bar_of(mounting), &test.mountings()[mounting]);
                let run = identify::rehearse(&planned.program, machine, &bar, mounting, named)?;
                step();
                Ok((planned, run))
            })
            .collect();
        let (programs, runs): (Vec<PlannedProgram>, Vec<RunInput>) =
            programs.into_iter().collect::<Result<Vec<_>>>()?.into_iter().unzip();

        let options = Options::of(test);
        let places: Vec<(String, Mounting)> =
            test.mountings().iter().map(|m| (m.name.clone(), m.mounting)).collect();
        let names: Vec<String> = places.iter().map(|(name, _)| name.clone()).collect();
        let balls: Vec<Mounting> = places.iter().map(|(_, mounting)| *mounting).collect();
        let wanted = test.estimation().coefficients();
        let (terms, runs) = identify::explicit_terms(&wanted, machine, &places, runs, &options)?;
        let chosen = wanted.iter().any(|name| name == COMPLETE);
        let mountings: Vec<MountingOutlook> = programs
            .into_iter()
            .zip(&runs)
            .map(|(program, run)| MountingOutlook::new(test, machine, program, run))
            .collect();

        let model = Model::new(machine, balls.clone(), model::terms(&terms, &names)?);
        let noise = identify::stated_noise(test.ball_bar());
        let prediction = identify::predict(&model, runs.clone(), &options, &noise)?;
        step();
        let at_the_place = if test.estimation().is_local() {
            identify::foresee(test, machine, runs.clone(), &options, &noise)?
        } else {
            Vec::new()
        };
        let (ideal_rank, unseen) = unseen(test, machine, &model, chosen)?;
        step();

        let all: Vec<Coefficient> = Coefficient::all().collect();
        let volume =
            Volume::new(machine, &balls[0], Volume::travel_mm(machine), VOLUME_STEPS, &all);
        let told: Vec<&str> = prediction.parameters.iter().map(|p| p.name.as_str()).collect();
        let of_noise = of_coefficients(&volume, &told, &prediction.covariance);
        let unknown_mm = SEEN_UM * 1e-3;
        let of_unseen = unknown(machine, &balls, &names, runs, &options, &noise, &volume)?;
        let plan = test.plan()?;
        Ok(Self {
            name: test.name().to_owned(),
            strategy: plan.strategy_name(),
            feeds_mm_s: plan.feeds_mm_s.clone(),
            bar: test.ball_bar().clone(),
            operator: *test.operator(),
            mountings,
            terms: told.iter().map(|&name| name.to_owned()).collect(),
            chosen,
            ideal_rank,
            unseen,
            volume_noise: volume.sigma(&of_noise),
            volume_unseen: volume.sigma(&of_unseen),
            unknown_mm,
            at_the_place,
            prediction,
        })
    }

    /// Time by kind of all mountings.
    pub fn time(&self) -> TimeByKind {
        let times = self.mountings.iter().map(|mounting| &mounting.time);
        times.fold(TimeByKind::default(), TimeByKind::plus)
    }

    /// Number of coefficients and of set-up errors among the terms.
    pub fn term_counts(&self) -> (usize, usize) {
        identify::count(&self.terms)
    }
}

impl MountingOutlook {
    fn new(test: &Test, machine: &Machine, program: PlannedProgram, run: &RunInput) -> Self {
        let named = test.mountings()[program.mounting].clone();
        let (time, lengths_mm) = time_by_kind(test, &program, run);
        let on_arcs = run.samples().iter().filter(|sample| match sample.part {
            crate::align::Part::Arc(section) => !run.alignment.sections[section].transit,
            _ => false,
        });
        let mut used_mm = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for point in program.path.points_below() {
            let at = named.mounting.coincidence_mm + point;
            for axis in Axis::ALL {
                let [low, high] = &mut used_mm[axis.index()];
                *low = low.min(at[axis.index()]);
                *high = high.max(at[axis.index()]);
            }
        }
        Self {
            clearance: program.path.least_clearance(machine),
            arcs_mm: lengths_mm[0],
            transits_mm: lengths_mm[1],
            samples: on_arcs.count(),
            named,
            program,
            time,
            used_mm,
        }
    }
}

/// Time by kind of a program, and the lengths of its arcs and of its transits, mm.
fn time_by_kind(test: &Test, program: &PlannedProgram, run: &RunInput) -> (TimeByKind, [f64; 2]) {
    let total = program.trajectory.duration();
    let (mut time, mut lengths_mm) = (TimeByKind::default(), [0.0; 2]);
    // The sections are the path's arcs and transits, in the same order.
    for (section, leg) in run.alignment.sections.iter().zip(&program.path.legs) {
        let seconds = section.end_s - section.start_s;
        let sphere_mm = test.bar_of(program.mounting).length_mm;
        let arc = leg.driven();
        let length_mm = arc.circle_radius_mm(sphere_mm) * arc.sweep_rad.abs();
        *(if leg.transit { &mut time.transits_s } else { &mut time.arcs_s }) += seconds;
        lengths_mm[usize::from(leg.transit)] += length_mm;
    }
    let operator = test.operator();
    let between = total.stops.saturating_sub(BAR_STOPS) as f64;
    time.operator_s = operator.set_up_s + operator.fit_bar_s + between * operator.stop_s;
    time.other_feed_s = total.feed_s - time.arcs_s - time.transits_s;
    (time.dwell_s, time.rapid_s, time.stops) = (total.dwell_s, total.rapid_s, total.stops);
    (time, lengths_mm)
}

/// What is driven in every mounting.
fn driven(test: &Test) -> Result<Vec<Driven>> {
    let plan = test.plan()?;
    let driven = |(index, named): (usize, &NamedMounting)| Driven {
        mounting: named.mounting,
        bar_mm: named.bar_length_mm,
        arcs: plan.arcs(index),
    };
    Ok(test.mountings().iter().enumerate().map(driven).collect())
}

/// Rank of the terms on ideal arcs, and what cannot be told: the terms that a complete set leaves out, or
/// the groups among named terms.
fn unseen(
    test: &Test,
    machine: &Machine,
    model: &Model,
    chosen: bool,
) -> Result<(usize, Vec<Unseen>)> {
    let driven = driven(test)?;
    let names: Vec<String> = test.mountings().iter().map(|m| m.name.clone()).collect();
    let sight = sight(machine, &driven, &names)?;
    let mut terms: Vec<String> = Vec::new();
    for parameter in model.parameters() {
        // A bare name stands for the set-up errors of all mountings.
        let name = parameter.bare_name();
        if !terms.contains(&name) {
            terms.push(name);
        }
    }
    let rank = sight.rank(&sight.columns(|name| terms.iter().any(|term| term == name)))?;
    let order =
        if chosen { identify::order_of(&test.estimation().coefficients())? } else { terms.clone() };
    let selection = sight.select(&sight.ordered(&order))?;
    let groups: Vec<NullDirection> =
        selection.removed.iter().map(|removal| removal.direction.clone()).collect();
    let remedies = identify::remedies(machine, &driven, &groups, &sight);
    let mut unseen: Vec<Unseen> = selection
        .removed
        .into_iter()
        .zip(remedies)
        .map(|(removal, remedies)| Unseen { name: removal.name, reason: removal.reason, remedies })
        .collect();
    // What ideal arcs tell apart and the noise does not; and the other way round, where a slide that
    // stands still keeps a sense, which ideal arcs do not count.
    if chosen {
        unseen.retain(|unseen| model.parameters().iter().all(|p| p.name != unseen.name));
        let kept = selection.kept.iter().map(|&k| sight.parameter(k));
        let faint = kept.filter(|parameter| !terms.contains(&parameter.bare_name()));
        unseen.extend(faint.map(|Parameter { name, .. }| Unseen {
            name: name.clone(),
            reason: format!("{name} does not stand out of the noise on these arcs"),
            remedies: vec!["more samples or less noise".to_owned()],
        }));
    }
    Ok((rank, unseen))
}

/// All terms on the ideal arcs of mountings with these names.
pub(super) fn sight(machine: &Machine, driven: &[Driven], names: &[String]) -> Result<Sight> {
    let mountings: Vec<Mounting> = driven.iter().map(|driven| driven.mounting).collect();
    let mut gather = Gather::named(machine, &mountings, names, &[])?;
    for (index, driven) in driven.iter().enumerate() {
        gather.drive(index, &driven.arcs, driven.bar_mm, POINTS);
    }
    gather.finish()
}

/// Covariance of all coefficients that is left because the test does not see them.
fn unknown(
    machine: &Machine,
    balls: &[Mounting],
    names: &[String],
    runs: Vec<RunInput>,
    options: &Options,
    noise: &crate::solve::NoiseModel,
    volume: &Volume,
) -> Result<crate::solve::Matrix> {
    let terms =
        model::terms(&["all".to_owned(), "-EXw".into(), "-EYw".into(), "-EZw".into()], names)?;
    let model = Model::new(machine, balls.to_vec(), terms);
    let prior = |name: &str| {
        let mut coefficients = volume.coefficients().iter().zip(volume.sizes());
        let size = coefficients.find(|(c, _)| c.to_string() == name).map(|(_, size)| *size);
        // What does not move the tool at all matters to nobody: any number will do.
        size.map_or(SET_UP_MM, |size| SEEN_UM * 1e-3 / size.max(1e-9))
    };
    let priors: Vec<f64> = model.parameters().iter().map(|p| prior(&p.name)).collect();
    let [_, unseen] = identify::predict_with_prior(&model, runs, options, noise, &priors)?;
    let told: Vec<&str> = model.parameters().iter().map(|p| p.name.as_str()).collect();
    if unseen.diagonal().iter().any(|variance| !variance.is_finite()) {
        return Err(Error::input("the prior leaves a parameter without bounds"));
    }
    Ok(of_coefficients(volume, &told, &unseen))
}
