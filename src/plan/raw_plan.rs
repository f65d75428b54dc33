//! How the path is driven, as a test file writes it.

use serde::Deserialize;
use toml::Spanned;

use super::leg::Interpolation;
use super::parts::{BallBar, FreeArc, NamedMounting, PathPlan};
use super::planar::{Planar, Planes};
use super::raw_arc::RawArc;
use super::raw_feeds::{self, RawFeeds};
use super::strategy::Strategy;
use crate::error::{Error, Result};
use crate::toml_text::Text;

/// A point of a program with two decimals is off by no more, mm: half of the last decimal in three axes is 8.7 um.
const ROUNDED_MM: f64 = 0.0099;

/// Data arcs, degrees.
const SWEEPS_DEG: [f64; 2] = [1.0, 360.0];
/// Where they begin, degrees.
const STARTS_DEG: [f64; 2] = [-360.0, 360.0];
/// What is driven before them and after them, degrees: two turns at the most.
const OVERSHOOTS_DEG: [f64; 2] = [0.0, 720.0];

/// With their dwells some hours of driving, which no operator waits for.
const MOST_ARCS: usize = 1000;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPlan {
    strategy: Option<Spanned<String>>,
    sweep_deg: Option<Spanned<f64>>,
    start_deg: Option<Spanned<f64>>,
    overshoot_deg: Option<Spanned<f64>>,
    interpolation: Option<Spanned<String>>,
    feed_mm_min: Spanned<RawFeeds>,
    chord_sag_um: Option<Spanned<f64>>,
    dwell_s: Option<Spanned<f64>>,
    settle_s: Option<Spanned<f64>>,
    feed_in_mm: Option<Spanned<f64>>,
    both_directions: Option<bool>,
    stop_between_arcs: Option<bool>,
    release_between_arcs: Option<bool>,
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
        let planar = self.planar(text)?;
        let strategy = match &self.strategy {
            Some(name) if planar.is_none() => Some(on_sphere(name, text)?),
            _ => None,
        };
        let beyond = self.arc.get(MOST_ARCS).map(Spanned::span);
        let hint = "divide the test: each file has programs of its own";
        text.at_most(self.arc.len(), MOST_ARCS, "arcs", beyond, hint)?;
        let free_arcs: Vec<FreeArc> = self
            .arc
            .iter()
            .enumerate()
            .map(|(index, arc)| arc.get_ref().check(index, arc.span(), mountings, text))
            .collect::<Result<_>>()?;
        if strategy.is_none() && planar.is_none() && free_arcs.is_empty() && !designed {
            return Err(Error::input("the plan has neither a strategy nor arcs")
                .at(text.place(self.feed_mm_min.span()))
                .hint("add `strategy = \"3d6\"`, `strategy = \"xy\"` or `[[plan.arc]]`"));
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
        if let Some(given) =
            self.program_number.as_ref().filter(|n| *n.get_ref() < 1 || last > 7999)
        {
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
            planar,
            free_arcs,
            feeds_mm_s: raw_feeds::check(&self.feed_mm_min, text)?,
            interpolation: self.interpolation(planar.is_some(), text)?,
            chord_sag_mm: within(&self.chord_sag_um, "chord_sag_um", 0.4, 0.01, 100.0)? * 1e-3,
            dwell_s: within(&self.dwell_s, "dwell_s", 3.0, 0.1, 600.0)?,
            settle_s: within(&self.settle_s, "settle_s", 2.0, 0.1, 600.0)?,
            feed_in_mm,
            both_directions: self.both_directions.unwrap_or(true),
            stop_between_arcs: self.stop_between_arcs.unwrap_or(false),
            release_between_arcs: self.release_between_arcs.unwrap_or(planar.is_some()),
            program_number,
        })
    }
    /// The planes of the strategy, if it is one of planes.
    fn planar(&self, text: &Text<'_>) -> Result<Option<Planar>> {
        let keys = [
            ("sweep_deg", &self.sweep_deg, SWEEPS_DEG),
            ("start_deg", &self.start_deg, STARTS_DEG),
            ("overshoot_deg", &self.overshoot_deg, OVERSHOOTS_DEG),
        ];
        let of_strategy = self.strategy.as_ref().and_then(|name| Planes::parse(name.get_ref()));
        let Some(planes) = of_strategy else {
            let given = keys.into_iter().find_map(|(key, value, _)| Some((key, value.as_ref()?)));
            return match given {
                None => Ok(None),
                Some((key, value)) => Err(Error::input(format!(
                    "`{key}` belongs to the strategies of planes"
                ))
                .at(text.place(value.span()))
                .hint(format!(
                    "write `strategy = \"xy\"`, or one of `{}`; a `[[plan.arc]]` has angles of its own",
                    Planes::ALL.map(Planes::name).join("`, `")
                ))),
            };
        };
        let [sweep_deg, start_deg, overshoot_deg] = keys.map(|(key, value, [low, high])| {
            value.as_ref().map(|value| text.within(value, key, low, high)).transpose()
        });
        Ok(Some(Planar {
            planes,
            sweep_deg: sweep_deg?,
            start_deg: start_deg?,
            overshoot_deg: overshoot_deg?,
        }))
    }

    /// Circles in planes are driven as every control and every user of a ball-bar knows them.
    fn interpolation(&self, planar: bool, text: &Text<'_>) -> Result<Interpolation> {
        let Some(name) = &self.interpolation else {
            return Ok(if planar { Interpolation::Arcs } else { Interpolation::Chords });
        };
        let known = Interpolation::ALL.into_iter().find(|way| way.name() == name.get_ref());
        known.ok_or_else(|| {
            Error::input(format!("unknown interpolation `{}`", name.get_ref()))
                .at(text.place(name.span()))
                .hint("write `arcs` (G02 and G03) or `chords` (G01)")
        })
    }
}

/// A strategy that is none of planes.
fn on_sphere(name: &Spanned<String>, text: &Text<'_>) -> Result<Strategy> {
    Strategy::parse(name.get_ref()).ok_or_else(|| {
        let of_planes = Planes::ALL.map(Planes::name);
        let names = [of_planes, Strategy::ALL.map(Strategy::name)].concat().join("`, `");
        Error::input(format!("unknown strategy `{}`", name.get_ref()))
            .at(text.place(name.span()))
            .hint(format!("write one of `{names}`, or leave it out and give `[[plan.arc]]`"))
    })
}
