//! What a `.b5r` says to `ballbar init`.

use std::path::Path;

use super::results::path_from;
use crate::error::{Error, Place, Result};
use crate::log::{self, Angles, BallbarFile, ByAngle, Content, Format, LengthUnit};
use crate::plan::{LENGTHS_MM, Planes};
use crate::start::{Measured, TestKind};

/// What the user says of the file.
pub(super) struct Stated {
    /// Which test it was.
    pub(super) test: Option<TestKind>,
    /// The degrees that its readings stand on.
    pub(super) arc_deg: Option<f64>,
    /// The unit of its readings.
    pub(super) unit: Option<LengthUnit>,
}

/// A measured plane, and what of it goes into both files.
pub(super) struct Found {
    /// What was tested.
    pub(super) machine: Option<String>,
    /// Its plane.
    pub(super) test: TestKind,
    /// Nominal length of the bar, mm.
    pub(super) bar_mm: Option<f64>,
    /// Programmed feed, mm/min.
    pub(super) feed_mm_min: Option<f64>,
    /// What the test file says of the log.
    pub(super) measured: Measured,
    /// What is not certain of it.
    pub(super) notes: Vec<String>,
}

impl Found {
    /// Reads a file for a test file in a folder.
    ///
    /// # Errors
    /// What is no `.b5r`; one that contradicts itself or what is stated; two runs the same way: a planned program has one.
    pub(super) fn read(file: &Path, folder: &Path, stated: &Stated) -> Result<Self> {
        let refused = |what: String, hint: &str| {
            Err(Error::input(what).at(Place::file(file)).hint(hint.to_owned()))
        };
        let found = match log::look_into(file, None)? {
            Content::Ballbar(found) => *found,
            Content::Table(_) => {
                return refused(
                    "this is a table of readings, which does not say what was tested".into(),
                    "`ballbar show FILE` tells the lines for `[log]` of the test file; `--from` is for a .b5r",
                );
            }
        };
        let test = test_of(&found, file, stated.test)?;
        let states_plane = plane_of(&found).is_none();
        let format = Format {
            plane: axes_of(test),
            data_arc_deg: stated.arc_deg,
            stated_unit: stated.unit,
            ..Format::default()
        };
        let [shortest, longest] = LENGTHS_MM;
        if let Some(mm) = found.nominal_length_mm.filter(|mm| !(shortest..=longest).contains(mm)) {
            return refused(
                format!("the file is of a bar of {mm} mm, and a bar has {shortest} to {longest}"),
                "take the file as Ballbar 20 wrote it",
            );
        }
        let log = log::log_of(&found, file, &format).map_err(in_options)?;
        let by_angle = log.by_angle();
        let ways = [true, false].map(|way| {
            let turns = by_angle.map_or(&[][..], |by_angle| &by_angle.turns);
            turns.iter().filter(|turn| turn.counter_clockwise == way).count()
        });
        if ways.iter().any(|&count| count > 1) {
            let [counter, clockwise] = ways;
            return refused(
                format!(
                    "the file has {counter} run(s) CCW and {clockwise} CW: `init` writes a program of one each way"
                ),
                "begin without `--from`, and name the program that ran and this log under `[[run]]` in the test file",
            );
        }
        let measured = Measured {
            log: path_from(folder, file)?,
            arc_deg: by_angle.and_then(even_deg).unwrap_or(360.0),
            states_arc: stated.arc_deg.is_some(),
            unit: stated.unit,
            states_plane,
        };
        let mut notes = log.notes().to_vec();
        if measured.begins_anywhere(test) {
            notes.push("the file does not say where the arc began: `start_deg` in the test file, here 0, must be that of the program that ran".into());
        }
        Ok(Self {
            machine: found.machine,
            test,
            bar_mm: found.nominal_length_mm,
            feed_mm_min: found.feed_mm_min,
            measured,
            notes,
        })
    }

    /// What was found, in a line.
    pub(super) fn words(&self) -> String {
        let number = |value: Option<f64>, unit: &str| {
            value.map_or(String::new(), |value| format!(", {value} {unit}"))
        };
        format!(
            "plane {}, {} degrees{}{}{}",
            self.test.name(),
            self.measured.arc_deg,
            number(self.bar_mm, "mm"),
            number(self.feed_mm_min, "mm/min"),
            self.machine.as_ref().map_or(String::new(), |name| format!(", {name}"))
        )
    }
}

/// How much of an arc readings stand on that are even over it, degrees, to the nearest hundredth.
fn even_deg(by_angle: &ByAngle) -> Option<f64> {
    match by_angle.turns.first()?.angles {
        Angles::Even(arc_rad) => Some((1e2 * arc_rad.to_degrees()).round() / 1e2),
        Angles::Stated(_) => None,
    }
}

fn plane_of(found: &BallbarFile) -> Option<Planes> {
    let axes = log::plane_of(found.plane.as_deref()?)?;
    Planes::ALL.into_iter().find(|&planes| axes_of(TestKind::Planes(planes)) == Some(axes))
}

/// The axes of a plane.
fn axes_of(test: TestKind) -> Option<[usize; 2]> {
    let TestKind::Planes(planes) = test else { return None };
    let &[plane] = planes.planes() else { return None };
    Some(plane.axes())
}

/// The plane that file and user agree on.
fn test_of(found: &BallbarFile, file: &Path, stated: Option<TestKind>) -> Result<TestKind> {
    let refused = |what: String, hint: &str| {
        Err(Error::input(what).at(Place::file(file)).hint(hint.to_owned()))
    };
    let own = plane_of(found).map(TestKind::Planes);
    match (own, stated) {
        (Some(own), Some(other)) if own != other => refused(
            format!(
                "the file is of the plane {}, and `--test {}` is another",
                own.name(),
                other.name()
            ),
            "leave `--test` out: the file says it",
        ),
        (Some(own), _) => Ok(own),
        (None, Some(stated)) if axes_of(stated).is_some() => Ok(stated),
        (None, _) => refused(
            "the file does not say its plane".into(),
            "say which it was: `--test xy`, `--test yz` or `--test zx`",
        ),
    }
}

/// Nobody has a test file yet: what it would have to say is told by options.
fn in_options(error: Error) -> Error {
    let hint = error.hint.map(|hint| {
        if hint.contains("`data_arc_deg`") {
            "say both the unit of the readings and the degrees that they stand on without overshoot, such as `--unit um --arc 220`; then they are taken as they are"
                .to_owned()
        } else if hint.contains("`reading_unit`") {
            "is the unit right? `--unit mm` or `--unit um` says it".to_owned()
        } else {
            hint
        }
    });
    Error { hint, ..error }
}
