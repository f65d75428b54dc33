//! What of an effect the fits of the model leave.
//!
//! A campaign without anything hidden is identified once. On its clock every effect runs through the exact
//! chain; the difference that it makes at the samples of the fits, less what the fits follow, is its trace.

use super::chance::{Chance, Purpose};
use super::class::Class;
use super::course::Course;
use super::days::days;
use super::draw::{self, Reach};
use super::simulated::{measured, simulate_all};
use crate::error::{Error, Kind, Result};
use crate::identify::{Campaign, Failure, Linearised, Options};
use crate::model::{Cause, Effect, Unit};
use crate::simulate::{Noise, Scenario};

/// An effect of which less than this share of its rms lies outside of the model is not hidden.
const SEEN: f64 = 0.03;
/// Effects that would displace anything by more than this are not hidden, mm.
const FARTHEST_MM: f64 = 0.3;
/// Nor those that would turn anything by more, rad.
const STEEPEST_RAD: f64 = 5e-4;
/// A size is right when it is so near, as a share.
const NEAR: f64 = 1e-3;
/// How often an effect of a cause is drawn before another cause is.
const PATIENCE: usize = 40;
/// Two effects of one trial are less alike than this.
const ALIKE: f64 = 0.9;

/// What an effect changes at the samples of a campaign, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Outside of the model, repeat after repeat.
    outside_mm: Vec<f64>,
    /// Share of its rms that lies there.
    share: f64,
    /// Its largest change, of the whole, mm.
    largest_mm: f64,
}

impl Trace {
    /// Root mean square outside of the model, over all samples, mm.
    pub fn rms_mm(&self) -> f64 {
        (self.outside_mm.iter().map(|c| c * c).sum::<f64>() / self.outside_mm.len().max(1) as f64)
            .sqrt()
    }

    /// Share of the rms that lies outside of the model.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Correlation with another trace outside of the model, -1 to 1.
    pub fn correlation(&self, other: &Self) -> f64 {
        let dot = |a: &Self, b: &Self| -> f64 {
            a.outside_mm.iter().zip(&b.outside_mm).map(|(a, b)| a * b).sum()
        };
        let norm = (dot(self, self) * dot(other, other)).sqrt();
        if norm > 0.0 { dot(self, other) / norm } else { 0.0 }
    }
}

/// One repeat.
struct Block {
    linear: Linearised,
    /// Run of the course and index of the reading, for every sample.
    readings: Vec<(usize, usize)>,
}

/// A campaign without anything hidden.
pub(super) struct Stage {
    scenarios: Vec<Scenario>,
    exact_mm: Vec<Vec<f64>>,
    blocks: Vec<Block>,
    pub(super) reach: Reach,
}

impl Stage {
    /// Simulates and identifies the campaign.
    pub(super) fn new(course: &Course) -> Result<Self> {
        Self::of(course, days(course, &mut Chance::new(0, Class::None, 0, Purpose::Days)), false)
    }

    /// The same on these days; effects are drawn `anywhere`, or where people know them.
    pub(super) fn of(
        course: &Course,
        mut scenarios: Vec<Scenario>,
        anywhere: bool,
    ) -> Result<Self> {
        let simulated = simulate_all(course, &scenarios)?;
        let measured = measured(course, &simulated)?;
        let campaign =
            Campaign::of_measured(&course.test, &course.machine, measured, Failure::Refuse)?;
        let model = campaign.model(&course.test, &course.machine, 0)?;
        let options = Options::of(&course.test);
        let rates: Vec<f64> = simulated.iter().map(|run| run.sample_rate_hz).collect();
        let mut reach = Reach {
            travel_mm: [[f64::INFINITY, f64::NEG_INFINITY]; 3],
            elapsed_s: vec![[f64::INFINITY, f64::NEG_INFINITY]; rates.len()],
            anywhere,
        };
        let mut blocks = Vec::new();
        for (of_repeat, repeat) in course.repeats().iter().zip(&campaign.repeats) {
            let linear = repeat.linearised(&model, &options)?;
            let mut readings = Vec::with_capacity(linear.samples.len());
            for sample in &linear.samples {
                let run = of_repeat[sample.run];
                readings.push((run, (sample.log_s * rates[run]).round() as usize));
                let position_mm = &sample.situation.pose.position_mm;
                for (travel, at) in reach.travel_mm.iter_mut().zip(position_mm.iter()) {
                    *travel = [travel[0].min(*at), travel[1].max(*at)];
                }
                let (elapsed, at) = (&mut reach.elapsed_s[run], sample.situation.motion.elapsed_s);
                *elapsed = [elapsed[0].min(at), elapsed[1].max(at)];
            }
            blocks.push(Block { linear, readings });
        }
        let exact_mm =
            simulated.iter().map(|run| run.truth.iter().map(|t| t.exact_mm).collect()).collect();
        for scenario in &mut scenarios {
            scenario.noise = Noise::OFF;
        }
        Ok(Self { scenarios, exact_mm, blocks, reach })
    }

    /// The trace of effects that work together.
    ///
    /// # Errors
    /// When an effect cannot be.
    pub(super) fn trace(&self, course: &Course, effects: &[Effect]) -> Result<Trace> {
        let mut scenarios = self.scenarios.clone();
        for scenario in &mut scenarios {
            for effect in effects {
                scenario.hide(effect.clone())?;
            }
        }
        let changed = simulate_all(course, &scenarios)?;
        let mut outside_mm = Vec::new();
        let (mut squares, mut largest_mm) = (0.0, 0.0_f64);
        for block in &self.blocks {
            let change: Vec<f64> = block
                .readings
                .iter()
                .zip(&block.linear.samples)
                .map(|(&(run, reading), sample)| {
                    let with = changed[run].truth.get(reading).map_or(0.0, |t| t.exact_mm);
                    let without = self.exact_mm[run].get(reading).copied().unwrap_or(0.0);
                    (with - without) * sample.root_weight
                })
                .collect();
            squares += change.iter().map(|c| c * c).sum::<f64>();
            largest_mm = change.iter().fold(largest_mm, |most, c| most.max(c.abs()));
            outside_mm.extend(block.linear.basis.outside(&change));
        }
        let outside: f64 = outside_mm.iter().map(|c| c * c).sum();
        let share = if squares > 0.0 { (outside / squares).sqrt() } else { 0.0 };
        Ok(Trace { outside_mm, share, largest_mm })
    }

    /// Draws effects of these causes that differ from each other, each of a size, mm rms.
    pub(super) fn drawn(
        &self,
        course: &Course,
        causes: &[&'static Cause],
        count: usize,
        size_mm: f64,
        chance: &mut Chance,
    ) -> Result<Vec<(Effect, Trace)>> {
        let mut drawn: Vec<(Effect, Trace)> = Vec::new();
        // A cause that nothing of the campaign shows must not hold up the trial for ever.
        for _ in 0..PATIENCE {
            if drawn.len() == count {
                break;
            }
            let cause = chance.one_of(causes);
            for _ in 0..PATIENCE {
                let effect = draw::effect(cause, &self.reach, chance);
                let Some((effect, trace)) = self.sized(course, effect, size_mm)? else { continue };
                let alike = |other: &(Effect, Trace)| {
                    (other.0.cause == effect.cause && other.0.seat == effect.seat)
                        || other.1.correlation(&trace).abs() > ALIKE
                };
                if !drawn.iter().any(alike) {
                    drawn.push((effect, trace));
                    break;
                }
            }
        }
        if drawn.len() < count {
            return Err(Error::new(
                Kind::Undetermined,
                "no effect of this size can be hidden: the model follows all that was drawn",
            )
            .hint("choose a smaller `--size`, or a test that sees more"));
        }
        Ok(drawn)
    }

    /// The effect with an amplitude that leaves this rms outside of the model; `None` where next to
    /// nothing of it would show, or the machine would not be one.
    fn sized(
        &self,
        course: &Course,
        effect: Effect,
        size_mm: f64,
    ) -> Result<Option<(Effect, Trace)>> {
        let Some(key) = effect.size_key() else { return Ok(None) };
        let mut effect = effect;
        let mut trace = self.trace(course, std::slice::from_ref(&effect))?;
        // Twice more for what does not grow in proportion.
        for _ in 0..3 {
            if trace.share() < SEEN {
                return Ok(None);
            }
            let factor = size_mm / trace.rms_mm();
            if (factor - 1.0).abs() < NEAR {
                break;
            }
            let value = effect.get(key.name) * factor;
            let most = match key.unit(effect.seat) {
                Unit::URAD => STEEPEST_RAD,
                Unit::UM => FARTHEST_MM,
                _ => f64::INFINITY,
            };
            if value.abs() > most || factor * trace.largest_mm > 2.0 * FARTHEST_MM {
                return Ok(None);
            }
            effect = effect.with(key.name, value);
            trace = self.trace(course, std::slice::from_ref(&effect))?;
            if trace.largest_mm > FARTHEST_MM {
                return Ok(None);
            }
        }
        Ok(Some((effect, trace)))
    }
}
