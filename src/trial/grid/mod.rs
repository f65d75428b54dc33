//! The grid: every trial a campaign of its own, drawn over tests, machines, rates, motions, runs and noises.
//!
//! What of an effect lies outside of the model is worked out on the same programs and machine, driven as planned, as fast as they
//! really are, and read at most [`STAGE_HZ`] times a second.

mod course;
mod days;
mod factors;
mod table;

use std::collections::BTreeMap;

use super::archive::CampaignFiles;
use super::chance::{Chance, Purpose};
use super::class::Class;
use super::course::Course;
use super::draw::{drawn, outside};
use super::files::{files, hide};
use super::one::{Drawn, Outcome, trial};
use super::request::Request;
use super::session::side_by_side;
use super::stage::Stage;
use crate::error::Result;
use crate::simulate::{Control, Scenario};
use factors::{Driving, Factors};

pub use table::table;

/// Effects are sized on so many readings a second: they go on for longer than the time between two.
const STAGE_HZ: f64 = 50.0;
/// An effect is this size, mm rms, or so many times the noise, whichever is more.
const SIZE_MM: f64 = 1e-3;
const TIMES_NOISE: f64 = 5.0;

/// The grid of a seed.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// Where everything random begins.
    pub seed: u64,
    /// Size of every hidden effect, mm rms outside of the model; `None` for that of its class.
    pub size_mm: Option<f64>,
}

impl Grid {
    /// Does one trial; `keep` its findings. Where no effect of its size can be hidden in what was drawn, it fails.
    pub fn trial(&self, request: Request, keep: bool) -> Outcome {
        let Request { class, index } = request;
        let mut chance = Chance::new(self.seed, class, index, Purpose::Grid);
        let factors = Factors::drawn(&mut chance);
        let outcome = self.outcome(request, &factors, &mut chance, keep);
        let mut outcome = outcome.unwrap_or_else(|error| Outcome::failed(request, error.what));
        outcome.strata = factors.strata();
        outcome
    }

    fn outcome(
        &self,
        request: Request,
        factors: &Factors,
        of_grid: &mut Chance,
        keep: bool,
    ) -> Result<Outcome> {
        let Campaign { course, days, .. } = self.campaign(request, factors, of_grid)?;
        let (stage, drawn) = self.drawn(request, factors, &course, days)?;
        Ok(trial(&stage, &course, drawn, keep))
    }

    /// What is hidden in a campaign, and on what its sizes were worked out.
    fn drawn(
        &self,
        Request { class, index }: Request,
        factors: &Factors,
        course: &Course,
        days: Vec<Scenario>,
    ) -> Result<(Stage, Drawn)> {
        let mut planned = days.clone();
        for day in &mut planned {
            day.control = Control::AS_PLANNED;
            day.sample_rate_hz = day.sample_rate_hz.map(|rate_hz| rate_hz.min(STAGE_HZ));
        }
        let stage = Stage::of(course, planned, true)?;
        let noise_mm = factors.noise_mm();
        let size_mm = self.size_mm.unwrap_or(match class {
            Class::Single | Class::Two | Class::Outside => SIZE_MM.max(TIMES_NOISE * noise_mm),
            _ => class.size_mm(index, noise_mm),
        });
        // Of a cause that is true of the campaign anyway, what was hidden and what was there cannot be judged apart.
        let true_too = true_too(factors);
        let mut causes = if class == Class::Outside { outside() } else { drawn() };
        causes.retain(|cause| !true_too.contains(&cause.id));
        let mut of_effects = Chance::new(self.seed, class, index, Purpose::Effects);
        let hidden = stage.drawn(course, &causes, class.effects(), size_mm, &mut of_effects)?;
        Ok((stage, Drawn { class, index, size_mm, hidden, days, true_too }))
    }

    fn campaign(
        &self,
        Request { class, index }: Request,
        factors: &Factors,
        of_grid: &mut Chance,
    ) -> Result<Campaign> {
        let (course, test_toml) = course::course(factors, of_grid)?;
        let mut of_days = Chance::new(self.seed, class, index, Purpose::Days);
        let days = days::days(&course, factors, &mut of_days);
        Ok(Campaign { course, test_toml, days })
    }

    /// A trial as if it had been measured: machine, test, programs, logs, and what is true.
    ///
    /// # Errors
    /// When no effect of its size can be hidden.
    pub fn files(&self, request: Request) -> Result<CampaignFiles> {
        let mut chance = Chance::new(self.seed, request.class, request.index, Purpose::Grid);
        let factors = Factors::drawn(&mut chance);
        let Campaign { course, test_toml, mut days } =
            self.campaign(request, &factors, &mut chance)?;
        let (mut size_mm, mut hidden) = (0.0, Vec::new());
        if request.class != Class::None {
            let drawn = self.drawn(request, &factors, &course, days)?.1;
            size_mm = drawn.size_mm;
            days = drawn.days;
            hidden = hide(drawn.hidden, &mut days)?;
        }
        let files = files(&course, &test_toml, course::machine_toml(factors.make), &days)?;
        Ok(CampaignFiles { request, size_mm, hidden, strata: factors.strata(), files })
    }

    /// The campaigns of trials as files, handed to `taken` as they are made: where nothing of its size can be hidden, the
    /// error of it. What it made of them stands in the order of the requests.
    ///
    /// # Errors
    /// What `taken` fails with.
    pub fn campaigns<T: Send>(
        &self,
        requests: &[Request],
        taken: &(dyn Fn(Request, Result<CampaignFiles>) -> Result<T> + Sync),
    ) -> Result<Vec<T>> {
        side_by_side(requests, &|request| taken(request, self.files(request)), &|_| ())
    }

    /// Does trials, as many at a time as there are threads; `finished` is called after each.
    ///
    /// # Errors
    /// When there are no threads.
    pub fn run(
        &self,
        requests: &[Request],
        finished: &(dyn Fn(&Outcome) + Sync),
    ) -> Result<Vec<Outcome>> {
        side_by_side(requests, &|request| Ok(self.trial(request, false)), finished)
    }
}

/// What a trial measures.
struct Campaign {
    course: Course,
    test_toml: String,
    days: Vec<Scenario>,
}

/// Causes that are true of the campaign though they were not hidden: nobody says that they must be found.
fn true_too(factors: &Factors) -> Vec<&'static str> {
    let mut causes = Vec::new();
    if matches!(factors.driving, Driving::FollowingUnlike(..)) {
        causes.push("servo");
    }
    if !factors.feed_is_stated() {
        causes.push("feed-override");
    }
    causes
}

/// Outcomes by factor and value.
fn by_stratum<'a>(outcomes: &[&'a Outcome]) -> BTreeMap<(&'static str, &'a str), Vec<&'a Outcome>> {
    let mut strata: BTreeMap<_, Vec<&Outcome>> = BTreeMap::new();
    for &outcome in outcomes {
        for (factor, value) in &outcome.strata {
            strata.entry((*factor, value.as_str())).or_default().push(outcome);
        }
    }
    strata
}
