//! Files of Ballbar 20 (`.b5r`): XML that its maker has not described in public.
//!
//! What stands here is what programs of others read from real files. Names are compared without their namespace, what is not
//! known is passed over, and nothing but the readings and their direction has to be there. Entities are not resolved and a
//! document type is refused: neither is in these files, and both can be made to take all memory.

use std::ops::Range;
use std::path::Path;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::error::{Error, Place, Result};

/// A file of Ballbar 20, as it is written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BallbarFile {
    /// Name of the test, such as `XY 360 150mm`.
    pub test: Option<String>,
    /// Who ran it.
    pub operator: Option<String>,
    /// When it began, `yyyyMMdd-HHmmss`.
    pub started: Option<String>,
    /// When it ended.
    pub completed: Option<String>,
    /// On what.
    pub machine: Option<String>,
    /// What the instrument is.
    pub instrument: Option<String>,
    /// Its serial number.
    pub serial: Option<String>,
    /// When it was calibrated last.
    pub calibrated: Option<String>,
    /// What was measured on.
    pub part: Option<String>,
    /// Nominal length of the bar, mm.
    pub nominal_length_mm: Option<f64>,
    /// Programmed feed, mm/min.
    pub feed_mm_min: Option<f64>,
    /// The plane, such as `XY`.
    pub plane: Option<String>,
    /// The runs, in the order of the file.
    pub runs: Vec<BarRun>,
    /// What Ballbar 20 makes of both runs.
    pub features: Vec<Feature>,
}

/// A run in one direction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BarRun {
    /// Whether it was driven counter-clockwise.
    pub counter_clockwise: Option<bool>,
    /// Its readings in the unit of the file; `None` where one is none.
    pub readings: Vec<Option<f64>>,
    /// Line of the file in which they begin.
    pub line: usize,
    /// What Ballbar 20 makes of the run.
    pub features: Vec<Feature>,
}

/// A value that Ballbar 20 computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Feature {
    /// What it is, such as `AF_CIRCULARITY`.
    pub name: String,
    /// Its unit, such as `UT_LENGTH_MM`.
    pub unit: String,
    /// In that unit.
    pub value: f64,
}

impl BarRun {
    /// A value of the run, by its name and unit.
    pub fn feature(&self, name: &str, unit: &str) -> Option<f64> {
        self.features.iter().find(|of| of.name == name && of.unit == unit).map(|of| of.value)
    }
}

/// Elements inside elements; the files have six.
const DEEPEST: usize = 64;
/// A test has two runs, and two feeds at the most.
const MOST_RUNS: usize = 64;
/// A run at 1000 a second over ten minutes.
const MOST_READINGS: usize = 1_000_000;
/// 10 mm in nanometres.
const BEYOND: f64 = 1e7;
const MOST_FEATURES: usize = 10_000;

const EXPORT: &str =
    "take the file as Ballbar 20 wrote it; readings as text go in a CSV with a column `angle_deg`";

/// Whether a text is XML, and not a table.
pub(super) fn is_xml(text: &str) -> bool {
    text.trim_start().starts_with('<')
}

/// Reads the text of a `.b5r`.
pub(super) fn parse(text: &str, file: &Path) -> Result<BallbarFile> {
    let mut reader = Reader::from_str(text);
    // The crate counts from where the text begins.
    let mut state = State { file, text, open: Vec::new(), found: BallbarFile::default() };
    loop {
        let before = reader.buffer_position() as usize;
        let event = reader.read_event();
        let place = before..reader.buffer_position() as usize;
        match event {
            Err(error) => return Err(state.refused(place, format!("the XML is broken: {error}"))),
            Ok(Event::DocType(_)) => {
                return Err(state.refused(place, "the file has a document type (DTD)".into()));
            }
            Ok(Event::Start(element)) => state.start(&element, place)?,
            Ok(Event::Empty(element)) => {
                state.start(&element, place.clone())?;
                state.end(place)?;
            }
            Ok(Event::End(_)) => state.end(place)?,
            Ok(Event::Text(words)) => state.text(&words.xml10_content(), &place),
            Ok(Event::CData(words)) => state.text(&words.xml10_content(), &place),
            Ok(Event::GeneralRef(entity)) => {
                let known = match &*entity.xml10_content() {
                    "amp" => Some('&'),
                    "lt" => Some('<'),
                    "gt" => Some('>'),
                    "quot" => Some('"'),
                    "apos" => Some('\''),
                    _ => entity.resolve_char_ref().ok().flatten(),
                };
                let Some(known) = known else {
                    return Err(state.refused(place, "the file has an entity of its own".into()));
                };
                state.text(known.encode_utf8(&mut [0; 4]), &place);
            }
            Ok(Event::Eof) => return state.finish(),
            Ok(_) => {}
        }
    }
}

/// An element that is not closed yet.
struct Open {
    /// Upper case, without its namespace.
    name: String,
    /// `NAME` and `DT` of a feature.
    attributes: [Option<String>; 2],
    text: String,
    /// Where its text begins.
    begins: usize,
}

struct State<'a> {
    file: &'a Path,
    text: &'a str,
    open: Vec<Open>,
    found: BallbarFile,
}

impl State<'_> {
    fn refused(&self, place: Range<usize>, what: String) -> Error {
        // An element may stand on several lines, and begin with the end of the one before.
        let written = self.text.get(place.clone()).unwrap_or("");
        let blank = written.len() - written.trim_start().len();
        let place = place.start + blank..place.end.max(place.start + blank + 1);
        Error::input(what).at(Place::bytes(self.file, self.text, place)).hint(EXPORT)
    }

    fn start(&mut self, element: &BytesStart, place: Range<usize>) -> Result<()> {
        if self.open.len() == DEEPEST {
            return Err(self.refused(place, format!("more than {DEEPEST} elements in each other")));
        }
        let name = element.local_name().as_ref().to_uppercase();
        let mut attributes = [None, None];
        let mut plane = None;
        for attribute in element.attributes() {
            let attribute = attribute.map_err(|error| {
                self.refused(place.clone(), format!("the XML is broken: {error}"))
            })?;
            let value = attribute.normalized_value(quick_xml::XmlVersion::Implicit1_0).map_err(
                |error| self.refused(place.clone(), format!("the XML is broken: {error}")),
            )?;
            let value = value.trim().to_owned();
            match attribute.key.local_name().as_ref().to_uppercase().as_str() {
                "NAME" | "MODEL" => attributes[0] = Some(value),
                "DT" | "MANUFACTURER" => attributes[1] = Some(value),
                "TEST_PLANE" => plane = Some(value),
                _ => {}
            }
        }
        let [named, _] = &attributes;
        match name.as_str() {
            "TEST_SPEC" => self.found.test.clone_from(named),
            "MACHINE_TESTED" => self.found.machine.clone_from(named),
            "INSTRUMENT" => {
                let words = [&attributes[1], &attributes[0]].into_iter().flatten();
                let words: Vec<&str> = words.map(String::as_str).collect();
                self.found.instrument = (!words.is_empty()).then(|| words.join(" "));
            }
            "PLANE" => self.found.plane = plane.or(self.found.plane.take()),
            "BALLBAR_RUN" if self.found.runs.len() == MOST_RUNS => {
                return Err(self.refused(place, format!("more than {MOST_RUNS} runs")));
            }
            "BALLBAR_RUN" => self.found.runs.push(BarRun::default()),
            _ => {}
        }
        self.open.push(Open { name, attributes, text: String::new(), begins: place.end });
        Ok(())
    }

    fn text(&mut self, words: &str, place: &Range<usize>) {
        if let Some(open) = self.open.last_mut() {
            if open.text.is_empty() {
                open.begins = place.start;
            }
            open.text.push_str(words);
        }
    }

    fn end(&mut self, place: Range<usize>) -> Result<()> {
        let Some(Open { name, attributes, text, begins }) = self.open.pop() else {
            return Err(self.refused(place, "an element ends that has not begun".into()));
        };
        let inside = begins..place.start.max(begins);
        let in_run = self.open.iter().any(|open| open.name == "BALLBAR_RUN");
        let words = text.trim();
        let filled = || (!words.is_empty()).then(|| words.to_owned());
        match name.as_str() {
            "RUN_DIRECTION" => {
                let counter_clockwise = match words.to_uppercase().as_str() {
                    "CCW" => true,
                    "CW" => false,
                    _ => {
                        return Err(
                            self.refused(inside, "a direction is neither CW nor CCW".into())
                        );
                    }
                };
                if let Some(run) = self.found.runs.last_mut().filter(|_| in_run) {
                    run.counter_clockwise = Some(counter_clockwise);
                }
            }
            "READINGS" if in_run => self.readings(&text, begins)?,
            "FEATURE" => self.feature(attributes, words, inside, in_run)?,
            "OPERATOR" => self.found.operator = filled(),
            "DATE_STARTED" => self.found.started = filled(),
            "DATE_COMPLETED" => self.found.completed = filled(),
            "SERIAL_NUMBER" => self.found.serial = filled(),
            "LAST_CALIBRATED" => self.found.calibrated = filled(),
            "PART_NUMBER" => self.found.part = filled(),
            // What is not above zero says nothing.
            "NOMINAL_LENGTH" => {
                self.found.nominal_length_mm = number(words).filter(|length| *length > 0.0);
            }
            "PROGRAMMED_FEEDRATE" => {
                self.found.feed_mm_min = number(words).filter(|feed| *feed > 0.0);
            }
            "MACHINE_TESTED" if self.found.machine.is_none() => self.found.machine = filled(),
            "PLANE" if self.found.plane.is_none() => self.found.plane = filled(),
            _ => {}
        }
        Ok(())
    }

    fn readings(&mut self, text: &str, begins: usize) -> Result<()> {
        let line = self.text[..begins.min(self.text.len())].matches('\n').count() + 1;
        let mut readings = Vec::new();
        for word in text.split_whitespace() {
            if readings.len() == MOST_READINGS {
                let what = format!("a run has more than {MOST_READINGS} readings");
                return Err(self.refused(begins..begins + 1, what));
            }
            let at = || {
                // Where no entity stands before it, the text is as it was written.
                let at = begins + word.as_ptr() as usize - text.as_ptr() as usize;
                at..at + word.len()
            };
            let reading = number(word);
            if reading.is_some_and(|reading| reading.abs() > BEYOND) {
                let what = format!(
                    "a reading of {}, which no ball-bar reaches in any unit",
                    super::text::quote(word)
                );
                return Err(self.refused(at(), what));
            }
            if reading.is_none() && !super::number::is_no_reading(word) {
                let what = format!("{} is not a number", super::text::quote(word));
                return Err(self.refused(at(), what));
            }
            readings.push(reading);
        }
        if let Some(run) = self.found.runs.last_mut() {
            (run.readings, run.line) = (readings, line);
        }
        Ok(())
    }

    fn feature(
        &mut self,
        [name, unit]: [Option<String>; 2],
        words: &str,
        inside: Range<usize>,
        in_run: bool,
    ) -> Result<()> {
        // One that says nothing is passed over.
        let (Some(name), Some(unit), Some(value)) = (name, unit, number(words)) else {
            return Ok(());
        };
        let features = match self.found.runs.last_mut() {
            Some(run) if in_run => &mut run.features,
            _ => &mut self.found.features,
        };
        if features.len() == MOST_FEATURES {
            return Err(self.refused(inside, format!("more than {MOST_FEATURES} values")));
        }
        features.push(Feature { name, unit, value });
        Ok(())
    }

    fn finish(self) -> Result<BallbarFile> {
        let end = self.text.trim_end().len();
        let last = end.saturating_sub(1)..end;
        if let Some(open) = self.open.last() {
            let what = format!("the file ends inside of `{}`: was it copied whole?", open.name);
            return Err(self.refused(last, what));
        }
        let error = |what: &str| Err(Error::input(what).at(Place::file(self.file)).hint(EXPORT));
        if self.found.runs.is_empty() {
            return error("the file is XML, and has no BALLBAR_RUN: it is no .b5r of Ballbar 20");
        }
        if self.found.runs.iter().any(|run| run.readings.len() < FEWEST_READINGS) {
            return error("a run of the file has less than 30 readings");
        }
        if self.found.runs.iter().any(|run| run.counter_clockwise.is_none()) {
            return error("a run of the file does not say its direction (RUN_DIRECTION)");
        }
        Ok(self.found)
    }
}

/// A circle needs some points.
pub(super) const FEWEST_READINGS: usize = 30;

/// A finite number, with a decimal point or comma.
fn number(words: &str) -> Option<f64> {
    let value: f64 = words.trim().replace(',', ".").replace('\u{2212}', "-").parse().ok()?;
    value.is_finite().then_some(value)
}
