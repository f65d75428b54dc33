//! `ballbar show`: says what is in a file of Ballbar 20.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::common::Common;
use super::output;
use crate::error::Result;
use crate::log::{self, BallbarFile};

/// Say what is in a .b5r of Ballbar 20
///
/// Who, when and with what, the runs with how many readings, and what Ballbar 20 made of them. The format is not described in
/// public: what is not known of it is left out. To analyse one, name it as the `log` of a run.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  ballbar show monday.b5r\n  ballbar show monday.b5r --json | jq .runs"
)]
pub(super) struct Arguments {
    /// Files of Ballbar 20
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common) -> Result<()> {
        let mut shown = Vec::new();
        for file in &self.files {
            shown.push((file, log::read_ballbar_file(file)?));
        }
        if common.json {
            let list: Vec<Value> = shown.iter().map(|(_, found)| as_json(found)).collect();
            return output::print(&format!(
                "{:#}\n",
                json!({ "format": "ballbar.show/1", "files": list })
            ));
        }
        for (file, found) in shown {
            output::print(&format!("{}\n{}", file.display(), as_text(&found)))?;
        }
        Ok(())
    }
}

/// What is said of the day, each with its name.
fn facts(found: &BallbarFile) -> [(&'static str, Option<String>); 12] {
    let number = |value: Option<f64>, unit: &str| value.map(|value| format!("{value} {unit}"));
    [
        ("test", found.test.clone()),
        ("operator", found.operator.clone()),
        ("started", found.started.clone()),
        ("completed", found.completed.clone()),
        ("machine", found.machine.clone()),
        ("instrument", found.instrument.clone()),
        ("serial", found.serial.clone()),
        ("calibrated", found.calibrated.clone()),
        ("part", found.part.clone()),
        ("nominal length", number(found.nominal_length_mm, "mm")),
        ("feed", number(found.feed_mm_min, "mm/min")),
        ("plane", found.plane.clone()),
    ]
}

fn way(counter_clockwise: Option<bool>) -> Option<&'static str> {
    counter_clockwise.map(|ccw| if ccw { "CCW" } else { "CW" })
}

fn as_text(found: &BallbarFile) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    for (name, value) in facts(found) {
        if let Some(value) = value {
            let _ = writeln!(text, "  {name:<16}{value}");
        }
    }
    for (index, run) in found.runs.iter().enumerate() {
        let read = || run.readings.iter().flatten();
        let low = read().copied().fold(f64::INFINITY, f64::min);
        let high = read().copied().fold(f64::NEG_INFINITY, f64::max);
        let _ = writeln!(
            text,
            "  run {} {:<10}{} readings, {low} to {high} in the unit of the file",
            index + 1,
            way(run.counter_clockwise).unwrap_or("-"),
            run.readings.len()
        );
        for feature in &run.features {
            let _ = writeln!(text, "    {:<28}{} {}", feature.name, feature.value, feature.unit);
        }
    }
    for feature in &found.features {
        let _ = writeln!(text, "  {:<30}{} {}", feature.name, feature.value, feature.unit);
    }
    text
}

fn as_json(found: &BallbarFile) -> Value {
    let features = |of: &[log::Feature]| -> Vec<Value> {
        of.iter().map(|f| json!({ "name": f.name, "unit": f.unit, "value": f.value })).collect()
    };
    let runs: Vec<Value> = found
        .runs
        .iter()
        .map(|run| {
            json!({
                "direction": way(run.counter_clockwise),
                "line": run.line,
                "readings": run.readings,
                "features": features(&run.features),
            })
        })
        .collect();
    json!({
        "test": found.test,
        "operator": found.operator,
        "started": found.started,
        "completed": found.completed,
        "machine": found.machine,
        "instrument": found.instrument,
        "serial": found.serial,
        "calibrated": found.calibrated,
        "part": found.part,
        "nominal_length_mm": found.nominal_length_mm,
        "feed_mm_min": found.feed_mm_min,
        "plane": found.plane,
        "runs": runs,
        "features": features(&found.features),
    })
}
