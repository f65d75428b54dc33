//! The section of the report.

use askama::Template;

use super::facts::{DiagnosisFacts, FindingFacts};
use super::{figures, terminal};
use crate::error::{Error, Kind, Result};
use crate::report::text::filters;
use crate::report::text::numbers::{fixed, percent, share, typeset};
use crate::report::text::units::{engineering, row_decimals};
use crate::report::text::words::fine;

/// Tables are in um.
const UM: f64 = 1e3;

#[derive(Template)]
#[template(path = "diagnosis.html")]
struct Section<'a> {
    facts: &'a DiagnosisFacts,
    verdict: Vec<String>,
    findings: Vec<FindingRow<'a>>,
    gains: Option<String>,
    runs: Vec<[String; 6]>,
    programs: Vec<[String; 4]>,
    views: Vec<String>,
    shares: Vec<Vec<[String; 3]>>,
    arcs: Vec<[String; 6]>,
    moved: Vec<[String; 5]>,
}

/// A finding with its picture.
struct FindingRow<'a> {
    facts: &'a FindingFacts,
    numbers: String,
    size: String,
    others: Vec<String>,
    picture: Option<String>,
    caption: &'static str,
}

/// The section, as HTML without a page around it.
pub(in crate::report) fn section(facts: &DiagnosisFacts) -> Result<String> {
    let section = Section {
        verdict: facts.verdict.sentences().map(fine).collect(),
        findings: facts.findings.iter().map(told).collect(),
        gains: figures::gains(facts).filter(|_| !facts.findings.is_empty()),
        runs: runs(facts),
        programs: facts
            .programs
            .iter()
            .map(|program| {
                [
                    program.runs.join(", "),
                    fixed(program.feed_mm_min, 0),
                    fixed(program.before_mm * UM, 3),
                    fixed(program.after_mm * UM, 3),
                ]
            })
            .collect(),
        views: facts.views.iter().filter(|v| !v.bins.is_empty()).map(figures::view).collect(),
        shares: shares(facts),
        arcs: arcs(facts),
        moved: moved(facts),
        facts,
    };
    section.render().map_err(|error| {
        Error::new(Kind::Output, format!("the diagnosis cannot be rendered: {error}"))
    })
}

fn told(finding: &FindingFacts) -> FindingRow<'_> {
    FindingRow {
        numbers: typeset_minus(&fine(&finding.in_words)),
        size: fixed(finding.rms_mm * UM, 3),
        others: terminal::others(finding),
        picture: finding.picture.as_ref().map(|picture| figures::picture(finding, picture)),
        caption: if finding.named {
            "The effect alone. Line: as fitted. Dots: with the residual added (band: two standard deviations)."
        } else {
            "The curve alone, without the part that the model contains. Line and its knots: as fitted. Small dots: with the residual added (band: two standard deviations)."
        },
        facts: finding,
    }
}

/// A minus before a number as wide as a plus; hyphens of words stay.
fn typeset_minus(text: &str) -> String {
    text.replace(" -", " −")
}

fn runs(facts: &DiagnosisFacts) -> Vec<[String; 6]> {
    let each = facts.runs.iter().enumerate().map(|(k, run)| {
        [
            (k + 1).to_string(),
            run.run.clone(),
            fixed(run.before_mm * UM, 3),
            fixed(run.after_mm * UM, 3),
            run.floor_mm.map_or("–".into(), |floor_mm| fixed(floor_mm * UM, 3)),
            run.explained.map_or("–".into(), |share| format!("{} %", percent(share))),
        ]
    });
    each.collect()
}

/// The best view of each variable, in two columns.
fn shares(facts: &DiagnosisFacts) -> Vec<Vec<[String; 3]>> {
    let mut known: Vec<&str> = Vec::new();
    let mut rows = Vec::new();
    for view in &facts.views {
        if known.contains(&view.variable.as_str()) {
            continue;
        }
        known.push(&view.variable);
        let counted =
            if view.counted.is_empty() { String::new() } else { format!(", {}", view.counted) };
        rows.push([
            format!("{}{counted}", view.variable),
            share(view.share_before),
            share(view.share_after),
        ]);
    }
    let half = rows.len().div_ceil(2).max(1);
    rows.chunks(half).map(<[_]>::to_vec).collect()
}

fn arcs(facts: &DiagnosisFacts) -> Vec<[String; 6]> {
    let shown = |of: Option<f64>| of.map_or("–".into(), share);
    let each = facts.arcs.iter().map(|arc| {
        [
            arc.name.clone(),
            fixed(arc.feed_mm_min, 0),
            fixed(arc.before_mm * UM, 3),
            fixed(arc.after_mm * UM, 3),
            shown(arc.structure_before),
            shown(arc.structure_after),
        ]
    });
    each.collect()
}

fn moved(facts: &DiagnosisFacts) -> Vec<[String; 5]> {
    let each = facts.moved.iter().map(|moved| {
        let unit = engineering(moved.unit);
        let of = |value: f64| value * unit.factor;
        let places = row_decimals(of(moved.after), Some(of(moved.sigma_after)));
        [
            moved.name.clone(),
            typeset(&fixed(of(moved.before), places)),
            typeset(&fixed(of(moved.after), places)),
            fixed(of(moved.sigma_after), places),
            unit.fine.to_owned(),
        ]
    });
    each.collect()
}
