//! How the control drove, as a table.

use super::control::ControlResult;
use super::facts::Analysis;
use super::run_facts::RunResult;
use crate::report::text::layout::table;
use crate::report::text::numbers::{fixed, signed};

/// The columns of the table.
pub(super) const HEAD: [&str; 7] =
    ["run", "all follow with", "X later by", "Y", "Z", "standstills longer by", "corners rounded"];

/// How the control drove in every run, as far as its log tells.
pub(super) fn table_of(analysis: &Analysis) -> String {
    let head = HEAD.map(str::to_owned).to_vec();
    let rows = rows(analysis).into_iter().map(Vec::from);
    table(&std::iter::once(head).chain(rows).collect::<Vec<_>>(), "lrrrrrr")
}

/// Its rows.
pub(super) fn rows(analysis: &Analysis) -> Vec<[String; 7]> {
    let row = |run: &RunResult| {
        let control = &run.control;
        let later = [0, 1, 2].map(|axis| {
            let (ms, sigma) = (control.later_ms[axis], control.later_sigma_ms[axis]);
            if sigma > 0.0 { format!("{} ms", signed(ms, 3)) } else { "-".into() }
        });
        let stood = match (control.standstill_longer_ms, control.standstill_longest_ms) {
            (Some(mean), Some(most)) => format!("{} to {} ms", fixed(mean, 0), fixed(most, 0)),
            _ => "-".into(),
        };
        let [x, y, z] = later;
        [run.name.clone(), following(control), x, y, z, stood, rounded(control)]
    };
    analysis.runs().map(row).collect()
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
