//! What many trials say, as text.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::class::Class;
use super::draw::{drawn, outside};
use super::judge::Verdict;
use super::one::Outcome;
use super::rates::Rate;

/// A requirement: what, of which class, how often at the least or at the most.
type Requirement = (&'static str, Class, fn(&Outcome) -> bool, f64, bool);

fn cause_right(outcome: &Outcome) -> bool {
    matches!(outcome.judgement.verdict, Verdict::Right | Verdict::CauseOnly)
}

fn right(outcome: &Outcome) -> bool {
    outcome.judgement.verdict == Verdict::Right
}

fn wrong_named(outcome: &Outcome) -> bool {
    outcome.judgement.wrong_named > 0
}

fn found(outcome: &Outcome) -> bool {
    !outcome.judgement.found.is_empty()
}

const REQUIREMENTS: [Requirement; 9] = [
    ("cause right", Class::Single, cause_right, 0.95, true),
    ("cause, axis and function right", Class::Single, right, 0.90, true),
    ("cause right", Class::Small, cause_right, 0.70, true),
    ("a wrong cause named", Class::Small, wrong_named, 0.03, false),
    ("false alarm", Class::None, found, 0.02, false),
    ("both causes right", Class::Two, cause_right, 0.85, true),
    ("both, axis and function too", Class::Two, right, 0.0, true),
    ("unexplained, right variable", Class::Outside, right, 0.90, true),
    ("a wrong cause named", Class::Outside, wrong_named, 0.05, false),
];

/// Rates against what is required, detection against size, what is taken for what.
pub fn table(outcomes: &[Outcome], noise_mm: f64) -> String {
    let mut text = String::from("What came out, with the 95 % interval of the rate\n");
    let of = |class: Class| outcomes.iter().filter(|o| o.class == class).collect::<Vec<_>>();
    for (what, class, so, limit, at_least) in REQUIREMENTS {
        let trials = of(class);
        if trials.is_empty() {
            continue;
        }
        let rate = Rate::of(&trials, |outcome| so(outcome));
        let kept = if at_least { rate.share() >= limit } else { rate.share() <= limit };
        let goal = match (at_least, limit > 0.0) {
            (_, false) => String::new(),
            (true, _) => format!(", at least {:.0} %", 100.0 * limit),
            (false, _) => format!(", at most {:.0} %", 100.0 * limit),
        };
        let mark = if kept { "" } else { "  <- not reached" };
        let _ = writeln!(text, "  {:8} {what:31} {rate}{goal}{mark}", class.name());
    }
    for class in [Class::Single, Class::Small, Class::Two] {
        let trials = of(class);
        if trials.is_empty() {
            continue;
        }
        let verdicts = [
            Verdict::Right,
            Verdict::CauseOnly,
            Verdict::Partly,
            Verdict::Unexplained,
            Verdict::Wrong,
            Verdict::Nothing,
            Verdict::Failed,
        ];
        let counts = verdicts.iter().filter_map(|verdict| {
            let count = trials.iter().filter(|o| o.judgement.verdict == *verdict).count();
            (count > 0).then(|| format!("{count} {}", verdict.name()))
        });
        let counts: Vec<String> = counts.collect();
        let beside = trials.iter().filter(|o| cause_right(o) && wrong_named(o)).count();
        let _ = writeln!(
            text,
            "  {:8} {}; {beside} with a wrong cause beside the right one",
            class.name(),
            counts.join(", ")
        );
    }
    text.push_str(&against_size(outcomes, noise_mm));
    for class in Class::ALL {
        text.push_str(&confusion(class, &of(class)));
    }
    text.push_str(&times(outcomes));
    text
}

/// Detection rate against size in units of the noise.
fn against_size(outcomes: &[Outcome], noise_mm: f64) -> String {
    let mut sizes: BTreeMap<u64, Vec<&Outcome>> = BTreeMap::new();
    for outcome in outcomes {
        if matches!(outcome.class, Class::Single | Class::Small | Class::Sizes) {
            let tenths = (outcome.size_mm / noise_mm * 10.0).round() as u64;
            sizes.entry(tenths).or_default().push(outcome);
        }
    }
    if sizes.is_empty() {
        return String::new();
    }
    let mut text =
        String::from("\nOne effect, against its size in units of the noise, % of trials\n");
    let _ = writeln!(
        text,
        "  {:>5} {:>7} {:>6} {:>12} {:>11} {:>12} {:>8}",
        "size", "trials", "found", "cause right", "seat right", "wrong cause", "nothing"
    );
    for (tenths, trials) in sizes {
        let share = |so: fn(&Outcome) -> bool| 100.0 * Rate::of(&trials, |o| so(o)).share();
        let _ = writeln!(
            text,
            "  {:>5.1} {:>7} {:>6.1} {:>12.1} {:>11.1} {:>12.1} {:>8.1}",
            tenths as f64 / 10.0,
            trials.len(),
            share(found),
            share(cause_right),
            share(right),
            share(wrong_named),
            share(|o| !found(o)),
        );
    }
    text
}

/// Which hidden cause is named as which.
fn confusion(class: Class, trials: &[&Outcome]) -> String {
    let mut counts: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let drawn = drawn().into_iter().map(|cause| cause.id);
    let rows: Vec<&str> = drawn.clone().chain(outside().into_iter().map(|c| c.id)).collect();
    let columns: Vec<&str> =
        drawn.chain(["bar-length", "coefficient", "other", "unexplained", "nothing"]).collect();
    for trial in trials {
        for (effect, _) in &trial.hidden {
            let Some(row) = rows.iter().position(|id| *id == effect.cause.id) else { continue };
            let found = &trial.judgement.found;
            // Of several findings the one that is right about it, else the largest.
            let own = found.iter().find(|f| f.right && f.cause == Some(effect.cause.id));
            let named =
                own.or(found.first()).map_or("nothing", |f| f.cause.unwrap_or("unexplained"));
            let other = columns.len() - 3;
            let column = columns.iter().position(|id| *id == named).unwrap_or(other);
            *counts.entry((row, column)).or_default() += 1;
        }
    }
    let used: Vec<usize> =
        (0..columns.len()).filter(|c| counts.keys().any(|(_, column)| column == c)).collect();
    if used.is_empty() {
        return String::new();
    }
    let mut text = format!("\nHidden (down) and found (across), class {class}\n  {:18}", "");
    for (letter, _) in ('a'..).zip(&used) {
        let _ = write!(text, "{letter:>4}");
    }
    text.push('\n');
    for (row, name) in rows.iter().enumerate() {
        if !counts.keys().any(|(of, _)| *of == row) {
            continue;
        }
        let _ = write!(text, "  {name:18}");
        for column in &used {
            match counts.get(&(row, *column)) {
                Some(count) => _ = write!(text, "{count:>4}"),
                None => text.push_str("   ."),
            }
        }
        text.push('\n');
    }
    let legend: Vec<String> =
        ('a'..).zip(&used).map(|(letter, c)| format!("{letter} {}", columns[*c])).collect();
    let _ = writeln!(text, "  {}", legend.join(", "));
    text
}

fn times(outcomes: &[Outcome]) -> String {
    let mean = |of: fn(&Outcome) -> f64| {
        outcomes.iter().map(of).sum::<f64>() / outcomes.len().max(1) as f64
    };
    let longest = outcomes.iter().map(|o| o.seconds.diagnose_s).fold(0.0, f64::max);
    format!(
        "\n{} trials; a mean one took {:.1} s to simulate, {:.1} s to align and identify, {:.1} s to diagnose (at most {longest:.1} s) on one thread\n",
        outcomes.len(),
        mean(|o| o.seconds.simulate_s),
        mean(|o| o.seconds.identify_s),
        mean(|o| o.seconds.diagnose_s)
    )
}
