//! Page one: is the machine good, what is wrong, what to do, and how sure that is. One sheet of A4.
//!
//! Everything on it is bounded, so that it stays one sheet: so many rows, so many letters; the sections below have all.

use askama::Template;

use super::facts::Analysis;
use super::place;
use super::record;
use super::traces::OnCircle;
use super::{advice, figures, uncertain};
use crate::error::{Error, Kind, Result};
use crate::report::circular::facts::{CircularFacts, Verdict};
use crate::report::circular::html::{self as circular, InShort};
use crate::report::ranked::html as ranked;
use crate::report::text::filters;
use crate::report::text::markup::shortened;
use crate::report::text::numbers::{fixed, many, signed, typeset};
use crate::report::text::words::{capital, fine};

/// So many judged values, circular tests and errors of the machine.
const JUDGED: usize = 4;
const TESTS: usize = 4;
const ERRORS: usize = 7;
/// Of features, each with its side in a second line: so many, and beside judged values.
const FEATURES: [usize; 2] = [7, 3];
/// Up to so many circles are all drawn; of more only the one with the largest deviation.
const CIRCLES: usize = 3;
/// So many letters of a name, and of a fact.
const NAME: usize = 90;
const FACT: usize = 40;
/// Of the record, what stands on page one.
const RECORD: [&str; 6] = [
    "Customer",
    "Date",
    "Operator",
    "Serial number of the machine",
    "Serial number of the bar",
    "Bar calibrated",
];

#[derive(Template)]
#[template(path = "front.html")]
struct Front {
    name: String,
    facts: Vec<(&'static str, String)>,
    /// How the verdict is coloured: `pass`, `fail`, `open`, or nothing.
    class: &'static str,
    headline: String,
    sentences: Vec<String>,
    judged: Vec<[String; 4]>,
    judged_more: usize,
    plots: Vec<String>,
    other_circles: usize,
    magnification: String,
    ways: [&'static str; 2],
    tables: String,
    to_do: Vec<String>,
    uncertain: Vec<String>,
}

/// The tables of page one.
#[derive(Template)]
#[template(path = "front_tables.html")]
struct Tables {
    circular: InShort,
    /// The features of a plane; where there is none, the errors of the machine.
    ranked: Option<ranked::InShort>,
    errors: Vec<ErrorRow>,
    more: usize,
    /// What the uncertainties count.
    uncertainty: &'static str,
    radius_mm: String,
}

/// An error of the machine, by how much it matters on the circle.
struct ErrorRow {
    name: String,
    value: String,
    uncertainty: String,
    size: String,
    /// It stands out of what is not known of it.
    there: bool,
}

/// Page one, as HTML without a page around it.
pub(super) fn section(
    analysis: &Analysis,
    circles: &[OnCircle],
    before: &[OnCircle],
    ways: [&'static str; 2],
) -> Result<String> {
    let (class, headline) = headline(&analysis.circular);
    let judged = circular::judged(&analysis.circular, JUDGED);
    let all = analysis.circular.conformity.as_ref().map_or(0, |of| of.items.len());
    let (plots, other_circles, magnification) = plots(&analysis.circular, circles, before);
    let front = Front {
        name: shortened(&analysis.test.name, NAME),
        facts: facts(analysis),
        class,
        headline,
        sentences: sentences(analysis),
        judged_more: all - judged.len(),
        judged,
        plots,
        other_circles,
        magnification,
        ways,
        tables: tables(analysis)?,
        to_do: advice::of(analysis),
        uncertain: uncertain::of(analysis),
    };
    rendered(&front)
}

fn rendered(of: &impl Template) -> Result<String> {
    of.render().map_err(|error| {
        Error::new(Kind::Output, format!("page one of the report cannot be rendered: {error}"))
    })
}

/// Who, when, what, each in a line.
fn facts(analysis: &Analysis) -> Vec<(&'static str, String)> {
    let record = analysis.test.record.as_ref().map_or_else(Vec::new, record::lines);
    let record = record.into_iter().filter(|(name, _)| RECORD.contains(name));
    let mut facts = vec![
        ("Machine", analysis.machine.name.clone()),
        ("Ball-bar", format!("{} mm", analysis.bar_lengths())),
    ];
    facts.extend(record);
    facts.into_iter().map(|(name, of)| (name, shortened(&of, FACT))).collect()
}

/// The verdict in a line, and how it is coloured.
fn headline(circular: &CircularFacts) -> (&'static str, String) {
    if let Some(conformity) = &circular.conformity {
        let class = match conformity.verdict {
            Verdict::Pass => "pass",
            Verdict::Fail => "fail",
            Verdict::WithinUncertainty | Verdict::NotDecided => "open",
        };
        return (class, format!("Tolerances: {}", conformity.verdict.words()));
    }
    let largest =
        circular::largest(circular).map(|(what, um)| format!("{what}: {} µm", fixed(um, 1)));
    ("", largest.unwrap_or_else(|| "No circular test".into()))
}

/// What belongs to the verdict.
fn sentences(analysis: &Analysis) -> Vec<String> {
    let mut sentences = Vec::new();
    match &analysis.circular.conformity {
        Some(conformity) => {
            let of = |verdict: Verdict| {
                conformity.items.iter().filter(|item| item.verdict == verdict).count()
            };
            let counts = [Verdict::Pass, Verdict::Fail, Verdict::WithinUncertainty, Verdict::NotDecided]
                .map(|verdict| (of(verdict), verdict.words()));
            let counts = counts.iter().filter(|(count, _)| *count > 0);
            let counts: Vec<String> =
                counts.map(|(count, words)| format!("{count} {words}")).collect();
            sentences.push(format!(
                "Of {}: {}. ISO 14253-1, k = 2.",
                many(conformity.items.len(), "value"),
                counts.join(", ")
            ));
        }
        None => sentences.push(
            "No pass or fail: the test file states no limits (`[tolerance]`). The largest circular deviation is told."
                .into(),
        ),
    }
    let (rms_um, before_um) = analysis.residual_rms_um();
    let verdict = analysis.diagnosis.as_ref().map(|of| &of.verdict);
    let found = verdict.and_then(|of| of.found.as_deref());
    let before =
        before_um.map_or(String::new(), |um| format!(", without what was found {}", fixed(um, 2)));
    sentences.push(format!(
        "{}The model leaves {} µm rms of the readings{before}.",
        found.map_or(String::new(), |found| format!("{found} ")),
        fixed(rms_um, 2)
    ));
    sentences.extend(verdict.and_then(|of| of.doubt.clone()));
    sentences.into_iter().map(|sentence| fine(&sentence)).collect()
}

/// The circles: all of a few, otherwise that with the largest deviation; how many are not shown; the magnification.
fn plots(
    circular: &CircularFacts,
    circles: &[OnCircle],
    before: &[OnCircle],
) -> (Vec<String>, usize, String) {
    let spread = |circle: &OnCircle| {
        let values = || circle.traces.iter().flat_map(|trace| &trace.measured_um).copied();
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let worst = circular::largest_circle(circular)
        .and_then(|name| circles.iter().position(|circle| circle.name == name))
        .or_else(|| {
            let by_spread =
                |a: &usize, b: &usize| spread(&circles[*a]).total_cmp(&spread(&circles[*b]));
            (0..circles.len()).max_by(by_spread)
        });
    let shown = match worst {
        Some(worst) if circles.len() > CIRCLES => &circles[worst..=worst],
        _ => circles,
    };
    let (groups, magnification) = figures::polar(shown, before);
    let plots: Vec<String> = groups.into_iter().flatten().map(|figure| figure.svg).collect();
    let others = circles.len() - plots.len();
    (plots, others, magnification)
}

/// The circular tests of ISO 230-4 and the largest errors of the machine.
fn tables(analysis: &Analysis) -> Result<String> {
    let radius_mm = advice::radius_mm(analysis);
    let (seen, _) = place::seen(&analysis.at_the_place);
    let mut sized: Vec<(f64, &place::PlaceResult)> =
        seen.into_iter().filter_map(|of| Some((advice::size_um(of, radius_mm)?, of))).collect();
    sized.sort_by(|a, b| {
        let there = |of: &place::PlaceResult| advice::is_there(of);
        there(b.1).cmp(&there(a.1)).then(b.0.total_cmp(&a.0))
    });
    let more = sized.len().saturating_sub(ERRORS);
    let errors = sized.into_iter().take(ERRORS).map(|(size_um, of)| {
        let sigma = of.all.or(of.noise);
        let places = place::decimals(sigma.unwrap_or(0.0));
        let unit = fine(&format!(" {}", of.unit));
        ErrorRow {
            name: capital(&of.quantity),
            value: format!("{}{unit}", typeset(&signed(of.value, places))),
            uncertainty: sigma.map_or("–".into(), |sigma| fixed(sigma, places)),
            size: fixed(size_um, 1),
            there: advice::is_there(of),
        }
    });
    rendered(&Tables {
        circular: circular::in_short(&analysis.circular, TESTS),
        ranked: ranked::in_short(
            &analysis.ranking,
            FEATURES[usize::from(analysis.circular.conformity.is_some())],
        ),
        errors: errors.collect(),
        more,
        uncertainty: if analysis.is_local() { "all" } else { "noise" },
        radius_mm: fixed(radius_mm, 0),
    })
}
