//! The summary of a plan for the terminal.

use std::fmt::Write as _;

use super::facts::{PlanReport, TestOutlook};
use super::unseen::{Group, groups};
use super::words::{STEP, assumed, clearances, heading, not_separated, under_title};
use super::{rows, verdict, words};
use crate::report::text::layout::{WIDTH, paragraph, table};
use crate::report::text::numbers::many;

/// So many lines of what a test cannot tell are shown unless all are wanted.
const MOST_UNSEEN: usize = 14;
/// Names of mountings are cut to so many letters in tables, those of tests to so many.
const LONGEST_NAME: usize = 14;
const LONGEST_TEST: usize = 26;

/// What the tests are, take and will tell; several of them side by side, each by itself if `all`, which
/// also lists every term that they cannot tell.
pub fn plan_summary(plan: &PlanReport, all: bool) -> String {
    let mut text = String::new();
    let several = plan.tests.len() > 1;
    if several {
        side_by_side(&mut text, plan);
    }
    for (k, test) in plan.tests.iter().enumerate() {
        if several && !all {
            if !test.cautions.is_empty() {
                let _ = writeln!(text, "\n{}", test.name);
                list(&mut text, &test.cautions);
            }
            continue;
        }
        if k > 0 || several {
            text.push('\n');
        }
        one(&mut text, test, plan.repeats, all);
    }
    if several && !all {
        text.push_str("\nEach test by itself: plan.html, or `--all`.\n");
    }
    text
}

fn side_by_side(text: &mut String, plan: &PlanReport) {
    text.push_str("Side by side");
    if plan.repeats > 1 {
        let _ = write!(text, " (each {} times; sigma of the mean)", plan.repeats);
    }
    text.push('\n');
    let rows: Vec<rows::Row> = rows::side_by_side(plan)
        .into_iter()
        .map(|row| row.iter().map(|cell| cut(cell, LONGEST_TEST)).collect())
        .collect();
    // As many tests at a time as fit.
    let width =
        |k: usize| rows.iter().filter_map(move |row| row.get(k)).map(|c| c.chars().count() + 2);
    let width = |k: usize| width(k).max().unwrap_or(0);
    let mut first = 1;
    while first <= plan.tests.len() {
        let mut end = first + 1;
        while end <= plan.tests.len() && width(0) + (first..=end).map(width).sum::<usize>() <= WIDTH
        {
            end += 1;
        }
        let part: Vec<rows::Row> =
            rows.iter().map(|row| [&row[..1], &row[first..end]].concat()).collect();
        if first > 1 {
            text.push('\n');
        }
        text.push_str(&table(&part, &format!("l{}", "r".repeat(end - first))));
        first = end;
    }
}

fn one(text: &mut String, test: &TestOutlook, repeats: u32, all: bool) {
    paragraph(text, "", &test.name);
    paragraph(text, "", &under_title(test));
    text.push('\n');
    for line in verdict::of(test, repeats) {
        paragraph(text, "", &line);
    }
    if !test.cautions.is_empty() {
        text.push_str("\nCautions\n");
        list(text, &test.cautions);
    }
    text.push_str("\nMountings\n");
    text.push_str(&table(&narrow(rows::mountings(test)), "lllrrrrrr"));
    for line in clearances(test) {
        paragraph(text, "  ", &line);
    }
    text.push_str("\nTravel, mm (used by the path, and what is left to the nearer limit)\n");
    text.push_str(&table(&narrow(rows::travel(test)), "lrrrrrr"));
    text.push_str("\nTime, min:s\n");
    text.push_str(&table(&narrow(rows::time(test, repeats)), "lrrrrrrrrr"));
    paragraph(text, "  ", &assumed(test, repeats));
    if !test.at_the_place.is_empty() {
        text.push_str("\nWhat it will know of the machine at its place\n");
        let sides = if repeats > 1 { "lrrrl" } else { "lrrl" };
        text.push_str(&table(&rows::at_the_place(test, repeats), sides));
        paragraph(text, "  ", words::BOTH);
        for line in words::looks_like(test) {
            paragraph(text, "  - ", &line);
        }
    }
    text.push_str("\nWhat it will determine\n");
    let sides = if repeats > 1 { "llrrl" } else { "llrl" };
    text.push_str(&table(&rows::machine_errors(test, repeats), sides));
    paragraph(text, "  ", STEP);
    text.push_str("\nCoefficients and set-up errors\n");
    let coefficients = narrow(rows::parameters(test, repeats, false));
    text.push_str(&beside(&coefficients, if repeats > 1 { "lrrl" } else { "lrl" }));
    unseen(text, test, all);
}

fn list(text: &mut String, lines: &[String]) {
    for line in lines {
        paragraph(text, "  - ", line);
    }
}

/// The same table with its first column cut: a table cannot be filled into lines.
fn narrow(mut rows: Vec<rows::Row>) -> Vec<rows::Row> {
    for name in rows.iter_mut().filter_map(|row| row.first_mut()) {
        *name = cut(name, LONGEST_NAME);
    }
    rows
}

fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let begin: String = text.chars().take(most - 2).collect();
    format!("{}..", begin.trim_end())
}

/// A long table in two halves side by side, each with its head.
fn beside(all: &[rows::Row], sides: &str) -> String {
    let Some((head, body)) = all.split_first() else { return String::new() };
    let half = body.len().div_ceil(2);
    let mut both = vec![[head.as_slice(), &["  ".to_owned()], head].concat()];
    for k in 0..half {
        let mut row = body[k].clone();
        row.push("  ".into());
        row.extend(body.get(half + k).cloned().unwrap_or_default());
        both.push(row);
    }
    table(&both, &format!("{sides}l{sides}"))
}

fn unseen(text: &mut String, test: &TestOutlook, all: bool) {
    if test.unseen.is_empty() {
        return;
    }
    let _ = writeln!(text, "\nWhat it cannot distinguish ({})", many(test.unseen.len(), "term"));
    let groups = groups(&test.unseen);
    if all {
        for group in &groups {
            paragraph(text, "  ", &format!("{}:", heading(&group.what)));
            for term in &group.terms {
                paragraph(text, "    ", &term.reason);
            }
        }
        return;
    }
    // First what is in each group, then, as far as there is room, the simplest sentence of each.
    let mut told: Vec<String> = Vec::new();
    let mut lines = 0;
    let mut untold = 0;
    let mut fits = |words: String| {
        lines += words.lines().count();
        let fits = lines <= MOST_UNSEEN;
        if !fits {
            lines -= words.lines().count();
        }
        fits.then_some(words)
    };
    let filled = |lead: &str, words: &str| {
        let mut text = String::new();
        paragraph(&mut text, lead, words);
        text
    };
    let (nothing, remedied): (Vec<&Group<'_>>, Vec<&Group<'_>>) =
        groups.iter().partition(|group| group.what.is_empty());
    let names = |group: &Group<'_>| -> String {
        let names: Vec<&str> = group.terms.iter().map(|term| term.name.as_str()).collect();
        format!("{}: {}", heading(&group.what), names.join(" "))
    };
    let last = nothing.first().map(|group| filled("  ", &not_separated(group.terms.len())));
    let last = last.and_then(&mut fits);
    let mut kept: Vec<&Group<'_>> = Vec::new();
    for group in remedied {
        match fits(filled("  ", &names(group))) {
            Some(words) => {
                told.push(words);
                kept.push(group);
            }
            None => untold += group.terms.len(),
        }
    }
    for (group, words) in kept.iter().zip(&mut told) {
        let simplest = group.terms.iter().map(|term| &term.reason).min_by_key(|r| r.len());
        let example = simplest.and_then(|reason| fits(filled("    such as ", reason)));
        words.push_str(&example.unwrap_or_default());
    }
    text.push_str(&told.concat());
    if untold > 0 {
        let _ = writeln!(text, "  and {}: see plan.html, or `--all`", many(untold, "more term"));
    }
    text.push_str(&last.unwrap_or_default());
}
