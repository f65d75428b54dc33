//! The summary for the terminal: plain text, at most [`WIDTH`](crate::report::text::layout::WIDTH) columns.

use std::fmt::Write as _;

use super::cautions::DETERMINED;
use super::facts::Analysis;
use super::machine_errors::MachineErrors;
use super::means::MeanResult;
use super::run_facts::RunResult;
use super::{control_text, driven, place, record, verdict};
use crate::report::text::layout::{paragraph, table};
use crate::report::text::numbers::{fixed, signed};
use crate::report::text::units::{engineering, row_decimals};
use crate::report::text::words::list;
use crate::report::{circular, diagnosis, ranked};

/// The summary: verdict, runs, coefficients in engineering units, squareness and reversal, what nobody
/// can see, and cautions.
pub fn summary(analysis: &Analysis) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "{}", analysis.test.name);
    let _ = writeln!(text, "{}\n", under_title(analysis));
    if let Some(of_day) = &analysis.test.record {
        let lines = record::lines(of_day).into_iter();
        let told: Vec<String> = lines.map(|(name, value)| format!("{name}: {value}")).collect();
        paragraph(&mut text, "", &told.join("; "));
        text.push('\n');
    }
    for line in verdict::of(analysis) {
        paragraph(&mut text, "", &line);
    }
    text.push_str(&circular::terminal::text(&analysis.circular));
    text.push_str(&ranked::terminal::text(&analysis.ranking));
    text.push_str("\nRuns\n");
    text.push_str(&runs_table(analysis));
    text.push_str("\nHow the control drove\n");
    text.push_str(&control_text::table_of(analysis));
    if analysis.is_local() {
        text.push_str("\nThe machine at the place of the test\n");
        text.push_str(&at_the_place(analysis));
    } else {
        text.push_str("\nCoefficients");
        text.push_str(if analysis.repeats.len() > 1 {
            " (mean of the repeats; sigma of one repeat; deviation between repeats)\n"
        } else {
            "\n"
        });
        text.push_str(&coefficients(analysis));
        text.push_str(&machine_errors(analysis));
    }
    let confounded: Vec<&String> =
        analysis.repeats.first().map_or_else(Vec::new, |repeat| repeat.confounded.iter().collect());
    if !confounded.is_empty() {
        text.push_str("\nNot observable: do not read these values one by one\n");
        for sentence in confounded {
            paragraph(&mut text, "  ", sentence);
        }
    }
    if !analysis.cautions.is_empty() {
        text.push_str("\nCautions\n");
        for caution in &analysis.cautions {
            paragraph(&mut text, "  - ", caution);
        }
    }
    if let Some(diagnosis) = &analysis.diagnosis {
        text.push_str("\nWhat the model gets wrong\n");
        text.push_str(&diagnosis::terminal::in_short(diagnosis));
    }
    text
}

fn under_title(analysis: &Analysis) -> String {
    let mut parts = vec![
        format!("{} ({})", analysis.machine.name, analysis.machine.topology),
        format!("bar {} mm", analysis.bar_lengths()),
    ];
    parts.push(match &analysis.strategy {
        Some(strategy) => format!("strategy {strategy}"),
        None => driven::told(&analysis.driven),
    });
    parts.push(format!("terms {}", analysis.terms.join(" ")));
    let line = parts.join(", ");
    let mut text = String::new();
    paragraph(&mut text, "", &line);
    text.trim_end().to_owned()
}

/// The runs as a table: when the bar engaged, the clock, the uncertainty of time, the residual, the pauses.
pub fn runs_table(analysis: &Analysis) -> String {
    let several = analysis.several_mountings();
    let mut rows = vec![
        ["run", "engaged at", "clock", "time sigma", "used", "residual", "pauses"]
            .map(str::to_owned)
            .to_vec(),
    ];
    let extended = analysis.before.is_some();
    if extended {
        rows[0].insert(6, "before".to_owned());
    }
    if several {
        rows[0].insert(1, "mounting".to_owned());
    }
    for (run, before) in analysis.runs_with_before() {
        let mut row = vec![
            run.name.clone(),
            format!("{} s", fixed(run.engagement_log_s, 3)),
            format!(
                "{} +- {} ppm",
                signed(run.clock_rate_ppm, 1),
                run.clock_rate_sigma_ppm.map_or("?".into(), |s| fixed(s, 1))
            ),
            run.worst_time_sigma_ms.map_or("unknown".into(), |s| format!("{} ms", fixed(s, 1))),
            run.samples.used.to_string(),
            format!("{} um", fixed(run.residual_rms_um, 3)),
            pauses(run),
        ];
        if let Some(before) = before {
            row.insert(6, format!("{} um", fixed(before.residual_rms_um, 3)));
        }
        if several {
            row.insert(1, run.mounting.clone());
        }
        rows.push(row);
    }
    let sides = if extended { "rrrrrrl" } else { "rrrrrl" };
    table(&rows, &format!("{}{sides}", if several { "ll" } else { "l" }))
}

/// Operator's pauses of a run: how many, from the shortest to the longest.
pub(super) fn pauses(run: &RunResult) -> String {
    let known: Vec<f64> = run.pauses.iter().filter_map(|pause| pause.length_s).collect();
    let shortest = known.iter().copied().fold(f64::INFINITY, f64::min);
    let longest = known.iter().copied().fold(0.0, f64::max);
    match known.len() {
        0 => "none".into(),
        1 => format!("1 of {} s", fixed(longest, 2)),
        n => format!("{n} of {} to {} s", fixed(shortest, 2), fixed(longest, 2)),
    }
}

fn coefficients(analysis: &Analysis) -> String {
    let repeated = analysis.repeats.len() > 1;
    let mut head = vec!["name", "mean", "sigma"];
    if repeated {
        head.push("deviation");
    } else {
        head[1] = "value";
    }
    let extended = analysis.before.is_some();
    if extended {
        head.push("before");
    }
    head.extend(["unit", "observed"]);
    let mut rows = vec![head.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    for mean in &analysis.over_repeats {
        rows.push(coefficient(mean, repeated, analysis));
    }
    let numbers = 2 + usize::from(repeated) + usize::from(extended);
    table(&rows, &format!("l{}lr", "r".repeat(numbers)))
}

fn coefficient(mean: &MeanResult, repeated: bool, analysis: &Analysis) -> Vec<String> {
    let unit = engineering(mean.unit);
    let value = mean.mean * unit.factor;
    let sigma = mean.sigma.map(|s| s * unit.factor);
    let decimals = row_decimals(value, sigma);
    // The sigma of what is half seen counts the seen half only: worse than none.
    let sigma = sigma.filter(|_| mean.observed >= DETERMINED);
    let shown = |number: Option<f64>| number.map_or("-".into(), |n| fixed(n, decimals));
    let mut row = vec![mean.name.clone(), fixed(value, decimals), shown(sigma)];
    if repeated {
        row.push(shown(mean.deviation.map(|d| d * unit.factor)));
    }
    if analysis.before.is_some() {
        row.push(shown(analysis.mean_before(&mean.name).map(|before| before.mean * unit.factor)));
    }
    row.extend([unit.plain.to_owned(), observed(mean.observed)]);
    row
}

/// A share as percent; what is not quite all is never told as all.
pub(super) fn observed(share: f64) -> String {
    if share > 0.999_999 {
        return "100 %".into();
    }
    format!("{} %", fixed((share * 1000.0).floor() / 10.0, 1))
}

/// The machine at the place of the test with what was found, below what was found; empty where nothing was.
pub fn place_text(analysis: &Analysis) -> String {
    if analysis.before.is_none() || !analysis.is_local() {
        return String::new();
    }
    format!(
        "\nThe machine at the place of the test, with what was found\n{}",
        at_the_place(analysis)
    )
}

/// What people ask, with both uncertainties.
fn at_the_place(analysis: &Analysis) -> String {
    let repeated = analysis.repeats.len() > 1;
    let mut head = vec!["", "value", "noise", "all"];
    if repeated {
        head.push("repeats");
    }
    let extended = analysis.before.is_some();
    if extended {
        head.push("before");
    }
    head.push("unit");
    let mut rows = vec![head.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    let (seen, unseen) = place::seen(&analysis.at_the_place);
    for result in seen {
        let places = place::decimals(result.noise.unwrap_or(0.0));
        let shown = |number: Option<f64>| number.map_or("-".into(), |n| fixed(n, places));
        let mut row = vec![
            result.quantity.clone(),
            signed(result.value, places),
            shown(result.noise),
            shown(result.all),
        ];
        if repeated {
            row.push(shown(result.deviation));
        }
        if extended {
            let before = analysis.place_before(&result.quantity);
            row.push(before.map_or("-".into(), |before| signed(before.value, places)));
        }
        row.push(result.unit.to_owned());
        rows.push(row);
    }
    let numbers = 3 + usize::from(repeated) + usize::from(extended);
    let mut text = table(&rows, &format!("l{}l", "r".repeat(numbers)));
    if !unseen.is_empty() {
        paragraph(&mut text, "  ", &format!("Not seen in this test: {}.", list(unseen)));
    }
    text
}

fn machine_errors(analysis: &Analysis) -> String {
    let errors = &analysis.machine_errors;
    let before = analysis.errors_before();
    let mut text = String::new();
    if !errors.squareness.is_empty() {
        text.push_str("\nSquareness (angle between the positive directions minus 90 deg)\n");
        text.push_str(&squareness(errors, before));
    }
    if !errors.scale.is_empty() {
        text.push_str("\nScale\n");
        text.push_str(&scale(errors, before));
    }
    if !errors.reversal.is_empty() || !errors.angular_hysteresis.is_empty() {
        text.push_str(
            "\nReversal (step from negative to positive motion, twice the coefficient b)\n",
        );
        text.push_str(&reversal(errors, before));
    }
    text
}

/// What a row was before anything was found, as its last cell; empty where nothing was.
fn earlier(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(String::new, |value| format!("before {}", signed(value, decimals)))
}

fn squareness(errors: &MachineErrors, before: Option<&MachineErrors>) -> String {
    let rows = errors.squareness.iter().map(|s| {
        vec![
            s.axes.to_owned(),
            s.name.clone(),
            s.symbol.to_owned(),
            format!("{} um/m", signed(s.angle_minus_90_um_m, 2)),
            format!("{} arcsec", signed(s.angle_minus_90_arcsec, 2)),
            spread(s.observed, s.sigma_um_m, s.deviation_um_m, "um/m", 2),
            earlier(before.and_then(|b| b.angle_um_m(&s.name)), 2),
        ]
    });
    table(&rows.collect::<Vec<_>>(), "lllrrlr")
}

fn scale(errors: &MachineErrors, before: Option<&MachineErrors>) -> String {
    let rows = errors.scale.iter().map(|s| {
        vec![
            s.name.clone(),
            format!("{} um/m", signed(s.value_um_m, 2)),
            spread(s.observed, s.sigma_um_m, s.deviation_um_m, "um/m", 2),
            earlier(before.and_then(|b| b.scale_um_m(&s.name)), 2),
        ]
    });
    table(&rows.collect::<Vec<_>>(), "lrlr")
}

/// Displacements and then rotations.
fn reversal(errors: &MachineErrors, before: Option<&MachineErrors>) -> String {
    let displacements = errors.reversal.iter().map(|r| {
        vec![
            r.name.clone(),
            r.kind.to_owned(),
            format!("step {} um", signed(r.step_um, 3)),
            format!("b {} um", signed(r.coefficient_um, 3)),
            spread(r.observed, r.sigma_um, r.deviation_um, "um", 3),
            earlier(before.and_then(|b| b.step_um(&r.name)), 3),
        ]
    });
    let rotations = errors.angular_hysteresis.iter().map(|h| {
        vec![
            h.name.clone(),
            "angular".into(),
            format!("step {} urad", signed(h.step_urad, 2)),
            format!("b {} urad", signed(h.coefficient_urad, 2)),
            spread(h.observed, h.sigma_urad, h.deviation_urad, "urad", 2),
            earlier(before.and_then(|b| b.step_urad(&h.name)), 2),
        ]
    });
    table(&displacements.chain(rotations).collect::<Vec<_>>(), "llrrlr")
}

/// Sigma of one repeat and deviation between them, in words; or that the value stands on one leg only.
fn spread(
    share: f64,
    sigma: Option<f64>,
    deviation: Option<f64>,
    unit: &str,
    decimals: usize,
) -> String {
    if share < DETERMINED {
        return format!("only {} observed", observed(share));
    }
    let told: Vec<String> = [("sigma", sigma), ("repeats", deviation)]
        .into_iter()
        .filter_map(|(name, value)| Some(format!("{name} {}", fixed(value?, decimals))))
        .collect();
    if told.is_empty() { String::new() } else { format!("{} {unit}", told.join(", ")) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::report::fixture;
    use crate::report::text::layout::WIDTH;

    #[test]
    fn the_summary_fits_the_terminal() {
        for set in ["hu40t", "planar"] {
            check(&summary(&fixture::identified(set).analysis));
        }
        let diagnosed = &fixture::diagnosed().analysis;
        check(&summary(diagnosed));
        check(&diagnosis::terminal::diagnosis_text(diagnosed.diagnosis.as_ref().unwrap()));
    }

    #[track_caller]
    fn check(text: &str) {
        for line in text.lines() {
            // A cause as `--hide` takes it is one word.
            assert!(line.chars().count() <= WIDTH || line.contains("--hide"), "{line}");
            assert!(!line.contains("NaN") && !line.contains("inf "), "{line}");
        }
    }

    #[test]
    fn what_is_not_quite_all_is_not_told_as_all() {
        assert_eq!(observed(1.0), "100 %");
        assert_eq!(observed(0.999_99), "99.9 %");
        assert_eq!(observed(0.5), "50.0 %");
    }
}
