//! `ballbar machines`: lists and checks machine files.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::common::Common;
use super::output::{self, Talk};
use crate::error::Result;
use crate::machine::{Axis, Builtin, Machine, Pivot, Slide};

/// List the built-in machines, or check machine files
///
/// Without FILE, the machines that are built in; `ballbar init --machine NAME` begins with one of them.
#[derive(Args)]
#[command(after_help = "Examples:\n  ballbar machines\n  ballbar machines my-machine.toml --json")]
pub(super) struct Arguments {
    /// Machine files
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        if self.files.is_empty() {
            return built_in(common);
        }
        let mut first_wrong = None;
        let mut machines = Vec::new();
        for file in &self.files {
            match Machine::read(file) {
                Ok(machine) => machines.push(machine),
                // Every file is checked; all but the last error are told on the way.
                Err(error) => {
                    if let Some(before) = first_wrong.replace(error) {
                        talk.error(&before);
                    }
                }
            }
        }
        if common.json {
            let file = |machine: &Machine| ("file", machine.file().display().to_string());
            let list: Vec<_> = machines.iter().map(|m| as_json(m, file(m))).collect();
            output::print_json("machines", json!({ "machines": list }))?;
        } else {
            for machine in &machines {
                let file = machine.file().display().to_string();
                output::print(&as_text(machine, ("file", &file)))?;
            }
        }
        first_wrong.map_or(Ok(()), Err)
    }
}

/// The machines that every user has.
fn built_in(common: &Common) -> Result<()> {
    let machines = Builtin::ALL.map(|builtin| (builtin.name, builtin.machine()));
    let mut list = Vec::new();
    for (name, machine) in machines {
        let machine = machine?;
        if common.json {
            list.push(as_json(&machine, ("built_in", name.to_owned())));
        } else {
            output::print(&as_text(&machine, ("built in", name)))?;
        }
    }
    if common.json {
        output::print_json("machines", json!({ "machines": list }))?;
    }
    Ok(())
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

fn as_text(machine: &Machine, (what, from): (&str, &str)) -> String {
    let mut text = format!(
        "{}\n  {what:9} {from}\n  topology  {}\n",
        machine.name(),
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

fn as_json(machine: &Machine, (what, from): (&str, String)) -> serde_json::Value {
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
        (what): from,
        "topology": machine.topology().as_str(),
        "axes": axes,
        "decimals": machine.controller().decimals,
    })
}
