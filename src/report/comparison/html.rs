//! A comparison as one self-contained page in the style of the report.

use askama::Template;

use super::terminal::cells;
use super::{figures, words};
use crate::error::{Error, Kind, Result};
use crate::monitor::{self, Change, Comparison, Judged, Past};
use crate::report::text::numbers::typeset;
use crate::report::text::words::{capital, fine};

#[derive(Template)]
#[template(path = "comparison.html")]
struct Page {
    title: String,
    facts: Vec<(&'static str, [String; 2])>,
    verdict: Vec<String>,
    cautions: Vec<String>,
    pictures: Vec<(String, String)>,
    table: Table,
    findings: Vec<String>,
    untold: Vec<String>,
    basis: String,
}

struct Table {
    head: Vec<(&'static str, bool)>,
    body: Vec<Vec<(String, bool)>>,
}

/// The page of two analyses; `name` says how their files are called in it.
///
/// # Errors
/// When the page cannot be filled.
pub fn comparison_page(
    comparison: &Comparison,
    [before, after]: [&Past; 2],
    name: &dyn Fn(&Past) -> String,
) -> Result<String> {
    let mut units: Vec<&str> = Vec::new();
    for change in &comparison.changes {
        if !units.contains(&change.unit.as_str()) {
            units.push(&change.unit);
        }
    }
    let picture = |unit: &&str| {
        let of: Vec<&Change> = comparison
            .changes
            .iter()
            // Ranges are in the table: by themselves they would squeeze all else.
            .filter(|change| change.unit == **unit && change.judged != Judged::Unknown)
            .filter(|change| {
                change.kind != monitor::Kind::Range || change.judged == Judged::Changed
            })
            .collect();
        (!of.is_empty()).then(|| {
            let unit = fine(&format!(" {unit}")).trim().to_owned();
            (unit.clone(), figures::differences(&of, &unit))
        })
    };
    let both = |of: &dyn Fn(&Past) -> Option<String>| {
        [before, after].map(|past| of(past).unwrap_or_else(|| "–".to_owned()))
    };
    let row = |change: &Change| {
        let mut row: Vec<(String, bool)> = cells(change)
            .into_iter()
            .enumerate()
            .map(|(k, cell)| (fine(&typeset(&cell)), (1..5).contains(&k)))
            .collect();
        row.push((words::judged(change.judged).to_owned(), false));
        row
    };
    let page = Page {
        title: format!("{}: what changed", after.machine),
        facts: vec![
            ("Day", both(&|past| past.day.map(|day| day.to_string()))),
            ("Test", both(&|past| Some(past.test.clone()))),
            ("Machine", both(&|past| Some(past.machine.clone()))),
            ("Serial number of the machine", both(&|past| past.machine_serial.clone())),
            ("Serial number of the bar", both(&|past| past.bar_serial.clone())),
            ("Compensation", both(&|past| past.compensation.clone())),
            ("Repeats", both(&|past| Some(past.repeats.to_string()))),
            ("Analysis", both(&|past| Some(name(past)))),
        ],
        verdict: words::verdict(comparison).iter().map(|told| fine(told)).collect(),
        cautions: comparison.differences.clone(),
        pictures: units.iter().filter_map(picture).collect(),
        table: Table {
            head: vec![
                ("Quantity", false),
                ("Before", true),
                ("After", true),
                ("Difference", true),
                ("Its standard deviation", true),
                ("Unit", false),
                ("Verdict", false),
            ],
            body: comparison.changes.iter().map(row).collect(),
        },
        findings: comparison
            .findings
            .iter()
            .map(|of| fine(&capital(&words::finding(of))))
            .collect(),
        untold: comparison.untold.clone(),
        basis: words::basis(comparison),
    };
    page.render()
        .map_err(|error| Error::new(Kind::Output, format!("the page cannot be filled: {error}")))
}
