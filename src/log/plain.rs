//! The rows of a plain log, read side by side: numbers and nothing else, times in a column of their own.
//!
//! Nearly every log is one. Whatever is not - a comment between the rows, a quote, a word, a time of day, a time that goes
//! back - ends the attempt, and [`Table::rows`](super::table::Table::rows) reads from the beginning: what a log means, and
//! what is wrong with it and where, is said in one place only. So the readings are the same bits on any number of threads.

use rayon::prelude::*;

use super::bounds::{BEYOND, LARGEST_DEVIATION_MM, LATEST_S, MOST_READINGS};
use super::number::is_nines;
use super::reading::Reading;
use crate::plan::log_format::{DecimalMark, Delimiter, Format, ReadingKind, TimeUnit};

/// Rows are read in pieces of about so many bytes: enough for a millisecond.
const PIECE_BYTES: usize = 1 << 18;

/// Where the columns are, and what they mean.
pub(super) struct Plain<'a> {
    pub(super) delimiter: Delimiter,
    /// Fields of a row.
    pub(super) width: usize,
    pub(super) time: usize,
    pub(super) time_unit: TimeUnit,
    pub(super) reading: usize,
    pub(super) format: &'a Format,
}

/// A field that is a number, or nothing.
enum Field<'t> {
    Empty,
    /// Its value, and how it is written.
    Number(f64, &'t str),
}

/// What a number in the column of the readings means.
enum Meaning {
    /// Length less nominal length, mm.
    DeviationMm(f64),
    OutOfRange,
}

/// The readings of a log, or of a piece of it, and the numbers that stand for none, as they are written.
#[derive(Default)]
pub(super) struct PlainRows<'t> {
    pub(super) readings: Vec<Reading>,
    pub(super) no_readings: Vec<&'t str>,
}

impl Plain<'_> {
    /// The readings of the rows after line `above`; `None` where one of them is not plain.
    pub(super) fn rows<'t>(&self, text: &'t str, above: usize) -> Option<PlainRows<'t>> {
        let has_digit = |word: &String| word.contains(|c: char| c.is_ascii_digit());
        if self.delimiter == Delimiter::Blanks
            || self.format.decimal_mark == Some(DecimalMark::Comma)
            || self.format.out_of_range.words.iter().any(has_digit)
        {
            return None;
        }
        let pieces = pieces(text);
        let read: Option<Vec<PlainRows>> =
            pieces.par_iter().map(|piece| self.piece(piece)).collect();
        let read = read?;
        let count = read.iter().map(|piece| piece.readings.len()).sum();
        if count > MOST_READINGS {
            return None;
        }
        let mut all = PlainRows { readings: Vec::with_capacity(count), no_readings: Vec::new() };
        for piece in read {
            let last_s = all.readings.last().map_or(f64::NEG_INFINITY, |last| last.time_s);
            if piece.readings.first().is_some_and(|first| first.time_s <= last_s) {
                return None;
            }
            let before = above + all.readings.len();
            let numbered = |reading: Reading| Reading { line: before + reading.line, ..reading };
            all.readings.extend(piece.readings.into_iter().map(numbered));
            all.no_readings.extend(piece.no_readings);
        }
        Some(all)
    }

    /// The rows of a piece, their lines counted from its beginning.
    fn piece<'t>(&self, text: &'t str) -> Option<PlainRows<'t>> {
        let delimiter = self.delimiter.byte();
        let inverted = self.format.reading.inverted;
        let mut rows = PlainRows::default();
        let mut cursor = Cursor { text, at: 0 };
        let mut last_s = f64::NEG_INFINITY;
        while cursor.at < text.len() {
            let (mut time_s, mut deviation_mm) = (None, None);
            for field in 0..self.width {
                if field == self.time {
                    let Field::Number(value, _) = cursor.number()? else { return None };
                    time_s = Some(self.time_unit.to_s(value));
                } else if field == self.reading {
                    if let Field::Number(value, written) = cursor.number()? {
                        match self.meaning(value, written)? {
                            Meaning::DeviationMm(mm) => deviation_mm = Some(mm),
                            Meaning::OutOfRange => rows.no_readings.push(written),
                        }
                    }
                } else {
                    cursor.pass(delimiter)?;
                }
                if field + 1 < self.width {
                    cursor.take(delimiter)?;
                }
            }
            cursor.end_of_line()?;
            let time_s = time_s.filter(|s| s.abs() <= LATEST_S && *s > last_s)?;
            last_s = time_s;
            let deviation_mm = deviation_mm.map(|mm: f64| if inverted { -mm } else { mm });
            rows.readings.push(Reading { time_s, deviation_mm, line: rows.readings.len() + 1 });
        }
        Some(rows)
    }

    /// What a reading means; `None` where it cannot be one.
    fn meaning(&self, value: f64, written: &str) -> Option<Meaning> {
        let Format { out_of_range, reading, range_mm, .. } = self.format;
        if out_of_range.has_number(value) {
            return Some(Meaning::OutOfRange);
        }
        let value_mm = reading.unit.to_mm(value);
        let deviation_mm = match reading.kind {
            ReadingKind::Deviation => value_mm,
            ReadingKind::Length { nominal_mm } => value_mm - nominal_mm,
        };
        if deviation_mm.abs() > BEYOND * range_mm && is_nines(written) {
            return Some(Meaning::OutOfRange);
        }
        (deviation_mm.abs() <= LARGEST_DEVIATION_MM).then_some(Meaning::DeviationMm(deviation_mm))
    }
}

/// A text in pieces of whole lines.
fn pieces(text: &str) -> Vec<&str> {
    let mut pieces = Vec::with_capacity(text.len() / PIECE_BYTES + 1);
    let mut rest = text;
    while rest.len() > PIECE_BYTES {
        let end = rest.as_bytes()[PIECE_BYTES..].iter().position(|&byte| byte == b'\n');
        let Some(end) = end else { break };
        // An end of line is a character by itself.
        let (piece, after) = rest.split_at(PIECE_BYTES + end + 1);
        pieces.push(piece);
        rest = after;
    }
    pieces.push(rest);
    pieces
}

/// A place in a text.
struct Cursor<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Cursor<'t> {
    fn byte(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn pass_blanks(&mut self) {
        while self.byte() == Some(b' ') {
            self.at += 1;
        }
    }

    /// Takes a byte that must be there.
    fn take(&mut self, wanted: u8) -> Option<()> {
        (self.byte() == Some(wanted)).then(|| self.at += 1)
    }

    /// Passes over a field that nobody asks for. A comment and a quoted field are none.
    fn pass(&mut self, delimiter: u8) -> Option<()> {
        while let Some(byte) = self.byte() {
            match byte {
                b'"' | b'#' => return None,
                b'\n' | b'\r' => break,
                _ if byte == delimiter => break,
                _ => self.at += 1,
            }
        }
        Some(())
    }

    /// Takes the end of a line, or that of the text.
    fn end_of_line(&mut self) -> Option<()> {
        match self.byte() {
            None => return Some(()),
            Some(b'\r') => self.at += 1,
            Some(_) => {}
        }
        self.take(b'\n')
    }

    /// A number with a decimal point or none, and how it is written; or nothing; `None` for what is
    /// neither. Blanks around it do not count.
    fn number(&mut self) -> Option<Field<'t>> {
        self.pass_blanks();
        let start = self.at;
        let negative = self.byte() == Some(b'-');
        if negative || self.byte() == Some(b'+') {
            self.at += 1;
        }
        let (mut whole, mut digits, mut decimals, mut has_point) = (0_u64, 0, 0_usize, false);
        while let Some(byte) = self.byte() {
            match byte {
                b'0'..=b'9' => {
                    whole = whole.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
                    digits += 1;
                    decimals += usize::from(has_point);
                }
                b'.' if !has_point => has_point = true,
                _ => break,
            }
            self.at += 1;
        }
        let written = self.text.get(start..self.at)?;
        self.pass_blanks();
        if written.is_empty() {
            return Some(Field::Empty);
        }
        let value = match TENS.get(decimals) {
            _ if digits == 0 => return None,
            // Both are exact, so that the quotient is the double nearest to what is written.
            Some(tens) if digits < TENS.len() => {
                let value = whole as f64 / tens;
                if negative { -value } else { value }
            }
            _ => written.parse().ok().filter(|value: &f64| value.is_finite())?,
        };
        Some(Field::Number(value, written))
    }
}

/// Powers of ten. Whole numbers of as many digits are doubles, too.
const TENS: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
