//! The place of a test: about what the errors of a machine are told, and the terms that tell them.

use std::sync::Arc;

use super::input::RunInput;
use crate::error::Result;
use crate::machine::{Machine, Mounting};
use crate::model::{self, LOCAL, LocalFrame, Term};
use crate::plan::Test;

/// Points of an arc that are looked at: its ends are missed by less than 0.01 % of its radius.
const POINTS: u32 = 256;

/// The middle and the range of the arcs that these runs drive; `None` where they drive none.
pub(super) fn of<'a>(
    test: &Test,
    machine: &Machine,
    runs: impl Iterator<Item = &'a RunInput>,
) -> Option<Arc<LocalFrame>> {
    let mountings: Vec<Mounting> = test.mountings().iter().map(|m| m.mounting).collect();
    let positions_mm = runs.flat_map(|run| {
        let trajectory = &run.alignment.trajectory;
        run.alignment.sections.iter().flat_map(move |section| {
            let length_s = section.end_s - section.start_s;
            (0..=POINTS).map(move |k| {
                // Not at its very ends, where the block before or after it has begun.
                let share = 1e-9 + (1.0 - 2e-9) * f64::from(k) / f64::from(POINTS);
                trajectory.at(section.start_s + share * length_s).position_mm
            })
        })
    });
    LocalFrame::around(machine, &mountings, positions_mm).map(Arc::new)
}

/// The terms of these names, those of a place where they are asked for.
///
/// # Errors
/// When a name is unknown.
pub fn terms(
    names: &[String],
    frame: Option<&Arc<LocalFrame>>,
    machine: &Machine,
    mountings: &[String],
) -> Result<Vec<Box<dyn Term>>> {
    let local = names.iter().any(|name| name == LOCAL);
    let Some(frame) = frame.filter(|_| local) else { return model::terms(names, mountings) };
    let mut terms = model::local_terms(frame, machine.plausible(), mountings);
    let others: Vec<String> = names.iter().filter(|name| *name != LOCAL).cloned().collect();
    if !others.is_empty() {
        terms.extend(model::terms(&others, mountings)?);
    }
    Ok(terms)
}
