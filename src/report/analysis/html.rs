//! The report: one self-contained HTML file for screen and paper, page one first, all else folded below it.
//!
//! It loads nothing: its content security policy allows the style and the script that stand in it, by their hashes, and
//! nothing else. Without the script everything is there; with it plots can be asked and changed.

use askama::Template;

use super::arc_table::{self, ArcRow};
use super::facts::Analysis;
use super::figures::{self, Figure, RunPicture};
use super::front;
use super::record;
use super::shown::Shown;
use super::tables::{self, CoefficientRow};
use super::{control_text, driven, live, place, run_tables, traces, verdict};
use crate::error::{Error, Kind, Result};
use crate::report::text::filters;
use crate::report::text::numbers::fixed;
use crate::report::text::policy::policy;
use crate::report::text::words::{fine, list};
use crate::report::{circular, diagnosis, ranked};

/// The style sheet and the script of the report.
const STYLE: &str = include_str!("../../../templates/report.css");
const SCRIPT: &str = include_str!("../../../templates/report.js");

#[allow(clippy::struct_excessive_bools)] // what a page shows or not
#[derive(Template)]
#[template(path = "report.html")]
struct Page<'a> {
    policy: String,
    style: &'static str,
    script: &'static str,
    live: String,
    front: String,
    contents: Vec<(&'static str, &'static str)>,
    analysis: &'a Analysis,
    verdict: Vec<String>,
    circular: String,
    ranked: String,
    diagnosis: String,
    facts: Vec<(&'static str, String)>,
    coefficients: Vec<Vec<CoefficientRow>>,
    repeated: bool,
    extended: bool,
    at_the_place: Vec<[String; 7]>,
    unseen: String,
    squareness: Vec<[String; 6]>,
    scale: Vec<[String; 5]>,
    reversal: Vec<[String; 6]>,
    several_mountings: bool,
    runs: Vec<[String; 9]>,
    /// How the control drove, below these words.
    driving: Vec<[String; 7]>,
    driving_head: [&'static str; 7],
    arcs: Vec<ArcRow>,
    confounded: Vec<String>,
    noise: Vec<[String; 7]>,
    pauses: Vec<(String, String)>,
    pictures: Vec<RunPicture>,
    polar: Vec<Vec<Figure>>,
    magnification: String,
    /// The two directions of an arc.
    ways: [&'static str; 2],
    set_up_taken_off: bool,
    hysteresis: Vec<Figure>,
    sphere: Option<Figure>,
    over_time: Vec<Figure>,
    over_angle: Vec<Figure>,
    distribution: Vec<Figure>,
}

/// Renders the report. The same input gives the same bytes.
///
/// `shown` are the identifications that `analysis` was made of, in the same order: tables come from the
/// one, curves from the others.
pub fn render(analysis: &Analysis, shown: Shown) -> Result<String> {
    let identifications = shown.repeats;
    let circles = traces::circles(analysis, identifications);
    let before = traces::circles(analysis, shown.before);
    let (polar, magnification) = figures::polar(&circles, &before);
    let distribution = figures::histogram(shown)
        .into_iter()
        .chain(analysis.repeats.first().and_then(|r| figures::autocorrelation(r, shown, analysis)));
    // The gravest of what the model gets wrong is part of the verdict.
    let wrong = analysis.diagnosis.iter().map(|diagnosis| &diagnosis.verdict.structure);
    let diagnosis = analysis.diagnosis.as_ref().map(diagnosis::html::section).transpose()?;
    let ways = traces::ways(&circles);
    let circular = circular::html::section(&analysis.circular)?;
    let ranked = ranked::html::section(&analysis.ranking)?;
    let page = Page {
        policy: policy(STYLE, SCRIPT),
        style: STYLE,
        script: SCRIPT,
        live: live::json(analysis, shown, &circles)?,
        front: front::section(analysis, &circles, &before, ways)?,
        contents: contents(analysis, !circular.is_empty(), !ranked.is_empty()),
        verdict: verdict::of(analysis).iter().chain(wrong).map(|line| fine(line)).collect(),
        circular,
        ranked,
        diagnosis: diagnosis.unwrap_or_default(),
        facts: facts(analysis),
        coefficients: tables::coefficients(analysis),
        repeated: analysis.repeats.len() > 1,
        at_the_place: tables::at_the_place(analysis),
        unseen: list(place::seen(&analysis.at_the_place).1),
        extended: analysis.before.is_some(),
        squareness: tables::squareness(analysis),
        scale: tables::scale(analysis),
        reversal: tables::reversal(analysis),
        several_mountings: analysis.several_mountings(),
        runs: analysis
            .runs_with_before()
            .map(|(now, before)| run_tables::run(now, before))
            .collect(),
        driving: run_tables::driving(analysis),
        driving_head: control_text::HEAD,
        arcs: arc_table::rows(analysis),
        confounded: analysis.repeats.first().map_or_else(Vec::new, |r| r.confounded.clone()),
        noise: run_tables::noises(analysis),
        pauses: run_tables::pauses(analysis),
        pictures: figures::runs(analysis, identifications),
        polar,
        magnification,
        ways,
        set_up_taken_off: traces::set_up_taken_off(analysis, identifications),
        hysteresis: figures::hysteresis(analysis),
        sphere: figures::left_over(&circles),
        over_time: figures::against_time(analysis, shown),
        over_angle: figures::against_angle(&circles, &before, shown),
        distribution: distribution.collect(),
        analysis,
    };
    page.render().map_err(|error| {
        Error::new(Kind::Output, format!("the report cannot be rendered: {error}"))
    })
}

/// The sections below page one.
fn contents(
    analysis: &Analysis,
    circular: bool,
    ranked: bool,
) -> Vec<(&'static str, &'static str)> {
    let machine = if analysis.is_local() {
        "The machine at the place of the test"
    } else {
        "Errors of the machine"
    };
    let all = [
        (true, ("test", "The test")),
        (!analysis.cautions.is_empty(), ("cautions", "Cautions")),
        (circular, ("circular", "Circular tests as in ISO 230-4")),
        (ranked, ("repair", "What to repair")),
        (analysis.diagnosis.is_some(), ("found", "What the model gets wrong")),
        (true, ("machine", machine)),
        (true, ("circles", "Deviations on the circles")),
        (true, ("coefficients", "Coefficients")),
        (true, ("alignment", "Alignment of the logs")),
        (true, ("residuals", "Residuals")),
        (true, ("meaning", "What the numbers mean")),
    ];
    all.into_iter().filter_map(|(there, section)| there.then_some(section)).collect()
}

fn facts(analysis: &Analysis) -> Vec<(&'static str, String)> {
    let bar = &analysis.ball_bar;
    let pivots = analysis.machine.pivots;
    let mut rates: Vec<String> =
        analysis.runs().map(|run| fixed(run.averaged as f64 / run.sample_period_s, 0)).collect();
    rates.dedup();
    let mut facts = analysis.test.record.as_ref().map_or_else(Vec::new, record::lines);
    facts.extend([
        ("Machine", format!("{}, topology {}", analysis.machine.name, analysis.machine.topology)),
        ("Pivots", format!("X {}, Y {}, Z {}", pivots.x, pivots.y, pivots.z)),
        (
            "Ball-bar",
            format!(
                "{} mm, range ± {} mm, resolution {} µm, noise {} µm, clock ± {} ppm, read at {} Hz",
                analysis.bar_lengths(),
                bar.range_mm,
                fixed(bar.resolution_um, 2),
                fixed(bar.noise_um, 3),
                fixed(bar.clock_tolerance_ppm, 0),
                rates.join(" and ")
            ),
        ),
    ]);
    facts.push(match &analysis.strategy {
        Some(strategy) => ("Strategy", strategy.clone()),
        None => ("Driven", driven::told(&analysis.driven)),
    });
    facts.push(("Terms", analysis.terms.join(" ")));
    for mounting in &analysis.test.mountings {
        facts.push(("Mounting", analysis.told(mounting)));
    }
    facts.push(("Test file", analysis.test.file.clone()));
    facts
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::report::fixture;

    /// Largest file that a mail still carries without complaint.
    const MOST_BYTES: usize = 3_000_000;

    /// Elements that HTML knows without an end.
    const VOID: [&str; 2] = ["meta", "!DOCTYPE"];

    /// Every tag that is opened is closed, in order; style and script are no HTML.
    fn check_balanced(html: &str) {
        let mut open: Vec<&str> = Vec::new();
        let html = html.replace(STYLE, "").replace(SCRIPT, "");
        let mut rest = html.as_str();
        while let Some(start) = rest.find('<') {
            rest = &rest[start + 1..];
            let tag = &rest[..rest.find('>').unwrap()];
            assert!(!tag.contains('<'), "a stray `<` before `{tag}`");
            let name = tag.trim_start_matches('/').split([' ', '/', '\n']).next().unwrap();
            if tag.starts_with('/') {
                assert_eq!(open.pop(), Some(name), "`</{name}>`");
            } else if !tag.ends_with('/') && !VOID.contains(&name) {
                open.push(name);
            }
            rest = &rest[tag.len()..];
        }
        assert!(open.is_empty(), "{open:?}");
    }

    #[test]
    fn the_report_is_one_well_formed_file() {
        let sets = ["hu40t", "hu40t-stops", "planar", "case-a"];
        for set in sets {
            let fixture =
                if set == "case-a" { fixture::diagnosed() } else { fixture::identified(set) };
            let html = render(&fixture.analysis, fixture.shown()).unwrap();
            check_balanced(&html);
            for part in ["http:", "https:", "src=", "href=\"h", "NaN", "url(", "style=", "@import"]
            {
                assert!(!html.contains(part), "{set}: {part}");
            }
            assert_eq!(html.matches("<script").count(), 2, "{set}: data and script");
            for link in html.split("href=\"").skip(1) {
                let to = link.split('"').next().unwrap().strip_prefix('#').unwrap();
                assert_eq!(html.matches(&format!("id=\"{to}\"")).count(), 1, "{set}: {to}");
            }
            for (id, title) in contents(&fixture.analysis, true, true) {
                let section =
                    format!("<h2>{title}</h2></summary>\n<div class=\"section\" id=\"{id}\">");
                assert_eq!(html.matches(&section).count(), 1, "{set}: {id}");
            }
            assert!(html.len() < MOST_BYTES, "{set}: {} bytes", html.len());
            let again = render(&fixture.analysis, fixture.shown()).unwrap();
            assert!(html == again, "{set}: the same input gives the same bytes");
        }
    }

    #[test]
    fn the_script_is_small() {
        assert!(SCRIPT.len() <= 15_000, "{} bytes", SCRIPT.len());
    }

    #[test]
    fn keys_in_messages_are_code() {
        let fixture = fixture::identified("planar");
        let html = render(&fixture.analysis, fixture.shown()).unwrap();
        let text = html.replace(STYLE, "").replace(SCRIPT, "");
        assert!(text.contains("<code>[tolerance]</code>"));
        assert!(!text.contains('`'));
    }

    #[test]
    fn a_name_cannot_break_the_page() {
        let fixture = fixture::identified("planar");
        let mut analysis = fixture.analysis.clone();
        analysis.test.name = "</h1><b>\"five\" & more".into();
        let html = render(&analysis, fixture.shown()).unwrap();
        check_balanced(&html);
        assert!(!html.contains("</h1><b>"));
    }
}
