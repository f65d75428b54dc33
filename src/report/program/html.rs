//! A program as a picture: its path on the sphere, and its speed over time.

use askama::Template;
use nalgebra::Vector3;

use super::figures::{speed, view};
use super::legs::{Leg, legs};
use crate::error::{Error, Kind, Result};
use crate::motion::Trajectory;
use crate::nc::Sphere;

#[derive(Template)]
#[template(path = "path.html")]
struct Page<'a> {
    plot: &'a Plot,
}

struct Plot {
    title: String,
    legs: Vec<Leg>,
    above: String,
    oblique: String,
    speed: String,
}

/// The page of a program around a ball-bar.
///
/// # Errors
/// When the page cannot be filled.
pub fn path_page(title: &str, trajectory: &Trajectory, sphere: &Sphere) -> Result<String> {
    let (legs, radial) = legs(trajectory, sphere);
    let above = |v: &Vector3<f64>| (v.x, v.y, v.z);
    // From azimuth -60 degrees, 30 degrees above the equator.
    let (sine, cosine) = (-60_f64).to_radians().sin_cos();
    let oblique = move |v: &Vector3<f64>| {
        let (right, depth) = (v.y * cosine - v.x * sine, v.x * cosine + v.y * sine);
        (right, v.z * 0.75_f64.sqrt() - depth * 0.5, depth * 0.75_f64.sqrt() + v.z * 0.5)
    };
    let plot = Plot {
        title: title.to_owned(),
        above: view(&legs, &radial, &above, "the path seen from +Z"),
        oblique: view(&legs, &radial, &oblique, "the path seen obliquely"),
        speed: speed(trajectory, &legs),
        legs,
    };
    Page { plot: &plot }
        .render()
        .map_err(|error| Error::new(Kind::Output, format!("the picture cannot be drawn: {error}")))
}
