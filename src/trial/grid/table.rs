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
        for ((factor, value), trials) in by_stratum(&of_class) {
            let name = format!("{factor}: {value}");
            let _ = writeln!(text, "  {name:42} {}", Rate::of(&trials, |o| so(o)));
        }
    }
    text.push_str(&numbers(outcomes));
    text
}

/// Kinds of numbers that people ask.
const KINDS: [&str; 4] = ["scale", "squareness", "reversal", "lateral play"];

/// Where *all* is more than so many times *noise*, a report says what else could have been taken for it.
const TOLD: f64 = 3.0;
/// Of an error that is normal with the deviation *all*, as many lie within two of *noise* as of a normal deviate within two of
/// *noise* over *all*: 95 % only where *all* is no more than 2 over 1.96 times *noise*, and 50 % where it is three times.
const NOISE_ALONE: f64 = 2.0 / 1.96;

/// By which of its uncertainties a number is judged: its name, which numbers, and how many of it the number is off.
type By = (&'static str, fn(&OffBy) -> bool, fn(&OffBy) -> f64);

const BY: [By; 3] = [
    ("*all*", |_| true, |off| off.alls.abs()),
    ("*noise*, of those of which *all* is no more than three times it", told, |off| {
        off.noises.abs()
    }),
    ("*noise*, of those of which *all* is no more than 2 % more", noise_alone, |off| {
        off.noises.abs()
    }),
];

fn told(off: &OffBy) -> bool {
    off.noises.abs() <= TOLD * off.alls.abs()
}

fn noise_alone(off: &OffBy) -> bool {
    off.noises.abs() <= NOISE_ALONE * off.alls.abs()
}

/// How often what people ask was within two of its stated uncertainty.
fn numbers(outcomes: &[Outcome]) -> String {
    let mut text = String::new();
    let hidden = |o: &&Outcome| o.class == Class::None;
    for (what, nothing) in [("nothing hidden", true), ("something hidden", false)] {
        let of: Vec<&Outcome> = outcomes.iter().filter(|o| hidden(o) == nothing).collect();
        for (name, counts, off_by) in BY {
            let within = |trials: &[&Outcome], kind: &str| {
                let off: Vec<&OffBy> = trials
                    .iter()
                    .flat_map(|o| &o.off_by)
                    .filter(|off| counts(off) && off.name.starts_with(kind))
                    .collect();
                Rate::of(&off, |off| off_by(off) <= 2.0)
            };
            let all = within(&of, "");
            if all.of == 0 {
                continue;
            }
            let _ = writeln!(text, "{what}: numbers within two of {name}, at least 95 %");
            let _ = writeln!(text, "  {:42} {all}", "all");
            for kind in KINDS {
                let _ = writeln!(text, "  {kind:42} {}", within(&of, kind));
            }
            for ((factor, value), trials) in by_stratum(&of) {
                let name = format!("{factor}: {value}");
                let _ = writeln!(text, "  {name:42} {}", within(&trials, ""));
            }
        }
    }
    text
}
