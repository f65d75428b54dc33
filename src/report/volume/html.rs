//! A map as one self-contained page in the style of the report.

use askama::Template;

use super::figures::{SHOWN, slices};
use super::{Mapped, terminal, words};
use crate::error::{Error, Kind, Result};
use crate::report::analysis::place::decimals;
use crate::report::text::numbers::{fixed, typeset};
use crate::report::text::words::fine;

#[derive(Template)]
#[template(path = "volume.html")]
struct Page {
    title: String,
    facts: Vec<(&'static str, String)>,
    verdict: Vec<String>,
    near: Option<Table>,
    whole: Option<Table>,
    rows: Vec<Row>,
    lines: Table,
    basis: String,
}

struct Row {
    title: &'static str,
    /// What the darkest colour is, um.
    full: String,
    slices: Vec<String>,
}

struct Table {
    head: Vec<(String, bool)>,
    body: Vec<Vec<(String, bool)>>,
}

impl Table {
    /// The first row is the head; `numbers` says which columns are.
    fn of(rows: Vec<Vec<String>>, numbers: impl Fn(usize) -> bool) -> Self {
        let cells = |row: Vec<String>| {
            let cells = row.into_iter().enumerate();
            cells.map(|(k, cell)| (fine(&typeset(&cell)), numbers(k))).collect::<Vec<_>>()
        };
        let mut rows = rows.into_iter().map(cells);
        let head = rows.next().unwrap_or_default();
        Self { head, body: rows.collect() }
    }
}

/// The page of a map.
///
/// # Errors
/// When the page cannot be filled.
pub fn volume_page(of: &Mapped) -> Result<String> {
    let [low_mm, high_mm] = of.map.volume.ends_mm;
    let span = |k: usize| format!("{} to {} mm", fixed(low_mm[k], 1), fixed(high_mm[k], 1));
    let rows = SHOWN.iter().map(|shown| {
        let (slices, full) = slices(of, shown);
        Row { title: shown.title, full: fixed(full, decimals(full)), slices }
    });
    let figures = |figures| Table::of(terminal::rows(figures), |k| k > 0);
    let page = Page {
        title: of.test.clone(),
        facts: vec![
            ("Machine", of.errors.machine.name().to_owned()),
            ("From", of.file.clone()),
            ("X", typeset(&span(0))),
            ("Y", typeset(&span(1))),
            ("Z", typeset(&span(2))),
            (
                "Tip of the tool",
                typeset(&<[f64; 3]>::from(of.tool_ball_mm).map(|mm| fixed(mm, 1)).join(", "))
                    + " mm",
            ),
            ("Points", of.map.counts.map(|count| count.to_string()).join(" × ")),
        ],
        verdict: words::verdict(of).iter().map(|told| fine(told)).collect(),
        near: of.map.near.as_ref().map(figures),
        whole: of.map.whole.as_ref().map(figures),
        rows: rows.collect(),
        lines: Table::of(terminal::lines(&of.map.lines), |k| (1..8).contains(&k)),
        basis: fine(words::BASIS).replace('`', ""),
    };
    page.render()
        .map_err(|error| Error::new(Kind::Output, format!("the page cannot be filled: {error}")))
}
