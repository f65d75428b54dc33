//! How the control drove, as a table.

use super::control::ControlResult;
use super::facts::Analysis;
use crate::report::text::layout::table;
use crate::report::text::numbers::{fixed, signed};

/// How the control drove in every run, as far as its log tells.
pub(super) fn table_of(analysis: &Analysis) -> String {
    let head = [
        "run",
        "all follow with",
        "X later by",
        "Y",
        "Z",
        "standstills longer by",
        "corners rounded",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for run in analysis.runs() {
        let control = &run.control;
        let mut row = vec![run.name.clone(), following(control)];
        let later = control.later_ms.iter().zip(&control.later_sigma_ms);
        row.extend(later.map(|(ms, sigma)| {
            if *sigma > 0.0 { format!("{} ms", signed(*ms, 3)) } else { "-".into() }
        }));
        row.push(match (control.standstill_longer_ms, control.standstill_longest_ms) {
            (Some(mean), Some(most)) => format!("{} to {} ms", fixed(mean, 0), fixed(most, 0)),
            _ => "-".into(),
        });
        row.push(rounded(control));
        rows.push(row);
    }
    table(&rows, "lrrrrrr")
}

/// By which share corners of chords were rounded out.
fn rounded(control: &ControlResult) -> String {
    match control.rounded_percent {
        None => "-".into(),
        Some([percent, sigma]) if percent < 3.0 * sigma => {
            format!("0 to {} %", fixed((percent + 2.0 * sigma).clamp(0.0, 100.0), 0))
        }
        Some([percent, sigma]) => {
            format!("{} +- {} %", fixed(percent.min(100.0), 0), fixed(sigma, 0))
        }
    }
}

/// With what all slides followed alike.
///
/// What they do for it grows with the square of the time constant, of which three standard deviations are six of its root.
fn following(control: &ControlResult) -> String {
    let (ms, sigma_ms) = (control.following_ms, control.following_sigma_ms);
    match sigma_ms {
        None => format!("{} +- ? ms", fixed(ms, 1)),
        Some(sigma_ms) if ms < 6.0 * sigma_ms => {
            format!("0 to {} ms", fixed(ms + 2.0 * sigma_ms, 0))
        }
        Some(sigma_ms) => format!("{} +- {} ms", fixed(ms, 1), fixed(sigma_ms, 1)),
    }
}
