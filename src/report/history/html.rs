//! A history as one self-contained page in the style of the report.

use std::path::Path;

use askama::Template;

use super::terminal::cells;
use super::{figures, words};
use crate::error::{Error, Kind, Result};
use crate::monitor::History;
use crate::report::text::numbers::typeset;
use crate::report::text::words::fine;

#[derive(Template)]
#[template(path = "history.html")]
struct Page {
    title: String,
    verdict: Vec<String>,
    tests: Vec<[String; 3]>,
    pictures: Vec<String>,
    table: Table,
    left_out: Vec<(String, String)>,
    basis: &'static str,
}

struct Table {
    head: Vec<(&'static str, bool)>,
    body: Vec<Vec<(String, bool)>>,
}

/// The page of a machine; `name` says how files are called in it.
///
/// # Errors
/// When the page cannot be filled.
pub fn history_page(history: &History, name: &dyn Fn(&Path) -> String) -> Result<String> {
    let days = history.tests.first().zip(history.tests.last());
    let several = || history.series.iter().filter(|of| of.points.len() > 1 && of.is_seen());
    let pictures = days.map_or_else(Vec::new, |((first, _), (last, _))| {
        several().map(|series| figures::over_time(series, *first, *last)).collect()
    });
    let row = |series: &crate::monitor::Series| {
        let cells = cells(series).into_iter().enumerate();
        cells.map(|(k, cell)| (fine(&typeset(&cell)), (1..4).contains(&k))).collect()
    };
    let page = Page {
        title: history.machine.clone(),
        verdict: words::verdict(history).iter().map(|told| fine(told)).collect(),
        tests: history
            .tests
            .iter()
            .map(|(day, past)| [day.to_string(), past.test.clone(), name(&past.file)])
            .collect(),
        pictures,
        table: Table {
            head: vec![
                ("Quantity", false),
                ("First", true),
                ("Last", true),
                ("Tests", true),
                ("Trend", false),
                ("", false),
            ],
            body: history.series.iter().map(row).collect(),
        },
        left_out: history.left_out.iter().map(|of| (name(&of.file), of.reason.clone())).collect(),
        basis: words::BASIS,
    };
    page.render()
        .map_err(|error| Error::new(Kind::Output, format!("the page cannot be filled: {error}")))
}
