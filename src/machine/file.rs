//! The machine file: TOML in, a checked [`Machine`] out.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::axis::Axis;
use super::bounds::{ACCELERATIONS_MM_S2, PITCHES_MM, SPEEDS_MM_MIN};
use super::clearance::Clearance;
use super::clearance::RawClearance;
use super::controller::{Controller, RawController};
use super::plausible::{Plausible, RawPlausible};
use super::topology::Topology;
use crate::error::{Error, Place, Result};
use crate::toml_text::{self, FARTHEST_MM, Text, short};

/// Where a slide turns when it has an angular error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
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
        if !(-FARTHEST_MM <= low && low < high && high <= FARTHEST_MM) {
            return Err(Error::input(format!(
                "travel of axis {axis} goes from {} to {} mm; it must go upwards and stay between -{FARTHEST_MM} and {FARTHEST_MM}",
                short(low),
                short(high)
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
        let no_limit_without = |value: &Option<Spanned<f64>>, key: &str, [low, high]: [f64; 2]| {
            value.as_ref().map_or(Ok(f64::INFINITY), |value| text.within(value, key, low, high))
        };
        let [slowest, fastest] = SPEEDS_MM_MIN;
        let [softest, hardest] = ACCELERATIONS_MM_S2;
        Ok(Slide {
            travel_mm: [low, high],
            rapid_mm_s: text.within(&self.rapid_mm_min, "rapid_mm_min", slowest, fastest)? / 60.0,
            acceleration_mm_s2: text.within(
                &self.acceleration_mm_s2,
                "acceleration_mm_s2",
                softest,
                hardest,
            )?,
            max_feed_mm_s: no_limit_without(
                &self.max_feed_mm_min,
                "max_feed_mm_min",
                SPEEDS_MM_MIN,
            )? / 60.0,
            feed_acceleration_mm_s2: no_limit_without(
                &self.feed_acceleration_mm_s2,
                "feed_acceleration_mm_s2",
                ACCELERATIONS_MM_S2,
            )?,
            pivot: self.pivot,
            screw_pitch_mm: self
                .screw_pitch_mm
                .map(|pitch| text.within(&pitch, "screw_pitch_mm", PITCHES_MM[0], PITCHES_MM[1]))
                .transpose()?,
            retract_mm,
            location_mm: location,
        })
    }
}
