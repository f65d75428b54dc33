//! What the model leaves over: against time, against the angle, as a distribution.

use super::figure::Figure;
use super::polar::direction;
use crate::identify::{Identification, IdentifiedRun, Record};
use crate::log::Log;
use crate::report::analysis::facts::{Analysis, RepeatResult};
use crate::report::analysis::shown::Shown;
use crate::report::analysis::traces::OnCircle;
use crate::report::draw::chart::{Axis, Chart};
use crate::report::draw::svg::{Anchor, envelope, thinned};
use crate::report::draw::ticks::{enclosing, symmetric};
use crate::report::text::numbers::fixed;
use crate::solve::Autocovariances;

/// Points of a residual curve over a whole run.
const TIME_POINTS: usize = 1400;
/// Dots of one arc.
const DOTS: usize = 260;
/// Width of the stretches over which residuals are averaged, degrees.
const STRETCH_DEG: f64 = 3.0;

/// Range of the residuals that were believed, um: the same for every figure.
fn range_um(shown: Shown) -> f64 {
    let all = shown.repeats.iter().chain(shown.before);
    symmetric(all.flat_map(believed).map(|r| r.residual_mm * 1e3))
}

/// The readings of all runs that the fit used and believed.
fn believed(identification: &Identification) -> impl Iterator<Item = &Record> {
    let used = identification.runs.iter().flat_map(IdentifiedRun::used);
    used.filter(|record| !record.rejected())
}

/// One chart a run: residual against program time, arcs shaded.
pub(in crate::report) fn against_time(analysis: &Analysis, shown: Shown) -> Vec<Figure> {
    let range = range_um(shown);
    let mut figures = Vec::new();
    for (run, before) in shown.runs() {
        let points = over_time(run);
        let (Some(first), Some(last)) = (points.first(), points.last()) else { continue };
        let x = Axis::new("program time, s", (first.1 - 2.0, last.1 + 2.0));
        let y = Axis::new("residual, µm", (-range, range));
        let mut chart = Chart::new(980.0, 165.0, x, y);
        for section in &run.alignment.sections {
            let class = match (section.transit, section.forward) {
                (true, _) => "shade transit",
                (_, true) => "shade forward",
                (_, false) => "shade backward",
            };
            chart.shade(section.start_s, section.end_s, class);
        }
        if let Some(before) = before {
            draw_over_time(&mut chart, &over_time(before), "before");
        }
        draw_over_time(&mut chart, &points, "residual");
        chart.title(&analysis.in_mounting(&run.name, run.mounting));
        let svg = chart.finish(&format!("{}: residual against program time", run.name));
        figures.push(Figure { svg, caption: String::new(), tall: false });
    }
    figures
}

/// Section, program time and residual, um, of the readings that were believed.
fn over_time(run: &IdentifiedRun) -> Vec<(usize, f64, f64)> {
    let believed = run.used().filter(|record| !record.rejected());
    let point = |r: &Record| Some((r.section()?, r.sample.program_s, r.residual_mm * 1e3));
    believed.filter_map(point).collect()
}

fn draw_over_time(chart: &mut Chart, points: &[(usize, f64, f64)], class: &str) {
    let share = TIME_POINTS as f64 / points.len() as f64;
    for arc in points.chunk_by(|a, b| a.0 == b.0) {
        let line: Vec<(f64, f64)> = arc.iter().map(|(_, t, r)| (*t, *r)).collect();
        let most = (arc.len() as f64 * share).ceil() as usize;
        chart.line(&envelope(&line, most), class);
    }
}

/// One chart a circle: residuals of the first repeat as dots, their mean over all repeats as a line.
pub(in crate::report) fn against_angle(
    circles: &[OnCircle],
    before: &[OnCircle],
    shown: Shown,
) -> Vec<Figure> {
    let range = range_um(shown);
    circles
        .iter()
        .map(|circle| {
            // Arcs of a whole circle begin anywhere and run on through a full turn.
            let whole = circle.whole();
            let degrees = |point: &(f64, f64)| {
                let angle_deg = point.0.to_degrees();
                (if whole { angle_deg.rem_euclid(360.0) } else { angle_deg }, point.1)
            };
            let ends = circle.traces.iter().flat_map(|trace| {
                let first = trace.angle_rad.iter().copied().fold(f64::INFINITY, f64::min);
                let last = trace.angle_rad.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                if whole { [0.0, 360.0] } else { [first.to_degrees(), last.to_degrees()] }
            });
            let (low, high) =
                ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            let name = &circle.name;
            let x = Axis::new("angle on the circle, °", (low.round(), high.round()));
            let mut chart = Chart::new(480.0, 190.0, x, Axis::new("residual, µm", (-range, range)));
            for trace in circle.traces.iter().filter(|trace| trace.repeat == 0) {
                let dots: Vec<(f64, f64)> =
                    thinned(&trace.residuals, DOTS).iter().map(degrees).collect();
                chart.dots(&dots, direction(trace.forward));
            }
            let mean = |circle: &OnCircle, forward: bool| {
                let traces = circle.traces.iter().filter(|trace| trace.forward == forward);
                let all: Vec<(f64, f64)> =
                    traces.flat_map(|trace| trace.residuals.iter().map(degrees)).collect();
                averaged(&all, low)
            };
            for before in before.iter().filter(|before| before.is_same(circle)) {
                for forward in [true, false] {
                    chart.line(&mean(before, forward), "before");
                }
            }
            for forward in [true, false] {
                let class = format!("mean {}", direction(forward));
                chart.line(&mean(circle, forward), &class);
            }
            chart.title(name);
            let svg = chart.finish(&format!("{name}: residual against angle"));
            Figure { svg, caption: String::new(), tall: false }
        })
        .collect()
}

/// Means over stretches of equal width.
fn averaged(points: &[(f64, f64)], low: f64) -> Vec<(f64, f64)> {
    let place = |x: f64| ((x - low) / STRETCH_DEG).floor().max(0.0) as usize;
    let count = points.iter().map(|point| place(point.0) + 1).max().unwrap_or(0);
    let mut sums = vec![(0.0, 0.0, 0.0); count];
    for (x, y) in points {
        let sum = &mut sums[place(*x)];
        *sum = (sum.0 + 1.0, sum.1 + x, sum.2 + y);
    }
    let filled = sums.into_iter().filter(|sum| sum.0 > 0.0);
    filled.map(|(n, x, y)| (x / n, y / n)).collect()
}

/// Distribution of the residuals, with the normal distribution of the same standard deviation.
pub(in crate::report) fn histogram(shown: Shown) -> Option<Figure> {
    let of = |identifications: &[Identification]| -> Vec<f64> {
        identifications.iter().flat_map(believed).map(|r| r.residual_mm * 1e3).collect()
    };
    let values = of(shown.repeats);
    if values.len() < 20 {
        return None;
    }
    let total = values.len() as f64;
    let sigma = (values.iter().map(|v| v * v).sum::<f64>() / total).sqrt();
    let range = range_um(shown);
    let bins = 48_usize;
    let width = 2.0 * range / bins as f64;
    let counted = |values: &[f64]| {
        let mut counts = vec![0.0; bins];
        for value in values {
            let place = ((value + range) / width).floor().clamp(0.0, bins as f64 - 1.0);
            counts[place as usize] += 100.0 / values.len() as f64;
        }
        counts
    };
    let (counts, before) = (counted(&values), counted(&of(shown.before)));
    let normal = |x: f64| {
        100.0 * width / (sigma * (2.0 * std::f64::consts::PI).sqrt())
            * (-0.5 * (x / sigma).powi(2)).exp()
    };
    let top = counts.iter().copied().chain([normal(0.0)]);
    let (_, high) = enclosing(top.chain([0.0]), 5);
    let mut chart = Chart::new(
        480.0,
        220.0,
        Axis::new("residual, µm", (-range, range)),
        Axis::new("share of samples, %", (0.0, high)),
    );
    let from = |k: usize| -range + k as f64 * width;
    for (k, share) in counts.iter().enumerate() {
        chart.bar(from(k), from(k) + width, *share, "bin");
    }
    if !shown.before.is_empty() {
        let steps = before.iter().enumerate();
        let steps = steps.flat_map(|(k, share)| [(from(k), *share), (from(k) + width, *share)]);
        chart.line(&steps.collect::<Vec<_>>(), "before");
    }
    let curve: Vec<(f64, f64)> = (0..=160)
        .map(|k| -range + 2.0 * range * f64::from(k) / 160.0)
        .map(|x| (x, normal(x)))
        .collect();
    chart.line(&curve, "model");
    Some(Figure {
        svg: chart.finish("distribution of the residuals"),
        caption: format!(
            "Distribution of the residuals of all runs; line: normal distribution with {} µm rms.{}",
            fixed(sigma, 3),
            if shown.before.is_empty() { "" } else { " Grey: without what was found." }
        ),
        tall: false,
    })
}

/// Autocorrelation of the residuals of the first repeat over the first lags, with the noise model.
pub(in crate::report) fn autocorrelation(
    result: &RepeatResult,
    shown: Shown,
    analysis: &Analysis,
) -> Option<Figure> {
    let lags = result.noise.autocorrelation.len();
    let seen = seen(shown.repeats.first()?, lags)?;
    let before = shown.before.first().and_then(|before| self::seen(before, lags));
    let before = before.unwrap_or_default();
    let all = seen.iter().chain(&before).chain(&result.noise.autocorrelation);
    let lowest = all.copied().fold(0.0, f64::min);
    let low = (lowest * 5.0).floor() / 5.0;
    let mut chart =
        Chart::of_categories(480.0, 220.0, lags, Axis::new("autocorrelation", (low, 1.05)));
    for (lag, value) in before.iter().enumerate() {
        chart.bar(lag as f64 + 0.12, lag as f64 + 0.88, *value, "bar was");
    }
    for (lag, value) in seen.iter().enumerate() {
        chart.bar(lag as f64 + 0.3, lag as f64 + 0.7, *value, "bar");
        chart.below(lag as f64 + 0.5, &lag.to_string());
    }
    let model: Vec<(f64, f64)> = result
        .noise
        .autocorrelation
        .iter()
        .enumerate()
        .map(|(lag, value)| (lag as f64 + 0.5, *value))
        .collect();
    chart.line(&model, "model");
    let period_s = analysis.runs().next().map_or(0.0, |run| run.sample_period_s);
    let note = format!("lag, samples of {} s", fixed(period_s, 3));
    chart.note((lags as f64, 1.05), (-8.0, 16.0), Anchor::End, &note);
    Some(Figure {
        svg: chart.finish("autocorrelation of the residuals"),
        caption: format!(
            "Autocorrelation of the residuals of the first repeat (bars) and of the noise model (line), autoregressive of order {}.{}",
            result.noise.autoregressive.len(),
            if before.is_empty() { "" } else { " Grey: without what was found." }
        ),
        tall: false,
    })
}

/// Autocorrelation of the residuals of a repeat over the first lags.
fn seen(identification: &Identification, lags: usize) -> Option<Vec<f64>> {
    let mut covariances = Autocovariances::new(lags.saturating_sub(1));
    for run in &identification.runs {
        let longest_s = Log::GAP_PERIODS * run.alignment.sample_period_s;
        let used: Vec<&Record> = run.used().filter(|record| !record.rejected()).collect();
        let together = |a: &&Record, b: &&Record| {
            a.sample.part == b.sample.part && b.sample.log_s - a.sample.log_s <= longest_s
        };
        for piece in used.chunk_by(together) {
            let values: Vec<f64> = piece.iter().map(|record| record.residual_mm * 1e3).collect();
            covariances.push_segment(&values);
        }
    }
    let measured = covariances.unbiased();
    let variance = measured.first().copied().filter(|v| *v > 0.0)?;
    Some(measured.iter().map(|v| v / variance).collect())
}
