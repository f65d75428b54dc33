//! What the model gets wrong, as plain text of at most [`WIDTH`](crate::report::text::layout::WIDTH) columns.

use super::facts::{DiagnosisFacts, FindingFacts};
use super::words::shortened;
use crate::diagnose::{Rival, Separation};
use crate::report::text::layout::{paragraph, table};
use crate::report::text::numbers::{fixed, percent};
use crate::report::text::units::{engineering, row_decimals};

/// Tables are in um.
const UM: f64 = 1e3;

/// Everything: verdict, findings, gain, coefficients that moved, what cannot be seen.
pub fn diagnosis_text(facts: &DiagnosisFacts) -> String {
    let mut text = String::new();
    for line in facts.verdict.sentences() {
        paragraph(&mut text, "", line);
    }
    if !facts.findings.is_empty() {
        text.push_str("\nFindings, the largest first\n");
    }
    for (k, finding) in facts.findings.iter().enumerate() {
        full(&mut text, k + 1, finding);
    }
    text.push_str(&gains(facts));
    text.push_str(&moved(facts));
    if !facts.unseen.is_empty() {
        text.push_str("\nWhat these runs cannot show\n");
        for sentence in &facts.unseen {
            paragraph(&mut text, "  - ", sentence);
        }
    }
    if !facts.left_out.is_empty() {
        text.push_str("\nRuns that were left out\n");
        for run in &facts.left_out {
            paragraph(&mut text, "  - ", &format!("{}: {}", run.runs, run.reason));
            if let Some(hint) = &run.hint {
                paragraph(&mut text, "    hint: ", hint);
            }
        }
    }
    text
}

/// Verdict and findings, for the end of a summary.
pub(in crate::report) fn in_short(facts: &DiagnosisFacts) -> String {
    let mut text = String::new();
    for line in facts.verdict.in_short() {
        paragraph(&mut text, "  ", line);
    }
    for (k, finding) in facts.findings.iter().enumerate() {
        paragraph(&mut text, &format!("  {}. ", k + 1), &headline(finding));
    }
    if !facts.findings.is_empty() {
        paragraph(
            &mut text,
            "  ",
            "Where they come from and what to do: `ballbar diagnose`, or the report.",
        );
    }
    text
}

/// What it is with its numbers and its size.
pub(super) fn headline(finding: &FindingFacts) -> String {
    if finding.named {
        let size = format!("{} um rms of the residual", fixed(finding.rms_mm * UM, 3));
        let parts = [finding.in_words.as_str(), &size];
        let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        format!("{}: {}.", finding.title, parts.join("; "))
    } else {
        format!("{}: {}.", finding.title, finding.in_words)
    }
}

fn full(text: &mut String, number: usize, finding: &FindingFacts) {
    paragraph(text, &format!("  {number}. "), &headline(finding));
    for remark in &finding.remarks {
        paragraph(text, "     ", remark);
    }
    for sentence in others(finding) {
        paragraph(text, "     ", &sentence);
    }
    if !finding.owner.is_all() {
        paragraph(text, "     in           ", &finding.owner.to_string());
    }
    let parts = [
        ("     comes from   ", finding.source),
        ("     what to do   ", finding.remedy),
        ("     mistaken for ", finding.taken_for),
    ];
    for (lead, words) in parts.into_iter().filter(|(_, words)| !words.is_empty()) {
        paragraph(text, lead, words);
    }
    if !finding.named {
        paragraph(
            text,
            "     what to do   ",
            "no known cause explains it: inspect the machine there; the curve can join the model, marked as empirical",
        );
    }
    for effect in &finding.effects {
        paragraph(text, "     --hide       ", &shortened(effect));
    }
}

/// What else it could be, in sentences.
pub(super) fn others(finding: &FindingFacts) -> Vec<String> {
    let of = |separation: Separation| -> Vec<&Rival> {
        finding.rivals.iter().filter(|rival| rival.separation == separation).collect()
    };
    let names =
        |rivals: &[&Rival]| rivals.iter().map(|rival| rival.name()).collect::<Vec<_>>().join(", ");
    let mut told = Vec::new();
    let same = of(Separation::Same);
    if !same.is_empty() {
        told.push(format!(
            "Cannot be distinguished from {} with these runs: the readings would be the same.",
            names(&same)
        ));
    }
    let undecided = of(Separation::Undecided);
    if let Some(first) = undecided.first() {
        told.push(format!(
            "Not distinguished within the noise: {} (explains {} % of the same).",
            names(&undecided),
            percent_of(first)
        ));
    }
    if let Some(next) = of(Separation::Apart).first() {
        told.push(format!(
            "Next best: {} explains {} % of the same.",
            next.name(),
            percent_of(next)
        ));
    }
    told
}

fn percent_of(rival: &Rival) -> String {
    // One with more numbers may explain a little more, and is not named for that.
    fixed(100.0 * rival.share.clamp(0.0, 1.0), 1)
}

fn gains(facts: &DiagnosisFacts) -> String {
    let mut text = String::new();
    if facts.findings.is_empty() {
        return text;
    }
    text.push_str(if facts.foretold {
        "\nResidual of every run, with the effects as fitted to the other repeats, um rms\n"
    } else {
        "\nResidual, um rms\n"
    });
    // What repeats is known where a program ran twice.
    let known = facts.floors_known();
    let head = ["run", "before", "after", "not repeatable", "explained"];
    let shown = if known { head.len() } else { 3 };
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for run in &facts.runs {
        rows.push(vec![
            run.run.clone(),
            fixed(run.before_mm * UM, 3),
            fixed(run.after_mm * UM, 3),
            run.floor_mm.map_or("-".into(), |floor_mm| fixed(floor_mm * UM, 3)),
            run.explained.map_or("-".into(), |share| format!("{} %", percent(share))),
        ]);
    }
    for row in &mut rows {
        row.truncate(shown);
    }
    text.push_str(&table(&rows, "lrrrr"));
    if let Some(own) = facts.not_foretold() {
        paragraph(&mut text, "  ", &own);
    }
    if !facts.programs.is_empty() {
        text.push_str("\nPredicted from the runs of the other programs, um rms\n");
        let head = ["runs", "feed", "before", "after"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        for program in &facts.programs {
            rows.push(vec![
                program.runs.join(", "),
                format!("{} mm/min", fixed(program.feed_mm_min, 0)),
                fixed(program.before_mm * UM, 3),
                fixed(program.after_mm * UM, 3),
            ]);
        }
        text.push_str(&table(&rows, "lrrr"));
    }
    text
}

fn moved(facts: &DiagnosisFacts) -> String {
    if facts.moved.is_empty() {
        return String::new();
    }
    let mut text =
        String::from("\nCoefficients that change by more than their sigma with the effects\n");
    let head = ["name", "before", "after", "sigma", "unit"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for moved in &facts.moved {
        let unit = engineering(moved.unit);
        let of = |value: f64| value * unit.factor;
        let places = row_decimals(of(moved.after), Some(of(moved.sigma_after)));
        rows.push(vec![
            moved.name.clone(),
            fixed(of(moved.before), places),
            fixed(of(moved.after), places),
            fixed(of(moved.sigma_after), places),
            unit.plain.to_owned(),
        ]);
    }
    text.push_str(&table(&rows, "lrrrl"));
    text
}
