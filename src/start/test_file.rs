//! A test file with a comment on every key.

use nalgebra::Vector3;

use super::commented::{Commented, number, numbers, quoted};
use super::measured::Measured;
use super::test_kind::TestKind;
use super::wish::{MACHINE_FILE, Wish};
use crate::plan::Planes;

/// Budget of a design, min: what three tests of 3D6 take with their operator.
const BUDGET_MIN: f64 = 90.0;

/// Of the first program.
pub(super) const PROGRAM_NUMBER: u32 = 1001;

/// The text of the test file of a wish, with a bar, the balls in a place, mm, and the file of its program.
pub(super) fn test_file(
    wish: &Wish,
    bar_mm: f64,
    place_mm: &Vector3<f64>,
    program_file: &str,
) -> String {
    let mut file = Commented::new("Test file");
    file.note(
        "What is tested, with what, and what was measured. A line that begins with # is an example of a key that may be \
         left out. `ballbar reference KEY` says more of a key, `ballbar reference test` lists all.",
    );
    file.key("name", &quoted(&format!("{}, {}", wish.name, wish.test.name())));
    file.key("machine", &quoted(MACHINE_FILE));
    file.table("[ball_bar]", "[ball_bar]");
    file.key("length_mm", &number(bar_mm));
    file.key("range_mm", "1.0");
    mounting(&mut file, wish, place_mm);
    plan(&mut file, wish);
    if wish.test == TestKind::Design {
        file.table("[design]", "[design]");
        file.key("budget_min", &number(BUDGET_MIN));
        file.off("most_mountings", "3");
        file.off("bar_lengths_mm", "[100.0, 150.0]");
    }
    match &wish.measured {
        Some(measured) => was_measured(&mut file, wish, measured, program_file),
        None => will_be_measured(&mut file),
    }
    file.finish()
}

fn mounting(file: &mut Commented, wish: &Wish, place_mm: &Vector3<f64>) {
    file.table("[[mounting]]", "[[mounting]]");
    file.key("name", &quoted("A"));
    file.note(
        "Machine coordinates at which the two ball centres would coincide. The program sets nothing: the same numbers must \
         stand in the work offset. These are a place where the test fits into the travel. Find the true ones on the machine: \
         fix the workpiece ball on the table about there; with the tool ball in the spindle, let both meet (the magnet of an \
         unlocked centre pivot takes the tool ball, then lock the pivot), and read the machine coordinates X, Y and Z off the \
         control. Write them here and into the work offset, retract Z, and write the program anew. A few hundredths are \
         estimated with the rest.",
    );
    file.key("coincidence_mm", &numbers(place_mm.as_slice()));
    file.note(
        "Centre of the tool ball seen from the middle of the spindle nose: 0, 0 and the length that sticks out of the \
         spindle, downwards. A ruler is good enough: only angular errors ask for it, 1 mm makes 0.05 um of 50 urad.",
    );
    file.key("tool_ball_mm", &numbers(&[0.0, 0.0, -wish.tool_mm]));
    file.key("work_offset", &quoted("G54"));
}

fn plan(file: &mut Commented, wish: &Wish) {
    file.table("[plan]", "[plan]");
    if wish.test == TestKind::Design {
        file.note(
            "Until `ballbar design` has chosen arcs, `plan` and `program` take this strategy.",
        );
    }
    file.key("strategy", &quoted(wish.test.strategy()));
    file.key("feed_mm_min", &number(wish.feed_mm_min));
    if let TestKind::Planes(planes) = wish.test {
        let (sweep, overshoot) =
            if planes == Planes::Xy { ("360.0", "180.0") } else { ("180.0", "2.0") };
        match &wish.measured {
            Some(measured) => {
                file.key("sweep_deg", &number(measured.arc_deg));
                if measured.begins_anywhere(wish.test) {
                    file.key("start_deg", "0.0");
                }
            }
            None => file.off("sweep_deg", sweep),
        }
        file.off("overshoot_deg", overshoot);
    }
    file.key("dwell_s", "3.0");
    file.off("both_directions", "false");
    file.off("interpolation", &quoted("chords"));
    file.key("program_number", &PROGRAM_NUMBER.to_string());
}

/// A log that is there, with the program that init writes beside it.
fn was_measured(file: &mut Commented, wish: &Wish, measured: &Measured, program_file: &str) {
    record(file);
    let stated_arc = measured.states_arc.then_some(measured.arc_deg);
    let stated_plane = measured.states_plane.then_some(wish.test.name());
    if stated_arc.is_some() || stated_plane.is_some() || measured.unit.is_some() {
        file.table("[log]", "[log]");
    }
    if let Some(plane) = stated_plane {
        file.key("plane", &quoted(plane));
    }
    if let Some(unit) = measured.unit {
        file.key("reading_unit", &quoted(unit.name()));
    }
    if let Some(arc_deg) = stated_arc {
        file.key("data_arc_deg", &number(arc_deg));
    }
    file.table("[[run]]", "[[run]]");
    file.note(
        "The log does not hold the program. This one drives the same plane, arc and feed with the balls in the place above; \
         better is the one that ran: write its name here, and its place into `coincidence_mm`.",
    );
    file.key("program", &quoted(program_file));
    file.key("log", &quoted(&measured.log));
    file.off("feed_override_percent", "100.0");
}

fn record(file: &mut Commented) {
    file.table_off("[record]", "[record]");
    file.off("operator", &quoted("K. Huber"));
    file.off("machine_serial", &quoted("4711"));
    file.off("bar_serial", &quoted("0AF3"));
}

fn will_be_measured(file: &mut Commented) {
    record(file);
    file.table_off("[log]", "[log]");
    file.off("time_column", &quoted("Time (ms)"));
    file.off("time_unit", &quoted("ms"));
    file.off("reading_column", &quoted("Deviation"));
    file.off("reading_unit", &quoted("mm"));
    file.table_off("[[run]]", "[[run]]");
    file.off("program", &quoted("programs/O1001.nc"));
    file.off("log", &quoted("monday.csv"));
    file.off("feed_override_percent", "100.0");
}
