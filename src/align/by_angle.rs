//! Logs by angle: a reading was taken where the program's arc has its angle, and the program says when that was.
//!
//! From then on all goes as with any log. What engagement and release are to others, the middle of each arc is here, with the
//! uncertainty of the angle: the instrument's program spread its readings over the arc as well as it could.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use super::draft::Draft;
use super::engagement;
use super::ramp::{Mark, MarkKind};
use super::run::{Rig, Run};
use super::samples::Alignment;
use super::section::{self, Circle, Section};
use super::time_map::TimeMap;
use crate::error::{Error, Kind, Place, Result};
use crate::log::{Angles, ByAngle, Reading, Turn};
use crate::motion::Trajectory;

/// How well a log knows where on the arc its readings were taken, rad: a fifth of a degree, 0.5 mm at 150 mm. Where the
/// feed-in ends and how the machine gathers speed is all that the instrument's program has to tell by.
const ANGLE_SIGMA_RAD: f64 = 0.2 * PI / 180.0;
/// Two planes are the same when their normals are this near to each other.
const SAME_PLANE: f64 = 0.999;
/// An arc may be this much shorter than the readings that it should hold, rad.
const SHORT_RAD: f64 = PI / 180.0;
/// Feeds that differ by less than this share are the same.
const SAME_FEED: f64 = 0.05;
/// Bars that differ by more are not the same, mm: a calibrated length may stand for the nominal one.
const OTHER_BAR_MM: f64 = 1.0;
/// Places of an arc at which its angle is looked up; between them it is straight.
const PLACES: usize = 4096;

/// Lays a log by angle over the program that ran.
///
/// # Errors
/// When the program does not drive the arcs of the log.
pub fn by_angle(run: &Run, log: &ByAngle) -> Result<Alignment> {
    let refused = |what: String, hint: &str| {
        Error::new(Kind::Mismatch, what).at(Place::file(run.log.file())).hint(hint)
    };
    let length_mm = run.rig.bar.length_mm;
    if let Some(other_mm) =
        log.nominal_mm.filter(|other_mm| (other_mm - length_mm).abs() > OTHER_BAR_MM)
    {
        return Err(refused(
            format!("the log is of a bar of {other_mm} mm, and the test of one of {length_mm} mm"),
            "correct `length_mm` of the bar, or `bar_length_mm` of the mounting, in the test file",
        ));
    }
    let trajectory = run.trajectory(run.feed_override);
    let sections = section::sections(&trajectory, &run.rig);
    let arcs: Vec<Driven> = sections
        .iter()
        .filter(|section| !section.transit && is_in_plane(section, log.plane))
        .map(|section| Driven::new(&trajectory, &run.rig, section, log.plane))
        .collect();
    let mut timed: Vec<(&Turn, Vec<f64>, Mark)> = Vec::new();
    for counter_clockwise in [true, false] {
        let turns: Vec<&Turn> =
            log.turns.iter().filter(|turn| turn.counter_clockwise == counter_clockwise).collect();
        let mut ways: Vec<&Driven> =
            arcs.iter().filter(|arc| arc.counter_clockwise() == counter_clockwise).collect();
        if let Some(feed_mm_s) = log.feed_mm_s.filter(|_| ways.len() > turns.len()) {
            ways.retain(|arc| (arc.feed_mm_s / feed_mm_s - 1.0).abs() < SAME_FEED);
        }
        if ways.len() < turns.len() || (ways.len() > turns.len() && !turns.is_empty()) {
            let way = if counter_clockwise { "counter-clockwise" } else { "clockwise" };
            let [a, b] = log.plane.map(|axis| ['X', 'Y', 'Z'][axis]);
            return Err(refused(
                format!(
                    "the log has {} arc(s) {way} in the plane {a}{b}, and the program drives {}",
                    turns.len(),
                    ways.len()
                ),
                "take the program that ran, with the arcs of this log alone; under `[log]` in the test file `plane` says the plane, and `clockwise_order` how the clockwise readings of a table stand",
            ));
        }
        for (turn, arc) in turns.into_iter().zip(ways) {
            let times_s = arc.times_s(turn).ok_or_else(|| {
                refused(
                    format!(
                        "the arc of the program has {:.0} degrees, and the readings do not fit into it",
                        arc.sweep_rad().to_degrees()
                    ),
                    match turn.angles {
                        Angles::Even(_) => {
                            "take the program that ran; `data_arc_deg` under `[log]` in the test file says how many degrees the readings stand on"
                        }
                        Angles::Stated(_) => {
                            "take the program that ran; where clockwise readings stand by rising angle, write `clockwise_order = \"rising\"` under `[log]` in the test file"
                        }
                    },
                )
            })?;
            let mark = arc.mark(&times_s);
            timed.push((turn, times_s, mark));
        }
    }
    timed.sort_by(|a, b| a.2.program_s.total_cmp(&b.2.program_s));
    let (mut readings, mut stretches, mut marks) = (Vec::new(), Vec::new(), Vec::new());
    for (turn, times_s, mark) in timed {
        let from = readings.len();
        let mut laid: Vec<Reading> = run.log.readings()[turn.readings.clone()]
            .iter()
            .zip(times_s)
            .map(|(reading, time_s)| Reading { time_s, ..*reading })
            .collect();
        laid.dedup_by(|later, before| later.time_s <= before.time_s);
        readings.extend(laid);
        stretches.push(from..readings.len());
        marks.push(mark);
    }
    if readings.len() < 2 {
        return Err(refused(
            "the log has no arc".into(),
            "take the log as the instrument's program wrote it",
        ));
    }
    let timed = run.log.timed(readings);
    let engagements = engagement::expected(&trajectory, &run.rig);
    let first_s = marks.first().map_or(0.0, |mark| mark.program_s);
    let last_s = marks.last().map_or(0.0, |mark| mark.program_s);
    let mut time_map = TimeMap::new(&trajectory, 0.0..trajectory.end_s(), 0.5 * (first_s + last_s));
    time_map.set_by_angle(&marks);
    let draft = Draft::of_angles(trajectory, engagements, stretches, marks, time_map);
    Ok(draft.laid(&Run { log: &timed, ..*run }))
}

/// An arc of the program, by the angle that it has reached.
struct Driven {
    /// Times in the program, s, and the angle there, rad, without jumps.
    places: Vec<(f64, f64)>,
    /// How far along it the middle of its data arc is, rad: what is driven besides is overshoot.
    middle_rad: f64,
    feed_mm_s: f64,
}

impl Driven {
    fn new(trajectory: &Trajectory, rig: &Rig, section: &Section, [a, b]: [usize; 2]) -> Self {
        let mut last_rad: Option<f64> = None;
        let places = (0..=PLACES).map(|k| {
            // Just inside of its ends.
            let share = 1e-9 + (1.0 - 2e-9) * k as f64 / PLACES as f64;
            let time_s = section.start_s + share * (section.end_s - section.start_s);
            let ball_mm = rig.commanded_mm(&trajectory.at(time_s).position_mm);
            let angle_rad = ball_mm[b].atan2(ball_mm[a]);
            let angle_rad = last_rad
                .map_or(angle_rad, |last| last + (angle_rad - last + PI).rem_euclid(TAU) - PI);
            last_rad = Some(angle_rad);
            (time_s, angle_rad)
        });
        let places: Vec<(f64, f64)> = places.collect();
        let middle_s = 0.5 * section.data_s.iter().sum::<f64>();
        let middle = places.partition_point(|place| place.0 < middle_s).min(PLACES);
        let middle_rad = (places[middle].1 - places[0].1).abs();
        Self { places, middle_rad, feed_mm_s: section.feed_mm_s }
    }

    fn ends_rad(&self) -> [f64; 2] {
        [self.places.first(), self.places.last()].map(|place| place.map_or(0.0, |place| place.1))
    }

    fn counter_clockwise(&self) -> bool {
        let [start, end] = self.ends_rad();
        end > start
    }

    fn sweep_rad(&self) -> f64 {
        let [start, end] = self.ends_rad();
        (end - start).abs()
    }

    /// When each reading was taken, s of program time; `None` where they do not fit into the arc.
    fn times_s(&self, turn: &Turn) -> Option<Vec<f64>> {
        let [start, end] = self.ends_rad();
        let way = (end - start).signum();
        // How far along the arc, rad.
        let along: Vec<f64> = match &turn.angles {
            Angles::Even(span_rad) => {
                let count = turn.readings.len() as f64;
                let before = self.middle_rad - 0.5 * span_rad;
                (0..turn.readings.len())
                    .map(|k| before + span_rad * (k as f64 + 0.5) / count)
                    .collect()
            }
            Angles::Stated(angles_rad) => {
                let mut along: Vec<f64> = Vec::with_capacity(angles_rad.len());
                for (k, angle_rad) in angles_rad.iter().enumerate() {
                    let from_start = (way * (angle_rad - start)).rem_euclid(TAU);
                    let turns =
                        if k == 0 { 0.0 } else { ((along[k - 1] - from_start) / TAU).ceil() };
                    along.push(from_start + TAU * turns);
                }
                // Of several turns, the one in the middle.
                let (first, last) = (along.first()?, along.last()?);
                let turns = ((self.middle_rad - 0.5 * (first + last)) / TAU).round();
                along.iter().map(|angle| angle + TAU * turns).collect()
            }
        };
        let (first, last) = (along.first()?, along.last()?);
        if *first < -SHORT_RAD || *last > self.sweep_rad() + SHORT_RAD {
            return None;
        }
        Some(along.into_iter().map(|along| self.time_s(start + way * along)).collect())
    }

    /// When the arc reaches an angle, s.
    fn time_s(&self, angle_rad: f64) -> f64 {
        let rising = self.counter_clockwise();
        let reached =
            |place: &(f64, f64)| if rising { place.1 < angle_rad } else { place.1 > angle_rad };
        let after = self.places.partition_point(reached).clamp(1, PLACES);
        let (before, after) = (self.places[after - 1], self.places[after]);
        let step_rad = after.1 - before.1;
        let share = if step_rad == 0.0 { 0.0 } else { (angle_rad - before.1) / step_rad };
        before.0 + share.clamp(0.0, 1.0) * (after.0 - before.0)
    }

    /// The middle of the readings, known as well as their angles are.
    fn mark(&self, times_s: &[f64]) -> Mark {
        let [first, last] =
            [times_s.first(), times_s.last()].map(|time| time.copied().unwrap_or(0.0));
        let middle_s = 0.5 * (first + last);
        let lasts_s = match (self.places.first(), self.places.last()) {
            (Some(first), Some(last)) => last.0 - first.0,
            _ => 0.0,
        };
        let speed_rad_s = self.sweep_rad() / lasts_s.max(1e-9);
        Mark {
            log_s: middle_s,
            program_s: middle_s,
            sigma_s: ANGLE_SIGMA_RAD / speed_rad_s.max(1e-9),
            kind: MarkKind::Angle,
            samples: times_s.len(),
        }
    }
}

/// Whether an arc lies in the plane of two axes.
fn is_in_plane(section: &Section, [a, b]: [usize; 2]) -> bool {
    let mut across = Vector3::zeros();
    across[3 - a - b] = 1.0;
    let normal = match section.circle {
        Circle::Equator => Vector3::z(),
        Circle::Meridian { azimuth_deg } => {
            let (sin, cos) = azimuth_deg.to_radians().sin_cos();
            Vector3::new(sin, -cos, 0.0)
        }
        Circle::Plane(plane) => Vector3::ith(plane.normal(), 1.0),
        Circle::Other { normal, .. } => normal,
    };
    normal.dot(&across).abs() > SAME_PLANE
}
