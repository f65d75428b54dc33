//! Is the fit to be trusted? The verdict, a sentence an entry.

use super::facts::Analysis;
use crate::report::text::numbers::{fixed, many};

/// The verdict, a line a sentence: time, observability, residual.
pub(super) fn of(analysis: &Analysis) -> Vec<String> {
    let runs = analysis.runs().count();
    let worst = analysis.runs().filter_map(|run| run.worst_time_sigma_ms).fold(0.0, f64::max);
    let rank = analysis.repeats.iter().map(|r| r.rank).min().unwrap_or(0);
    let parameters = analysis.repeats.first().map_or(0, |r| r.parameter_count);
    let condition = analysis.repeats.iter().filter_map(|r| r.condition).fold(0.0, f64::max);
    let used: usize = analysis.repeats.iter().map(|r| r.samples.used).sum();
    let rejected: usize = analysis.repeats.iter().map(|r| r.samples.rejected).sum();
    let (rms, before) = analysis.residual_rms_um();
    let before =
        before.map(|rms| format!(" (a fit without what was found leaves {} um)", fixed(rms, 3)));
    vec![
        format!(
            "{} aligned in {}, worst time uncertainty {} ms.",
            many(runs, "run"),
            many(analysis.repeats.len(), "repeat"),
            fixed(worst, 1)
        ),
        if analysis.is_local() {
            format!("The readings decide {rank} numbers about the machine and its set-up.")
        } else {
            format!(
                "{rank} of {parameters} parameters observed, condition number {}.",
                fixed(condition, 0)
            )
        },
        format!(
            "Residual {} um rms{} over {}{}.",
            fixed(rms, 3),
            before.unwrap_or_default(),
            many(used, "sample"),
            if rejected > 0 { format!(", {rejected} rejected") } else { String::new() }
        ),
    ]
}
