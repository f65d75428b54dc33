//! The log and its truth as text.

use std::fmt::Write as _;

use super::instrument::decimals;
use super::run::SimulatedRun;

impl SimulatedRun {
    /// The log as CSV: a comment with the seed, the header `time_s,deviation_um`, then one row a sample,
    /// the time with four decimals, the deviation with those of the instrument's step. The default
    /// [`crate::log::Format`] reads it.
    pub fn csv(&self) -> String {
        let decimals = usize::from(decimals(self.resolution_mm));
        let mut text = String::with_capacity(20 * self.readings.len() + 64);
        let _ = writeln!(text, "# simulated, seed {}\ntime_s,deviation_um", self.scenario.seed);
        for (time_s, deviation_mm) in &self.readings {
            let _ = match deviation_mm {
                Some(mm) => writeln!(text, "{time_s:.4},{:.decimals$}", mm * 1e3),
                None => writeln!(text, "{time_s:.4},"),
            };
        }
        text
    }
}

/// A simulated run with the names of its files.
#[derive(Debug, Clone, Copy)]
pub struct TrueRun<'a> {
    /// File name of the log.
    pub log: &'a str,
    /// File name of the program.
    pub program: &'a str,
    /// The run.
    pub run: &'a SimulatedRun,
}

/// What was put into simulated logs, as TOML: the hidden effects, joined by ` + `, which all runs share,
/// and for each run its start, its pauses, its clock, and the coefficients and set-up errors that are not
/// zero, in mm and rad, with what is hidden in them.
///
/// Each effect reads back through [`crate::model::Effect::parse`].
///
/// `asked` is what [`at_the_place`](super::at_the_place) says.
pub fn truth_toml(runs: &[TrueRun<'_>], asked: &[(String, f64)]) -> String {
    let hidden = runs.first().map_or(&[][..], |first| &first.run.scenario.hidden);
    let effects: Vec<String> = hidden.iter().map(ToString::to_string).collect();
    let effect = if effects.is_empty() { "none".to_owned() } else { effects.join(" + ") };
    let mut text = format!(
        "# What was put into these logs. For scoring only: no command reads it.\neffect = {effect:?}\n",
    );
    if !asked.is_empty() {
        text.push_str(
            "\n[at_the_place]  # tool against workpiece along programmed directions, lines through the middle\n",
        );
    }
    for (name, value) in asked {
        let slope = name.starts_with("scale") || name.starts_with("squareness");
        let (unit, of_unit) = if slope { ("um_m", 1e6) } else { ("um", 1e3) };
        let _ = writeln!(text, "{}_{unit} = {:.4}", name.replace(' ', "_"), value * of_unit);
    }
    for TrueRun { log, program, run } in runs {
        let pauses: Vec<String> = run.clock.pauses_s.iter().map(|s| format!("{s:?}")).collect();
        let _ = write!(
            text,
            "\n[[run]]\nlog = {log:?}\nprogram = {program:?}\nseed = {}\nfeed_mm_min = {}\n\
             feed_override_percent = {}\nsample_rate_hz = {}\n\
             # program time of a sample = time_s * (1 + clock_ppm * 1e-6) - start_s - pauses so far\n\
             start_s = {:?}\nclock_ppm = {:?}\n# how long each M00 of the program stood, s\n\
             pauses_s = [{}]\n# standard deviation of the noise, um\nnoise_um = {:?}\n\
             [run.coefficients]  # mm, rad\n",
            run.scenario.seed,
            round(run.feed_mm_s * 60.0),
            round(run.scenario.feed_override * 100.0),
            run.sample_rate_hz,
            run.clock.start_s,
            run.clock.ppm,
            pauses.join(", "),
            round(run.scenario.noise.sigma_mm() * 1e3),
        );
        for (name, value) in run.scenario.named_values() {
            let _ = writeln!(text, "{name} = {value:e}");
        }
        if let Some(place) = &run.scenario.place {
            let _ = write!(
                text,
                "[run.local]  # mm, rad: P1 P2 P3 and sense about the middle\nmiddle_mm = {:?}\nreach_mm = {:?}\n",
                place.middle_mm.as_slice(),
                place.reach_mm.as_slice(),
            );
            for (name, value) in place.named_values() {
                let _ = writeln!(text, "{name} = {value:e}");
            }
        }
    }
    text
}

/// Without the last digits, which a change of units leaves behind.
fn round(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}
