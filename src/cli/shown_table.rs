//! What `ballbar show` says of a table of readings.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::align;
use crate::log::{
    Angles, Delimiter, Layout, Log, ReadingKind, Table, TimeColumn, Turn, Written,
    lines_for_the_test,
};

/// So many gaps are told one by one.
const LISTED: usize = 100;

/// A step between two samples in which others are missing.
struct Gap {
    /// Line of the sample before it.
    line: usize,
    seconds: f64,
}

/// What the readings themselves show.
struct Facts {
    lowest_um: f64,
    highest_um: f64,
    out_of_range: usize,
    /// Stretches in range without a gap.
    stretches: usize,
    /// The longest first.
    gaps: Vec<Gap>,
    /// The values that readings were cut off at, um, each with how many.
    clipped: Vec<(f64, usize)>,
}

impl Facts {
    fn of(table: &Table) -> Self {
        let log = &table.log;
        let deviations = || log.readings().iter().filter_map(|reading| reading.deviation_mm);
        let longest_s = Log::GAP_PERIODS * log.sample_period_s();
        let pairs = log.readings().windows(2);
        let steps =
            pairs.map(|pair| Gap { line: pair[0].line, seconds: pair[1].time_s - pair[0].time_s });
        let mut gaps: Vec<Gap> = steps.filter(|gap| gap.seconds > longest_s).collect();
        gaps.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        let mut clipped: Vec<(f64, usize)> = Vec::new();
        let cut = align::clipped(log).map(|(_, cut)| cut).unwrap_or_default();
        for um in cut.iter().filter_map(|reading| reading.deviation_mm).map(|mm| 1e3 * mm) {
            match clipped.iter_mut().find(|(limit, _)| limit.total_cmp(&um).is_eq()) {
                Some((_, count)) => *count += 1,
                None => clipped.push((um, 1)),
            }
        }
        Self {
            lowest_um: 1e3 * deviations().fold(f64::INFINITY, f64::min),
            highest_um: 1e3 * deviations().fold(f64::NEG_INFINITY, f64::max),
            out_of_range: log.readings().len() - deviations().count(),
            stretches: log.in_range_intervals().len(),
            gaps,
            clipped,
        }
    }
}

pub(super) fn as_text(table: &Table, has_test: bool) -> String {
    let Table { log, turns, layout } = table;
    let facts = Facts::of(table);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut say = |name: &str, what: String| {
        let _ = writeln!(text, "  {name:<16}{what}");
    };
    say("written as", written(layout));
    match &layout.format.time {
        TimeColumn::Named { name, unit } => {
            let kind = if layout.of_day { "times of day" } else { unit.name() };
            let day = log.began().map_or(String::new(), |day| format!(", from {day} on"));
            say("times", format!("`{}`, {kind}{day}", name.trim()));
        }
        TimeColumn::Rate { hz } => say("times", format!("none; {hz} a second by the test file")),
        TimeColumn::Angle { name } => {
            let plane = layout.format.plane.map_or(
                "the plane is not said: write `plane = \"xy\"` (or `yz`, `zx`) under `[log]`"
                    .to_owned(),
                |plane| format!("plane {}", plane.map(|axis| ["X", "Y", "Z"][axis]).concat()),
            );
            say("angles", format!("`{}`, degrees; {plane}", name.trim()));
        }
    }
    let reading = &layout.format.reading;
    let kind = match reading.kind {
        ReadingKind::Deviation if reading.inverted => "deviations, of the other sign".to_owned(),
        ReadingKind::Deviation => "deviations".to_owned(),
        ReadingKind::Length { nominal_mm } => format!("lengths of a bar of {nominal_mm} mm"),
    };
    say("readings", format!("`{}`, {kind} in {}", reading.name.trim(), reading.unit.name()));
    let others = others(layout);
    if !others.is_empty() {
        say("not read", others.join(", "));
    }
    let count = log.readings().len();
    if matches!(layout.format.time, TimeColumn::Angle { .. }) {
        say("samples", count.to_string());
    } else {
        let (span_s, period_s) = (log.span_s(), log.sample_period_s());
        say("samples", format!("{count} in {span_s:.3} s, {:.4} a second", 1.0 / period_s));
        let longest = facts.gaps.first().map_or(String::new(), |gap| {
            format!(", the longest of {:.3} s behind line {}", gap.seconds, gap.line)
        });
        say("gaps", format!("{}{longest}", facts.gaps.len()));
    }
    say(
        "in range",
        format!(
            "{} samples in {} stretches, {:.2} to {:.2} um; {} out of range",
            count - facts.out_of_range,
            facts.stretches,
            facts.lowest_um,
            facts.highest_um,
            facts.out_of_range
        ),
    );
    for (um, count) in &facts.clipped {
        say("cut off", format!("{count} readings at {um} um"));
    }
    for (index, turn) in turns.iter().enumerate() {
        let [from, to] = ends_deg(turn);
        let count = turn.readings.len();
        say(
            &format!("arc {}", index + 1),
            format!("{} {from:.2} to {to:.2} degrees, {count} readings", way(turn)),
        );
    }
    for note in log.notes() {
        say("caution", note.clone());
    }
    let lines = lines_for_the_test(&layout.format);
    if !has_test && !lines.is_empty() {
        say("in a test file", "[log]".to_owned());
        for line in lines {
            say("", line);
        }
    }
    text
}

pub(super) fn as_json(table: &Table) -> Value {
    let Table { log, turns, layout } = table;
    let facts = Facts::of(table);
    let (time, by_angle) = match &layout.format.time {
        TimeColumn::Named { name, unit } => {
            (json!({ "column": name, "unit": unit.name(), "of_day": layout.of_day }), false)
        }
        TimeColumn::Rate { hz } => (json!({ "rate_hz": hz }), false),
        TimeColumn::Angle { name } => (json!({ "angle_column": name }), true),
    };
    let reading = &layout.format.reading;
    let nominal_mm = match reading.kind {
        ReadingKind::Deviation => None,
        ReadingKind::Length { nominal_mm } => Some(nominal_mm),
    };
    let arc = |turn: &Turn| {
        let [from, to] = ends_deg(turn);
        json!({ "direction": way(turn), "from_deg": from, "to_deg": to, "readings": turn.readings.len() })
    };
    let by_time = |value: f64| (!by_angle).then_some(value);
    let gaps = facts.gaps.iter().take(LISTED);
    let gaps: Vec<Value> =
        gaps.map(|gap| json!({ "behind_line": gap.line, "seconds": gap.seconds })).collect();
    let clipped = facts.clipped.iter();
    let clipped: Vec<Value> =
        clipped.map(|(um, count)| json!({ "at_um": um, "readings": count })).collect();
    json!({
        "kind": "table",
        "encoding": match &layout.written { Written::Text(name) => Some(name), Written::Sheet(_) => None },
        "sheet": match &layout.written { Written::Sheet(name) => Some(name), Written::Text(_) => None },
        "header_line": layout.header_line,
        "columns": layout.columns,
        "time": time,
        "reading": {
            "column": reading.name,
            "unit": reading.unit.name(),
            "length_of_mm": nominal_mm,
            "inverted": reading.inverted,
        },
        "began": log.began().map(|day| day.to_string()),
        "samples": log.readings().len(),
        "span_s": by_time(log.span_s()),
        "sample_period_s": by_time(log.sample_period_s()),
        "gaps": if by_angle { Vec::new() } else { gaps },
        "gap_count": if by_angle { 0 } else { facts.gaps.len() },
        "out_of_range": facts.out_of_range,
        "stretches_in_range": facts.stretches,
        "lowest_um": facts.lowest_um,
        "highest_um": facts.highest_um,
        "cut_off": clipped,
        "arcs": turns.iter().map(arc).collect::<Vec<_>>(),
        "notes": log.notes(),
        "log_keys": lines_for_the_test(&layout.format),
    })
}

fn written(layout: &Layout) -> String {
    let fields = match layout.delimiter {
        Delimiter::Comma => "commas",
        Delimiter::Semicolon => "semicolons",
        Delimiter::Tab => "tabs",
        Delimiter::Blanks => "blanks",
    };
    let line = layout.header_line;
    match &layout.written {
        Written::Text(encoding) => {
            format!("text in {encoding}, columns named in line {line}, apart by {fields}")
        }
        Written::Sheet(name) => {
            format!("sheet `{name}` of a workbook, columns named in row {line}")
        }
    }
}

/// The names of the columns that are not read.
fn others(layout: &Layout) -> Vec<String> {
    let time = match &layout.format.time {
        TimeColumn::Named { name, .. } | TimeColumn::Angle { name } => name.as_str(),
        TimeColumn::Rate { .. } => "",
    };
    let same = |a: &str, b: &str| a.trim().to_lowercase() == b.trim().to_lowercase();
    let is_read = |name: &str| same(name, time) || same(name, &layout.format.reading.name);
    let others = layout.columns.iter().filter(|name| !name.is_empty() && !is_read(name));
    others.map(|name| format!("`{name}`")).collect()
}

/// Where an arc begins and ends, degrees.
fn ends_deg(turn: &Turn) -> [f64; 2] {
    match &turn.angles {
        Angles::Stated(rad) => {
            [rad.first(), rad.last()].map(|rad| rad.map_or(0.0, |rad| rad.to_degrees()))
        }
        Angles::Even(rad) => [-rad.to_degrees() / 2.0, rad.to_degrees() / 2.0],
    }
}

fn way(turn: &Turn) -> &'static str {
    if turn.counter_clockwise { "CCW" } else { "CW" }
}
