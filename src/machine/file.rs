//! The machine file: TOML in, a checked [`Machine`] out.

use std::ops::Range;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use serde::Deserialize;
use toml::Spanned;

use super::axis::Axis;
use super::clearance::Clearance;
use super::clearance::RawClearance;
use super::plausible::{Plausible, RawPlausible};
use super::topology::Topology;
use crate::error::{Error, Place, Result};
use crate::toml_text::{self, Text};

/// Where a slide turns when it has an angular error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Pivot {
    /// On the moving carriage: `T_motion · T_error`, the order of the paper's Eq. 1.
    #[default]
    Carriage,
    /// On the guide: `T_error · T_motion`.
    Base,
}

/// One linear axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Slide {
    /// Lowest and highest machine coordinate, mm.
    pub travel_mm: [f64; 2],
    /// Rapid traverse, mm/s.
    pub rapid_mm_s: f64,
    /// Acceleration at rapid, mm/s².
    pub acceleration_mm_s2: f64,
    /// Fastest cutting feed, mm/s; infinite where the machine file gives none.
    pub max_feed_mm_s: f64,
    /// Acceleration at feed, mm/s²; infinite where only that along the path counts.
    pub feed_acceleration_mm_s2: f64,
    /// Where the slide turns.
    pub pivot: Pivot,
    /// Lead of the ball screw, mm, where known.
    pub screw_pitch_mm: Option<f64>,
    /// Machine coordinate that it retracts to, mm; of use for Z, whose upper end takes the tool away from the workpiece.
    pub retract_mm: f64,
    /// `T_location`: origin of the slide's frame on its neighbour at position 0, mm.
    pub location_mm: Vector3<f64>,
}

/// Which control reads the programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dialect {
    /// Fanuc 15i/150i and its relatives.
    #[default]
    Fanuc,
    /// LinuxCNC, RS274/NGC.
    LinuxCnc,
}

impl Dialect {
    /// All, the default first.
    pub const ALL: [Self; 2] = [Self::Fanuc, Self::LinuxCnc];

    /// Its name in a machine file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fanuc => "fanuc",
            Self::LinuxCnc => "linuxcnc",
        }
    }
}

/// What the control writes, reads and does at corners.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// The dialect of the programs.
    pub dialect: Dialect,
    /// Decimals of an axis word.
    pub decimals: usize,
    /// Step of the N numbers; 0 writes none.
    pub sequence_step: u32,
    /// Characters allowed in comments besides letters and digits.
    pub comment_characters: String,
    /// Block that switches look-ahead on, empty for none.
    pub look_ahead_on: String,
    /// Block that switches look-ahead off, empty for none.
    pub look_ahead_off: String,
    /// Acceleration along the path at feed, mm/s².
    pub path_acceleration_mm_s2: f64,
    /// Corners sharper than this are taken with a stop, rad.
    pub corner_stop_rad: f64,
    /// By how much the speed of a slide may jump at a corner, mm/s; infinite where only
    /// [`Controller::corner_stop_rad`] counts.
    pub corner_speed_step_mm_s: f64,
    /// Within how much the control rounds corners, mm: the arc that fits is driven with the acceleration
    /// of the path across it. Infinite where that does not limit the speed.
    pub corner_tolerance_mm: f64,
    /// In how much time the acceleration along the path builds up, s; 0 at once. The jerk is the
    /// acceleration over this time.
    pub acceleration_change_s: f64,
    /// Time that the control needs to prepare a block, s; 0 none.
    pub block_time_s: f64,
    /// Largest program that the control's memory holds, bytes; none if it does not matter.
    pub memory_bytes: Option<usize>,
}

/// A checked machine description.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    name: String,
    file: PathBuf,
    topology: Topology,
    slides: [Slide; 3],
    controller: Controller,
    clearance: Clearance,
    plausible: Plausible,
}

impl Machine {
    /// Reads and checks a machine file.
    pub fn read(file: &Path) -> Result<Self> {
        Self::parse(&toml_text::read(file)?, file)
    }

    /// Checks the text of a machine file; `file` is for messages.
    pub fn parse(source: &str, file: &Path) -> Result<Self> {
        let text = Text { source, file };
        let raw: RawMachine = text.parse()?;
        let topology = Topology::parse(raw.topology.get_ref())
            .map_err(|error| error.at(text.place(raw.topology.span())))?;
        if raw.name.trim().is_empty() {
            return Err(Error::input("the machine has no name").at(Place::file(file)));
        }
        let slides = [
            raw.axes.x.check(Axis::X, &text)?,
            raw.axes.y.check(Axis::Y, &text)?,
            raw.axes.z.check(Axis::Z, &text)?,
        ];
        let controller = raw.controller.check(&text)?;
        let clearance = raw.clearance.check(&text)?;
        let plausible = raw.plausible.check(&text)?;
        Ok(Self {
            name: raw.name,
            file: file.to_path_buf(),
            topology,
            slides,
            controller,
            clearance,
            plausible,
        })
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file that it was read from.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The order of the slides.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// One slide.
    pub fn slide(&self, axis: Axis) -> &Slide {
        &self.slides[axis.index()]
    }

    /// The control.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The bodies behind the balls.
    pub fn clearance(&self) -> &Clearance {
        &self.clearance
    }

    /// How large its errors plausibly are.
    pub fn plausible(&self) -> &Plausible {
        &self.plausible
    }

    /// The same machine with the pivot of one slide moved.
    #[must_use]
    pub fn with_pivot(mut self, axis: Axis, pivot: Pivot) -> Self {
        self.slides[axis.index()].pivot = pivot;
        self
    }

    /// The same machine with all accelerations multiplied and, where it is given, another time in which they build
    /// up, s.
    #[must_use]
    pub fn with_accelerations(mut self, factor: f64, change_s: Option<f64>) -> Self {
        for slide in &mut self.slides {
            slide.acceleration_mm_s2 *= factor;
            slide.feed_acceleration_mm_s2 *= factor;
        }
        self.controller.path_acceleration_mm_s2 *= factor;
        self.controller.acceleration_change_s =
            change_s.unwrap_or(self.controller.acceleration_change_s);
        self
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawMachine {
    name: String,
    topology: Spanned<String>,
    axes: RawAxes,
    #[serde(default)]
    controller: RawController,
    #[serde(default)]
    clearance: RawClearance,
    #[serde(default)]
    plausible: RawPlausible,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "UPPERCASE")]
struct RawAxes {
    x: RawSlide,
    y: RawSlide,
    z: RawSlide,
}

/// So far below the end of its travel a slide retracts to, mm: files round travels to a millimetre.
const BELOW_THE_END_MM: f64 = 1.0;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSlide {
    travel_mm: Spanned<[f64; 2]>,
    rapid_mm_min: Spanned<f64>,
    acceleration_mm_s2: Spanned<f64>,
    max_feed_mm_min: Option<Spanned<f64>>,
    feed_acceleration_mm_s2: Option<Spanned<f64>>,
    #[serde(default)]
    pivot: Pivot,
    screw_pitch_mm: Option<Spanned<f64>>,
    retract_mm: Option<Spanned<f64>>,
    #[serde(default)]
    location_mm: Option<Spanned<[f64; 3]>>,
}

impl RawSlide {
    fn check(self, axis: Axis, text: &Text<'_>) -> Result<Slide> {
        let [low, high] = *self.travel_mm.get_ref();
        if !(low.is_finite() && high.is_finite() && low < high) {
            return Err(Error::input(format!(
                "travel of axis {axis} goes from {low} to {high} mm"
            ))
            .at(text.place(self.travel_mm.span()))
            .hint(
                "give the lowest machine coordinate first, such as `travel_mm = [-250.0, 250.0]`",
            ));
        }
        let location = match &self.location_mm {
            None => Vector3::zeros(),
            Some(at) => text.finite_vector(at, "location_mm")?,
        };
        let retract_mm = match &self.retract_mm {
            None => (high - BELOW_THE_END_MM).max(low),
            Some(at) => text.within(at, "retract_mm", low, high)?,
        };
        let no_limit_without = |value: &Option<Spanned<f64>>, key: &str| {
            value.as_ref().map_or(Ok(f64::INFINITY), |value| text.positive(value, key))
        };
        Ok(Slide {
            travel_mm: [low, high],
            rapid_mm_s: text.positive(&self.rapid_mm_min, "rapid_mm_min")? / 60.0,
            acceleration_mm_s2: text.positive(&self.acceleration_mm_s2, "acceleration_mm_s2")?,
            max_feed_mm_s: no_limit_without(&self.max_feed_mm_min, "max_feed_mm_min")? / 60.0,
            feed_acceleration_mm_s2: no_limit_without(
                &self.feed_acceleration_mm_s2,
                "feed_acceleration_mm_s2",
            )?,
            pivot: self.pivot,
            screw_pitch_mm: self
                .screw_pitch_mm
                .map(|pitch| text.positive(&pitch, "screw_pitch_mm"))
                .transpose()?,
            retract_mm,
            location_mm: location,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawController {
    dialect: Spanned<String>,
    decimals: Spanned<usize>,
    sequence_step: Spanned<u32>,
    comment_characters: String,
    look_ahead_on: Spanned<String>,
    look_ahead_off: Spanned<String>,
    path_acceleration_mm_s2: Spanned<f64>,
    corner_stop_deg: Spanned<f64>,
    corner_speed_step_mm_min: Option<Spanned<f64>>,
    corner_tolerance_um: Option<Spanned<f64>>,
    acceleration_change_ms: Spanned<f64>,
    block_time_ms: Spanned<f64>,
    memory_kb: Option<Spanned<f64>>,
}

impl Default for RawController {
    fn default() -> Self {
        fn bare<T>(value: T) -> Spanned<T> {
            Spanned::new(Range { start: 0, end: 0 }, value)
        }
        Self {
            dialect: bare("fanuc".into()),
            decimals: bare(3),
            sequence_step: bare(10),
            // The characters that the generic Fanuc post-processors let through.
            comment_characters: " .,=_-".into(),
            look_ahead_on: bare(String::new()),
            look_ahead_off: bare(String::new()),
            path_acceleration_mm_s2: bare(500.0),
            corner_stop_deg: bare(25.0),
            corner_speed_step_mm_min: None,
            corner_tolerance_um: None,
            acceleration_change_ms: bare(0.0),
            block_time_ms: bare(0.0),
            memory_kb: None,
        }
    }
}

impl RawController {
    fn check(self, text: &Text<'_>) -> Result<Controller> {
        let name = self.dialect.get_ref();
        let dialect =
            Dialect::ALL.into_iter().find(|dialect| dialect.name() == name).ok_or_else(|| {
                Error::input(format!("unknown dialect `{name}`"))
                    .at(text.place(self.dialect.span()))
                    .hint("write `dialect = \"fanuc\"` or `dialect = \"linuxcnc\"`")
            })?;
        let decimals = *self.decimals.get_ref();
        if !(2..=6).contains(&decimals) {
            return Err(Error::input(format!("an axis word cannot have {decimals} decimals"))
                .at(text.place(self.decimals.span()))
                .hint("increment system IS-B has 3 decimals, IS-C has 4"));
        }
        for block in [&self.look_ahead_on, &self.look_ahead_off] {
            check_look_ahead(block, dialect, text)?;
        }
        let sequence_step = *self.sequence_step.get_ref();
        if sequence_step > LARGEST_STEP {
            return Err(Error::input(format!(
                "blocks cannot be numbered in steps of {sequence_step}"
            ))
            .at(text.place(self.sequence_step.span()))
            .hint(format!("give 1 to {LARGEST_STEP}, or 0 for no numbers")));
        }
        let corner_deg = *self.corner_stop_deg.get_ref();
        if !(0.0..=180.0).contains(&corner_deg) {
            return Err(Error::input(format!("a corner of {corner_deg} degrees cannot be"))
                .at(text.place(self.corner_stop_deg.span()))
                .hint("give the angle between the two directions of motion, 0 to 180"));
        }
        Ok(Controller {
            dialect,
            decimals,
            sequence_step,
            comment_characters: self.comment_characters,
            look_ahead_on: self.look_ahead_on.into_inner(),
            look_ahead_off: self.look_ahead_off.into_inner(),
            path_acceleration_mm_s2: text
                .positive(&self.path_acceleration_mm_s2, "path_acceleration_mm_s2")?,
            corner_stop_rad: corner_deg.to_radians(),
            corner_speed_step_mm_s: match &self.corner_speed_step_mm_min {
                None => f64::INFINITY,
                Some(step) => text.positive(step, "corner_speed_step_mm_min")? / 60.0,
            },
            corner_tolerance_mm: match &self.corner_tolerance_um {
                None => f64::INFINITY,
                Some(tolerance) => text.positive(tolerance, "corner_tolerance_um")? * 1e-3,
            },
            acceleration_change_s: text.within(
                &self.acceleration_change_ms,
                "acceleration_change_ms",
                0.0,
                1000.0,
            )? * 1e-3,
            block_time_s: text.within(&self.block_time_ms, "block_time_ms", 0.0, 1000.0)? * 1e-3,
            memory_bytes: match &self.memory_kb {
                None => None,
                Some(memory) => Some((text.positive(memory, "memory_kb")? * 1024.0) as usize),
            },
        })
    }
}

/// N numbers go to 99999 and then begin anew, which leaves a hundred of them different.
const LARGEST_STEP: u32 = 1000;

/// A block around every arc switches the look-ahead and does nothing else: G05.1 Q, G05 P or G08 P with a number, alone.
fn check_look_ahead(block: &Spanned<String>, dialect: Dialect, text: &Text<'_>) -> Result<()> {
    let written = block.get_ref();
    let words: String = written.split_whitespace().collect();
    let switches = |begin: &str| {
        let argument = words.strip_prefix(begin);
        argument.is_some_and(|n| !n.is_empty() && n.bytes().all(|c| c.is_ascii_digit()))
    };
    let known = ["G05.1Q", "G5.1Q", "G05P", "G5P", "G08P", "G8P"];
    if words.is_empty() || (dialect == Dialect::Fanuc && known.into_iter().any(switches)) {
        return Ok(());
    }
    Err(Error::input(format!("`{written}` does not switch a look-ahead"))
        .at(text.place(block.span()))
        .hint(match dialect {
            Dialect::Fanuc => {
                "write `G05.1 Q1`, `G05 P10000` or `G08 P1`, off with 0, or leave it empty"
            }
            Dialect::LinuxCnc => "LinuxCNC has no word for it: leave it empty",
        }))
}
