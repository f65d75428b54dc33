//! `ballbar machines`: lists and checks machine files.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::common::Common;
use super::output::{self, Talk};
use crate::error::{Error, Place, Result};
use crate::machine::{Axis, Machine, Pivot, Slide};

/// List and check machine files
///
/// Without FILE, all of the directory `machines`.
#[derive(Args)]
#[command(after_help = "Examples:\n  ballbar machines\n  ballbar machines my-machine.toml --json")]
pub(super) struct Arguments {
    /// Machine files
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common) -> Result<()> {
        let files = if self.files.is_empty() { all_in_directory()? } else { self.files.clone() };
        let mut first_wrong = None;
        let mut machines = Vec::new();
        for file in &files {
            match Machine::read(file) {
                Ok(machine) => machines.push(machine),
                // Every file is checked; all but the last error are told on the way.
                Err(error) => {
                    if let Some(before) = first_wrong.replace(error) {
                        Talk::error(&before);
                    }
                }
            }
        }
        if common.json {
            let list: Vec<_> = machines.iter().map(as_json).collect();
            output::print(&format!("{:#}\n", json!(list)))?;
        } else {
            for machine in &machines {
                output::print(&as_text(machine))?;
            }
        }
        first_wrong.map_or(Ok(()), Err)
    }
}

fn all_in_directory() -> Result<Vec<PathBuf>> {
    let directory = PathBuf::from("machines");
    let entries = std::fs::read_dir(&directory).map_err(|error| {
        Error::input(format!("cannot list the machine files: {error}"))
            .at(Place::file(&directory))
            .hint("run it where the directory `machines` is, or name the files")
    })?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|file| file.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    files.sort();
    Ok(files)
}

fn pivot(pivot: Pivot) -> &'static str {
    match pivot {
        Pivot::Carriage => "carriage",
        Pivot::Base => "base",
    }
}

/// Limits at feed, where there are any.
fn at_feed(slide: &Slide) -> String {
    let mut text = String::new();
    if slide.max_feed_mm_s.is_finite() {
        let _ = write!(text, ", feed {:.0} mm/min", slide.max_feed_mm_s * 60.0);
    }
    if slide.feed_acceleration_mm_s2.is_finite() {
        let _ = write!(text, ", {:.0} mm/s2 at feed", slide.feed_acceleration_mm_s2);
    }
    text
}

fn as_text(machine: &Machine) -> String {
    let mut text = format!(
        "{}\n  file      {}\n  topology  {}\n",
        machine.name(),
        machine.file().display(),
        machine.topology().as_str()
    );
    for axis in Axis::ALL {
        let slide = machine.slide(axis);
        let _ = writeln!(
            text,
            "  {axis}         {:>7.1} to {:>6.1} mm, rapid {:>5.0} mm/min, {:>5.0} mm/s2, pivot on the {}{}{}",
            slide.travel_mm[0],
            slide.travel_mm[1],
            slide.rapid_mm_s * 60.0,
            slide.acceleration_mm_s2,
            pivot(slide.pivot),
            slide.screw_pitch_mm.map_or(String::new(), |pitch| format!(", screw {pitch} mm")),
            at_feed(slide),
        );
    }
    let controller = machine.controller();
    let _ = writeln!(
        text,
        "  control   {}, {} decimals, {:.0} mm/s2 along the path, stops at corners above {:.0} deg",
        controller.dialect.name(),
        controller.decimals,
        controller.path_acceleration_mm_s2,
        controller.corner_stop_rad.to_degrees()
    );
    let further = [
        (controller.corner_speed_step_mm_s * 60.0, "mm/min at most as a step of speed at corners"),
        (controller.acceleration_change_s * 1e3, "ms until the acceleration is built up"),
        (controller.block_time_s * 1e3, "ms for a block"),
        (controller.memory_bytes.map_or(0.0, |bytes| bytes as f64 / 1024.0), "KB of memory"),
    ];
    for (value, meaning) in further.iter().filter(|(value, _)| *value > 0.0 && value.is_finite()) {
        let _ = writeln!(text, "            {value:.1} {meaning}");
    }
    text
}

fn as_json(machine: &Machine) -> serde_json::Value {
    let axes: serde_json::Map<String, serde_json::Value> = Axis::ALL
        .into_iter()
        .map(|axis| {
            let slide = machine.slide(axis);
            let value = json!({
                "travel_mm": slide.travel_mm,
                "rapid_mm_min": slide.rapid_mm_s * 60.0,
                "acceleration_mm_s2": slide.acceleration_mm_s2,
                "pivot": pivot(slide.pivot),
                "screw_pitch_mm": slide.screw_pitch_mm,
            });
            (axis.to_string(), value)
        })
        .collect();
    json!({
        "name": machine.name(),
        "file": machine.file().display().to_string(),
        "topology": machine.topology().as_str(),
        "axes": axes,
        "decimals": machine.controller().decimals,
    })
}
