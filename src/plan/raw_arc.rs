//! A free arc as a test file writes it.

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{Unit, UnitVector3, Vector3};
use serde::Deserialize;
use toml::Spanned;

use super::arc::Arc;
use super::parts::{FreeArc, NamedMounting};
use super::raw_mounting::mounting_index;
use crate::error::{Error, Result};
use crate::toml_text::Text;

#[derive(Deserialize, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
enum RawArcKind {
    /// Constant polar angle; the equator unless `polar_deg` says otherwise.
    Equator,
    Parallel,
    Meridian,
    Circle,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawArc {
    kind: RawArcKind,
    name: Option<String>,
    azimuth_deg: Option<f64>,
    polar_deg: Option<f64>,
    start_deg: Option<f64>,
    sweep_deg: Option<f64>,
    start: Option<[f64; 3]>,
    normal: Option<[f64; 3]>,
    mountings: Option<Spanned<Vec<Spanned<String>>>>,
}

/// Largest component of a direction: only its sense counts.
const LARGEST_COMPONENT: f64 = 1e6;

impl RawArc {
    /// Checks the free arc of an index; `span` is its table in the file.
    pub(super) fn check(
        &self,
        index: usize,
        span: Range<usize>,
        mountings: &[NamedMounting],
        text: &Text<'_>,
    ) -> Result<FreeArc> {
        let place = text.place(span);
        let wrong = |what: &str, hint: &str| {
            Err(Error::input(format!("arc {}: {what}", index + 1)).at(place.clone()).hint(hint))
        };
        let allowed: &[&str] = match self.kind {
            RawArcKind::Equator => &["azimuth_deg", "sweep_deg"],
            RawArcKind::Parallel => &["azimuth_deg", "sweep_deg", "polar_deg"],
            RawArcKind::Meridian => &["azimuth_deg", "sweep_deg", "start_deg"],
            RawArcKind::Circle => &["start", "normal", "sweep_deg"],
        };
        let given = [
            ("azimuth_deg", self.azimuth_deg.is_some()),
            ("polar_deg", self.polar_deg.is_some()),
            ("start_deg", self.start_deg.is_some()),
            ("sweep_deg", self.sweep_deg.is_some()),
            ("start", self.start.is_some()),
            ("normal", self.normal.is_some()),
        ];
        if let Some((key, _)) = given.iter().find(|(key, is)| *is && !allowed.contains(key)) {
            return wrong(
                &format!("`{key}` does not belong to this kind of arc"),
                &format!("its keys are `{}`", allowed.join("`, `")),
            );
        }
        let whole_deg = if self.kind == RawArcKind::Meridian { 180.0 } else { 360.0 };
        let sweep_deg = self.sweep_deg.unwrap_or(whole_deg);
        let angles = [self.azimuth_deg, self.polar_deg, self.start_deg, Some(sweep_deg)];
        if angles.iter().flatten().any(|angle| !angle.is_finite() || angle.abs() > 360.0)
            || sweep_deg.abs() < 0.1
        {
            return wrong(
                "an angle is out of bounds",
                "angles go to 360, sweeps from 0.1 to 360 degrees",
            );
        }
        let rad = |angle: Option<f64>, default_deg: f64| angle.unwrap_or(default_deg).to_radians();
        let (azimuth_rad, sweep_rad) = (rad(self.azimuth_deg, 0.0), sweep_deg.to_radians());
        let default_name = format!("ARC {}", index + 1);
        let name = self.name.as_deref().unwrap_or(&default_name).to_uppercase();
        let arc = match self.kind {
            RawArcKind::Equator => Arc::equator(&name, azimuth_rad, sweep_rad),
            RawArcKind::Parallel => {
                Arc::parallel(&name, rad(self.polar_deg, 90.0), azimuth_rad, sweep_rad)
            }
            RawArcKind::Meridian => {
                Arc::meridian(&name, azimuth_rad, rad(self.start_deg, 0.0), sweep_rad)
            }
            RawArcKind::Circle => {
                let unit = |v: Option<[f64; 3]>| -> Option<UnitVector3<f64>> {
                    // The square of what is larger might not be a number.
                    let v = v.filter(|v| v.iter().all(|x| x.abs() <= LARGEST_COMPONENT))?;
                    Unit::try_new(Vector3::from(v), 1e-6)
                };
                let (Some(start), Some(normal)) = (unit(self.start), unit(self.normal)) else {
                    return wrong(
                        "`start` and `normal` must be vectors that are not zero, with components from -1000000 to 1000000",
                        "`start` points from the workpiece ball to the first point, `normal` is the axis that the arc turns about",
                    );
                };
                Arc { name, start, normal, sweep_rad }
            }
        };
        if arc.circle_radius_mm(1.0) < 0.02 {
            return wrong(
                "its circle shrinks to a point",
                "move its start away from the axis that it turns about",
            );
        }
        if arc.sweep_rad.abs() > 2.0 * PI + 1e-9 {
            return wrong("it sweeps more than one turn", "give at most 360 degrees");
        }
        Ok(FreeArc { arc, mountings: self.check_mountings(mountings, text)? })
    }

    /// Indices of the mountings that drive it.
    fn check_mountings(&self, known: &[NamedMounting], text: &Text<'_>) -> Result<Vec<usize>> {
        let Some(written) = &self.mountings else {
            return Ok((0..known.len()).collect());
        };
        if written.get_ref().is_empty() {
            return Err(Error::input("an arc of no mounting is never driven")
                .at(text.place(written.span()))
                .hint("leave `mountings` out to drive it in every mounting"));
        }
        let named = written.get_ref();
        let all =
            named.iter().map(|name| mounting_index(name, known, text)).collect::<Result<_>>()?;
        let (beyond, hint) = (named.get(known.len()).map(Spanned::span), "name each mounting once");
        text.at_most(named.len(), known.len(), "mountings for an arc", beyond, hint)?;
        Ok(all)
    }
}
