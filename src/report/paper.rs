//! The comparison with the paper: on the terminal, as a page, as JSON.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::identify::Seen;
use crate::paper::{
    Comparison, Nearest, PAPER_READINGS, PAPER_TEST_S, PaperTime, Row, StrategyRows,
};

/// Rounded to three significant digits, in powers of ten where it is large.
fn rounded(value: f64) -> String {
    match value {
        _ if !value.is_finite() => "-".to_owned(),
        _ if value < 1e5 => {
            let decimals = (2 - value.log10().floor() as i32).max(0);
            let unit = 10_f64.powi(2 - value.log10().floor() as i32);
            format!("{:.*}", decimals as usize, (value * unit).round() / unit)
        }
        _ => format!("{value:.1e}"),
    }
}

/// With a mark where directions had to be left out.
fn condition(seen: &Seen) -> String {
    format!("{}{}", rounded(seen.condition), if seen.rank < seen.columns { "*" } else { "" })
}

/// Columns as they are: only with the full rank is it more than rounding.
fn raw(seen: &Seen) -> String {
    if seen.rank == seen.columns { rounded(seen.raw_condition) } else { "-".to_owned() }
}

const HEAD: [&str; 10] = [
    "columns",
    "rank paper",
    "carriage",
    "base",
    "cond. paper",
    "carriage",
    "base",
    "raw paper",
    "base",
    "verdict",
];

fn cells(row: &Row) -> [String; 10] {
    [
        row.stage.columns.to_string(),
        row.paper_rank.map_or("-".to_owned(), |rank| rank.to_string()),
        row.carriage.rank.to_string(),
        row.base.rank.to_string(),
        row.paper_condition.map_or("-".to_owned(), |printed| printed.to_string()),
        condition(&row.carriage),
        condition(&row.base),
        row.paper_raw_condition.map_or("-".to_owned(), |printed| format!("{printed:e}")),
        raw(&row.base),
        row.verdict.clone(),
    ]
}

fn title(rows: &StrategyRows) -> String {
    rows.strategy.name().to_uppercase()
}

/// For the terminal.
pub fn paper_text(paper: &Comparison) -> String {
    let mut text = geometry(paper);
    text.push_str("\n\nSection 4: random poses in the volume\n");
    text.push_str(&table(&paper.volume));
    for strategy in &paper.strategies {
        let _ = write!(
            text,
            "\n{}: lengths along its arcs\n{}",
            title(strategy),
            table(&strategy.rows)
        );
        for (pivot, sentences) in [("carriage", &strategy.carriage), ("base", &strategy.base)] {
            for sentence in sentences {
                let _ = writeln!(text, "  {pivot}: {sentence}");
            }
        }
    }
    text.push_str(
        "\nSeveral mountings of 3D6, every pivot on its carriage: coefficients of 53, of 90\n",
    );
    for row in &paper.mountings {
        let _ = writeln!(text, "  {:<40} {:>2} {:>3}", row.what, row.of_53, row.of_90);
    }
    text.push_str("\n* of the retained directions: the columns depend on each other\n");
    text
}

fn table(rows: &[Row]) -> String {
    let cells: Vec<[String; 10]> = rows.iter().map(self::cells).collect();
    let width = |k: usize| {
        let all = cells.iter().map(|row| row[k].len());
        all.chain([HEAD[k].len()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..9).map(width).collect();
    let mut text = String::new();
    let mut line = |cells: &[String]| {
        for (cell, width) in cells.iter().zip(&widths) {
            let _ = write!(text, "  {cell:>width$}");
        }
        let _ = writeln!(text, "  {}", cells[9]);
    };
    line(&HEAD.map(str::to_owned));
    for cells in &cells {
        line(cells);
    }
    let mut removed = String::new();
    for row in rows.iter().filter(|row| !row.stage.removed.is_empty()) {
        let _ = writeln!(removed, "  to {}: without {}", row.stage.columns, row.stage.removed);
    }
    text + &removed
}

fn geometry(paper: &Comparison) -> String {
    let at = &paper.geometry;
    let [x, y, z] = at.coincidence_mm;
    format!(
        "Mitsui Seiki HU40-T, wCBXFZYSt; balls coincide at X{x} Y{y} Z{z}, tool ball {} mm below its slide, bar {} mm,\nmeridians over {} deg",
        at.tool_length_mm, at.bar_mm, at.meridian_deg
    )
}

/// As a page of the documentation.
pub fn paper_page(paper: &Comparison, nearest: Option<&Nearest>) -> String {
    let mut page = String::from(INTRODUCTION);
    let _ = write!(page, "\n## Where the balls are\n\n{}.\n", geometry(paper));
    page.push_str(HOW_TO_READ);
    page.push_str("\n## Section 4: the volume\n\n");
    page.push_str(&markdown(&paper.volume));
    for strategy in &paper.strategies {
        let _ = write!(page, "\n## {}\n\n{}", title(strategy), markdown(&strategy.rows));
        if !strategy.carriage.is_empty() {
            page.push_str(
                "\nWith every pivot on its carriage, the last row cannot tell apart (also by names that are removed\nby then, because other columns do what they do):\n\n",
            );
            for sentence in &strategy.carriage {
                let _ = writeln!(page, "- {sentence}");
            }
        }
        if strategy.base.is_empty() {
            page.push_str(
                "\nWith the pivot of X on the base, the columns of the last row are independent.\n",
            );
        }
        let ranks: Vec<String> = strategy.x_and_z_base.iter().map(ToString::to_string).collect();
        let _ = writeln!(
            page,
            "With the pivots of X and Z on the base the ranks are {}.",
            ranks.join(", ")
        );
    }
    page.push_str(BEYOND);
    for row in &paper.mountings {
        let _ = writeln!(page, "| {} | {} | {} |", row.what, row.of_53, row.of_90);
    }
    page.push_str(&times_page(&paper.times));
    if let Some(nearest) = nearest {
        page.push_str(&nearest_page(nearest));
    }
    page
}

fn times_page(times: &[PaperTime]) -> String {
    let minutes = |seconds: f64| format!("{:.1}", seconds / 60.0);
    let mut text = String::from(TIMES);
    for time in times {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.1} | {} | {} |",
            time.what,
            minutes(time.arcs_s),
            minutes(time.transits_s),
            time.feed_in_s / 60.0,
            minutes(time.dwells_s),
            minutes(time.total_s())
        );
    }
    let _ = writeln!(
        text,
        "\nThe paper's test took {:.0} min and gave {} readings, {:.2} a second over the whole of it. To take as long,\n",
        PAPER_TEST_S / 60.0,
        PAPER_READINGS,
        PAPER_READINGS / PAPER_TEST_S
    );
    for time in times {
        let _ = writeln!(
            text,
            "- {}: each of the {} arcs would overshoot by {:.0} deg at both ends, or each of the {} pauses would be {:.0} s longer; over the arcs alone the readings are {:.1} a second.",
            time.what,
            time.legs,
            time.overshoot_deg(),
            time.pauses,
            time.longer_pauses_s(),
            time.readings_on_arcs_per_s()
        );
    }
    text.push_str(TIMES_MEAN);
    text
}

fn markdown(rows: &[Row]) -> String {
    let mut head = HEAD.map(str::to_owned).to_vec();
    head.insert(1, "removed".to_owned());
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), " --- |".repeat(head.len()));
    for row in rows {
        let mut cells = self::cells(row).to_vec();
        cells.insert(1, row.stage.removed.to_owned());
        let _ = writeln!(text, "| {} |", cells.join(" | ").replace('*', "\\*"));
    }
    text
}

fn nearest_page(nearest: &Nearest) -> String {
    let mut text = String::from(SEARCH);
    for line in nearest_lines(nearest) {
        let _ = writeln!(text, "- {line}");
    }
    text.push_str(SEARCHED);
    text
}

fn nearest_lines(nearest: &Nearest) -> Vec<String> {
    let volume = &nearest.volume;
    let [x, y, z] = volume.range_mm.map(|[low, high]| format!("{low} to {high}"));
    let [a, b] = volume.conditions.map(rounded);
    let mut lines = vec![format!(
        "volume: X {x}, Y {y}, Z {z} mm, tool {} mm: {a} and {b} (paper 387 and 108), {:.0} % off at most",
        volume.tool_length_mm,
        (volume.worst_factor - 1.0) * 100.0
    )];
    for found in &nearest.bar {
        let at = &found.geometry;
        let [x, y, z] = at.coincidence_mm;
        let [c2, c5, c6, c10] = found.conditions.map(rounded);
        lines.push(format!(
            "meridians over {} deg: balls coincide at X{x} Y{y} Z{z}, tool {} mm: 2D {c2}, 3D5 {c5}, 3D6 {c6}, 3D10 {c10} (paper 2801, 1950, 1948, 1948), {:.0} % off at most",
            at.meridian_deg,
            at.tool_length_mm,
            (found.worst_factor - 1.0) * 100.0
        ));
    }
    lines
}

/// What a search has found, for the terminal.
pub fn nearest_text(nearest: &Nearest) -> String {
    let mut text =
        "\nNearest to the paper's condition numbers, pivot of X on the base\n".to_owned();
    for line in nearest_lines(nearest) {
        let _ = writeln!(text, "  {line}");
    }
    text
}

/// For another program.
pub fn paper_json(paper: &Comparison, nearest: Option<&Nearest>) -> Value {
    let seen = |seen: &Seen| {
        let full = seen.rank == seen.columns;
        json!({
            "rank": seen.rank,
            "condition": seen.condition,
            "raw_condition": full.then_some(seen.raw_condition),
        })
    };
    let row = |row: &Row| {
        json!({
            "columns": row.stage.columns,
            "removed": row.stage.removed().collect::<Vec<_>>(),
            "paper": {
                "rank": row.paper_rank,
                "condition": row.paper_condition,
                "raw_condition": row.paper_raw_condition,
            },
            "carriage": seen(&row.carriage),
            "base": seen(&row.base),
            "verdict": row.verdict,
        })
    };
    let strategy = |rows: &StrategyRows| {
        json!({
            "strategy": rows.strategy.name(),
            "stages": rows.rows.iter().map(row).collect::<Vec<_>>(),
            "confounded": { "carriage": rows.carriage, "base": rows.base },
            "rank_with_x_and_z_on_base": rows.x_and_z_base,
        })
    };
    let at = &paper.geometry;
    json!({
        "geometry": {
            "coincidence_mm": at.coincidence_mm,
            "tool_length_mm": at.tool_length_mm,
            "ball_bar_mm": at.bar_mm,
            "meridian_deg": at.meridian_deg,
        },
        "volume": paper.volume.iter().map(row).collect::<Vec<_>>(),
        "strategies": paper.strategies.iter().map(strategy).collect::<Vec<_>>(),
        "mountings": paper.mountings.iter().map(|row| json!({
            "what": row.what, "of_53": row.of_53, "of_90": row.of_90,
        })).collect::<Vec<_>>(),
        "times": paper.times.iter().map(|time| json!({
            "what": time.what,
            "arcs_s": time.arcs_s,
            "transits_s": time.transits_s,
            "feed_in_s": time.feed_in_s,
            "dwells_s": time.dwells_s,
            "total_s": time.total_s(),
            "overshoot_to_37_min_deg": time.overshoot_deg(),
            "longer_pauses_to_37_min_s": time.longer_pauses_s(),
            "readings_on_arcs_per_s": time.readings_on_arcs_per_s(),
        })).collect::<Vec<_>>(),
        "nearest": nearest.map(|nearest| json!({
            "volume": {
                "range_mm": nearest.volume.range_mm,
                "tool_length_mm": nearest.volume.tool_length_mm,
                "conditions": nearest.volume.conditions,
                "worst_factor": nearest.volume.worst_factor,
            },
            "bar": nearest.bar.iter().map(|found| json!({
                "coincidence_mm": found.geometry.coincidence_mm,
                "tool_length_mm": found.geometry.tool_length_mm,
                "meridian_deg": found.geometry.meridian_deg,
                "conditions": found.conditions,
                "worst_factor": found.worst_factor,
            })).collect::<Vec<_>>(),
        })),
    })
}

const INTRODUCTION: &str = "\
# The paper's tables, computed again

`ballbar paper --page` wrote this page; a test compares it with what the program computes. The paper is *An Integrated
Geometric and Hysteretic Error Model of a Three Axis Machine Tool and Its Identification With a 3D Telescoping
Ball-Bar*. It reports that 3D6 identifies 37 coefficients and 3 set-up errors in one mounting. Here,

- with the order of the transforms that its Eq. 1 prints, an angular error of X turns the tool ball about the moving
  carriage. On a sphere about the workpiece ball, EBX3, EBXb, ECX3 and ECXb then act as translations of X and cannot
  be identified; EAZ3 and EAZb, which the paper removes, can. That makes **35 coefficients and 3 set-up errors**.
- with the error before the motion, so that the pivot of X stays on the base, the paper's final set is complete:
  **37 coefficients and 3 set-up errors**. Before EAZ is removed, however, two more directions are seen than the paper
  says.

None of the eight choices of pivots reproduces all of its ranks. The pivots of X and Z both on the base come close: 40 from 56 columns
down to 41, but 39 of the last 40. The paper also disagrees with itself: it gives 2D the rank 32 with 56 columns and
33 with 40 of those.
";

const HOW_TO_READ: &str = "
Random poses fill the travel of the machine. Arcs are ideal circles, both directions, each by itself; a slide that
stands still during an arc has the sense 0 there. The rank counts singular values of unit columns above 1e-10 of the
largest. *carriage* has every pivot on its carriage, *base* the pivot of X on the base. The condition number is that
of the unit columns; with an asterisk, of the retained directions only, because the columns depend on each other. The
raw condition, of columns in mm, rad and powers of mm, is given at full rank only: otherwise its digits are rounding,
and so are the paper's from 1e15 to 1e35. The paper does not state mounting and tool, so condition numbers cannot be
expected to agree; ranks can. A mounting may be too symmetrical, such as balls that coincide at machine zero: 2D then
sees other ranks than anywhere else.
";

const BEYOND: &str = "
## Beyond the paper: several mountings

Coefficients that 3D6 identifies with every pivot on its carriage, of the 53 that the volume needs and of all 90. Each
mounting brings three set-up errors of its own, which are not counted. Three places, not on one line, see all 53.

| mountings | of 53 | of 90 |
| --- | --- | --- |
";

const TIMES: &str = "
## How long the test takes

3D6 at 500 mm/min with a bar of 150 mm, dwells of 3 s between arcs, arcs in both directions, as `ballbar time` estimates
it, in minutes:

| driven | arcs | transits | feed-in and -out | dwells | all |
| --- | --- | --- | --- | --- | --- |
";

const TIMES_MEAN: &str = "
So half meridians with a few seconds between them do not take 37 minutes, whatever the accelerations. An overshoot of half
a turn at both ends, common in circular tests, comes to it within a minute on half meridians, and one of a quarter of a
turn within two on whole circles. The 2.7 readings a second then are those of the whole 37 minutes, with overshoots,
transits and pauses: a log that runs on. The paper states neither; pauses of that length after every arc, for the
operator, would explain as much.
";

const SEARCH: &str = "
## Which geometry gives the paper's condition numbers

`ballbar paper --search` tries tool lengths, places of the balls in machine coordinates, meridians of 180 and 360
degrees, and working volumes, with the pivot of X on the base. Nearest come:

";

const SEARCHED: &str = "
That is a fit of as many free lengths as there are figures, and other geometries come about as near. The figures of
the bar are reached within some per cent, so they are of the right size for this model; where its balls were, that
does not show. The figures of the volume are missed by more, and need a small volume: over the whole travel both are
far below the paper's.
";
