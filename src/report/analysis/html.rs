//! The report: one self-contained HTML file, without script, without network, for screen and paper.

use askama::Template;

use super::arc_table::{self, ArcRow};
use super::cautions::DETERMINED;
use super::facts::{Analysis, RepeatResult, RunResult};
use super::figures::{self, Figure, RunPicture};
use super::means::MeanResult;
use super::record;
use super::shown::Shown;
use super::{place, terminal, traces, verdict};
use crate::error::{Error, Kind, Result};
use crate::report::text::numbers::{count, fixed, many, signed, typeset};
use crate::report::text::units::{engineering, row_decimals};
use crate::report::text::words::{fine, list};
use crate::report::{circular, diagnosis, ranked};

#[allow(clippy::struct_excessive_bools)] // what a page shows or not
#[derive(Template)]
#[template(path = "report.html")]
struct Page<'a> {
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
    over_time: Vec<Figure>,
    over_angle: Vec<Figure>,
    distribution: Vec<Figure>,
}

/// A row of the table of coefficients.
struct CoefficientRow {
    name: String,
    mean: String,
    sigma: String,
    deviation: String,
    before: String,
    unit: &'static str,
    observed: String,
    determined: bool,
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
    let page = Page {
        verdict: verdict::of(analysis).iter().chain(wrong).map(|line| fine(line)).collect(),
        circular: circular::html::section(&analysis.circular)?,
        ranked: ranked::html::section(&analysis.ranking)?,
        diagnosis: diagnosis.unwrap_or_default(),
        facts: facts(analysis),
        coefficients: coefficients(analysis),
        repeated: analysis.repeats.len() > 1,
        at_the_place: at_the_place(analysis),
        unseen: list(place::seen(&analysis.at_the_place).1),
        extended: analysis.before.is_some(),
        squareness: squareness(analysis),
        scale: scale(analysis),
        reversal: reversal(analysis),
        several_mountings: analysis.several_mountings(),
        runs: analysis.runs_with_before().map(|(now, before)| run(now, before)).collect(),
        arcs: arc_table::rows(analysis),
        confounded: analysis.repeats.first().map_or_else(Vec::new, |r| r.confounded.clone()),
        noise: noises(analysis),
        pauses: pauses(analysis),
        pictures: figures::runs(analysis, identifications),
        polar,
        magnification,
        ways: traces::ways(&circles),
        set_up_taken_off: traces::set_up_taken_off(analysis, identifications),
        hysteresis: figures::hysteresis(analysis),
        over_time: figures::against_time(analysis, shown),
        over_angle: figures::against_angle(&circles, &before, shown),
        distribution: distribution.collect(),
        analysis,
    };
    page.render().map_err(|error| {
        Error::new(Kind::Output, format!("the report cannot be rendered: {error}"))
    })
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
    if let Some(strategy) = &analysis.strategy {
        facts.push(("Strategy", strategy.clone()));
    }
    facts.push(("Terms", analysis.terms.join(" ")));
    for mounting in &analysis.test.mountings {
        facts.push(("Mounting", analysis.told(mounting)));
    }
    facts.push(("Test file", analysis.test.file.clone()));
    facts
}

fn shown(value: Option<f64>, decimals: usize) -> String {
    value.map_or("–".into(), |value| typeset(&fixed(value, decimals)))
}

/// Two columns of the page, the first with the odd row.
fn coefficients(analysis: &Analysis) -> Vec<Vec<CoefficientRow>> {
    let half = analysis.over_repeats.len().div_ceil(2).max(1);
    let halves = analysis.over_repeats.chunks(half);
    let row = |mean| coefficient(mean, analysis.mean_before(&mean.name));
    halves.map(|means| means.iter().map(row).collect()).collect()
}

fn coefficient(mean: &MeanResult, before: Option<&MeanResult>) -> CoefficientRow {
    let unit = engineering(mean.unit);
    let determined = mean.observed >= DETERMINED;
    let value = mean.mean * unit.factor;
    let sigma = mean.sigma.filter(|_| determined).map(|s| s * unit.factor);
    let decimals = row_decimals(value, sigma);
    CoefficientRow {
        name: mean.name.clone(),
        mean: shown(Some(value), decimals),
        sigma: shown(sigma, decimals),
        deviation: shown(mean.deviation.map(|d| d * unit.factor), decimals),
        before: shown(before.map(|before| before.mean * unit.factor), decimals),
        unit: unit.fine,
        observed: terminal::observed(mean.observed),
        determined,
    }
}

/// A value that the data do not determine is told as such instead of with a sigma.
fn spread(value: Option<f64>, decimals: usize, observed: f64) -> String {
    if observed < DETERMINED {
        return format!("only {} observed", terminal::observed(observed));
    }
    shown(value, decimals)
}

/// What people ask, with both uncertainties, where the machine was described where it was measured.
fn at_the_place(analysis: &Analysis) -> Vec<[String; 7]> {
    let (seen, _) = place::seen(&analysis.at_the_place);
    seen.into_iter()
        .filter(|_| analysis.is_local())
        .map(|result| {
            let places = place::decimals(result.noise.unwrap_or(0.0));
            [
                result.quantity.clone(),
                typeset(&signed(result.value, places)),
                shown(result.noise, places),
                shown(result.all, places),
                shown(result.deviation, places),
                fine(&format!(" {}", result.unit)).trim().to_owned(),
                earlier(analysis.place_before(&result.quantity).map(|b| b.value), places),
            ]
        })
        .collect()
}

/// A signed value as it was before anything was found.
fn earlier(value: Option<f64>, decimals: usize) -> String {
    value.map_or("–".into(), |value| typeset(&signed(value, decimals)))
}

fn squareness(analysis: &Analysis) -> Vec<[String; 6]> {
    let before = analysis.errors_before();
    let rows = analysis.machine_errors.squareness.iter();
    rows.map(|s| {
        [
            format!("{} ({}, {})", s.axes, s.name, s.symbol),
            typeset(&signed(s.angle_minus_90_um_m, 2)),
            typeset(&signed(s.angle_minus_90_arcsec, 2)),
            spread(s.sigma_um_m, 2, s.observed),
            shown(s.deviation_um_m, 2),
            earlier(before.and_then(|b| b.angle_um_m(&s.name)), 2),
        ]
    })
    .collect()
}

fn scale(analysis: &Analysis) -> Vec<[String; 5]> {
    let before = analysis.errors_before();
    let rows = analysis.machine_errors.scale.iter();
    rows.map(|s| {
        [
            s.name.clone(),
            typeset(&signed(s.value_um_m, 2)),
            spread(s.sigma_um_m, 2, s.observed),
            shown(s.deviation_um_m, 2),
            earlier(before.and_then(|b| b.scale_um_m(&s.name)), 2),
        ]
    })
    .collect()
}

fn reversal(analysis: &Analysis) -> Vec<[String; 6]> {
    let errors = &analysis.machine_errors;
    let before = analysis.errors_before();
    let displacements = errors.reversal.iter().map(|r| {
        [
            format!("{}, {}", r.name, r.kind),
            format!("{} µm", typeset(&signed(r.step_um, 3))),
            format!("{} µm", typeset(&signed(r.coefficient_um, 3))),
            spread(r.sigma_um, 3, r.observed),
            shown(r.deviation_um, 3),
            earlier(before.and_then(|b| b.step_um(&r.name)), 3),
        ]
    });
    let rotations = errors.angular_hysteresis.iter().map(|h| {
        [
            format!("{}, angular", h.name),
            format!("{} µrad", typeset(&signed(h.step_urad, 2))),
            format!("{} µrad", typeset(&signed(h.coefficient_urad, 2))),
            spread(h.sigma_urad, 2, h.observed),
            shown(h.deviation_urad, 2),
            earlier(before.and_then(|b| b.step_urad(&h.name)), 2),
        ]
    });
    displacements.chain(rotations).collect()
}

fn run(run: &RunResult, before: Option<&RunResult>) -> [String; 9] {
    let rate_sigma =
        run.clock_rate_sigma_ppm.map_or(String::new(), |s| format!(" ± {}", fixed(s, 1)));
    let knob = &run.feed_override;
    let feed = match knob.excess_sigma_percent {
        Some(sigma) => format!(
            "{} % {} ± {} %",
            fixed(knob.stated_percent, 0),
            typeset(&signed(knob.excess_percent, 3)),
            fixed(sigma, 3)
        ),
        None => format!("{} %", fixed(knob.stated_percent, 0)),
    };
    [
        run.name.clone(),
        fixed(run.engagement_log_s, 3),
        format!("{}{rate_sigma}", typeset(&signed(run.clock_rate_ppm, 1))),
        feed,
        run.worst_time_sigma_ms.map_or("unknown".into(), |s| fixed(s, 2)),
        format!(
            "{} / {} / {}",
            count(run.samples.used),
            count(run.samples.rejected),
            count(run.samples.not_used)
        ),
        fixed(run.residual_rms_um, 3),
        run.mounting.clone(),
        shown(before.map(|before| before.residual_rms_um), 3),
    ]
}

fn noises(analysis: &Analysis) -> Vec<[String; 7]> {
    let before = |k: usize| Some(analysis.before.as_ref()?.repeats.get(k)?.residual_rms_um);
    let repeats = analysis.repeats.iter().enumerate();
    repeats.map(|(k, repeat)| noise(repeat, before(k))).collect()
}

fn noise(repeat: &RepeatResult, before_um: Option<f64>) -> [String; 7] {
    let coefficients: Vec<String> =
        repeat.noise.autoregressive.iter().map(|phi| typeset(&fixed(*phi, 3))).collect();
    [
        repeat.repeat.to_string(),
        fixed(repeat.residual_rms_um, 3),
        fixed(repeat.noise.sigma_um, 3),
        if coefficients.is_empty() { "white".into() } else { coefficients.join(", ") },
        repeat.noise.effective_samples.map_or("–".into(), |n| count(n.round() as usize)),
        count(repeat.samples.used),
        shown(before_um, 3),
    ]
}

/// Operator's pauses of each run that has any, in words.
fn pauses(analysis: &Analysis) -> Vec<(String, String)> {
    analysis
        .runs()
        .filter(|run| run.pauses.iter().any(|pause| pause.length_s.is_some()))
        .map(|run| {
            let lengths: Vec<String> = run
                .pauses
                .iter()
                .filter_map(|pause| {
                    let length = fixed(pause.length_s?, 3);
                    Some(pause.sigma_ms.map_or(length.clone(), |sigma| {
                        format!("{length} ± {}", fixed(sigma * 1e-3, 3))
                    }))
                })
                .collect();
            (
                run.name.clone(),
                format!("{}: {} s", many(lengths.len(), "pause"), lengths.join(", ")),
            )
        })
        .collect()
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

    /// Every tag that is opened is closed, in order.
    fn check_balanced(html: &str) {
        let mut open: Vec<&str> = Vec::new();
        let mut rest = html;
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
            for part in ["http", "<script", "src=", "href=", "NaN", "url("] {
                assert!(!html.contains(part), "{set}: {part}");
            }
            assert!(html.len() < MOST_BYTES, "{set}: {} bytes", html.len());
            let again = render(&fixture.analysis, fixture.shown()).unwrap();
            assert!(html == again, "{set}: the same input gives the same bytes");
        }
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
