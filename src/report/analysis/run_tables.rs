//! Tables of the runs: their alignment, what they leave, the pauses of the operator.

use super::control_text;
use super::facts::{Analysis, RepeatResult};
use super::run_facts::RunResult;
use super::tables::shown;
use crate::report::text::numbers::{count, fixed, many, signed, typeset};

pub(super) fn run(run: &RunResult, before: Option<&RunResult>) -> [String; 9] {
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

/// How the control drove in every run.
pub(super) fn driving(analysis: &Analysis) -> Vec<[String; 7]> {
    let cell = |text: String| match text.as_str() {
        "-" => "–".to_owned(),
        _ => typeset(&text.replace(" +- ", " ± ")),
    };
    let row = |[run, cells @ ..]: [String; 7]| {
        let [a, b, c, d, e, f] = cells.map(cell);
        [run, a, b, c, d, e, f]
    };
    control_text::rows(analysis).into_iter().map(row).collect()
}

pub(super) fn noises(analysis: &Analysis) -> Vec<[String; 7]> {
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
pub(super) fn pauses(analysis: &Analysis) -> Vec<(String, String)> {
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
