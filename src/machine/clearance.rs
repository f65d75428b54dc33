//! What stands behind the two balls, as solid cylinders, and how near two of them come.

use nalgebra::{Unit, UnitVector3, Vector3};
use serde::Deserialize;
use toml::Spanned;

use crate::error::{Error, Result};
use crate::toml_text::Text;

/// A solid cylinder with flat ends. It is given from the centre of the ball that it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// Centre of its first end, mm.
    pub start_mm: Vector3<f64>,
    /// From its first end to its second.
    pub axis: UnitVector3<f64>,
    /// Distance of the ends, mm.
    pub length_mm: f64,
    /// Half of its diameter, mm.
    pub radius_mm: f64,
}

/// The bodies behind the balls, in directions of `F`; what the machine file does not name is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Clearance {
    /// Holder of the tool ball, from the ball along the tool axis +Z.
    pub tool: Option<Cylinder>,
    /// Spindle nose, from the end of the tool along +Z; from the tool ball too.
    pub spindle_nose: Option<Cylinder>,
    /// Post of the workpiece ball, from that ball.
    pub support: Option<Cylinder>,
}

/// Sizes of a body behind a ball, mm: none is thinner than a tenth of a millimetre or larger than ten metres.
const SIZES_MM: [f64; 2] = [0.1, 10_000.0];
/// A step that brings two points nearer by less than this is the last, mm.
const NEGLIGIBLE_MM: f64 = 1e-9;
/// What is nearer than this touches, mm: there the projections gain less and less.
const TOUCHING_MM: f64 = 1e-3;
/// Most projections; some ten are usual.
const MOST_STEPS: usize = 10_000;

impl Cylinder {
    /// The point of the cylinder nearest to a point, mm: clamped along the axis and towards it.
    fn nearest_mm(&self, point_mm: &Vector3<f64>) -> Vector3<f64> {
        let from_start = point_mm - self.start_mm;
        let along_mm = from_start.dot(&self.axis);
        let aside = from_start - self.axis.into_inner() * along_mm;
        let share = (self.radius_mm / aside.norm()).min(1.0);
        let along_mm = along_mm.clamp(0.0, self.length_mm);
        self.start_mm + self.axis.into_inner() * along_mm + aside * share
    }

    /// Least distance to another cylinder that stands displaced by a vector, mm; 0 where they touch or
    /// overlap.
    ///
    /// `min |a - b|` over the points `a` of one and `b` of the other, by alternate projections
    /// `b -> a -> b ..`, which converge for convex bodies (Cheney and Goldstein, 1959).
    pub fn distance_mm(&self, other: &Self, displacement_mm: &Vector3<f64>) -> f64 {
        let other = Self { start_mm: other.start_mm + displacement_mm, ..*other };
        let mut b_mm = other.start_mm;
        let mut distance_mm = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let a_mm = self.nearest_mm(&b_mm);
            b_mm = other.nearest_mm(&a_mm);
            let before_mm = distance_mm;
            distance_mm = (b_mm - a_mm).norm();
            if distance_mm < TOUCHING_MM {
                return 0.0;
            }
            if before_mm - distance_mm < NEGLIGIBLE_MM {
                break;
            }
        }
        distance_mm
    }
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawClearance {
    tool: Option<RawCylinder>,
    spindle_nose: Option<RawCylinder>,
    support: Option<RawSupport>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCylinder {
    diameter_mm: Spanned<f64>,
    length_mm: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSupport {
    diameter_mm: Spanned<f64>,
    length_mm: Spanned<f64>,
    direction: Option<Spanned<String>>,
}

impl RawClearance {
    pub(super) fn check(&self, text: &Text<'_>) -> Result<Clearance> {
        let cylinder = |diameter_mm: &Spanned<f64>,
                        length_mm: &Spanned<f64>,
                        axis: UnitVector3<f64>,
                        from_ball_mm: f64| {
            Ok(Cylinder {
                start_mm: axis.into_inner() * from_ball_mm,
                axis,
                length_mm: text.within(length_mm, "length_mm", SIZES_MM[0], SIZES_MM[1])?,
                radius_mm: 0.5
                    * text.within(diameter_mm, "diameter_mm", SIZES_MM[0], SIZES_MM[1])?,
            })
        };
        let behind_tool = |raw: &RawCylinder, from_ball_mm: f64| {
            cylinder(&raw.diameter_mm, &raw.length_mm, Vector3::z_axis(), from_ball_mm)
        };
        let tool = self.tool.as_ref().map(|raw| behind_tool(raw, 0.0)).transpose()?;
        let tool_mm = tool.map_or(0.0, |tool| tool.length_mm);
        let spindle_nose =
            self.spindle_nose.as_ref().map(|raw| behind_tool(raw, tool_mm)).transpose()?;
        let support = self.support.as_ref().map(|raw| {
            let axis = match &raw.direction {
                None => -Vector3::z_axis(),
                Some(written) => direction(written, text)?,
            };
            cylinder(&raw.diameter_mm, &raw.length_mm, axis, 0.0)
        });
        Ok(Clearance { tool, spindle_nose, support: support.transpose()? })
    }
}

/// The direction of a sign and an axis letter.
fn direction(written: &Spanned<String>, text: &Text<'_>) -> Result<UnitVector3<f64>> {
    let known = ["+X", "-X", "+Y", "-Y", "+Z", "-Z"];
    let index = known.iter().position(|known| *known == written.get_ref().as_str());
    let index = index.ok_or_else(|| {
        Error::input(format!("`{}` is not a direction", written.get_ref()))
            .at(text.place(written.span()))
            .hint(format!("write one of `{}`", known.join("`, `")))
    })?;
    let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
    Ok(Unit::new_unchecked(Vector3::ith(index / 2, sign)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn along(axis: [f64; 3], length_mm: f64, radius_mm: f64) -> Cylinder {
        let axis = Unit::new_normalize(Vector3::from(axis));
        Cylinder { start_mm: Vector3::zeros(), axis, length_mm, radius_mm }
    }

    #[track_caller]
    fn close(found_mm: f64, expected_mm: f64) {
        assert!((found_mm - expected_mm).abs() < 1e-6, "{found_mm} instead of {expected_mm}");
    }

    #[test]
    fn parallel_cylinders_are_apart_aside_and_along() {
        let (tool, post) =
            (along([0.0, 0.0, 1.0], 100.0, 10.0), along([0.0, 0.0, -1.0], 80.0, 12.5));
        // Side by side: the distance of the axes less the radii.
        close(tool.distance_mm(&post, &Vector3::new(30.0, 40.0, 50.0)), 27.5);
        // One above the other, the ends overlapping from above: end to end.
        close(tool.distance_mm(&post, &Vector3::new(3.0, -5.0, -7.0)), 7.0);
        // Edge to edge.
        close(tool.distance_mm(&post, &Vector3::new(60.0, 0.0, -7.0)), 37.5_f64.hypot(7.0));
        close(tool.distance_mm(&post, &Vector3::new(3.0, 4.0, 185.0)), 5.0);
    }

    #[test]
    fn one_inside_the_other_is_no_distance() {
        let (wide, thin) = (along([0.0, 0.0, 1.0], 100.0, 60.0), along([0.0, 0.0, 1.0], 20.0, 5.0));
        for displacement in [[0.0, 0.0, 10.0], [50.0, 0.0, 99.0], [64.9, 0.0, 0.0], [0.0; 3]] {
            let found_mm = wide.distance_mm(&thin, &displacement.into());
            assert!(found_mm <= 0.0, "{displacement:?}: {found_mm}");
        }
        close(wide.distance_mm(&thin, &Vector3::new(66.0, 0.0, 0.0)), 1.0);
    }

    #[test]
    fn crossed_cylinders_are_apart_by_their_axes_less_the_radii() {
        let (tool, post) =
            (along([0.0, 0.0, 1.0], 100.0, 10.0), along([0.0, -1.0, 0.0], 80.0, 12.5));
        close(tool.distance_mm(&post, &Vector3::new(40.0, 30.0, 50.0)), 17.5);
        // Beyond the end of the post: flat end against the side.
        close(tool.distance_mm(&post, &Vector3::new(0.0, 95.0, 50.0)), 5.0);
    }

    /// Points all over the surface.
    fn surface(of: &Cylinder) -> Vec<Vector3<f64>> {
        let aside = of.axis.cross(&Vector3::new(0.3, -0.7, 0.5)).normalize();
        let other = of.axis.cross(&aside);
        let at = |along_mm: f64, radius_mm: f64, turn: usize| {
            let (sin, cos) = (TAU * turn as f64 / 72.0).sin_cos();
            of.start_mm + of.axis.into_inner() * along_mm + (aside * cos + other * sin) * radius_mm
        };
        let mut points = Vec::new();
        for turn in 0..72 {
            points.extend(
                (0..=40).map(|k| at(of.length_mm * f64::from(k) / 40.0, of.radius_mm, turn)),
            );
            for ring in 0..10 {
                let radius_mm = of.radius_mm * f64::from(ring) / 10.0;
                points.extend([at(0.0, radius_mm, turn), at(of.length_mm, radius_mm, turn)]);
            }
        }
        points
    }

    #[test]
    fn skew_cylinders_are_as_far_apart_as_the_nearest_of_many_points() {
        let tool = along([0.1, -0.2, 1.0], 60.0, 8.0);
        for (axis, displacement) in [
            ([0.5, -1.0, 0.3], [25.0, 30.0, 20.0]),
            ([1.0, 0.2, 0.8], [40.0, -10.0, -15.0]),
            ([0.3, 1.0, -1.0], [-18.0, 4.0, 75.0]),
            ([0.1, -0.25, 1.0], [30.0, 12.0, 3.0]),
        ] {
            let (post, displacement) = (along(axis, 45.0, 6.0), Vector3::from(displacement));
            let found_mm = tool.distance_mm(&post, &displacement);
            let of_post = surface(&post);
            let nearest_mm = surface(&tool)
                .iter()
                .flat_map(|a| of_post.iter().map(move |b| (b + displacement - a).norm()))
                .fold(f64::INFINITY, f64::min);
            assert!(found_mm > 1.0, "{axis:?} is no test of a distance");
            assert!(found_mm < nearest_mm + 1e-6, "{found_mm} with {nearest_mm} among the points");
            assert!(found_mm > nearest_mm - 0.3, "{found_mm} with {nearest_mm} among the points");
        }
    }
}
