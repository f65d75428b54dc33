//! Many trials, side by side.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use super::archive::CampaignFiles;
use super::chance::{Chance, Purpose};
use super::class::Class;
use super::course::Course;
use super::days::{NOISE, days};
use super::draw::{drawn, outside};
use super::files::{files, hide};
use super::one::{Drawn, Outcome, trial};
use super::request::Request;
use super::stage::Stage;
use crate::error::{Error, Kind, Result};

/// A course made ready for trials.
pub struct Session {
    course: Course,
    stage: Stage,
    seed: u64,
    size_mm: Option<f64>,
}

impl Session {
    /// Makes a course ready; every hidden effect has the given size (mm rms outside of the model) where
    /// one is given, else that of its class.
    ///
    /// # Errors
    /// When the campaign cannot be simulated and identified with nothing hidden.
    pub fn new(course: Course, seed: u64, size_mm: Option<f64>) -> Result<Self> {
        let stage = Stage::new(&course)?;
        Ok(Self { course, stage, seed, size_mm })
    }

    /// Standard deviation of a reading's noise, mm.
    pub fn noise_mm(&self) -> f64 {
        NOISE.sigma_mm()
    }

    fn drawn(&self, request: Request) -> Result<Drawn> {
        let Request { class, index } = request;
        let size_mm = self.size_mm.unwrap_or_else(|| class.size_mm(index, NOISE.sigma_mm()));
        let mut chance = Chance::new(self.seed, class, index, Purpose::Effects);
        let causes = if class == Class::Outside { outside() } else { drawn() };
        let hidden =
            self.stage.drawn(&self.course, &causes, class.effects(), size_mm, &mut chance)?;
        let days = days(&self.course, &mut Chance::new(self.seed, class, index, Purpose::Days));
        Ok(Drawn { class, index, size_mm, hidden, days, true_too: Vec::new() })
    }

    /// Does one trial, with its diagnosis kept.
    ///
    /// # Errors
    /// When no effect of its size can be hidden.
    pub fn replay(&self, request: Request) -> Result<Outcome> {
        Ok(trial(&self.stage, &self.course, self.drawn(request)?, true))
    }

    /// Does trials, as many at a time as there are threads, each on one of them; `finished` is called after
    /// each. The outcomes stand in the order of the requests.
    ///
    /// # Errors
    /// When no effect of the size can be hidden.
    pub fn run(
        &self,
        requests: &[Request],
        finished: &(dyn Fn(&Outcome) + Sync),
    ) -> Result<Vec<Outcome>> {
        let one = |request| Ok(trial(&self.stage, &self.course, self.drawn(request)?, false));
        side_by_side(requests, &one, finished)
    }

    /// The campaigns of trials as files, handed to `taken` as they are made: where nothing of its size can be hidden, the
    /// error of it. What it made of them stands in the order of the requests.
    ///
    /// # Errors
    /// When the course is not the built-in one, and what `taken` fails with.
    pub fn campaigns<T: Send>(
        &self,
        requests: &[Request],
        taken: &(dyn Fn(Request, Result<CampaignFiles>) -> Result<T> + Sync),
    ) -> Result<Vec<T>> {
        let texts = self.course.texts.ok_or_else(|| {
            Error::input("only campaigns of the built-in test are written as files")
                .hint("`ballbar simulate TEST --hide EFFECT` writes logs of a test of yours")
        })?;
        let made = |request| {
            let Drawn { size_mm, hidden, mut days, .. } = self.drawn(request)?;
            let hidden = hide(hidden, &mut days)?;
            let files = files(&self.course, texts.test_toml, texts.machine_toml, &days)?;
            Ok(CampaignFiles { request, size_mm, hidden, strata: Vec::new(), files })
        };
        side_by_side(requests, &|request| taken(request, made(request)), &|_| ())
    }
}

/// Trials side by side, as many as there are threads, each on one of them; the outcomes stand in the order of the
/// requests.
pub(super) fn side_by_side<T: Send>(
    requests: &[Request],
    one: &(dyn Fn(Request) -> Result<T> + Sync),
    finished: &(dyn Fn(&T) + Sync),
) -> Result<Vec<T>> {
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    let threads = rayon::current_num_threads().min(requests.len()).max(1);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let (sender, next) = (sender.clone(), &next);
            scope.spawn(move || {
                // Threads that share trials would take up one inside of another.
                let pool = match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
                    Ok(pool) => pool,
                    Err(error) => {
                        let error = Error::new(Kind::Output, format!("no thread: {error}"));
                        let _ = sender.send((0, Err(error)));
                        return;
                    }
                };
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(&request) = requests.get(index) else { return };
                    let outcome = pool.install(|| one(request));
                    if let Ok(outcome) = &outcome {
                        finished(outcome);
                    }
                    let _ = sender.send((index, outcome));
                }
            });
        }
    });
    drop(sender);
    let mut outcomes: Vec<(usize, Result<T>)> = receiver.into_iter().collect();
    outcomes.sort_by_key(|(index, _)| *index);
    outcomes.into_iter().map(|(_, outcome)| outcome).collect()
}
