//! All analyses of a machine in the order of their days.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use jiff::civil::Date;

use super::chance::exceeded_by_chance;
use super::circumstances::Circumstances;
use super::past::Past;
use super::quantity::{Kind, Quantity};
use super::series::{Point, Series, Trend};
use crate::error::Error;

/// A machine over time.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Name of the machine.
    pub machine: String,
    /// Its tests in the order of their days.
    pub tests: Vec<(Date, Past)>,
    /// What can be followed, in the order in which tests tell it.
    pub series: Vec<Series>,
    /// What is not in it, with the reason.
    pub left_out: Vec<LeftOut>,
}

/// A test of a history.
type Test = (Date, Past);

/// A file that is not in a history.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// The file.
    pub file: PathBuf,
    /// Why, with what to do about it where there is something.
    pub reason: String,
}

impl History {
    /// Of files that were read, those of the machine of this name, or of the one that has most tests.
    ///
    /// `None` where no file is an analysis with a day.
    pub fn of(
        read: Vec<(PathBuf, Result<Past, Error>)>,
        machine: Option<&str>,
    ) -> (Option<Self>, Vec<LeftOut>) {
        let mut left_out = Vec::new();
        let mut dated: Vec<Test> = Vec::new();
        for (file, past) in read {
            match past {
                Ok(past) => match past.day.or_else(|| day_of_folder(&file)) {
                    Some(day) => dated.push((day, past)),
                    None => left_out.push(LeftOut {
                        file,
                        reason: "nothing says its day: write `date` under `[record]` in the test file and analyse it again, or name its folder after the day, such as 2026-11-23".into(),
                    }),
                },
                Err(error) => {
                    let line = error.place.as_ref().filter(|place| place.line > 0).map(|place| format!(" (line {})", place.line));
                    let hint = error.hint.map(|hint| format!(": {hint}")).unwrap_or_default();
                    left_out.push(LeftOut { file, reason: format!("{}{}{hint}", error.what, line.unwrap_or_default()) });
                }
            }
        }
        dated.sort_by(|(day, a), (other, b)| day.cmp(other).then_with(|| a.file.cmp(&b.file)));
        let Some(chosen) = chosen(&dated, machine) else { return (None, left_out) };
        let (of_it, others): (Vec<Test>, Vec<Test>) =
            dated.into_iter().partition(|(_, past)| past.machine_key() == chosen);
        let name = of_it.first().map_or_else(String::new, |(_, past)| past.machine.clone());
        for (_, past) in others {
            let serial =
                past.machine_serial.as_ref().map(|serial| format!(", serial number {serial}"));
            let reason = format!(
                "of another machine: `{}`{} ({}); `--machine` chooses it",
                past.machine,
                serial.unwrap_or_default(),
                past.kinematics
            );
            left_out.push(LeftOut { file: past.file, reason });
        }
        let tests = once(of_it, &mut left_out);
        left_out.sort_by(|a, b| a.file.cmp(&b.file));
        let kinds = kinds(&tests);
        let series = series(&tests, &kinds);
        (Some(Self { machine: name, tests, series, left_out: left_out.clone() }), left_out)
    }
}

/// The machine of this name, or that with most tests, of two the one that was tested last.
fn chosen(dated: &[Test], machine: Option<&str>) -> Option<String> {
    let mut machines: BTreeMap<String, (usize, Date)> = BTreeMap::new();
    for (day, past) in dated {
        let named = machine.is_none_or(|machine| {
            past.machine == machine || past.machine_serial.as_deref() == Some(machine)
        });
        if named {
            let entry = machines.entry(past.machine_key()).or_insert((0, *day));
            *entry = (entry.0 + 1, entry.1.max(*day));
        }
    }
    machines.into_iter().max_by_key(|(_, most)| *most).map(|(key, _)| key)
}

/// Each measurement once: of analyses of the same readings the last in the order of the files.
fn once(tests: Vec<Test>, left_out: &mut Vec<LeftOut>) -> Vec<Test> {
    let mut kept: Vec<Test> = Vec::new();
    for (day, past) in tests {
        let same = kept.iter_mut().find(|(_, other)| {
            past.readings_sha256.is_some() && other.readings_sha256 == past.readings_sha256
        });
        let Some(same) = same else {
            kept.push((day, past));
            continue;
        };
        let earlier = std::mem::replace(same, (day, past));
        left_out.push(LeftOut {
            file: earlier.1.file,
            reason: format!("the same readings as {}, and counted once", same.1.file.display()),
        });
    }
    kept
}

/// For each test the first that it is equal to, itself if there is none before it.
fn kinds(tests: &[Test]) -> Vec<usize> {
    let mut firsts: Vec<usize> = Vec::new();
    let kind = |(index, (_, past)): (usize, &Test)| {
        let first = firsts.iter().find(|&&first| Circumstances::of(&tests[first].1, past).equal);
        first.copied().unwrap_or_else(|| {
            firsts.push(index);
            index
        })
    };
    tests.iter().enumerate().map(kind).collect()
}

fn series(tests: &[Test], kinds: &[usize]) -> Vec<Series> {
    let mut all: Vec<Series> = Vec::new();
    for (index, (day, past)) in tests.iter().enumerate() {
        let (first, like) = (&tests[0].1, &tests[kinds[index]]);
        let elsewhere = (!Circumstances::of(first, &like.1).same_place).then_some(like.0);
        for quantity in &past.quantities {
            let point = Point {
                test: index,
                day: *day,
                kind: kinds[index],
                value: quantity.value,
                // Ranges move with the set-up by more than the noise.
                noise: if quantity.kind == Kind::Range { quantity.all } else { quantity.noise },
                all: quantity.all.or(quantity.noise),
                plausible: quantity.plausible,
            };
            let name = name_in(quantity, elsewhere);
            match all.iter_mut().find(|series| series.name == name && series.unit == quantity.unit)
            {
                Some(series) => series.points.push(point),
                None => all.push(Series {
                    name,
                    unit: quantity.unit.clone(),
                    points: vec![point],
                    trend: None,
                }),
            }
        }
    }
    let beyond = exceeded_by_chance(all.len());
    for series in &mut all {
        series.trend = Trend::through(&series.points, beyond);
    }
    Series::judge_all(&mut all);
    all
}

/// Ranges and circular values are of their place: tests elsewhere have series of their own.
fn name_in(quantity: &Quantity, elsewhere: Option<Date>) -> String {
    match (quantity.kind, elsewhere) {
        (Kind::Range | Kind::Circular(..), Some(day)) => format!("{} (as on {day})", quantity.name),
        _ => quantity.name.clone(),
    }
}

/// The day that the folder of a file begins with.
fn day_of_folder(file: &Path) -> Option<Date> {
    let folder = file.parent()?.file_name()?.to_str()?;
    folder.get(..10)?.parse().ok()
}
