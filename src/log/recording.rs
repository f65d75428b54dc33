//! Where a control had its slides: what it recorded of its own motion.
//!
//! Text, plain or gzipped, with a line of names above its columns: one of times and one of each slide, each name with its unit at
//! the end (`time_ms`, `X [mm]`). Without names it is what LinuxCNC's sampler writes: a row of X, Y and Z in mm for every
//! millisecond of its servo thread, with the number of the row before them or without, and anything behind them.

use std::ops::Range;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::bounds::LATEST_S;
use super::encoding::as_text;
use super::number::Numbers;
use super::text::{Line, lines, quote, split};
use crate::error::{Error, Place, Result};
use crate::input;
use crate::plan::log_format::{Delimiter, Format, LengthUnit, TimeUnit, is_between};

/// More than an hour of every millisecond.
const MOST_ROWS: usize = 4_000_000;
/// Fewer tell no motion.
const FEWEST_ROWS: usize = 10;
/// As far as machine coordinates go, mm.
const FARTHEST_MM: f64 = 100_000.0;
/// Lines that may stand above the names of the columns.
const LOOKED_AT: usize = 200;
/// Period of the servo thread of LinuxCNC unless its INI file says otherwise, s.
const SERVO_PERIOD_S: f64 = 1e-3;
/// Where nothing was written down for longer, the slides must stand, s.
const LONGEST_GAP_S: f64 = 0.2;
/// A slide that is so near to where it was stands, mm.
const STANDS_MM: f64 = 0.1;

const COLUMNS: &str = "name the columns in a line above them, each with its unit at the end: `time_s,x_mm,y_mm,z_mm` (times in s, ms, us or min, positions in mm, um, nm or inch); \
    without names it must be what LinuxCNC's sampler writes, X, Y and Z in mm for every millisecond";

/// Where the slides were at a time of the control's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stand {
    /// Time on the control's clock, s.
    pub time_s: f64,
    /// Machine coordinates of X, Y, Z, mm.
    pub position_mm: Vector3<f64>,
}

/// Motion as a control has recorded it.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    file: PathBuf,
    rows: Vec<Stand>,
}

impl Recording {
    /// Reads the file of a recording.
    ///
    /// # Errors
    /// When it cannot be read or is none, with the line.
    pub fn read(file: &Path) -> Result<Self> {
        Self::of_text(&input::read(file, "recorded motion")?, file)
    }

    /// Reads a recording from the content of a file; `file` is only named in messages.
    ///
    /// # Errors
    /// When it is none, with the line.
    pub fn read_bytes(bytes: &[u8], file: &Path) -> Result<Self> {
        Self::of_text(&input::unpacked(bytes, file, "recorded motion")?, file)
    }

    fn of_text(bytes: &[u8], file: &Path) -> Result<Self> {
        let format = Format::default();
        let (text, _) = as_text(bytes, file, &format)?;
        let said = |line: &Line| !line.is_comment() && !line.is_blank();
        let (header, skipped) = header(lines(&text).filter(said), file)?;
        let rows = header.rows(lines(&text).filter(said).skip(skipped), file, &format)?;
        if rows.len() < FEWEST_ROWS {
            return Err(Error::input(format!(
                "the recorded motion has {} row(s), and {FEWEST_ROWS} are the least",
                rows.len()
            ))
            .at(Place::file(file))
            .hint("was the recording started before the program, and saved whole?"));
        }
        Ok(Self { file: file.to_path_buf(), rows })
    }

    /// The file that it was read from.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Its rows; times increase.
    pub fn rows(&self) -> &[Stand] {
        &self.rows
    }
}

/// Where a row has its time.
enum Times {
    Column(usize, TimeUnit),
    /// Rows of the servo thread, each with its number.
    Counted(usize),
    /// Rows of the servo thread, none left out.
    EveryPeriod,
}

struct Header {
    delimiter: Delimiter,
    times: Times,
    /// Columns of X, Y, Z with their units.
    slides: [(usize, LengthUnit); 3],
}

/// What the columns are, and how many lines stand above the first row.
fn header<'a>(said: impl Iterator<Item = Line<'a>>, file: &Path) -> Result<(Header, usize)> {
    let mut fields = Vec::new();
    let mut first = None;
    for (above, line) in said.take(LOOKED_AT).enumerate() {
        first.get_or_insert(line);
        for delimiter in Delimiter::ALL {
            split(line.text, delimiter, &mut fields);
            let names: Vec<&str> = fields.iter().map(|field| &line.text[field.clone()]).collect();
            if let Some(header) = named(&names, delimiter, line, &fields, file)? {
                return Ok((header, above + 1));
            }
            let numbers = names.iter().all(|name| name.parse::<f64>().is_ok());
            // Numbers below names that say nothing are no sampler's.
            if above == 0 && names.len() >= 3 && numbers {
                let mm = |column: usize| (column, LengthUnit::Millimetre);
                let (times, from) =
                    if names.len() == 3 { (Times::EveryPeriod, 0) } else { (Times::Counted(0), 1) };
                let slides = [mm(from), mm(from + 1), mm(from + 2)];
                return Ok((Header { delimiter, times, slides }, above));
            }
        }
    }
    let place = match first {
        Some(line) => Place::line(file, line.number, line.text),
        None => Place::file(file),
    };
    Err(Error::input("the recorded motion names no column of times and none of X, Y and Z")
        .at(place)
        .hint(COLUMNS))
}

/// The columns by their names; `None` where they are no such names.
fn named(
    names: &[&str],
    delimiter: Delimiter,
    line: Line,
    fields: &[Range<usize>],
    file: &Path,
) -> Result<Option<Header>> {
    let is_of = |name: &str, slide: &str| {
        LengthUnit::of_column(name).is_some()
            && name.split(is_between).any(|word| word.eq_ignore_ascii_case(slide))
    };
    let mut slides = [(0, LengthUnit::Millimetre); 3];
    for (slide, found) in ["x", "y", "z"].into_iter().zip(&mut slides) {
        let mut columns = (0..names.len()).filter(|k| is_of(names[*k], slide));
        let Some(column) = columns.next() else { return Ok(None) };
        if let Some(again) = columns.next() {
            let upper = slide.to_uppercase();
            return Err(line
                .error(
                    file,
                    &fields[again],
                    format!("the recorded motion has two columns of {upper}"),
                )
                .hint("keep one: the commanded positions, or the actual ones"));
        }
        let unit = LengthUnit::of_column(names[column]).unwrap_or(LengthUnit::Millimetre);
        *found = (column, unit);
    }
    let time = names.iter().enumerate().find_map(|(k, name)| {
        let of_slide = slides.iter().any(|(column, _)| *column == k);
        TimeUnit::of_column(name).filter(|_| !of_slide).map(|unit| Times::Column(k, unit))
    });
    Ok(time.map(|times| Header { delimiter, times, slides }))
}

impl Header {
    fn rows<'a>(
        &self,
        lines: impl Iterator<Item = Line<'a>>,
        file: &Path,
        format: &Format,
    ) -> Result<Vec<Stand>> {
        let mut rows: Vec<Stand> = Vec::new();
        let mut numbers = Numbers::new(self.delimiter, format);
        let mut fields = Vec::new();
        let time_column = match self.times {
            Times::Column(column, _) | Times::Counted(column) => Some(column),
            Times::EveryPeriod => None,
        };
        let columns = self.slides.iter().map(|(column, _)| *column).chain(time_column);
        let last_column = columns.max().unwrap_or(0);
        for line in lines {
            split(line.text, self.delimiter, &mut fields);
            let end = line.text.len();
            if fields.len() <= last_column {
                let what = format!(
                    "{} field(s), and the columns of the times, X, Y and Z need {}",
                    fields.len(),
                    last_column + 1
                );
                return Err(line
                    .error(file, &(end..end), what)
                    .hint("was the recording cut off here, or did its sampler run over?"));
            }
            if rows.len() == MOST_ROWS {
                return Err(line
                    .error(
                        file,
                        &(0..0),
                        format!("the recorded motion has more than {MOST_ROWS} rows"),
                    )
                    .hint("record the time of the program only, or fewer rows a second"));
            }
            let mut number = |column: usize, convert: &dyn Fn(f64) -> f64| {
                let field = &fields[column];
                let written = &line.text[field.clone()];
                let fail = |what| line.error(file, field, what);
                let value = numbers.parse(written, convert);
                let value =
                    value.map_err(|fault| fail(fault.what).hint(fault.hint.unwrap_or(COLUMNS)))?;
                Ok((value, quote(written), field.clone()))
            };
            let mut position_mm = Vector3::zeros();
            for (slide, (column, unit)) in self.slides.iter().enumerate() {
                let (mm, written, field) = number(*column, &|value| unit.to_mm(value))?;
                if mm.abs() > FARTHEST_MM {
                    return Err(line
                        .error(
                            file,
                            &field,
                            format!("{written} {} is beyond {FARTHEST_MM} mm", unit.name()),
                        )
                        .hint("is the unit at the end of the column's name right?"));
                }
                position_mm[slide] = mm;
            }
            let (time_s, field) = match self.times {
                Times::Column(column, unit) => {
                    let (time_s, _, field) = number(column, &|value| unit.to_s(value))?;
                    (time_s, field)
                }
                Times::Counted(column) => {
                    let (time_s, _, field) = number(column, &|value| value * SERVO_PERIOD_S)?;
                    (time_s, field)
                }
                Times::EveryPeriod => (rows.len() as f64 * SERVO_PERIOD_S, 0..0),
            };
            check_time(time_s, &position_mm, rows.last(), &|what| line.error(file, &field, what))?;
            rows.push(Stand { time_s, position_mm });
        }
        Ok(rows)
    }
}

/// Times increase, and nothing moves while nothing is written down.
fn check_time(
    time_s: f64,
    position_mm: &Vector3<f64>,
    before: Option<&Stand>,
    fail: &dyn Fn(String) -> Error,
) -> Result<()> {
    if time_s.abs() > LATEST_S {
        return Err(fail(format!("a time of {time_s} s")).hint("is the unit of the times right?"));
    }
    let Some(before) = before else { return Ok(()) };
    let later_s = time_s - before.time_s;
    if later_s <= 0.0 {
        return Err(fail(format!("{time_s} s comes after {} s", before.time_s)).hint(
            "times must increase from row to row: were two recordings joined, or are the times too coarse?",
        ));
    }
    let way_mm = (position_mm - before.position_mm).norm();
    if later_s > LONGEST_GAP_S && way_mm > STANDS_MM {
        return Err(fail(format!(
            "nothing was recorded for {later_s:.3} s, in which the slides went {way_mm:.3} mm"
        ))
        .hint(format!(
            "rows may be {LONGEST_GAP_S} s apart while the machine moves, 10 ms or less are better; where rows were lost, record again"
        )));
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)] // what is read is exact or wrong
mod tests {
    use std::fmt::Write as _;

    use super::*;

    fn read(text: &str) -> Result<Recording> {
        Recording::read_bytes(text.as_bytes(), "motion.csv".as_ref())
    }

    fn rows(of: impl Fn(usize) -> String) -> String {
        (0..FEWEST_ROWS).fold(String::new(), |mut text, k| {
            writeln!(text, "{}", of(k)).unwrap();
            text
        })
    }

    #[test]
    fn names_say_what_the_columns_are_and_in_which_units() {
        let plain = rows(|k| format!("0.5{k},{},2,-3", k as f64 / 1e3));
        let plain = read(&format!("# servo\ntime_s,x_mm,y_mm,z_mm\n{plain}")).unwrap();
        let other = rows(|k| format!("2000;-3,0;{};5;{}", k, 500 + 10 * k));
        let other =
            read(&format!("Trace 7\n\nY pos [um];Z (mm);X_um;load;time [ms]\n{other}")).unwrap();
        assert_eq!(plain.rows(), other.rows());
        assert_eq!(plain.rows()[1].time_s, 0.51);
        assert_eq!(plain.rows()[1].position_mm, Vector3::new(1e-3, 2.0, -3.0));
    }

    #[test]
    fn what_a_sampler_writes_needs_no_names() {
        let bare = read(&rows(|k| format!("{k}.000000 2.000000 -3.000000"))).unwrap();
        let counted =
            read(&rows(|k| format!("{} {k}.000000 2.000000 -3.000000 0", 17 + k))).unwrap();
        for (bare, counted) in bare.rows().iter().zip(counted.rows()) {
            assert_eq!(bare.position_mm, counted.position_mm);
            assert!((counted.time_s - bare.time_s - 0.017).abs() < 1e-12);
        }
    }

    #[track_caller]
    fn refused(text: &str, line: usize, what: &str) {
        let error = read(text).unwrap_err();
        let told = error.to_string();
        assert!(told.contains(what), "{told}");
        assert!(told.contains(&format!("motion.csv:{line}")), "{told}");
    }

    #[test]
    fn what_is_no_motion_is_refused_with_its_line() {
        let names = "time_s,x_mm,y_mm,z_mm\n";
        refused("time_s,x_mm,y_mm\n0,1,2\n", 1, "names no column");
        refused("time_s,x_mm,y_mm,z_mm,x_um\n0,1,2,3,4\n", 1, "two columns of X");
        refused(&format!("{names}0,1,2,3\n0,1,2,3\n"), 3, "comes after");
        refused(&format!("{names}0,1,2,3\n0.1,1,2\n"), 3, "3 field(s)");
        refused(&format!("{names}0,1,2,3\n0.1,1,2,NaN\n"), 3, "not a finite number");
        refused(&format!("{names}0,1,2,3\n0.1,1,2,1e6\n"), 3, "beyond 100000 mm");
        refused(&format!("{names}0,1,2,3\n1,1,2,4\n"), 3, "in which the slides went 1.000 mm");
        // A gap in which nothing moves is a pause in which nobody recorded.
        let paused = rows(|k| format!("{},1,2,3", 10 * k));
        assert!(read(&format!("{names}{paused}")).is_ok());
        assert!(read(&format!("{names}0,1,2,3\n")).unwrap_err().to_string().contains("1 row(s)"));
    }
}
