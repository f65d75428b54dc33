//! Hidden effects: what the virtual machine does beyond cubics, hysteresis and set-up errors.
//!
//! Each cause of [`CAUSES`](crate::model::CAUSES) works on one of four places of a run:
//!
//! | place | file |
//! | --- | --- |
//! | what the test and machine files say | `settings` |
//! | the error functions of an axis | `functions` |
//! | where an axis stands | `followings` |
//! | the balls and the bar | `readings` |
//!
//! All are worked out here from the equation and the motion, and go through the exact chain; nothing of
//! the columns that look for them is used.

mod followings;
mod functions;
mod harmonics;
mod readings;
mod settings;
#[cfg(test)]
mod tests;

use super::random::{Purpose, Stream};
use super::scenario::Scenario;
use crate::error::{Error, Result};
use crate::model::Effect;

pub(super) use followings::{delay_s, displacement_mm};
pub(super) use functions::add_to_slides;
pub(super) use readings::{add_to_balls, reading_mm};
pub(super) use settings::{machine_of, mounting_of, offset_mm, settings_of};

/// Causes that say how a thing is, not by how much it differs: there is one truth.
const STATED: [&str; 3] = ["feed-override", "clock", "pivot"];

impl Scenario {
    /// Hides one more effect.
    ///
    /// # Errors
    /// When what can be true only once is hidden already.
    ///
    /// ```
    /// use ballbar::model::Effect;
    /// use ballbar::simulate::Scenario;
    ///
    /// let mut scenario = Scenario::default();
    /// scenario.hide(Effect::parse("servo:on=Y,delay_ms=0.4")?)?;
    /// scenario.hide(Effect::parse("clock:ppm=40")?)?;
    /// assert!(scenario.hide(Effect::parse("clock:ppm=60")?).is_err());
    /// # Ok::<(), ballbar::Error>(())
    /// ```
    pub fn hide(&mut self, effect: Effect) -> Result<()> {
        check(&effect, &self.hidden)?;
        self.hidden.push(effect);
        Ok(())
    }
}

/// Refuses effects that cannot be together.
pub(super) fn check_all(effects: &[Effect]) -> Result<()> {
    effects.iter().enumerate().try_for_each(|(k, effect)| check(effect, &effects[..k]))
}

fn check(effect: &Effect, others: &[Effect]) -> Result<()> {
    let id = effect.cause.id;
    let same = |other: &Effect| other.cause == effect.cause && other.seat == effect.seat;
    if STATED.contains(&id) && others.iter().any(same) {
        return Err(Error::input(format!("`{id}` is hidden twice"))
            .hint("hide it once, with the value that is true"));
    }
    Ok(())
}

/// The effects of one run: what is drawn anew for every run is drawn, and knocks of other runs and places of
/// other mountings are gone.
pub(super) fn of_run(scenario: &Scenario) -> Vec<Effect> {
    let mut phases = Stream::new(scenario.seed, Purpose::Vibration);
    let mut effects = scenario.hidden.clone();
    effects.retain(|effect| match effect.cause.id {
        "knock" => effect.get("run") as u32 == scenario.run_number,
        "ball-place" => [0, scenario.mounting_number].contains(&(effect.get("mounting") as u32)),
        _ => true,
    });
    let drawn = |effect: Effect| match effect.cause.id {
        "vibration" => {
            let phase_rad = effect.get("phase") + phases.between([0.0, std::f64::consts::TAU]);
            effect.with("phase", phase_rad)
        }
        _ => effect,
    };
    effects.into_iter().map(drawn).collect()
}
