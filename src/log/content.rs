//! What a file of readings holds, and how it was understood.

use super::b5r::BallbarFile;
use super::by_angle::Turn;
use super::reading::Log;
use crate::plan::log_format::{Delimiter, Format};

/// What is in a file of readings.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// A file of Ballbar 20, as it is written.
    Ballbar(Box<BallbarFile>),
    /// A table of readings.
    Table(Box<Table>),
}

/// A table of readings: text, or a sheet of a workbook.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Its readings.
    pub log: Log,
    /// The arcs of a table by angle; none of a table by time.
    pub turns: Vec<Turn>,
    /// How it was understood.
    pub layout: Layout,
}

/// How a table is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// As what.
    pub written: Written,
    /// The line, or the row, that names its columns, counted from 1.
    pub header_line: usize,
    /// What separates its fields.
    pub delimiter: Delimiter,
    /// The names of all its columns.
    pub columns: Vec<String>,
    /// Whether its times are times of day.
    pub of_day: bool,
    /// The columns that were read, and their units.
    pub format: Format,
}

/// What a table is written in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Written {
    /// Text, by the name of its encoding.
    Text(&'static str),
    /// A sheet of a workbook, by its name.
    Sheet(String),
}
