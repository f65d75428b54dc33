//! `ballbar time`: how long a program takes.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::check::{Around, On};
use super::common::Common;
use super::output::{self, Talk};
use crate::error::Result;
use crate::motion::{BlockKind, Duration, Trajectory};
use crate::nc;

/// Estimate how long a program takes
///
/// Feeds, accelerations, corners, jerk and block time are those of the machine file. The approach to the
/// first position has no time, because nobody knows where the machine comes from; an operator's stop has
/// none either, and is counted. Where the zero of a work offset is tells the test file; without one, the way
/// from a place in machine coordinates (G53) to one in a work offset is not known, and counts from zero.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar time O1001.nc --machine machine.toml
  ballbar time O1001.nc --machine machine.toml --json | jq .by_comment")]
pub(super) struct Arguments {
    /// The program, gzipped or not
    #[arg(value_name = "PROGRAM")]
    program: PathBuf,
    #[command(flatten)]
    on: On,
    /// Where the feed override stands
    #[arg(long, value_name = "PERCENT", default_value_t = 100.0, value_parser = percent)]
    feed_override: f64,
}

fn percent(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (1.0..=200.0).contains(&value) => Ok(value),
        _ => Err("give a number from 1 to 200".to_owned()),
    }
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let text = nc::text_of(&self.program)?;
        let Around { machine, mut reading, .. } = self.on.read(&text, talk)?;
        // Where the zero is makes no difference to the time within one work offset.
        for number in 54..=59 {
            reading.work_offsets_mm.entry(number).or_default();
        }
        let program = nc::read(&text, &self.program, &reading)?;
        let trajectory = Trajectory::new(&program, &machine, self.feed_override / 100.0);
        let time = trajectory.duration();
        if common.json {
            let value = json!({
                "program": self.program.display().to_string(),
                "known_s": time.known_s(),
                "feed_s": time.feed_s,
                "dwell_s": time.dwell_s,
                "rapid_s": time.rapid_s,
                "operator_stops": time.stops,
                "by_comment": by_comment(&trajectory),
            });
            return output::print_json("time", value);
        }
        output::print(&format!("{}: {}\n", minutes(time.known_s()), told(&time)))
    }
}

/// Time under each comment, in the order of the program.
fn by_comment(trajectory: &Trajectory) -> Vec<serde_json::Value> {
    let mut parts: Vec<(usize, &str, f64)> = Vec::new();
    for block in trajectory.blocks().iter().filter(|block| block.kind != BlockKind::Stop) {
        match parts.last_mut() {
            Some((label, _, duration_s)) if *label == block.label => {
                *duration_s += block.duration_s;
            }
            _ => parts.push((block.label, trajectory.label(block), block.duration_s)),
        }
    }
    let as_json =
        |(_, comment, duration_s)| json!({ "comment": comment, "duration_s": duration_s });
    parts.into_iter().map(as_json).collect()
}

/// By kind: `14 min 50 s at feed, 39.0 s in dwells, 0.0 s at rapid, and 1 stop(s) for the operator`.
pub(super) fn told(time: &Duration) -> String {
    format!(
        "{} at feed, {} in dwells, {} at rapid, and {} stop(s) for the operator",
        minutes(time.feed_s),
        minutes(time.dwell_s),
        minutes(time.rapid_s),
        time.stops
    )
}

/// `14 min 50 s`.
fn minutes(seconds: f64) -> String {
    let whole = seconds.round();
    if whole < 60.0 {
        return format!("{seconds:.1} s");
    }
    format!("{} min {} s", (whole / 60.0).floor(), whole % 60.0)
}
