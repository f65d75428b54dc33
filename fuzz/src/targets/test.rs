//! Test files.

use ballbar::plan::Test;

use super::{Target, accepted};
use crate::seeds;

pub const TARGET: Target = Target { name: "test", seeds, words: WORDS, made: &[], read };

pub const WORDS: &[&str] = &[
    "name",
    "machine",
    "ball_bar",
    "length_mm",
    "range_mm",
    "resolution_um",
    "noise_um",
    "correlated_um",
    "correlation_s",
    "clock_ppm",
    "log",
    "time_column",
    "time_unit",
    "sample_rate_hz",
    "reading_column",
    "reading_unit",
    "reading",
    "reading_sign",
    "deviation",
    "length",
    "ms",
    "us",
    "min",
    "nm",
    "inch",
    "mounting",
    "coincidence_mm",
    "tool_ball_mm",
    "work_offset",
    "G54",
    "G59",
    "bar_length_mm",
    "plan",
    "strategy",
    "2d",
    "3d5",
    "3d6",
    "3d10",
    "xy",
    "yz",
    "zx",
    "iso230-4",
    "overshoot_deg",
    "interpolation",
    "arcs",
    "chords",
    "feed_mm_min",
    "chord_sag_um",
    "dwell_s",
    "settle_s",
    "feed_in_mm",
    "both_directions",
    "stop_between_arcs",
    "release_between_arcs",
    "program_number",
    "arc",
    "kind",
    "equator",
    "parallel",
    "meridian",
    "circle",
    "mountings",
    "azimuth_deg",
    "polar_deg",
    "start_deg",
    "sweep_deg",
    "start",
    "normal",
    "operator",
    "set_up_min",
    "fit_bar_min",
    "stop_s",
    "identify",
    "terms",
    "loss",
    "off",
    "huber",
    "tukey",
    "minimum_norm",
    "run",
    "program",
    "feed_override_percent",
    "repeat",
    "design",
    "budget_min",
    "criterion",
    "A",
    "G",
    "D",
    "wanted",
    "complete",
    "local",
    "observable35",
    "paper37",
    "all",
    "volume53",
    "planar27",
    "-EXX1",
    "EXt",
    "EXt@A",
    "most_mountings",
    "places",
    "corners",
    "tool_balls_mm",
    "bar_lengths_mm",
    "step_deg",
    "volume_mm",
    "true",
    "false",
    "nan",
    "inf",
    "cyclic:on=EXX,period_mm=10",
    "servo:on=X",
    "[[run]]\nprogram='a'\nlog='b'\n",
];

pub fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = seeds::all_of_project("tests/data", "test.toml");
    let texts = [seeds::FULL_TEST, seeds::SHORT_TEST, seeds::OTHER_TEST, seeds::PLANES_TEST];
    seeds.extend(texts.map(|text| text.as_bytes().to_vec()));
    seeds
}

fn read(input: &[u8]) -> bool {
    let test = Test::parse(&seeds::as_text(input), "tests/test.toml".as_ref());
    if let Ok(test) = &test {
        for mounting in 0..test.mountings().len() {
            assert!(
                test.bar_of(mounting).length_mm > test.ball_bar().range_mm,
                "a bar is longer than it reads"
            );
            let _ = test.log_format_of(mounting);
        }
        if let Ok(plan) = test.plan() {
            let _ = plan.arcs(0);
        }
        let _ = (test.repeat_count(), test.design().is_ok(), test.runs().is_ok());
    }
    accepted(&test)
}
