//! The sections of a test file as they are written, and the checks that make them types.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::design_request::RawDesign;
use super::operator::RawOperator;
use super::parts::{BallBar, Estimation, NamedMounting, Run};
use super::raw_log::RawLog;
use super::raw_mounting::{LENGTHS_MM, RawMounting, check_length, mounting_index};
use super::raw_plan::RawPlan;
use super::record::RawRecord;
use super::tolerance::RawTolerance;
use crate::error::{Error, Result};
use crate::file_name;
use crate::model;
use crate::solve::Loss;
use crate::toml_text::Text;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawTest {
    pub(super) name: String,
    pub(super) machine: String,
    pub(super) ball_bar: RawBallBar,
    #[serde(default)]
    pub(super) log: RawLog,
    pub(super) mounting: Vec<RawMounting>,
    pub(super) plan: Option<RawPlan>,
    pub(super) design: Option<RawDesign>,
    #[serde(default)]
    pub(super) operator: RawOperator,
    #[serde(default)]
    pub(super) record: RawRecord,
    #[serde(default)]
    pub(super) identify: RawEstimation,
    #[serde(default)]
    pub(super) tolerance: RawTolerance,
    #[serde(default)]
    pub(super) run: Vec<RawRun>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawBallBar {
    length_mm: Spanned<f64>,
    range_mm: Option<Spanned<f64>>,
    resolution_um: Option<Spanned<f64>>,
    noise_um: Option<Spanned<f64>>,
    correlated_um: Option<Spanned<f64>>,
    correlation_s: Option<Spanned<f64>>,
    clock_ppm: Option<Spanned<f64>>,
    length_sigma_um: Option<Spanned<f64>>,
    scale_sigma_percent: Option<Spanned<f64>>,
}

/// How far a bar reads either way, mm: no log with more is read.
const RANGES_MM: [f64; 2] = [0.01, 10.0];
/// Noise of a reading, um: from a tenth of a nanometre, which nothing reads, to a millimetre, which is no measurement.
const NOISES_UM: [f64; 2] = [1e-4, 1e3];
/// Smallest steps of a reading, um, on either side of what can be told from the noise.
const STEPS_UM: [f64; 2] = [1e-6, 1e3];
/// How long noise lasts, s: from less than two readings at the highest rate are apart to longer than a shift.
pub(crate) const CORRELATIONS_S: [f64; 2] = [1e-4, 1e5];
/// How far two clocks may be apart, parts per million: from a good oven to 1 %, where it is another feed.
const CLOCKS_PPM: [f64; 2] = [1e-3, 1e4];
/// How well the length of a bar is known, um: from better than any calibration to a bar that nobody measured.
const LENGTH_SIGMAS_UM: [f64; 2] = [0.01, 1e3];
/// How well the scale of a bar is known, percent: 0 leaves it out, beyond 10 it was never calibrated.
const SCALE_SIGMAS_PERCENT: [f64; 2] = [0.0, 10.0];
/// Of a bar whose maker states 0.3 % of what is read beside a constant part, as is known of the QC20-W: 0.3 % / sqrt(3),
/// rounded up.
const SCALE_SIGMA_PERCENT: f64 = 0.2;

impl RawBallBar {
    pub(super) fn check(self, log: &RawLog, text: &Text<'_>) -> Result<BallBar> {
        // Defaults: a QC20-W reads a little over 1 mm either way in steps of 0.1 um.
        let or = |value: Option<Spanned<f64>>, key: &str, default: f64, [low, high]: [f64; 2]| {
            value.map_or(Ok(default), |value| text.within(&value, key, low, high))
        };
        let length_mm = text.within(&self.length_mm, "length_mm", LENGTHS_MM[0], LENGTHS_MM[1])?;
        let range_mm = or(self.range_mm, "range_mm", 1.2, RANGES_MM)?;
        check_length(length_mm, range_mm, text.place(self.length_mm.span()))?;
        let noise_mm = or(self.noise_um, "noise_um", 0.15, NOISES_UM)? * 1e-3;
        let correlated_mm = match &self.correlated_um {
            None => 0.0,
            Some(given) => text.within(given, "correlated_um", 0.0, noise_mm * 1e3)? * 1e-3,
        };
        Ok(BallBar {
            length_mm,
            range_mm,
            resolution_mm: or(self.resolution_um, "resolution_um", 0.1, STEPS_UM)? * 1e-3,
            noise_mm,
            correlated_mm,
            correlation_s: or(self.correlation_s, "correlation_s", 0.3, CORRELATIONS_S)?,
            sample_rate_hz: log.sample_rate_hz(text)?.unwrap_or(10.0),
            length_sigma_mm: match &self.length_sigma_um {
                None => None,
                Some(given) => {
                    let [low, high] = LENGTH_SIGMAS_UM;
                    Some(text.within(given, "length_sigma_um", low, high)? * 1e-3)
                }
            },
            scale_sigma: 1e-2
                * or(
                    self.scale_sigma_percent,
                    "scale_sigma_percent",
                    SCALE_SIGMA_PERCENT,
                    SCALE_SIGMAS_PERCENT,
                )?,
            clock_tolerance: or(self.clock_ppm, "clock_ppm", 100.0, CLOCKS_PPM)? * 1e-6,
        })
    }
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawEstimation {
    terms: Option<Spanned<Vec<String>>>,
    #[serde(default)]
    loss: Loss,
    #[serde(default)]
    minimum_norm: bool,
}

impl RawEstimation {
    pub(super) fn check(self, text: &Text<'_>) -> Result<Estimation> {
        let terms = match self.terms {
            None => vec![model::LOCAL.to_owned()],
            Some(written) => {
                check_terms(written.get_ref())
                    .map_err(|error| error.at(text.place(written.span())))?;
                written.into_inner()
            }
        };
        let minimum_norm = self.minimum_norm || terms.iter().any(|name| name == "all");
        Ok(Estimation { terms, loss: self.loss, minimum_norm, curves: Vec::new() })
    }
}

/// Checks that a list of terms can be estimated together.
fn check_terms(names: &[String]) -> Result<()> {
    if !names.iter().any(|name| name == model::LOCAL) {
        return model::terms(names, &[String::new()]).map(|_| ());
    }
    let others: Vec<String> = names.iter().filter(|name| *name != model::LOCAL).cloned().collect();
    if let Some(other) = others.iter().find(|name| !name.contains(':')) {
        return Err(Error::input(format!("`{other}` cannot stand beside `{}`", model::LOCAL)).hint(
            "`local` describes the whole machine where it was measured: leave one of the two out; effects such as `cyclic:on=EXX,period_mm=10` may stand beside it",
        ));
    }
    if others.is_empty() { Ok(()) } else { model::terms(&others, &[String::new()]).map(|_| ()) }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawRun {
    pub(super) program: Spanned<String>,
    log: Spanned<String>,
    motion: Option<String>,
    name: Option<Spanned<String>>,
    mounting: Option<Spanned<String>>,
    feed_override_percent: Option<Spanned<f64>>,
    repeat: Option<u32>,
}

impl RawRun {
    pub(super) fn check(
        self,
        before: &[Run],
        mountings: &[NamedMounting],
        beside: &dyn Fn(&str) -> PathBuf,
        text: &Text<'_>,
    ) -> Result<Run> {
        let mounting = match &self.mounting {
            None => 0,
            Some(name) => mounting_index(name, mountings, text)?,
        };
        let percent = match &self.feed_override_percent {
            None => 100.0,
            Some(percent) => text.within(percent, "feed_override_percent", 1.0, 200.0)?,
        };
        let stem = |path: &str| {
            let name =
                Path::new(path).file_name().map_or(String::new(), |n| n.to_string_lossy().into());
            name.trim_end_matches(".gz")
                .rsplit_once('.')
                .map_or(name.clone(), |(stem, _)| stem.into())
        };
        let span = self.name.as_ref().map_or_else(|| self.log.span(), Spanned::span);
        let name = match self.name {
            Some(name) => name.into_inner(),
            None => stem(self.log.get_ref()),
        };
        check_run_name(&name, before).map_err(|error| error.at(text.place(span)))?;
        Ok(Run {
            name,
            program: beside(self.program.get_ref()),
            log: beside(self.log.get_ref()),
            motion: self.motion.as_deref().map(beside),
            mounting,
            feed_override: percent / 100.0,
            repeat: self.repeat.unwrap_or(before.len() as u32 + 1),
            line: text.place(self.program.span()).line,
        })
    }
}

/// Longest name of a run, bytes: `samples-NAME.csv` must be a name of a file everywhere.
const LONGEST_NAME: usize = 200;

/// A run's name becomes part of the name of its file of samples: it must be one that a file can have,
/// and no other run may have it, or one file would replace the other.
fn check_run_name(name: &str, before: &[Run]) -> Result<()> {
    if name.trim().is_empty() || name.len() > LONGEST_NAME || !name.chars().all(file_name::may_have)
    {
        let windows = if cfg!(windows) { ", `<`, `>`, `:`, `\"`, `|`, `?` and `*`" } else { "" };
        return Err(Error::input("the name of a run must be one that a file can have").hint(format!(
            "give it a `name` of 1 to {LONGEST_NAME} bytes without slashes and control characters{windows}: its samples go to `samples-NAME.csv`"
        )));
    }
    // Some file systems do not tell upper from lower case.
    if before.iter().any(|run| run.name.to_lowercase() == name.to_lowercase()) {
        return Err(Error::input(format!("there is another run `{name}`")).hint(format!(
            "a run is called as its log unless it has a name: give it one of its own, such as `name = \"{name}-{}\"`",
            before.len() + 1
        )));
    }
    Ok(())
}
