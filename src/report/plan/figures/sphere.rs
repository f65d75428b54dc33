//! The path of a mounting on its sphere: seen from above at an angle, what is behind drawn pale.

use nalgebra::Vector3;

use crate::design::MountingOutlook;
use crate::plan::{Arc, Leg as Driven};
use crate::report::draw::svg::{Anchor, Drawing, text_width};

/// Radius of the sphere, pixels.
const RADIUS: f64 = 150.0;
/// Room beside and above the sphere, pixels.
const ASIDE: f64 = 75.0;
const ABOVE: f64 = 44.0;
/// Where the viewer stands: from X towards Y, and above the equator, degrees.
const AZIMUTH_DEG: f64 = -55.0;
const ELEVATION_DEG: f64 = 27.0;
/// A line follows its arc in steps of this angle, degrees.
const STEP_DEG: f64 = 2.0;
/// Colours that tell circles apart.
pub(in crate::report::plan) const COLOURS: usize = 8;

/// A circle of a path: its arcs with their numbers in the order of driving.
#[derive(Debug)]
pub(in crate::report::plan) struct Circle {
    /// Index of its colour.
    pub(in crate::report::plan) colour: usize,
    /// What the program calls it, without the direction.
    pub(in crate::report::plan) name: String,
    /// Numbers of its arcs.
    pub(in crate::report::plan) numbers: String,
}

/// The drawing, and the circles for its legend.
pub(in crate::report::plan) fn sphere(mounting: &MountingOutlook) -> (String, Vec<Circle>) {
    let path = &mounting.program.path;
    let below = path.legs.iter().any(|leg| points(&leg.arc).iter().any(|p| p.z < -0.05));
    let mut view = View::new(below);
    view.globe(below);
    view.axes();
    let legs = legs(&path.legs);
    for leg in &path.legs {
        if leg.transit {
            view.line(&points(&leg.arc), 1.025, "transit-line");
        }
    }
    for leg in &legs {
        if leg.first_of_circle {
            view.line(&points(leg.arc), 1.0, &format!("path s{}", leg.circle % COLOURS));
        }
    }
    if let Some(first) = path.legs.first() {
        view.engagement(&first.driven().start);
    }
    for (number, leg) in legs.iter().enumerate() {
        view.arrow(number + 1, leg, &legs);
    }
    let told = format!(
        "Path of mounting {} on the sphere: {} arcs in order",
        mounting.named.name,
        legs.len()
    );
    (view.drawing.finish(&told), circles(&legs))
}

/// An arc, the circle that it lies on, and whether it is drawn for it.
struct Leg<'a> {
    arc: &'a Arc,
    circle: usize,
    first_of_circle: bool,
    points: Vec<Vector3<f64>>,
}

/// The arcs without the ways between them; the same arc driven back lies on the same circle.
fn legs(driven: &[Driven]) -> Vec<Leg<'_>> {
    let mut legs: Vec<Leg<'_>> = Vec::new();
    for Driven { arc, .. } in driven.iter().filter(|leg| !leg.transit) {
        let last = legs.last();
        let back = last.is_some_and(|last| {
            last.first_of_circle
                && (last.arc.at(1.0).into_inner() - arc.start.into_inner()).norm() < 1e-6
                && (last.arc.start.into_inner() - arc.at(1.0).into_inner()).norm() < 1e-6
                && last.arc.normal.dot(&arc.normal).abs() > 1.0 - 1e-9
        });
        let circle = last.map_or(0, |last| last.circle + usize::from(!back));
        legs.push(Leg { arc, circle, first_of_circle: !back, points: points(arc) });
    }
    legs
}

fn circles(legs: &[Leg<'_>]) -> Vec<Circle> {
    let mut circles: Vec<Circle> = Vec::new();
    for (number, leg) in (1..).zip(legs) {
        match circles.last_mut() {
            Some(circle) if !leg.first_of_circle => {
                circle.numbers = format!("{}, {number}", circle.numbers);
            }
            _ => circles.push(Circle {
                colour: leg.circle % COLOURS,
                // The arrow in the drawing shows the direction that the name ends with.
                name: leg.arc.name.rsplit_once(' ').map_or(&*leg.arc.name, |n| n.0).to_owned(),
                numbers: number.to_string(),
            }),
        }
    }
    circles
}

/// Directions along an arc, both ends included.
fn points(arc: &Arc) -> Vec<Vector3<f64>> {
    let steps = (arc.sweep_rad.abs().to_degrees() / STEP_DEG).ceil().max(2.0) as usize;
    (0..=steps).map(|k| arc.at(k as f64 / steps as f64).into_inner()).collect()
}

/// A parallel projection with what has been written on it so far.
struct View {
    drawing: Drawing,
    centre: (f64, f64),
    right: Vector3<f64>,
    up: Vector3<f64>,
    towards: Vector3<f64>,
    /// Boxes of the texts: left, top, right, bottom.
    taken: Vec<[f64; 4]>,
    /// Where arrows are.
    arrows: Vec<(f64, f64)>,
}

type Point = (f64, f64);

impl View {
    fn new(below: bool) -> Self {
        let (sin_a, cos_a) = AZIMUTH_DEG.to_radians().sin_cos();
        let (sin_e, cos_e) = ELEVATION_DEG.to_radians().sin_cos();
        let under = if below { RADIUS } else { RADIUS * sin_e };
        let height = ABOVE + RADIUS + under + 38.0;
        Self {
            drawing: Drawing::new(2.0 * (RADIUS + ASIDE), height),
            centre: (RADIUS + ASIDE, ABOVE + RADIUS),
            right: Vector3::new(-sin_a, cos_a, 0.0),
            up: Vector3::new(-sin_e * cos_a, -sin_e * sin_a, cos_e),
            towards: Vector3::new(cos_e * cos_a, cos_e * sin_a, sin_e),
            taken: Vec::new(),
            arrows: Vec::new(),
        }
    }

    fn at(&self, p: &Vector3<f64>) -> Point {
        (self.centre.0 + RADIUS * p.dot(&self.right), self.centre.1 - RADIUS * p.dot(&self.up))
    }

    fn in_front(&self, p: &Vector3<f64>) -> bool {
        p.dot(&self.towards) >= -1e-9
    }

    /// The hemisphere, or the whole sphere, with its equator.
    fn globe(&mut self, below: bool) {
        let turn = |k: usize| (k as f64).to_radians();
        let equator = |azimuth: f64| Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
        let ring: Vec<Vector3<f64>> = (0..=360).map(|k| equator(turn(k))).collect();
        if below {
            self.drawing.circle(self.centre, RADIUS, "globe");
        } else {
            let rim = (0..=180).map(|k| self.right * turn(k).cos() + self.up * turn(k).sin());
            let mut outline: Vec<Point> = rim.map(|p| self.at(&p)).collect();
            // From the left end of the rim along the near side of the equator to its right end.
            let near = (0..=180).map(|k| equator((AZIMUTH_DEG - 90.0).to_radians() + turn(k)));
            outline.extend(near.map(|p| self.at(&p)));
            self.drawing.polygon(&outline, "globe");
        }
        self.line(&ring, 1.0, "guide");
        self.drawing.circle(self.centre, 4.0, "mark");
    }

    /// A line on a sphere of this radius, the parts behind it pale.
    fn line(&mut self, along: &[Vector3<f64>], radius: f64, class: &str) {
        let mut part: Vec<Point> = Vec::new();
        let mut front = along.first().is_some_and(|p| self.in_front(p));
        for p in along {
            part.push(self.at(&(p * radius)));
            if self.in_front(p) != front {
                self.part(&part, class, front);
                part.drain(..part.len() - 1);
                front = !front;
            }
        }
        self.part(&part, class, front);
    }

    fn part(&mut self, points: &[Point], class: &str, front: bool) {
        let class = if front { class.to_owned() } else { format!("{class} behind") };
        self.drawing.polyline(points, &class);
    }

    fn axes(&mut self) {
        let names = [(Vector3::x(), "X"), (Vector3::y(), "Y"), (Vector3::z(), "Z, tool axis")];
        for (axis, name) in names {
            let [from, surface, to] = [0.0, 1.0, 1.22].map(|r| self.at(&(axis * r)));
            self.drawing.line(from, surface, "axis-inside");
            self.drawing.line(surface, to, "axis-line");
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            self.head(to, (dx, dy), "mark");
            let length = dx.hypot(dy);
            let at = (to.0 + 13.0 * dx / length, to.1 + 13.0 * dy / length + 4.0);
            let at = if name.len() > 1 { (at.0 + 0.5 * text_width(name), at.1) } else { at };
            self.write(at, "title", name);
        }
    }

    fn engagement(&mut self, at: &Vector3<f64>) {
        let (outside, point) = (self.at(&(at * 1.14)), self.at(at));
        self.drawing.line(outside, point, "engage-line");
        self.drawing.circle(point, 5.0, "engage");
        let text = "bar engages";
        let half = 0.5 * text_width(text);
        let places = [
            (point.0 + 0.4 * half, point.1 + 34.0),
            (point.0 + half + 12.0, point.1 + 18.0),
            (point.0 - half - 12.0, point.1 + 18.0),
            (point.0, point.1 + 22.0),
            (point.0, point.1 - 12.0),
        ];
        if let Some(place) = places.into_iter().find(|place| self.free(*place, text)) {
            self.write(place, "title", text);
        }
        self.arrows.push(point);
    }

    fn frame(at: Point, text: &str) -> [f64; 4] {
        let half = 0.5 * text_width(text) + 2.0;
        [at.0 - half, at.1 - 11.0, at.0 + half, at.1 + 4.0]
    }

    /// Whether a text fits there without touching another.
    fn free(&self, at: Point, text: &str) -> bool {
        let [left, top, right, bottom] = Self::frame(at, text);
        let inside = left >= 0.0 && right <= 2.0 * (RADIUS + ASIDE) && top >= 0.0;
        let clear = |b: &[f64; 4]| left >= b[2] || right <= b[0] || top >= b[3] || bottom <= b[1];
        inside && self.taken.iter().all(clear)
    }

    fn write(&mut self, at: Point, class: &str, text: &str) {
        self.taken.push(Self::frame(at, text));
        self.drawing.text(at, Anchor::Middle, class, text);
    }

    /// An arrow head with its tip a little before a point.
    fn head(&mut self, at: Point, (dx, dy): (f64, f64), class: &str) {
        let length = dx.hypot(dy).max(1e-9);
        let (dx, dy) = (dx / length, dy / length);
        let corner = |along: f64, aside: f64| {
            (at.0 + along * dx - aside * dy, at.1 + along * dy + aside * dx)
        };
        self.drawing.polygon(&[corner(6.0, 0.0), corner(-4.0, 4.5), corner(-4.0, -4.5)], class);
    }

    /// An arrow in the direction of driving with the arc's number, where there is most room.
    fn arrow(&mut self, number: usize, leg: &Leg<'_>, all: &[Leg<'_>]) {
        let others: Vec<Point> = all
            .iter()
            .filter(|other| other.circle != leg.circle && other.first_of_circle)
            .flat_map(|other| other.points.iter().filter(|p| self.in_front(p)))
            .map(|p| self.at(p))
            .collect();
        let apart = |a: Point, of: &[Point]| {
            of.iter().map(|b| (a.0 - b.0).hypot(a.1 - b.1)).fold(60.0, f64::min)
        };
        let text = number.to_string();
        let mut best: Option<(f64, Point, Point, Point)> = None;
        for k in 2..leg.points.len().saturating_sub(2) {
            let p = &leg.points[k];
            if !self.in_front(p) {
                continue;
            }
            let (a, at, b) = (self.at(&leg.points[k - 1]), self.at(p), self.at(&leg.points[k + 1]));
            let way = (b.0 - a.0, b.1 - a.1);
            let length = way.0.hypot(way.1);
            // Where the arc comes towards the viewer an arrow would say nothing.
            if length < 2.0 {
                continue;
            }
            for side in [-1.0, 1.0] {
                let aside = 12.0 * side / length;
                let place = (at.0 - way.1 * aside, at.1 + way.0 * aside + 4.0);
                if !self.free(place, &text) {
                    continue;
                }
                let middle = (place.0, place.1 - 4.0);
                let room = apart(middle, &others)
                    .min(0.7 * apart(at, &self.arrows))
                    .min(1.5 * apart(at, &others));
                if best.is_none_or(|(before, ..)| room > before + 1e-9) {
                    best = Some((room, at, way, place));
                }
            }
        }
        let Some((_, at, way, place)) = best else { return };
        self.head(at, way, &format!("arrow i{}", leg.circle % COLOURS));
        self.arrows.push(at);
        self.write(place, "number", &text);
    }
}
