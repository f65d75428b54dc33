//! Ball-bar logs: what the instrument read, on its own clock.
//!
//! A log is text, plain or gzipped: a header, then one line a sample. Lines that begin with `#` are
//! comments, blank lines mean nothing, an empty reading means that the bar was out of range.
//!
//! ```text
//! # bar 150 mm, run 1
//! time_s,deviation_um
//! 0.0000,
//! 0.1000,6.3
//! ```
//!
//! Which columns hold time and reading, and in which units, is a [`Format`], chosen in the test file. Fields are separated by
//! commas, semicolons or tabs; with the latter two numbers may have a decimal comma. In a log of a
//! single column (readings at a constant rate) a blank line is a reading out of range: were it
//! skipped, everything after it would come a sample early.
//!
//! What is *not* done here: no sample is dropped, smoothed or interpolated, and the clock is not
//! trusted to be the machine's. What looks wrong is an error with its line, never a guess.

mod arrays;
mod b5r;
#[cfg(test)]
#[allow(clippy::float_cmp)] // what is read is exact or wrong
mod b5r_tests;
mod ballbar_feed;
mod ballbar_log;
mod bounds;
mod by_angle;
mod clock;
mod columns;
mod content;
mod day;
mod encoding;
mod listed;
mod number;
mod plain;
#[cfg(test)]
#[allow(clippy::float_cmp)] // what is read is exact or wrong
mod plain_tests;
mod read;
mod reading;
mod recording;
mod table;
#[cfg(test)]
#[allow(clippy::float_cmp)] // what is read is exact or wrong
mod tests;
mod text;
mod unit_line;
#[cfg(test)]
#[allow(clippy::float_cmp)] // what is read is exact or wrong
mod variants;
mod workbook;
mod workbook_parts;
#[cfg(test)]
#[allow(clippy::float_cmp)] // what is read is exact or wrong
mod workbook_tests;

pub use crate::plan::log_format::{
    DecimalMark, Delimiter, Format, LengthUnit, OutOfRange, ReadingColumn, ReadingKind,
    TextEncoding, TimeColumn, TimeUnit,
};
pub use b5r::{BallbarFile, BarRun, Feature};
pub(crate) use ballbar_log::plane_of;
pub use by_angle::{Angles, ByAngle, Said, Turn};
pub(crate) use columns::lines_for_the_test;
pub use content::{Content, Layout, Table, Written};
pub use read::{log_of, look_into, read, read_bytes};
pub use reading::{Log, Reading};
pub use recording::{Recording, Stand};
