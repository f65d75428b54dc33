//! How the path is driven, as a test file writes it.

use serde::Deserialize;
use toml::Spanned;

use super::parts::{BallBar, FreeArc, NamedMounting, PathPlan};
use super::raw_arc::RawArc;
use super::strategy::Strategy;
use crate::error::{Error, Result};
use crate::toml_text::Text;

/// A point of a program with two decimals is off by no more, mm: half of the last decimal in three axes is 8.7 um.
const ROUNDED_MM: f64 = 0.0099;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPlan {
    strategy: Option<Spanned<String>>,
    feed_mm_min: Spanned<f64>,
    chord_sag_um: Option<Spanned<f64>>,
    dwell_s: Option<Spanned<f64>>,
    settle_s: Option<Spanned<f64>>,
    feed_in_mm: Option<Spanned<f64>>,
    both_directions: Option<bool>,
    stop_between_arcs: Option<bool>,
    program_number: Option<Spanned<u32>>,
    #[serde(default)]
    arc: Vec<Spanned<RawArc>>,
}

impl RawPlan {
    pub(super) fn check(
        self,
        bar: &BallBar,
        mountings: &[NamedMounting],
        designed: bool,
        text: &Text<'_>,
    ) -> Result<PathPlan> {
        let within =
            |value: &Option<Spanned<f64>>, key: &str, default: f64, low: f64, high: f64| {
                value.as_ref().map_or(Ok(default), |value| text.within(value, key, low, high))
            };
        let strategy = match &self.strategy {
            None => None,
            Some(name) => Some(Strategy::parse(name.get_ref()).ok_or_else(|| {
                let names = Strategy::ALL.map(Strategy::name).join("`, `");
                Error::input(format!("unknown strategy `{}`", name.get_ref()))
                    .at(text.place(name.span()))
                    .hint(format!(
                        "write one of `{names}`, or leave it out and give `[[plan.arc]]`"
                    ))
            })?),
        };
        let free_arcs: Vec<FreeArc> = self
            .arc
            .iter()
            .enumerate()
            .map(|(index, arc)| arc.get_ref().check(index, arc.span(), mountings, text))
            .collect::<Result<_>>()?;
        if strategy.is_none() && free_arcs.is_empty() && !designed {
            return Err(Error::input("the plan has neither a strategy nor arcs")
                .at(text.place(self.feed_mm_min.span()))
                .hint("add `strategy = \"3d6\"` or `[[plan.arc]]`"));
        }
        let feed_in_mm = within(&self.feed_in_mm, "feed_in_mm", bar.range_mm + 0.3, 0.0, 50.0)?;
        let inside = feed_in_mm < bar.range_mm + ROUNDED_MM;
        if let Some(given) = self.feed_in_mm.as_ref().filter(|_| inside) {
            return Err(Error::input(format!(
                "a feed-in of {feed_in_mm} mm begins inside the bar's range of {} mm, or where rounding puts it there",
                bar.range_mm
            ))
            .at(text.place(given.span()))
            .hint("begin outside the range: the moment of engagement is what ties the log to the program"));
        }
        let program_number = self.program_number.as_ref().map_or(1001, |number| *number.get_ref());
        // Every mounting has a program of its own.
        let last = program_number.saturating_add(mountings.len() as u32 - 1);
        if let Some(given) = self.program_number.filter(|n| *n.get_ref() < 1 || last > 7999) {
            let numbers = if last == program_number {
                format!("program number {program_number}")
            } else {
                format!("program numbers {program_number} to {last}")
            };
            return Err(Error::input(format!("{numbers} cannot be used"))
                .at(text.place(given.span()))
                .hint("take one from 1 to 7999; 8000 and up belong to the machine tool builder"));
        }
        Ok(PathPlan {
            strategy,
            free_arcs,
            feed_mm_s: text.within(&self.feed_mm_min, "feed_mm_min", 1.0, 60_000.0)? / 60.0,
            chord_sag_mm: within(&self.chord_sag_um, "chord_sag_um", 0.4, 0.01, 100.0)? * 1e-3,
            dwell_s: within(&self.dwell_s, "dwell_s", 3.0, 0.1, 600.0)?,
            settle_s: within(&self.settle_s, "settle_s", 2.0, 0.1, 600.0)?,
            feed_in_mm,
            both_directions: self.both_directions.unwrap_or(true),
            stop_between_arcs: self.stop_between_arcs.unwrap_or(false),
            program_number,
        })
    }
}
