//! From a file of Ballbar 20 to a log by angle.
//!
//! The file says neither the unit of its readings nor the arc that they stand on. Both are taken where the circularity that comes
//! of them is the one that the file states; where it is not, nothing is guessed.

use std::fmt;
use std::path::Path;

use super::b5r::{BallbarFile, BarRun, FEWEST_READINGS};
use super::ballbar_feed;
use super::by_angle::{Angles, ByAngle, Said, Turn, circularities};
use super::day;
use super::listed::{Listed, listed};
use super::reading::{Log, Reading};
use crate::error::{Error, Place, Result};
use crate::plan::log_format::{ClockwiseOrder, Format, LengthUnit, ReadingKind, TimeColumn};

/// A bar reads a little over 1 mm either way: what stays below twice that is mm.
const LARGEST_MM: f64 = 2.0;
/// What no bar reads, mm.
const BEYOND_MM: f64 = 10.0;
/// Circularities that differ by less than this share, and this many mm, are the same: Ballbar 20 rounds and filters.
const SAME_SHARE: f64 = 0.02;
const SAME_MM: f64 = 3e-4;

/// Readings, turns and what is to be told of a file.
pub(super) fn as_log(found: &BallbarFile, file: &Path, format: &Format) -> Result<Log> {
    let refused = |what: String, hint: &str| {
        Err(Error::input(what).at(Place::file(file)).hint(hint.to_owned()))
    };
    if matches!(format.reading.kind, ReadingKind::Length { .. }) {
        return refused(
            "a .b5r has deviations, and no lengths".into(),
            "leave `reading` out under `[log]` in the test file",
        );
    }
    let Some(plane) = format.plane.or_else(|| found.plane.as_deref().and_then(plane_of)) else {
        return refused(
            "the file does not say its plane".into(),
            "write `plane = \"xy\"` (or `yz`, `zx`) under `[log]` in the test file",
        );
    };
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned());
    let names = [found.test.as_deref(), name.as_deref()];
    let named_deg = || names.into_iter().flatten().find_map(arc_of_name);
    let arc_deg = format.data_arc_deg.or_else(named_deg).unwrap_or(360.0);
    let unit = match format.stated_unit {
        Some(unit) => unit,
        None => unit_of(found, arc_deg)?,
    };
    let mut notes = vec![taken_words(unit, format.stated_unit.is_some(), arc_deg)];
    let sign = if format.reading.inverted { -1.0 } else { 1.0 };
    let order = match format.clockwise {
        Some(ClockwiseOrder::Driven) => Listed::AsDriven,
        Some(ClockwiseOrder::Rising) => Listed::ByAngle,
        None => {
            let order = order_of(found, unit, arc_deg)?;
            notes.extend(order_words(found, order));
            order
        }
    };
    let (mut readings, mut turns) = (Vec::new(), Vec::new());
    for (index, run) in found.runs.iter().enumerate() {
        let from = readings.len();
        let mut as_driven = run.readings.clone();
        if run.counter_clockwise == Some(false) && order == Listed::ByAngle {
            as_driven.reverse();
        }
        for reading in as_driven {
            let deviation_mm = reading.map(|value| sign * unit.to_mm(value));
            if let Some(mm) = deviation_mm.filter(|mm| mm.abs() > BEYOND_MM) {
                return refused(
                    format!("a reading of {mm} mm, which no ball-bar reaches"),
                    "is `reading_unit` under `[log]` in the test file right?",
                );
            }
            // Its time comes from the program.
            readings.push(Reading { time_s: readings.len() as f64, deviation_mm, line: run.line });
        }
        turns.push(Turn {
            counter_clockwise: run.counter_clockwise.unwrap_or(true),
            readings: from..readings.len(),
            angles: Angles::Even(arc_deg.to_radians()),
        });
        let Some(round) = Round::of(run, unit, arc_deg)? else { continue };
        if round.is_as_stated() {
            continue;
        }
        let told =
            format!("run {} is {round}, in {} over {arc_deg} degrees", index + 1, unit.name());
        if format.stated_unit.is_none() || format.data_arc_deg.is_none() {
            return refused(
                told,
                "write `reading_unit` and `data_arc_deg`, the degrees of the arc without its overshoot, under `[log]` in the test file; with both the readings are taken as they are",
            );
        }
        notes.push(told);
    }
    let missing = readings.iter().filter(|reading| reading.deviation_mm.is_none()).count();
    if missing == readings.len() {
        return refused("the file has no reading in range".into(), "was the bar engaged?");
    }
    if missing > 0 {
        notes.push(format!("{missing} reading(s) are no numbers and count as out of range"));
    }
    let rate_hz = match format.time {
        TimeColumn::Rate { hz } => Some(hz),
        TimeColumn::Named { .. } | TimeColumn::Angle { .. } => None,
    };
    notes.extend(ballbar_feed::notes(found, arc_deg.to_radians(), rate_hz));
    let by_angle = ByAngle {
        plane,
        turns,
        feed_mm_s: found.feed_mm_min.map(|feed| feed / 60.0),
        nominal_mm: found.nominal_length_mm,
        said: Said {
            operator: short(found.operator.as_ref()),
            bar_serial: short(found.serial.as_ref()),
            bar_calibrated: found.calibrated.as_deref().and_then(|of| day::parse(of.get(..8)?)),
        },
    };
    let began = found.started.as_deref().and_then(|started| day::parse(started.get(..8)?));
    Ok(Log::new(file, readings, notes).begun(began).with_angles(by_angle))
}

/// What the readings are taken for.
fn taken_words(unit: LengthUnit, is_stated: bool, arc_deg: f64) -> String {
    let by = if is_stated { "as the test file says" } else { "by their size and circularity" };
    format!(
        "the .b5r has readings alone: they are taken for {} ({by}), even over the {arc_deg} degrees in the middle of each arc",
        unit.name()
    )
}

/// The order in which clockwise readings stand.
fn order_of(found: &BallbarFile, unit: LengthUnit, arc_deg: f64) -> Result<Listed> {
    let [counter_clockwise, clockwise] = [true, false].map(|way| {
        let is_circle = |run: &BarRun| run.readings.iter().flatten().count() >= FEWEST_READINGS;
        let runs = found.runs.iter().filter(|run| run.counter_clockwise == Some(way));
        let runs = runs.filter(|run| is_circle(run));
        let in_mm = |run: &BarRun| {
            run.readings.iter().map(|reading| reading.map(|value| unit.to_mm(value))).collect()
        };
        runs.map(in_mm).collect::<Vec<Vec<Option<f64>>>>()
    });
    listed(&counter_clockwise, &clockwise, arc_deg.to_radians())
}

/// What is to be said of it, where there is a clockwise run.
fn order_words(found: &BallbarFile, order: Listed) -> Option<String> {
    found.runs.iter().find(|run| run.counter_clockwise == Some(false))?;
    match order {
        Listed::AsDriven => None,
        Listed::ByAngle => Some(
            "the clockwise readings stand by rising angle, as both directions together tell, and are taken in the opposite order"
                .into(),
        ),
        Listed::NotTold(mm) => Some(format!(
            "in which order the clockwise readings stand is not told (what would tell is {:.1} um of 5): they are taken as driven; were they listed by rising angle, squareness and servo mismatch would have changed places: `clockwise_order = \"driven\"` or `\"rising\"` under `[log]` in the test file says it",
            1e3 * mm
        )),
    }
}

/// What is no longer than a name; a page is no place for more.
fn short(words: Option<&String>) -> Option<String> {
    const LONGEST: usize = 100;
    words.filter(|words| words.len() <= LONGEST).cloned()
}

/// The unit of the readings: that in which they are as round as the file says, else the one that makes them readings of a bar.
fn unit_of(found: &BallbarFile, arc_deg: f64) -> Result<LengthUnit> {
    for unit in [LengthUnit::Millimetre, LengthUnit::Micrometre] {
        for run in &found.runs {
            if Round::of(run, unit, arc_deg)?.is_some_and(|round| round.is_as_stated()) {
                return Ok(unit);
            }
        }
    }
    let all = found.runs.iter().flat_map(|run| run.readings.iter().flatten());
    let largest = all.fold(0.0_f64, |most, reading| most.max(reading.abs()));
    Ok(if largest <= LARGEST_MM { LengthUnit::Millimetre } else { LengthUnit::Micrometre })
}

/// How round a run is, of its readings and as the file has it.
struct Round {
    /// By least squares and by minimum zone: which of them Ballbar 20 takes is written nowhere.
    own_mm: [f64; 2],
    stated_mm: f64,
}

impl Round {
    /// `None` where the file says none.
    fn of(run: &BarRun, unit: LengthUnit, arc_deg: f64) -> Result<Option<Self>> {
        let Some(stated_mm) = run.feature("AF_CIRCULARITY", "UT_LENGTH_MM") else {
            return Ok(None);
        };
        if run.readings.iter().all(Option::is_none) {
            return Ok(None);
        }
        let own = circularities(&run.readings, arc_deg.to_radians())?;
        Ok(Some(Self { own_mm: own.map(|own| unit.to_mm(own)), stated_mm }))
    }

    fn is_as_stated(&self) -> bool {
        let stated_mm = self.stated_mm;
        let most_mm = SAME_SHARE * stated_mm.abs() + SAME_MM;
        self.own_mm.iter().any(|own_mm| (own_mm - stated_mm).abs() <= most_mm)
    }
}

impl fmt::Display for Round {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [least_squares_um, minimum_zone_um] = self.own_mm.map(|mm| 1e3 * mm);
        let stated_um = 1e3 * self.stated_mm;
        write!(
            f,
            "{stated_um:.1} um round as Ballbar 20 says, and its readings are {least_squares_um:.1} um round by least squares and {minimum_zone_um:.1} by minimum zone"
        )
    }
}

/// The axes of a plane, in the order in which G17, G18 and G19 count their angles.
pub(crate) fn plane_of(name: &str) -> Option<[usize; 2]> {
    match name.trim().to_uppercase().as_str() {
        "XY" | "YX" => Some([0, 1]),
        "YZ" | "ZY" => Some([1, 2]),
        "ZX" | "XZ" => Some([2, 0]),
        _ => None,
    }
}

/// The arc in a name such as `XY 360 grad 150mm`: a number before a word for degrees.
fn arc_of_name(name: &str) -> Option<f64> {
    let name = name.to_lowercase();
    let units = ["grad", "deg", "\u{b0}", "\u{5ea6}"];
    let at = units.into_iter().filter_map(|unit| name.find(unit)).min()?;
    let before = name[..at].trim_end_matches([' ', '-', '_']);
    let from = before
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| at + before[at..].chars().next().map_or(1, char::len_utf8));
    before[from..].parse().ok().filter(|degrees| (10.0..=360.0).contains(degrees))
}
