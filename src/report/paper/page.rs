//! The comparison with the paper as a page of the documentation.

use std::fmt::Write as _;

use super::rows::{HEAD, cells, geometry, nearest_lines, title};
use crate::paper::{Comparison, Nearest, PAPER_READINGS, PAPER_TEST_S, PaperTime, Row};

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
        let mut cells = cells(row).to_vec();
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
