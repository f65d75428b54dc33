//! What the columns of a log mean.

pub use super::log_text::{DecimalMark, OutOfRange, TextEncoding};

/// Whether a character stands between the words of a column's name.
pub(crate) fn is_between(c: char) -> bool {
    matches!(c, '_' | '[' | ']' | '(' | ')' | '{' | '}' | '/' | ':' | ';' | ',' | '.')
        || c.is_whitespace()
}

/// The unit at the end of a column's name: of `length_mm`, `Time (s)`, `Abweichung [µm]`.
fn at_the_end<T>(name: &str, parse: impl Fn(&str) -> Option<T>) -> Option<T> {
    name.split(is_between).rfind(|word| !word.is_empty()).and_then(parse)
}

/// Unit of a column of times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds.
    Second,
    /// Milliseconds.
    Millisecond,
    /// Microseconds.
    Microsecond,
    /// Minutes.
    Minute,
    /// Days: the times of Excel, as numbers.
    Day,
}

impl TimeUnit {
    /// Every unit.
    pub const ALL: [Self; 5] =
        [Self::Second, Self::Millisecond, Self::Microsecond, Self::Minute, Self::Day];
    /// The names that [`TimeUnit::parse`] knows.
    pub const NAMES: [&str; 5] = ["s", "ms", "us", "min", "d"];

    /// The unit of a name as a test file gives it.
    pub fn parse(name: &str) -> Option<Self> {
        match name {
            "s" => Some(Self::Second),
            "ms" => Some(Self::Millisecond),
            "us" | "\u{b5}s" | "\u{3bc}s" => Some(Self::Microsecond),
            "min" => Some(Self::Minute),
            "d" => Some(Self::Day),
            _ => None,
        }
    }

    /// The unit that the name of a column ends with.
    pub fn of_column(name: &str) -> Option<Self> {
        at_the_end(name, Self::parse)
    }

    /// The name as a test file gives it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Second => "s",
            Self::Millisecond => "ms",
            Self::Microsecond => "us",
            Self::Minute => "min",
            Self::Day => "d",
        }
    }

    /// A value in this unit, in s.
    pub fn to_s(self, value: f64) -> f64 {
        // Divisions, because 1e-3 and 1e-6 are not exact: 6.3 / 1e3 is the double nearest to 0.0063.
        match self {
            Self::Second => value,
            Self::Millisecond => value / 1e3,
            Self::Microsecond => value / 1e6,
            Self::Minute => value * 60.0,
            Self::Day => value * 86_400.0,
        }
    }
}

/// Unit of a column of readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    Millimetre,
    /// Micrometres.
    Micrometre,
    /// Nanometres.
    Nanometre,
    /// Inches of 25.4 mm.
    Inch,
}

impl LengthUnit {
    /// Every unit.
    pub const ALL: [Self; 4] = [Self::Millimetre, Self::Micrometre, Self::Nanometre, Self::Inch];
    /// The names that [`LengthUnit::parse`] knows.
    pub const NAMES: [&str; 4] = ["mm", "um", "nm", "inch"];

    /// The unit of a name as a test file gives it.
    pub fn parse(name: &str) -> Option<Self> {
        match name {
            "mm" => Some(Self::Millimetre),
            "um" | "\u{b5}m" | "\u{3bc}m" => Some(Self::Micrometre),
            "nm" => Some(Self::Nanometre),
            "inch" => Some(Self::Inch),
            _ => None,
        }
    }

    /// The unit that the name of a column ends with.
    pub fn of_column(name: &str) -> Option<Self> {
        at_the_end(name, Self::parse)
    }

    /// The name as a test file gives it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Micrometre => "um",
            Self::Nanometre => "nm",
            Self::Inch => "inch",
        }
    }

    /// A value in this unit, in mm.
    pub fn to_mm(self, value: f64) -> f64 {
        match self {
            Self::Millimetre => value,
            Self::Micrometre => value / 1e3,
            Self::Nanometre => value / 1e6,
            Self::Inch => value * 25.4,
        }
    }
}

/// Where the time of a reading comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum TimeColumn {
    /// A column of the log, on the instrument's own clock.
    Named {
        /// Its name in the header.
        name: String,
        /// Its unit.
        unit: TimeUnit,
    },
    /// No column: sample `k`, counted from 0, was taken at `k / hz`.
    Rate {
        /// Samples per second.
        hz: f64,
    },
    /// A column of angles, degrees, in place of times.
    Angle {
        /// Its name in the header.
        name: String,
    },
}

/// What the instrument wrote down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReadingKind {
    /// Length of the bar minus its nominal length, positive outward.
    Deviation,
    /// The whole length of the bar.
    Length {
        /// The nominal length that is subtracted, mm.
        nominal_mm: f64,
    },
}

/// Where the readings come from.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingColumn {
    /// Name of the column in the header.
    pub name: String,
    /// Its unit.
    pub unit: LengthUnit,
    /// Whether it holds deviations or lengths.
    pub kind: ReadingKind,
    /// Whether its numbers fall where the bar grows.
    pub inverted: bool,
}

/// What stands between two fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delimiter {
    /// A comma; numbers then have a decimal point.
    Comma,
    /// A semicolon; numbers may have a decimal comma.
    Semicolon,
    /// A tab; numbers may have a decimal comma.
    Tab,
    /// Spaces or tabs, as many as there are; no field can be empty then. Numbers may have a decimal comma.
    Blanks,
}

impl Delimiter {
    /// Every delimiter, in the order in which they are tried.
    pub const ALL: [Self; 4] = [Self::Comma, Self::Semicolon, Self::Tab, Self::Blanks];

    /// The delimiter of a first line such as `sep=;`, with which Excel is told.
    pub(crate) fn told(line: &str) -> Option<Self> {
        let line = line.trim_start().trim_start_matches('"').to_lowercase();
        match line.strip_prefix("sep=")?.chars().next() {
            None | Some(',' | '"') => Some(Self::Comma),
            Some(';') => Some(Self::Semicolon),
            Some('\t') => Some(Self::Tab),
            Some(' ') => Some(Self::Blanks),
            Some(_) => None,
        }
    }

    pub(crate) fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Blanks => b' ',
        }
    }
}

/// The column of times unless another is named.
pub(super) const DEFAULT_TIME: &str = "time_s";

/// In which order the readings of clockwise arcs stand in a log by angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ClockwiseOrder {
    /// As they were driven: by falling angle.
    Driven,
    /// By rising angle, as those of the other direction.
    Rising,
}

/// How to read a log.
///
/// The default is the format this program writes itself: `time_s` in s, `deviation_um` in um.
#[derive(Debug, Clone, PartialEq)]
pub struct Format {
    /// Where the time comes from.
    pub time: TimeColumn,
    /// Where the readings come from.
    pub reading: ReadingColumn,
    /// What separates the fields; `None` looks at the header: the delimiter by which it holds the
    /// wanted columns.
    pub delimiter: Option<Delimiter>,
    /// How its text is coded; `None` looks at it.
    pub encoding: Option<TextEncoding>,
    /// Lines at its beginning that are not looked at.
    pub skip_lines: usize,
    /// The mark of its decimals; `None` looks at its numbers.
    pub decimal_mark: Option<DecimalMark>,
    /// What stands where the bar is out of range.
    pub out_of_range: OutOfRange,
    /// The bar reads this much either way and nothing beyond, mm.
    pub range_mm: f64,
    /// The plane of a log by angle: the axis from which angles count, and that towards which; `None` where the log says it.
    pub plane: Option<[usize; 2]>,
    /// How many degrees of each arc a log by angle that states none stands on; `None` where its name says it, or a full turn.
    pub data_arc_deg: Option<f64>,
    /// In which order the clockwise readings of a log by angle stand; `None` where a `.b5r` has to tell and those of a table are
    /// as driven.
    pub clockwise: Option<ClockwiseOrder>,
    /// The unit of the readings where the test file states it: a file without columns has no other.
    pub stated_unit: Option<LengthUnit>,
    /// Name of the sheet of a workbook; `None` takes the only one that has cells.
    pub sheet: Option<String>,
}

impl Default for Format {
    fn default() -> Self {
        Self {
            time: TimeColumn::Named { name: DEFAULT_TIME.to_owned(), unit: TimeUnit::Second },
            reading: ReadingColumn {
                name: "deviation_um".to_owned(),
                unit: LengthUnit::Micrometre,
                kind: ReadingKind::Deviation,
                inverted: false,
            },
            delimiter: None,
            encoding: None,
            skip_lines: 0,
            decimal_mark: None,
            out_of_range: OutOfRange::default(),
            range_mm: 1.2,
            plane: None,
            data_arc_deg: None,
            clockwise: None,
            stated_unit: None,
            sheet: None,
        }
    }
}
