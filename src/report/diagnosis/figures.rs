//! Pictures before and after.

use super::facts::{DiagnosisFacts, FindingFacts};
use crate::diagnose::{Bin, Picture, View, ViewKind};
use crate::report::draw::chart::{Axis, Chart};
use crate::report::draw::svg::text_width;
use crate::report::draw::ticks::enclosing;
use crate::report::text::numbers::{fixed, share};

const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 200.0;
/// Room above the curves for the title, as a share of the range.
const HEADROOM: f64 = 0.22;
/// Figures are in um.
const UM: f64 = 1e3;
/// Half the width of a band of uncertainty, sigmas.
const BAND: f64 = 2.0;
/// Bins that lie farther apart than so many of the usual steps have a gap between them.
const GAP: f64 = 2.5;
/// More runs than this are not drawn: the table has them.
const MOST_RUNS: usize = 24;

/// A range of y that holds the values, with room for a title.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = enclosing(values.chain([0.0]), 5);
    (low, high + HEADROOM * (high - low))
}

/// A view: before in grey, after in colour with its band.
pub(super) fn view(of: &View) -> String {
    let bins = &of.bins;
    let spectrum = of.kind == ViewKind::Spectrum;
    let values = bins.iter().flat_map(|bin| [bin.before_mm * UM, bin.after_mm * UM]);
    let bands = bins.iter().flat_map(|bin| {
        let half = BAND * (bin.sigma_mm * UM);
        if spectrum { [half, 0.0] } else { [bin.after_mm * UM + half, bin.after_mm * UM - half] }
    });
    let along = if of.counted.is_empty() { String::new() } else { format!(", {}", of.counted) };
    let (what, variable) = if spectrum {
        ("amplitude, µm", of.variable.clone())
    } else {
        ("residual, µm", of.variable.clone())
    };
    let x = Axis::new(
        &format!("{variable}{along}, {}", of.unit.replace("deg", "°")),
        ends(bins.iter().map(|bin| bin.center)),
    );
    let mut chart = Chart::new(WIDTH, HEIGHT, x, Axis::new(what, range(values.chain(bands))));
    for piece in pieces(bins) {
        let edge = |side: f64| -> Vec<(f64, f64)> {
            let each = piece.iter().map(|bin| {
                let half = BAND * (bin.sigma_mm * UM);
                let y = match (spectrum, side > 0.0) {
                    (true, true) => half,
                    (true, false) => 0.0,
                    (false, _) => bin.after_mm * UM + side * half,
                };
                (bin.center, y)
            });
            each.collect()
        };
        let line = |of: fn(&Bin) -> f64| -> Vec<(f64, f64)> {
            piece.iter().map(|bin| (bin.center, of(bin))).collect()
        };
        chart.band(&edge(-1.0), &edge(1.0), "band");
        chart.line(&line(|bin| bin.before_mm * UM), "before");
        chart.line(&line(|bin| bin.after_mm * UM), "after");
    }
    chart.title(&format!(
        "{} of the variance before, {} after",
        share(of.share_before),
        share(of.share_after)
    ));
    chart.finish(&format!("residual before and after against {}{along}", of.variable))
}

/// Stretches without a gap: no line is drawn over what has no samples.
fn pieces(bins: &[Bin]) -> impl Iterator<Item = &[Bin]> {
    let mut steps: Vec<f64> = bins.windows(2).map(|pair| pair[1].center - pair[0].center).collect();
    steps.sort_by(f64::total_cmp);
    let longest = GAP * steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    bins.chunk_by(move |a, b| b.center - a.center <= longest)
}

fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
}

/// What was found by itself: dots with what is left around it, line as it was fitted.
pub(super) fn picture(finding: &FindingFacts, of: &Picture) -> String {
    let points = &of.points;
    let values = points.iter().flat_map(|p| [p.measured, p.fitted]);
    let knots = || finding.feature.iter().flat_map(|feature| feature.knots.iter().copied());
    let unit = if of.unit == "urad" { "µrad" } else { "µm" };
    let x = Axis::new(
        &format!("{}, {}", of.variable, of.variable_unit),
        ends(points.iter().map(|p| p.at).chain(knots())),
    );
    let (low, high) = enclosing(values, 5);
    let on = if finding.on.is_empty() { "length" } else { &finding.on };
    let mut chart = Chart::new(WIDTH, HEIGHT, x, Axis::new(&format!("{on}, {unit}"), (low, high)));
    let edge = |side: f64| -> Vec<(f64, f64)> {
        points.iter().map(|p| (p.at, p.measured + side * BAND * p.sigma)).collect()
    };
    chart.band(&edge(-1.0), &edge(1.0), "band grey");
    chart.line(&points.iter().map(|p| (p.at, p.fitted)).collect::<Vec<_>>(), "after");
    if let Some(feature) = &finding.feature {
        let knots = feature.knots.iter().zip(&feature.values).map(|(x, y)| (*x, *y));
        chart.dots(&knots.collect::<Vec<_>>(), "knot");
    }
    chart.dots(&points.iter().map(|p| (p.at, p.measured)).collect::<Vec<_>>(), "found");
    chart.finish(&format!("{} against {}", finding.title, of.variable))
}

/// Residual of every run: before, after, what does not repeat.
pub(super) fn gains(facts: &DiagnosisFacts) -> Option<String> {
    let runs = &facts.runs;
    if runs.is_empty() || runs.len() > MOST_RUNS {
        return None;
    }
    let values = runs.iter().flat_map(|run| [run.before_mm, run.after_mm].map(|mm| mm * UM));
    let (_, high) = enclosing(values.chain([0.0]), 5);
    let slot = 84.0_f64.min(900.0 / runs.len() as f64);
    let width = (60.0 + slot * runs.len() as f64).max(240.0);
    let y = Axis::new("residual, µm rms", (0.0, high));
    let mut chart = Chart::of_categories(width, 220.0, runs.len(), y);
    // Names that would touch each other give way to numbers.
    let fit = runs.iter().all(|run| 1.15 * text_width(&run.run) < slot - 6.0);
    for (k, run) in runs.iter().enumerate() {
        let from = k as f64;
        chart.bar(from + 0.14, from + 0.38, run.before_mm * UM, "bar was");
        chart.bar(from + 0.38, from + 0.62, run.after_mm * UM, "bar");
        if let Some(floor_mm) = run.floor_mm {
            chart.bar(from + 0.62, from + 0.86, floor_mm * UM, "bar least");
        }
        let name = if fit { run.run.clone() } else { fixed(from + 1.0, 0) };
        chart.below(from + 0.5, &name);
    }
    Some(
        chart.finish("residual of every run before and after, and its part that is not repeatable"),
    )
}
