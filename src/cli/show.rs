//! `ballbar show`: says what is in a log, before there is a test.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::common::Common;
use super::{output, shown_table};
use crate::error::Result;
use crate::log::{self, BallbarFile, Content, Format};
use crate::plan::Test;

/// Say what is in a log, and how it is understood
///
/// Of a table (text or .xlsx): its encoding, columns, units, rate, clock, span, gaps, and what is out of range or cut off. Without
/// --test the columns are those whose names say their units, and the lines to write in a test file are told.
///
/// Of a .b5r: who, when and with what, the runs with how many readings, and what Ballbar 20 made of them. The format is not
/// described in public: what is not known of it is left out.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar show monday.csv
  ballbar show monday.b5r tuesday.xlsx --test test.toml
  ballbar show monday.b5r --json | jq .files[0].runs")]
pub(super) struct Arguments {
    /// Logs, gzipped or not
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Test file that says under [log] how they are written
    #[arg(long, value_name = "FILE")]
    test: Option<PathBuf>,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common) -> Result<()> {
        let test = self.test.as_deref().map(Test::read).transpose()?;
        let mut list = Vec::new();
        let mut text = String::new();
        for file in &self.files {
            let format = test.as_ref().map(|test| format_of(test, file));
            let content = log::look_into(file, format.as_ref())?;
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{}", file.display());
            let mut value = match &content {
                Content::Table(table) => {
                    text += &shown_table::as_text(table, test.is_some());
                    shown_table::as_json(table)
                }
                Content::Ballbar(found) => {
                    let taken = log::log_of(found, file, &format.unwrap_or_default());
                    text += &as_text(found);
                    match &taken {
                        Ok(log) => log.notes().iter().for_each(|note| caution(&mut text, note)),
                        Err(error) => caution(&mut text, &format!("as a log: {}", error.what)),
                    }
                    as_json(found, &taken)
                }
            };
            value["file"] = file.display().to_string().into();
            list.push(value);
        }
        if common.json {
            return output::print_json("show", json!({ "files": list }));
        }
        output::print(&text)
    }
}

/// How a test says that a log is written: by the run that names it, else as in its first mounting.
fn format_of(test: &Test, log: &Path) -> Format {
    let same = |of: &Path| match (of.canonicalize(), log.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    };
    let run = test.runs().unwrap_or_default().iter().find(|run| same(&run.log));
    test.log_format_of(run.map_or(0, |run| run.mounting))
}

fn caution(text: &mut String, what: &str) {
    let _ = writeln!(text, "  {:<16}{what}", "caution");
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

fn as_json(found: &BallbarFile, taken: &Result<log::Log>) -> Value {
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
        "kind": "ballbar 20",
        "notes": taken.as_ref().map_or(&[][..], log::Log::notes),
        "refused": taken.as_ref().err().map(|error| &error.what),
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
