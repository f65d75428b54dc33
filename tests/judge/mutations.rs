//! Programs with one fault: what the judge calls dangerous, `check` calls an error; what is harmless, it lets pass.

use std::collections::{BTreeMap, BTreeSet};

use ballbar::machine::Dialect;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::faults::{Fault, put};
use crate::power::Unstated;
use crate::programs::{Program, errors, programs};
use crate::verdict::{From, Verdict, judge};

/// Errors of what stands in the file, of feeds, and of what leaves nothing to analyse: they have nothing to do with what
/// becomes of the bar, and are no false alarms where the path is harmless.
const OTHER_FAMILIES: [&str; 5] =
    ["characters", "percent", "block-number", "inside-arc", "engagement"];

/// How the two agree on one program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Agreement {
    DangerousAndError,
    /// Dangerous only where an option of the control was left on, and told by a warning.
    DangerousByOptionAndWarned,
    DangerousAndPassed,
    TooFastAndError,
    TooFastAndPassed,
    RefusedAndError,
    RefusedAndPassed,
    HarmlessAndPassed,
    /// Harmless to the bar, and an error of another family.
    HarmlessAndOtherError,
    HarmlessAndError,
    /// Neither dangerous nor harmless: it depends on what was left in force, is no test any more, or two angles of the
    /// release would say different things.
    Between,
}

impl Agreement {
    fn is_quarrel(self) -> bool {
        matches!(
            self,
            Self::DangerousAndPassed
                | Self::TooFastAndPassed
                | Self::RefusedAndPassed
                | Self::HarmlessAndError
        )
    }
}

struct Trial {
    fault: Fault,
    dialect: Dialect,
    agreement: Agreement,
    /// What the two said, and where.
    told: String,
}

fn by_option(verdict: &Verdict) -> bool {
    let option = |from: &From| matches!(from, From::Left(group) if group.is_option());
    verdict.harms.iter().all(|(from, _)| option(from))
}

fn agreement(verdict: &Verdict, errors: &[&'static str], warnings: &[&'static str]) -> Agreement {
    let error = !errors.is_empty();
    let dangerous = verdict.danger().is_some();
    if verdict.refused.is_some() {
        return if error { Agreement::RefusedAndError } else { Agreement::RefusedAndPassed };
    }
    match (dangerous, error) {
        (true, true) => return Agreement::DangerousAndError,
        (true, false) if by_option(verdict) && warnings.contains(&"power-on") => {
            return Agreement::DangerousByOptionAndWarned;
        }
        (true, false) => return Agreement::DangerousAndPassed,
        _ => {}
    }
    if verdict.too_fast() {
        return if error { Agreement::TooFastAndError } else { Agreement::TooFastAndPassed };
    }
    if !verdict.is_harmless() {
        return Agreement::Between;
    }
    let other = errors.iter().all(|rule| OTHER_FAMILIES.contains(rule));
    match (error, other) {
        (false, _) => Agreement::HarmlessAndPassed,
        (true, true) => Agreement::HarmlessAndOtherError,
        (true, false) => Agreement::HarmlessAndError,
    }
}

/// One program with one fault, drawn by its number.
fn trial(programs: &[Program], number: u64) -> Trial {
    let mut random = Pcg64Mcg::seed_from_u64(0x0bad_ba11_0000_0000 + number);
    loop {
        let program = &programs[random.random_range(0..programs.len())];
        let fault = Fault::ALL[random.random_range(0..Fault::ALL.len())];
        let Some((text, line)) = put(fault, &program.text, program.setting.dialect, &mut random)
        else {
            continue;
        };
        let places = program.setting.places();
        let verdict = judge(&text, &program.setting, &places);
        let checked = program.check(&text);
        let errors = errors(&checked);
        let warnings: Vec<&'static str> =
            checked.iter().flat_map(|c| c.findings.iter().map(|finding| finding.rule)).collect();
        let agreement = agreement(&verdict, &errors, &warnings);
        let rules = if errors.is_empty() { &warnings } else { &errors };
        let judged = match (&verdict.refused, verdict.harms.first()) {
            (Some(refused), _) => format!("refused, {}", refused.what),
            (None, Some((from, harmful))) => format!("{:?} {from:?}", harmful.harm),
            (None, None) => format!("{:?}", verdict.depends),
        };
        let told = format!("{judged} | {rules:?}");
        let place = || {
            let after = text.lines().nth(line - 1).unwrap_or("");
            let before = program.text.lines().nth(line - 1).unwrap_or("");
            let found = checked.iter().flat_map(|c| c.findings.iter().map(ToString::to_string));
            let harms = verdict.harms.iter().map(|harm| format!("{harm:?}"));
            let all: Vec<String> = harms.chain(found.take(3)).collect();
            format!(
                "\n  {number} {} line {line}: {before} -> {after}\n{}",
                program.name,
                all.join("\n")
            )
        };
        let told = if agreement.is_quarrel() { told + &place() } else { told };
        return Trial { fault, dialect: program.setting.dialect, agreement, told };
    }
}

fn trials(count: u64) -> Vec<Trial> {
    let programs = programs();
    for program in &programs {
        let verdict = judge(&program.text, &program.setting, &program.setting.places());
        assert!(verdict.is_harmless(), "{}: {verdict:?}", program.name);
        assert_eq!(errors(&program.check(&program.text)), Vec::<&str>::new(), "{}", program.name);
    }
    (0..count).into_par_iter().map(|number| trial(&programs, number)).collect()
}

/// Prints the counts and returns the quarrels.
fn told(trials: &[Trial]) -> Vec<String> {
    let mut counts: BTreeMap<Agreement, usize> = BTreeMap::new();
    let mut classes: BTreeMap<(Agreement, &str), Vec<&Trial>> = BTreeMap::new();
    for trial in trials {
        *counts.entry(trial.agreement).or_default() += 1;
        let class = trial.told.lines().next().unwrap_or("");
        classes.entry((trial.agreement, class)).or_default().push(trial);
    }
    println!("{} programs with one fault; of {:?}", trials.len(), Dialect::ALL.map(Dialect::name));
    for (agreement, count) in &counts {
        let of = Dialect::ALL.map(|dialect| {
            let those = trials.iter().filter(|trial| trial.agreement == *agreement);
            those.filter(|trial| trial.dialect == dialect).count()
        });
        println!("{count:6} {agreement:?} {of:?}");
    }
    let quarrels = classes.iter().filter(|((agreement, _), _)| agreement.is_quarrel());
    quarrels
        .map(|((agreement, _), trials)| {
            let faults: BTreeSet<Fault> = trials.iter().map(|trial| trial.fault).collect();
            format!("{} x {agreement:?} by {faults:?}: {}", trials.len(), trials[0].told)
        })
        .collect()
}

fn must_agree(count: u64) {
    let trials = trials(count);
    let quarrels = told(&trials);
    assert!(quarrels.is_empty(), "{} classes\n{}", quarrels.len(), quarrels.join("\n\n"));
    let of = |agreement| trials.iter().filter(|trial| trial.agreement == agreement).count() as u64;
    // The faults are worth their name, and so is the other side.
    assert!(of(Agreement::DangerousAndError) > count / 5);
    assert!(of(Agreement::HarmlessAndPassed) > count / 20);
}

#[test]
fn one_fault_is_an_error_if_it_is_dangerous_and_none_if_it_is_harmless() {
    must_agree(1000);
}

/// `BALLBAR_FAULTS=1000000 cargo test --release --test judge -- --ignored --nocapture` for a long run.
#[test]
#[ignore = "half a minute: twenty thousand programs"]
fn twenty_thousand_faults_are_judged_alike() {
    let count = std::env::var("BALLBAR_FAULTS").ok().and_then(|count| count.parse().ok());
    must_agree(count.unwrap_or(20_000));
}

/// What options leave on is told by a warning, because a control without them refuses the words.
#[test]
fn only_what_some_controls_do_not_have_is_an_option() {
    let options = [Unstated::Rotation, Unstated::Polar, Unstated::Scaling];
    assert!(options.iter().all(|group| group.is_option()));
    assert!(![Unstated::Unit, Unstated::Plane, Unstated::Length].iter().any(|g| g.is_option()));
}
