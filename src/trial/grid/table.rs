//! What the grid says, a line for each value of each factor.

use std::fmt::Write as _;

use super::by_stratum;
use crate::trial::class::Class;
use crate::trial::judge::Verdict;
use crate::trial::one::{OffBy, Outcome};
use crate::trial::rates::Rate;

/// What is asked of the outcomes of a class.
type Asked = (&'static str, Class, fn(&Outcome) -> bool, &'static str);

const ASKED: [Asked; 8] = [
    ("false alarm", Class::None, found, "at most 1 %"),
    ("cause right", Class::Single, right, "at least 95 %, of one run in a plane 90 %"),
    ("wrong cause", Class::Single, wrong, "at most 2 %"),
    ("wrong cause", Class::Small, wrong, "at most 2 %"),
    ("both right", Class::Two, right, "at least 85 %"),
    ("unexplained, right variable", Class::Outside, right, "at least 90 %"),
    ("wrong cause", Class::Outside, wrong, "at most 4 %"),
    ("failed", Class::None, failed, "none"),
];

fn found(outcome: &Outcome) -> bool {
    outcome.judgement.verdict == Verdict::FalseAlarm
}

fn right(outcome: &Outcome) -> bool {
    match outcome.class {
        Class::Outside => outcome.judgement.verdict == Verdict::Right,
        _ => matches!(outcome.judgement.verdict, Verdict::Right | Verdict::CauseOnly),
    }
}

fn wrong(outcome: &Outcome) -> bool {
    outcome.judgement.wrong_named > 0
}

fn failed(outcome: &Outcome) -> bool {
    outcome.judgement.verdict == Verdict::Failed
}

/// Rates for every value of every factor.
pub fn table(outcomes: &[Outcome]) -> String {
    let mut text = String::new();
    for (what, class, so, bound) in ASKED {
        let of_class: Vec<&Outcome> = outcomes.iter().filter(|o| o.class == class).collect();
        if of_class.is_empty() {
            continue;
        }
        let _ = writeln!(
            text,
            "{class}: {what}, {bound}\n  {:42} {}",
            "all",
            Rate::of(&of_class, |o| so(o))
        );
        for ((factor, value), trials) in by_stratum(outcomes) {
            let trials: Vec<&&Outcome> = trials.iter().filter(|o| o.class == class).collect();
            if !trials.is_empty() {
                let name = format!("{factor}: {value}");
                let _ = writeln!(text, "  {name:42} {}", Rate::of(&trials, |o| so(o)));
            }
        }
    }
    text.push_str(&numbers(outcomes));
    text
}

/// Kinds of numbers that people ask.
const KINDS: [&str; 4] = ["scale", "squareness", "reversal", "lateral play"];

/// How often what people ask was within two of its stated uncertainty, where nothing was hidden.
fn numbers(outcomes: &[Outcome]) -> String {
    let nothing = outcomes.iter().filter(|o| o.class == Class::None);
    let off: Vec<&OffBy> = nothing.clone().flat_map(|o| &o.off_by).collect();
    if off.is_empty() {
        return String::new();
    }
    let within = |off: &[&OffBy]| Rate::of(off, |off| off.alls.abs() <= 2.0);
    let mut text = format!(
        "none: numbers within two of their stated *all*, at least 95 %\n  {:42} {}\n",
        "all",
        within(&off)
    );
    for kind in KINDS {
        let of_kind: Vec<&OffBy> =
            off.iter().copied().filter(|off| off.name.starts_with(kind)).collect();
        let _ = writeln!(text, "  {kind:42} {}", within(&of_kind));
    }
    for ((factor, value), trials) in by_stratum(outcomes) {
        let nothing = trials.iter().filter(|o| o.class == Class::None);
        let off: Vec<&OffBy> = nothing.flat_map(|o| &o.off_by).collect();
        let _ = writeln!(text, "  {:42} {}", format!("{factor}: {value}"), within(&off));
    }
    text
}
