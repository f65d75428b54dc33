//! Tests drawn at random: what is written passes the judge, from anywhere, again, and after one another.

use std::collections::BTreeMap;

use ballbar::machine::Machine;
use ballbar::plan::Test;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::drawn;
use crate::path::Point;
use crate::power::PowerOn;
use crate::programs::Program;
use crate::verdict::{judge, stations};
use crate::walk::Bar;

/// Tests of one machine that are driven after one another.
const AFTER_ONE_ANOTHER: u64 = 5;
/// A reset stops a program at so many places.
const RESETS: usize = 40;

/// What became of the tests of one machine.
#[derive(Debug, Default)]
struct Outcome {
    tests: usize,
    written: usize,
    programs: BTreeMap<&'static str, usize>,
    blocks: usize,
    sequences: usize,
    refused: BTreeMap<String, usize>,
    failed: Vec<String>,
}

/// A message without its figures and names.
fn kind(told: &str) -> String {
    let words = told.split_whitespace();
    let plain = |word: &&str| !word.contains(|c: char| c.is_ascii_digit() || c == '`');
    words.filter(plain).collect::<Vec<_>>().join(" ")
}

/// Draws a machine and its tests, writes their programs and judges them.
fn drive(number: u64) -> Outcome {
    let mut random = Pcg64Mcg::seed_from_u64(0x7e57_ba11_0000_0000 + number);
    let mut outcome = Outcome::default();
    let (source, travel_mm) = drawn::machine(&mut random);
    let machine = Machine::parse(&source, "m.toml".as_ref());
    let machine = machine.unwrap_or_else(|error| panic!("{error}\n{source}"));
    let mut programs: Vec<(Program, String)> = Vec::new();
    for _ in 0..AFTER_ONE_ANOTHER {
        outcome.tests += 1;
        let source = drawn::test(&mut random, &travel_mm, machine.controller().dialect);
        let test = match Test::parse(&source, "t.toml".as_ref()) {
            Ok(test) => test,
            Err(error) => {
                *outcome.refused.entry(kind(&error.what)).or_default() += 1;
                continue;
            }
        };
        // One mounting that is refused refuses the test.
        let written: Result<Vec<Program>, String> = (0..test.mountings().len())
            .map(|mounting| Program::written(&test, &machine, mounting))
            .collect();
        match written {
            Ok(written) => {
                outcome.written += 1;
                programs.extend(written.into_iter().map(|program| (program, source.clone())));
            }
            Err(told) => *outcome.refused.entry(kind(&told)).or_default() += 1,
        }
    }
    let ends: Vec<Point> = programs
        .iter()
        .filter_map(|(program, _)| judge(&program.text, &program.setting, &[]).end)
        .filter(|(_, bar)| *bar == Bar::Off)
        .map(|(end_mm, _)| end_mm)
        .collect();
    if ends.len() < programs.len() {
        outcome.failed.push(format!("machine {number}: a program ends with the bar in"));
    }
    for (program, test) in &programs {
        outcome.blocks += program.text.lines().count();
        outcome.sequences += ends.len();
        *outcome.programs.entry(program.setting.dialect.name()).or_default() += 1;
        let mut places = program.setting.places();
        places.extend(&ends);
        places.extend(stations(&program.text, &program.setting, &PowerOn::default(), RESETS));
        let verdict = judge(&program.text, &program.setting, &places);
        if !verdict.is_harmless() {
            outcome.failed.push(format!("{}: {verdict:?}\n{source}\n{test}", program.name));
        }
    }
    outcome
}

fn all_pass(tests: u64) {
    let outcomes: Vec<Outcome> =
        (0..tests / AFTER_ONE_ANOTHER).into_par_iter().map(drive).collect();
    let mut all = Outcome::default();
    for outcome in outcomes {
        all.tests += outcome.tests;
        all.written += outcome.written;
        all.blocks += outcome.blocks;
        all.sequences += outcome.sequences;
        all.failed.extend(outcome.failed);
        for (dialect, count) in outcome.programs {
            *all.programs.entry(dialect).or_default() += count;
        }
        for (kind, count) in outcome.refused {
            *all.refused.entry(kind).or_default() += count;
        }
    }
    let Outcome { tests, written, programs, blocks, sequences, refused, failed } = all;
    println!(
        "{tests} tests, {written} written as {programs:?} with {blocks} lines, judged in {sequences} sequences; refused:"
    );
    for (kind, count) in &refused {
        println!("{count:6} {kind}");
    }
    assert!(
        failed.is_empty(),
        "{} programs\n{}",
        failed.len(),
        failed[..failed.len().min(5)].join("\n\n")
    );
    assert!(written * 4 > tests, "most tests were refused");
}

#[test]
fn every_test_that_is_written_passes_the_judge() {
    all_pass(150);
}

#[test]
#[ignore = "a minute: five thousand tests, of which nearly half are written"]
fn two_thousand_tests_that_are_written_pass_the_judge() {
    all_pass(5000);
}
