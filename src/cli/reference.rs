//! `ballbar reference`: what a key, a cause or a coefficient means.

use std::fmt::Write as _;

use clap::Args;
use serde_json::json;

use super::common::Common;
use super::output;
use crate::error::{Error, Result};
use crate::model::{Ball, Coefficient, Component, Power, SetUp};
use crate::start::{Entry, REFERENCE, Reference};

/// Say what a key means, with its unit, default and bounds
///
/// Knows the keys of machine, test, scenario and model files, columns of samples, causes, what a check finds, and the names of
/// coefficients and set-up errors; a heading prints its section. Without KEY, all of it.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar reference tool_ball_mm
  ballbar reference clearance.support.direction
  ballbar reference EXY1
  ballbar reference causes
  ballbar reference | less")]
pub(super) struct Arguments {
    /// A key, a cause, a coefficient, or a heading
    #[arg(value_name = "KEY")]
    key: Option<String>,
}

impl Arguments {
    pub(super) fn run(&self, common: &Common) -> Result<()> {
        let Some(key) = &self.key else { return output::print(REFERENCE) };
        let reference = Reference::get();
        let entries = reference.named(key);
        let meaning = coefficient(key);
        if common.json {
            let mut list: Vec<_> = entries.iter().map(|entry| as_json(entry)).collect();
            list.extend(meaning.map(|meaning| json!({ "names": [key], "meaning": meaning })));
            if !list.is_empty() {
                return output::print_json("reference", json!({ "entries": list }));
            }
            return Err(unknown(key, reference));
        }
        let mut told: Vec<String> = entries.iter().map(|entry| as_text(entry)).collect();
        told.extend(meaning.map(|meaning| format!("{key}\n  {meaning}\n")));
        if told.is_empty() {
            let Some((heading, text)) = reference.section(key) else {
                return Err(unknown(key, reference));
            };
            told.push(format!("{heading}\n\n{text}\n"));
        }
        output::print(&told.join("\n"))
    }
}

fn as_text(entry: &Entry) -> String {
    let table = if entry.table.is_empty() { String::new() } else { format!(", {}", entry.table) };
    let mut text = format!("{}   ({}{table})\n", entry.names.join(", "), entry.section);
    let width = entry.cells.iter().map(|(heading, _)| heading.chars().count()).max().unwrap_or(0);
    for (heading, cell) in &entry.cells {
        let _ = writeln!(text, "  {heading:width$}  {}", cell.replace('`', ""));
    }
    text
}

fn as_json(entry: &Entry) -> serde_json::Value {
    let cells: serde_json::Map<_, _> =
        entry.cells.iter().map(|(heading, cell)| (heading.clone(), cell.clone().into())).collect();
    json!({ "names": entry.names, "section": entry.section, "table": entry.table, "cells": cells })
}

/// What a coefficient or a set-up error is.
fn coefficient(name: &str) -> Option<String> {
    if let Some(set_up) = SetUp::all().find(|set_up| set_up.to_string().eq_ignore_ascii_case(name))
    {
        let ball = match set_up.ball {
            Ball::Workpiece => "workpiece ball",
            Ball::Tool => "tool ball",
        };
        return Some(format!(
            "set-up error, mm: how far the {ball} is from where the test file has it, along {}",
            set_up.axis
        ));
    }
    let known = |of: &Coefficient| of.to_string().eq_ignore_ascii_case(name);
    let Coefficient { slide, component, power } = Coefficient::all().find(known)?;
    let direction = ["X", "Y", "Z"][component.direction()];
    let way = match component {
        Component::A | Component::B | Component::C => {
            format!("angle by which {slide} turns about {direction}")
        }
        _ if direction == slide.to_string() => format!("positioning error of {slide}"),
        _ => format!("straightness error of {slide} in {direction}"),
    };
    let part = match power {
        Power::P0 => "its constant part",
        Power::P1 if component.is_angular() => "its part that grows with the position",
        Power::P1 if direction == slide.to_string() => "its scale",
        Power::P1 => "its slope, part of a squareness",
        Power::P2 => "its part with the square of the position",
        Power::P3 => "its part with the cube of the position",
        Power::B if component.is_angular() => "half of what changes at a reversal",
        Power::B if direction == slide.to_string() => "half of the backlash, with its sign",
        Power::B => "half of the lateral play at a reversal",
    };
    let unit = Coefficient { slide, component, power }.unit();
    Some(format!("{way}, {part}, {unit}; positions are machine coordinates"))
}

/// The hint has what sounds alike.
fn unknown(key: &str, reference: &Reference) -> Error {
    let wanted = key.trim_matches(['[', ']', '-']).to_lowercase();
    let words: Vec<&str> =
        wanted.split(['_', '.', ' ', '-']).filter(|word| word.len() > 2).collect();
    let mut alike: Vec<&str> = reference
        .entries()
        .iter()
        .flat_map(|entry| &entry.names)
        .map(String::as_str)
        .filter(|name| words.iter().any(|word| name.to_lowercase().contains(word)))
        .collect();
    alike.sort_unstable();
    alike.dedup();
    alike.truncate(12);
    let hint = if alike.is_empty() {
        let headings: Vec<&str> = reference.headings().collect();
        format!(
            "name a key, a cause, a coefficient, or one of the headings: {}",
            headings.join(", ")
        )
    } else {
        format!("these sound alike: `{}`", alike.join("`, `"))
    };
    Error::input(format!("the reference has no `{key}`")).hint(hint)
}
