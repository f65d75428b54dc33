//! Sections: the arcs that a program drives on the sphere, recognised by their geometry.

use nalgebra::Vector3;

use super::carried::carried_s;
use super::data_arc;
use super::run::Rig;
use crate::motion::{Block, BlockKind, Trajectory};
use crate::nc::{Move, Path};
use crate::plan::Plane;

/// The circle that a section lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Circle {
    /// Polar angle 90 degrees.
    Equator,
    /// Through the pole; azimuth from 0 to below 180 degrees.
    Meridian {
        /// Azimuth, degrees.
        azimuth_deg: f64,
    },
    /// The largest circle in a coordinate plane, of a program that drives only such.
    Plane(Plane),
    /// Any other.
    Other {
        /// Axis of the circle.
        normal: Vector3<f64>,
        /// Direction of angle 0, normal to the axis.
        zero: Vector3<f64>,
    },
}

impl Circle {
    /// Angle of a direction on the circle, rad: the azimuth on the equator; on a meridian 0 on the
    /// equator at its azimuth, pi/2 at the pole; in a plane from its first axis.
    pub fn angle_rad(&self, direction: &Vector3<f64>) -> f64 {
        let angle = match self {
            Self::Equator => direction.y.atan2(direction.x),
            Self::Meridian { azimuth_deg } => {
                let (sin, cos) = azimuth_deg.to_radians().sin_cos();
                direction.z.atan2(direction.x * cos + direction.y * sin)
            }
            Self::Plane(plane) => plane.angle_rad(direction),
            Self::Other { normal, zero } => {
                normal.cross(zero).dot(direction).atan2(zero.dot(direction))
            }
        };
        angle.rem_euclid(std::f64::consts::TAU)
    }

    /// Directions of its angles 0 and 90 degrees.
    pub fn directions(&self) -> [Vector3<f64>; 2] {
        match self {
            Self::Equator => [Vector3::x(), Vector3::y()],
            Self::Meridian { azimuth_deg } => {
                let (sin, cos) = azimuth_deg.to_radians().sin_cos();
                [Vector3::new(cos, sin, 0.0), Vector3::z()]
            }
            Self::Plane(plane) => plane.axes().map(|axis| Vector3::ith(axis, 1.0)),
            Self::Other { normal, zero } => [*zero, normal.cross(zero)],
        }
    }

    /// What the report calls it.
    pub fn name(&self) -> String {
        match self {
            Self::Equator => "Equator".into(),
            Self::Meridian { azimuth_deg } => format!("Meridian {azimuth_deg:.0}\u{b0}"),
            Self::Plane(plane) => format!("{} plane", plane.name()),
            Self::Other { normal, .. } => {
                // Plus zero: -0 is 0.
                let [x, y, z] =
                    [normal.x, normal.y, normal.z].map(|n| (n * 1e2).round() / 1e2 + 0.0);
                format!("Circle about ({x:.2}, {y:.2}, {z:.2})")
            }
        }
    }

    /// Whether two sections lie on the same circle.
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Equator, Self::Equator) => true,
            (Self::Plane(a), Self::Plane(b)) => a == b,
            (Self::Meridian { azimuth_deg: a }, Self::Meridian { azimuth_deg: b }) => {
                let apart = (a - b).abs() % 180.0;
                apart.min(180.0 - apart) < 1.0
            }
            (Self::Other { normal: a, .. }, Self::Other { normal: b, .. }) => (a - b).norm() < 0.02,
            _ => false,
        }
    }

    /// The coordinate plane that it is the largest circle of, and whether what is forward on it is CCW there.
    pub fn plane(&self) -> Option<(Plane, bool)> {
        match self {
            Self::Equator => Some((Plane::Xy, true)),
            // From the azimuth to the pole: X to Z is CW in ZX, Y to Z is CCW in YZ.
            Self::Meridian { azimuth_deg } if *azimuth_deg < IN_PLANE_DEG => {
                Some((Plane::Zx, false))
            }
            Self::Meridian { azimuth_deg } if (azimuth_deg - 90.0).abs() < IN_PLANE_DEG => {
                Some((Plane::Yz, true))
            }
            Self::Plane(plane) => Some((*plane, true)),
            Self::Meridian { .. } | Self::Other { .. } => None,
        }
    }
}

/// In such steps it is followed how an arc comes to its speed, s.
const LAG_STEP_S: f64 = 1e-3;
/// And until less than this share of it is missing.
const NEARLY: f64 = 0.01;

/// An acceleration may build up in as long as this although nobody says so, s: controls are set to some tens of milliseconds, and to
/// more where a machine is heavy.
const BUILDS_UP_S: f64 = 0.15;
/// No more than this part of an arc is given up at either end: what is left tells nearly as much.
const LARGEST_PART: f64 = 0.1;

/// A meridian within this angle of a coordinate plane is meant to lie in it, degrees: its azimuth has one decimal.
const IN_PLANE_DEG: f64 = 0.15;

/// One arc or transit.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// The comment in the program, or the circle's name where there is none.
    pub name: String,
    /// The circle.
    pub circle: Circle,
    /// Forward: CCW seen from the circle's axis, in a plane as ISO 841 has it; on a meridian from its azimuth over the pole.
    pub forward: bool,
    /// A way to the next arc rather than an arc.
    pub transit: bool,
    /// Beginning in program time, s.
    pub start_s: f64,
    /// End in program time, s.
    pub end_s: f64,
    /// Angle that it covers, rad.
    pub sweep_rad: f64,
    /// When its data arc begins and ends, s of program time: that part which is measured for its own sake. What is driven on
    /// the same circle before and after it is overshoot.
    pub data_s: [f64; 2],
    /// Feed, mm/s.
    pub feed_mm_s: f64,
    /// By how much later than at full speed it comes off where it begins, and is early at its end, s: half of what it takes to
    /// accelerate from a standstill.
    pub lags_s: [f64; 2],
    /// For how long after its begin the bar may read what slides that follow late had to catch up there, s.
    pub carried_s: f64,
}

impl Section {
    /// How long it takes, s.
    pub(super) fn duration_s(&self) -> f64 {
        self.end_s - self.start_s
    }

    /// For how long from either end on it is not known where on its way the slides are, s; 0 where it does not begin or end at
    /// rest and no slide has anything to [catch up](Self::carried_s). What the way loses in coming to its speed the time takes
    /// in, and not how it comes to it: with half of the acceleration it takes twice as long, half of which is before its planned
    /// begin, and an acceleration that builds up in a time `T` adds `T/2`. Of a short arc this is a part, but never less than
    /// what twice the acceleration would be off.
    pub fn comes_to_speed_s(&self) -> [f64; 2] {
        let most_s = LARGEST_PART * self.duration_s();
        let of_lag_s = |lag_s: f64| (3.0 * lag_s + 0.5 * BUILDS_UP_S).min(most_s).max(0.5 * lag_s);
        let [begins_s, ends_s] =
            self.lags_s.map(|lag_s| if lag_s > 0.0 { of_lag_s(lag_s) } else { 0.0 });
        [begins_s.max(self.carried_s.min(most_s)), ends_s]
    }

    /// In what direction it is driven, in words.
    pub fn direction(&self) -> &'static str {
        match (self.circle, self.forward) {
            (Circle::Plane(_), true) => "CCW",
            (Circle::Plane(_), false) => "CW",
            (_, true) => "forward",
            (_, false) => "backward",
        }
    }

    /// Whether a moment of program time is on its data arc.
    pub fn is_data(&self, program_s: f64) -> bool {
        (self.data_s[0]..=self.data_s[1]).contains(&program_s)
    }
}

/// A section leaves the sphere by no more than this, mm: coarse chords do, feed-ins do not.
const ON_SPHERE_MM: f64 = 0.1;

/// The sections of a trajectory: stretches at feed on the sphere, from standstill to standstill.
pub(super) fn sections(trajectory: &Trajectory, rig: &Rig) -> Vec<Section> {
    let on_sphere = |point: &Vector3<f64>| rig.commanded_deviation_mm(point).abs() < ON_SPHERE_MM;
    let mut sections: Vec<Section> = Vec::new();
    let mut first: Option<usize> = None;
    for (index, block) in trajectory.blocks().iter().enumerate() {
        let inside = block.kind == BlockKind::Feed
            && block.motion().is_some_and(|m| on_sphere(&m.start_mm) && on_sphere(&m.end_mm));
        if inside {
            first.get_or_insert(index);
        }
        if let Some(begin) = first
            && (!inside || block.ends_at_rest())
        {
            let end = if inside { index + 1 } else { index };
            sections.extend(section(trajectory, begin, end, rig));
            first = None;
        }
    }
    if let Some(begin) = first {
        sections.extend(section(trajectory, begin, trajectory.blocks().len(), rig));
    }
    // A way to the next arc is short and is not driven back.
    let driven_back = |section: &Section| {
        sections.iter().any(|other| {
            other.circle.is_same(&section.circle)
                && other.forward != section.forward
                && (other.sweep_rad - section.sweep_rad).abs() < 0.1
        })
    };
    // Our programs say so.
    let told = |section: &Section| section.name == "TRANSIT";
    let transits: Vec<bool> =
        sections.iter().map(|s| told(s) || (s.sweep_rad < 1.6 && !driven_back(s))).collect();
    // A plan of short one-way arcs has no transits among them that could be told.
    if transits.iter().any(|transit| !transit) {
        for (section, transit) in sections.iter_mut().zip(transits) {
            section.transit = transit;
        }
    }
    if sections.iter().all(|section| section.transit || section.circle.plane().is_some()) {
        sections.iter_mut().for_each(in_plane);
    }
    sections
}

/// Calls a circle of a coordinate plane by it: nobody who tests planes thinks of an equator.
fn in_plane(section: &mut Section) {
    let Some((plane, same)) = section.circle.plane() else { return };
    let told = unnamed(section);
    section.forward = section.forward == same;
    section.circle = Circle::Plane(plane);
    if section.name == told {
        section.name = unnamed(section);
    }
}

/// What a section is called that has no name in the program.
fn unnamed(section: &Section) -> String {
    let sense = match (section.circle, section.forward) {
        (Circle::Meridian { .. }, true) => "forward",
        (Circle::Meridian { .. }, false) => "backward",
        (_, true) => "CCW",
        (_, false) => "CW",
    };
    format!("{} {sense}", section.circle.name())
}

/// A few dozen points of a section: enough for its plane, few enough that rounding does not show.
const POINTS: usize = 48;

/// The section of blocks `begin..end`; `None` where it is too short to have a plane.
fn section(trajectory: &Trajectory, begin: usize, end: usize, rig: &Rig) -> Option<Section> {
    let blocks = &trajectory.blocks()[begin..end];
    let start_s = blocks.first()?.start_s;
    let end_s = blocks.last().map(|last| last.start_s + last.duration_s)?;
    let points: Vec<Vector3<f64>> = (0..=POINTS)
        .map(|k| {
            let share = 1e-9 + (1.0 - 2e-9) * k as f64 / POINTS as f64;
            rig.commanded_mm(&trajectory.at(start_s + (end_s - start_s) * share).position_mm)
        })
        .collect();
    let mut curl = Vector3::zeros();
    for three in points.windows(3) {
        curl += (three[1] - three[0]).cross(&(three[2] - three[1]));
    }
    let normal = curl.try_normalize(1e-6)?;
    let (first, last) = (points.first()?, points.last()?);
    let height_mm = first.dot(&normal);
    let radius = |point: &Vector3<f64>| point - normal * point.dot(&normal);
    let swept: f64 = points
        .windows(2)
        .map(|two| {
            let (a, b) = (radius(&two[0]), radius(&two[1]));
            normal.dot(&a.cross(&b)).atan2(a.dot(&b))
        })
        .sum();
    let great = height_mm.abs() < 0.01 * first.norm();
    let (circle, forward) = if great && normal.z.abs() > 0.9998 {
        (Circle::Equator, normal.z > 0.0)
    } else if great && normal.z.abs() < 0.02 {
        // Its lower end, seen from above, gives the azimuth; that below 180 degrees is the name.
        let plane_deg = (-normal.x).atan2(normal.y).to_degrees();
        let azimuth_deg = plane_deg.rem_euclid(180.0);
        // Adding zero takes the sign off a negative zero.
        let azimuth_deg =
            if azimuth_deg > 179.9 { 0.0 } else { (azimuth_deg * 10.0).round() / 10.0 + 0.0 };
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        // Forward turns the azimuth's direction towards the pole.
        (Circle::Meridian { azimuth_deg }, Vector3::new(sin, -cos, 0.0).dot(&normal) > 0.0)
    } else {
        let upwards =
            normal.z > 1e-6 || (normal.z.abs() <= 1e-6 && normal.x + 0.5 * normal.y > 0.0);
        let axis = if upwards { normal } else { -normal };
        let from = if upwards { first } else { last };
        let zero = radius(from).try_normalize(1e-9)?;
        (Circle::Other { normal: axis, zero }, upwards)
    };
    let longest = blocks.iter().filter_map(|b| b.motion()).map(|m| m.feed_mm_s).fold(0.0, f64::max);
    let mut section = Section {
        name: String::new(),
        circle,
        forward,
        transit: false,
        start_s,
        end_s,
        sweep_rad: swept.abs(),
        data_s: data_arc::of(trajectory, blocks, swept.abs()),
        feed_mm_s: longest,
        lags_s: lags_s(trajectory, [start_s, end_s]),
        carried_s: carried_s(trajectory, rig, start_s),
    };
    // A comment that was there before this arc, on an M00 say, is not its name; nor is that of its overshoot.
    let named = blocks.iter().find(|block| !data_arc::is_overshoot(trajectory.label(block)));
    let named = named.unwrap_or(&blocks[0]);
    let own = begin == 0 || trajectory.blocks()[begin - 1].label != named.label;
    section.name = Some(trajectory.label(named))
        .filter(|label| own && !label.is_empty())
        .map_or_else(|| unnamed(&section), str::to_owned);
    Some(section)
}

/// `integral of (1 - v / v_max) dt` from either end until the speed is `v_max`, the highest in between, or half of the time is over.
fn lags_s(trajectory: &Trajectory, [start_s, end_s]: [f64; 2]) -> [f64; 2] {
    let half_s = 0.5 * (end_s - start_s);
    let speed_mm_s = |then_s: f64| trajectory.at(then_s).velocity_mm_s.norm();
    let shares = (1..POINTS).map(|k| k as f64 / POINTS as f64);
    let speeds = shares.map(|share| speed_mm_s(start_s + 2.0 * half_s * share));
    let fastest_mm_s = speeds.fold(f64::MIN_POSITIVE, f64::max);
    [(start_s, 1.0), (end_s, -1.0)].map(|(from_s, inwards)| {
        let steps = 0..(half_s / LAG_STEP_S) as usize;
        let slower = steps.map(|k| {
            let then_s = from_s + inwards * (k as f64 + 0.5) * LAG_STEP_S;
            1.0 - speed_mm_s(then_s) / fastest_mm_s
        });
        slower.take_while(|slower| *slower > NEARLY).map(|slower| slower * LAG_STEP_S).sum()
    })
}

/// A slide that goes less far than this on all arcs stands still, mm: so little is rounding of the program.
const STANDS_MM: f64 = 0.1;

/// Which slides move on the arcs.
pub(super) fn moving(trajectory: &Trajectory, sections: &[Section]) -> [bool; 3] {
    let positions = sections.iter().flat_map(|section| {
        (0..=POINTS).map(|k| {
            let share = 1e-9 + (1.0 - 2e-9) * k as f64 / POINTS as f64;
            trajectory.at(section.start_s + share * (section.end_s - section.start_s)).position_mm
        })
    });
    let ends = positions.fold(None, |ends: Option<[Vector3<f64>; 2]>, at| {
        let [low, high] = ends.unwrap_or([at, at]);
        Some([low.inf(&at), high.sup(&at)])
    });
    [0, 1, 2].map(|k| ends.is_some_and(|[low, high]| high[k] - low[k] > STANDS_MM))
}

/// How far the chords of the arcs are off them in the middle, mm, the largest: `l² / 8 R`; 0 of a program of arcs.
pub(super) fn chord_sag_mm(trajectory: &Trajectory, sections: &[Section], radius_mm: f64) -> f64 {
    let on_arc = |start_s: f64| sections.iter().any(|s| (s.start_s..s.end_s).contains(&start_s));
    let chords = trajectory.blocks().iter().filter(|block| on_arc(block.start_s));
    let straight = chords.filter_map(Block::motion).filter(|motion| motion.path == Path::Line);
    let lengths_mm = straight.map(Move::length_mm);
    lengths_mm.fold(0.0_f64, |most, length_mm| most.max(length_mm * length_mm / (8.0 * radius_mm)))
}
