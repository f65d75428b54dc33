//! Bars of the hysteresis coefficients (paper, Figure 6).

use super::figure::Figure;
use crate::report::analysis::cautions::DETERMINED;
use crate::report::analysis::facts::Analysis;
use crate::report::draw::chart::{Axis, Chart};
use crate::report::draw::svg::Anchor;
use crate::report::draw::ticks::enclosing;
use crate::report::text::numbers::{signed, typeset};

/// A bar: name, value, half of its error bar, share that is observed.
struct Bar<'a> {
    name: &'a str,
    value: f64,
    spread: f64,
    observed: f64,
    /// The value without what was found.
    before: Option<f64>,
}

/// Displacements in um and rotations in urad, each where there are any.
pub(in crate::report) fn hysteresis(analysis: &Analysis) -> Vec<Figure> {
    let spread = |sigma: Option<f64>, deviation: Option<f64>| deviation.or(sigma).unwrap_or(0.0);
    let errors = &analysis.machine_errors;
    let before = analysis.errors_before();
    let half = |step: f64| 0.5 * step;
    let displacements: Vec<Bar<'_>> = errors
        .reversal
        .iter()
        .map(|r| Bar {
            name: &r.name,
            value: r.coefficient_um,
            spread: spread(r.sigma_um, r.deviation_um),
            observed: r.observed,
            before: before.and_then(|before| before.step_um(&r.name)).map(half),
        })
        .collect();
    let rotations: Vec<Bar<'_>> = errors
        .angular_hysteresis
        .iter()
        .map(|h| Bar {
            name: &h.name,
            value: h.coefficient_urad,
            spread: spread(h.sigma_urad, h.deviation_urad),
            observed: h.observed,
            before: before.and_then(|before| before.step_urad(&h.name)).map(half),
        })
        .collect();
    let bars = if analysis.repeats.len() > 1 {
        "Error bars: one standard deviation over the repeats."
    } else {
        "Error bars: one stated standard deviation."
    };
    [
        (displacements, "coefficient b, µm", "Displacement hysteresis", 2),
        (rotations, "coefficient b, µrad", "Angular hysteresis", 1),
    ]
    .into_iter()
    .filter(|(list, ..)| !list.is_empty())
    .map(|(list, label, title, decimals)| Figure {
        svg: chart(&list, label, title, decimals),
        caption: format!(
            "{title}: the coefficient b, half of the step at a reversal. {bars}{}{}",
            if list.iter().any(|bar| bar.observed < DETERMINED) {
                " Hollow bars are not determined by the data."
            } else {
                ""
            },
            if before.is_some() { " Grey: without what was found." } else { "" }
        ),
        tall: false,
    })
    .collect()
}

fn chart(bars: &[Bar<'_>], label: &str, title: &str, decimals: usize) -> String {
    let ends = bars.iter().flat_map(|bar| {
        let seen = bar.observed >= DETERMINED;
        let half = if seen { bar.spread } else { 0.0 };
        [bar.value - half, bar.value + half, bar.before.unwrap_or(0.0)]
    });
    let (low, high) = enclosing(ends, 6);
    // Room for the numbers above and below the bars.
    let margin = 0.16 * (high - low);
    let low = if low < 0.0 { low - margin } else { low };
    let high = if high > 0.0 { high + margin } else { high };
    let width = (90.0 + 66.0 * bars.len() as f64).max(240.0);
    let mut chart = Chart::of_categories(width, 280.0, bars.len(), Axis::new(label, (low, high)));
    for (k, bar) in bars.iter().enumerate() {
        let (from, to) = (k as f64 + 0.27, k as f64 + 0.73);
        let middle = 0.5 * (from + to);
        let seen = bar.observed >= DETERMINED;
        if let Some(before) = bar.before {
            chart.bar(from - 0.16, from, before, "bar was");
        }
        chart.bar(from, to, bar.value, if seen { "bar" } else { "bar hollow" });
        let half = if seen { bar.spread } else { 0.0 };
        if half > 0.0 {
            chart.error_bar(middle, bar.value, half);
        }
        let text = typeset(&signed(bar.value, decimals));
        if bar.value < 0.0 {
            chart.note((middle, bar.value - half), (0.0, 13.0), Anchor::Middle, &text);
        } else {
            chart.note((middle, bar.value + half), (0.0, -5.0), Anchor::Middle, &text);
        }
        chart.below(middle, bar.name);
    }
    chart.finish(title)
}
