//! What differs from run to run though nobody hides anything: the days of the sample measurements.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::chance::Chance;
use super::course::Course;
use crate::model::{Coefficient, Power};
use crate::simulate::{Coincidence, Noise, Pauses, Scenario};

/// The noise of the sample measurements: 0.15 um a reading, less of it correlated than in the scenario
/// that `simulate` takes by default.
pub(super) const NOISE: Noise =
    Noise { white_mm: 0.128e-3, correlated_mm: 0.08e-3, correlation_s: 0.1 };
/// Standard deviation of the place of the tool ball, mm.
const SET_UP_MM: f64 = 10e-3;
/// Limits of the rate of the instrument's clock, parts per million.
pub(super) const CLOCK_PPM: [f64; 2] = [-50.0, 50.0];
/// Limits of the time between the start of the log and that of the program, s.
pub(super) const START_S: [f64; 2] = [3.0, 20.0];
/// Limits of an operator's pause, s.
const PAUSE_S: [f64; 2] = [5.0, 40.0];
/// Share by which hysteresis varies.
const HYSTERESIS: f64 = 0.08;
/// Share by which other coefficients that vary do, by name.
const OTHERS: [(&str, f64); 10] = [
    ("EXX1", 0.08),
    ("EXX3", 0.04),
    ("EYX2", 0.025),
    ("EZX3", 0.02),
    ("EYY1", 0.02),
    ("EYY3", 0.01),
    ("EZZ1", 0.02),
    ("EAZ0", 0.025),
    ("ECZ0", 0.02),
    ("ECZ1", 0.001),
];

/// The scenario of every run, without anything hidden.
pub(super) fn days(course: &Course, chance: &mut Chance) -> Vec<Scenario> {
    let mut errors = BTreeMap::new();
    let mut set_ups = BTreeMap::new();
    let each = course.runs.iter().enumerate();
    each.map(|(index, run)| {
        let mut scenario = Scenario { noise: NOISE, ..Scenario::default() };
        scenario.run_number = index as u32 + 1;
        scenario.mounting_number = run.mounting as u32 + 1;
        scenario.seed = chance.seed();
        scenario.errors = errors
            .entry(run.repeat)
            .or_insert_with(|| {
                let mut errors = scenario.errors.clone();
                for coefficient in Coefficient::all() {
                    let name = coefficient.to_string();
                    let share = match coefficient.power {
                        Power::B => HYSTERESIS,
                        _ => OTHERS.iter().find(|(of, _)| *of == name).map_or(0.0, |of| of.1),
                    };
                    let value = errors.get(coefficient);
                    if share > 0.0 && value != 0.0 {
                        errors.set(coefficient, value * (1.0 + share * chance.normal()));
                    }
                }
                errors
            })
            .clone();
        scenario.tool_ball_mm = *set_ups
            .entry((run.repeat, run.mounting))
            .or_insert_with(|| SET_UP_MM * Vector3::from_fn(|_, _| chance.normal()));
        if course.test.mountings().len() > 1 {
            scenario.coincidence = Coincidence::Touched;
        }
        scenario.clock_ppm = chance.between(CLOCK_PPM);
        scenario.start_s = chance.between(START_S);
        scenario.pauses = Pauses::Between(PAUSE_S);
        scenario.sample_rate_hz = run.sample_rate_hz;
        scenario.feed_override = run.feed_override;
        scenario
    })
    .collect()
}
