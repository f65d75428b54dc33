//! Scenario files.

use ballbar::simulate::Scenario;

use super::{Target, accepted};
use crate::seeds;

pub const TARGET: Target = Target {
    name: "scenario",
    seeds: || vec![seeds::SCENARIO.as_bytes().to_vec()],
    words: WORDS,
    made: &[],
    read,
};

pub const WORDS: &[&str] = &[
    "seed",
    "sample_rate_hz",
    "resolution_um",
    "range_mm",
    "after_s",
    "feed_override_percent",
    "coefficients",
    "set_up",
    "coincidence",
    "nominal",
    "touched",
    "noise",
    "white_um",
    "correlated_um",
    "correlation_s",
    "motion",
    "acceleration_percent",
    "acceleration_change_ms",
    "standing_ms",
    "following_ms",
    "clock",
    "start_s",
    "ppm",
    "pauses",
    "between_s",
    "fixed_s",
    "dropouts",
    "per_s",
    "mean_s",
    "rows",
    "blank",
    "missing",
    "hide",
    "cause",
    "on",
    "cyclic",
    "servo",
    "reversal-spike",
    "growing-backlash",
    "pre-sliding",
    "drift",
    "knock",
    "repeated-step",
    "bar-length",
    "roundness",
    "degree",
    "vibration",
    "stick-slip",
    "feed-override",
    "clock",
    "ball-place",
    "pivot",
    "coefficient",
    "bump",
    "joint",
    "friction-tilt",
    "EXX",
    "EBX",
    "EZt",
    "EXw",
    "EXX1",
    "ECZ3",
    "EYYb",
    "bar",
    "X",
    "amplitude_um",
    "amplitude_urad",
    "amplitude_um_m",
    "period_mm",
    "phase_rad",
    "delay_ms",
    "decay_ms",
    "slope_um_m",
    "slope_urad_mm",
    "distance_mm",
    "time_constant_s",
    "step_um",
    "moment_s",
    "run",
    "order",
    "frequency_hz",
    "speed_mm_min",
    "percent",
    "offset_mm",
    "mounting",
    "value",
    "at_mm",
    "width_mm",
    "nan",
    "inf",
];

fn read(input: &[u8]) -> bool {
    let scenario = Scenario::parse(&seeds::as_text(input), "scenario.toml".as_ref());
    if let Ok(scenario) = &scenario {
        for (name, value) in scenario.named_values() {
            assert!(value.is_finite(), "{name} is {value}");
        }
        for effect in &scenario.hidden {
            assert!(effect.written().iter().all(|(_, value)| value.is_finite()), "{effect}");
        }
    }
    accepted(&scenario)
}
