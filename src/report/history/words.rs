//! A history in words.

use crate::monitor::{History, Judged, Series, Trend};
use crate::report::analysis::place::decimals;
use crate::report::text::numbers::{fixed, many, signed};
use crate::report::text::words::{capital, list};

/// Whether it is one, in words.
pub(super) fn judged(trend: Trend) -> &'static str {
    match trend.judged {
        Judged::Changed => "drifts",
        Judged::WithIt => "drifts, or what looks like it",
        Judged::Same | Judged::Unknown => "no drift that could be told",
    }
}

/// The verdict in sentences.
pub(super) fn verdict(history: &History) -> Vec<String> {
    let span = match &history.tests[..] {
        [(first, _), .., (last, _)] if first != last => format!("from {first} to {last}"),
        [(only, _), ..] => format!("on {only}"),
        [] => String::new(),
    };
    let mut told = vec![format!("{} {span}.", many(history.tests.len(), "test"))];
    let mut trends: Vec<(&Series, Trend)> = history
        .series
        .iter()
        .filter_map(|series| {
            Some((series, series.trend.filter(|trend| trend.judged == Judged::Changed)?))
        })
        .collect();
    trends.sort_by(|(_, a), (_, b)| {
        (b.per_year / b.sigma).abs().total_cmp(&(a.per_year / a.sigma).abs())
    });
    for (series, trend) in trends.iter().take(MOST) {
        told.push(format!("{} drifts by {}.", capital(&series.name), per_year(series, *trend)));
    }
    if let Some(more @ 1..) = trends.len().checked_sub(MOST) {
        told.push(format!("And {more} more: see the table."));
    }
    let with =
        history.series.iter().filter(|of| of.trend.is_some_and(|t| t.judged == Judged::WithIt));
    let with: Vec<&str> = with.map(|of| of.name.as_str()).collect();
    if !with.is_empty() {
        let what = if trends.is_empty() {
            "Something drifts, and these tests cannot tell which of"
        } else {
            "These move by no more than what drifts may look like"
        };
        told.push(format!("{what}: {}.", list(&with)));
    }
    if trends.is_empty() && with.is_empty() {
        let any = history.series.iter().any(|series| series.trend.is_some());
        told.push(if any {
            "No drift that could be told.".to_owned()
        } else {
            "A drift needs three equal tests or more, on more than one day.".to_owned()
        });
    }
    told
}

/// So many drifts are told in sentences.
const MOST: usize = 6;

/// Such as `+12.1 +- 0.8 um/m a year`.
pub(super) fn per_year(series: &Series, trend: Trend) -> String {
    let places = decimals(trend.sigma);
    format!(
        "{} +- {} {} a year",
        signed(trend.per_year, places),
        fixed(trend.sigma, places),
        series.unit
    )
}

/// What the numbers are.
pub(super) const BASIS: &str = "Trends are lines of least squares, weighted by the noise; tests of another kind or place have a height of their own. Their standard deviation counts the scatter about the line where that is larger than the noise. What a test cannot tell from other faults is the same in all equal tests, and where something drifts those may drift by the same share of what is plausible. A drift is what chance makes in one of a hundred histories of a machine that does not change.";
