//! Programs that are refused, and where the caret stands.

use super::{moves, try_text};
use crate::error::Kind;

/// Refuses every program with the words and at the place (line, column; 0 for the whole line) given.
fn refuse(cases: &[(&str, (usize, usize), &str)]) {
    for (source, place, what) in cases {
        let error = match try_text(source) {
            Err(error) => error,
            Ok(program) => panic!("read {source:?} as {:?}", program.steps),
        };
        assert!(error.what.contains(what), "{source:?}:\n{error}");
        assert_eq!(error.kind, Kind::Input);
        let found = error.place.as_ref().expect("a place");
        assert_eq!((found.line, found.column), *place, "{source:?}:\n{error}");
        assert!(!error.what.ends_with('.'), "{error}");
    }
}

/// The same after a block that positions at the zero of G54.
fn refuse_blocks(cases: &[(&str, usize, &str)]) {
    for (block, column, what) in cases {
        let source = format!("G90 G00 X0. Y0. Z0.\n{block}\nM30\n");
        refuse(&[(source.as_str(), (2, *column), *what)]);
    }
}

#[test]
fn what_is_not_known_is_never_skipped() {
    refuse_blocks(&[
        ("G28 X0.", 1, "G28 is not known"),
        ("N20 G43 H1 Z5.", 5, "G43 is not known"),
        ("G41 D1", 1, "G41 is not known"),
        ("G81 Z-5. R1. F100", 1, "G81 is not known"),
        ("G54.1 P1", 1, "G54.1 is not known"),
        ("G1. X5.", 1, "G01.0 is not known"),
        ("G-1 X5.", 1, "G-1 is not known"),
        ("G95 F0.1", 1, "G95 is not known"),
        ("M06 T1", 1, "M06 is not known"),
        ("M3.5", 1, "M3.5 is not known"),
        ("G00 X1. A30.", 9, "A30 has no meaning"),
        ("G00 X1. H1", 9, "H1 has no meaning"),
        ("G00 D2 X1.", 5, "D2 has no meaning"),
        ("G00 U1.", 5, "U1 has no meaning"),
        ("G00 X1. P5", 9, "P5 has no meaning"),
        ("M30 P1", 5, "P1 has no meaning"),
        ("G00 X1. L2", 9, "L2 has no meaning"),
        ("G01 X1. R2. F60", 9, "R2 has no meaning"),
        ("G00 I1.", 5, "I1 has no meaning"),
        ("#100=5", 1, "belongs to a macro"),
        ("G00 X#100", 5, "X has no number"),
        ("G00 X[1+2]", 5, "X has no number"),
        ("G00 [1]", 5, "belongs to a macro"),
        ("G05.1 Q2", 7, "G05.1 Q2"),
        ("G05.1", 1, "without Q"),
        ("G05 P2", 5, "G05 P2"),
        ("G08 P1 X1.", 8, "X1 has no meaning"),
        ("G08 P1 G64", 1, "not alone"),
        ("G08 P1.", 5, "not known"),
    ]);
}

#[test]
fn a_block_that_cannot_be_taken_apart_is_shown_with_its_character() {
    refuse_blocks(&[
        ("G00 X1.0.0", 5, "more than one decimal point"),
        ("G00 X--1.", 5, "more than one sign"),
        ("G00 X1-", 5, "not in front"),
        ("G00 X Y1.", 5, "X has no number"),
        ("G00 X1,5", 7, "`,` has no meaning"),
        ("G00 X1 .5", 8, "a number without an address"),
        ("12 G00", 1, "a number without an address"),
        ("G00 X1. (OPEN", 9, "not closed"),
        ("G00 X1.) Y2.", 8, "closed that was not opened"),
        ("(Ä) G00 X1. é", 13, "`é` has no meaning"),
        ("G00 X1.; Y1.", 10, "follows the end"),
        ("G00 X1. %", 9, "% stands inside"),
        ("G00 X1.\u{7}", 8, "control character"),
        ("G00 X1.\rY1.", 8, "control character"),
        ("(A\rB)", 1, "control character"),
        ("G00 / X1.", 5, "a slash stands"),
        ("/3 G00 X1.", 1, "/3 is not known"),
        ("G00 N10 X1.", 5, "a block number stands"),
        ("N10 N20 X1.", 5, "a block number stands"),
        ("N1.5 X1.", 1, "N1.5 is not a block number"),
        ("N10 O5", 5, "a program number stands"),
    ]);
}

#[test]
fn a_dwell_has_a_longest_time() {
    refuse_blocks(&[
        ("G04 X100000.", 5, "99999.999 s at the most"),
        ("G04 P999999999999", 5, "99999.999 s at the most"),
    ]);
}

#[test]
fn every_number_has_a_lowest_and_a_highest_value() {
    refuse_blocks(&[
        ("X100000.", 1, "X100000 is 100000 mm, outside of -99999.999 to 99999.999 mm"),
        ("G00 Y-100000.", 5, "Y-100000 is -100000 mm"),
        ("Z100000000", 1, "Z100000000 is 100000 mm"),
        ("G20 X3937.1", 5, "X3937.1 is 100002.34 mm"),
        ("G53 X100000.", 5, "X100000 is"),
        ("G02 X1. I100000. F60", 9, "I100000 is"),
        ("G03 X1. R-100000. F60", 9, "R-100000 is"),
        ("G19 G03 Y1. J99999.9991 F60", 13, "J99999.9991 is 99999.9991 mm"),
        ("F1000001", 1, "F1000001 is 1000001 mm/min, outside of 0.001 to 1000000 mm/min"),
        ("F0.0001", 1, "F0.0001 is 0.0001 mm/min"),
        ("G20 F40000.", 5, "F40000 is 1016000 mm/min"),
        ("S100000000", 1, "S100000000 is 100000000, outside of 0 to 99999999"),
        ("S-1", 1, "S-1 is"),
        ("T100000000", 1, "T100000000 is"),
        ("N100000000 X1.", 1, "N100000000 is"),
    ]);
    refuse(&[("M98 P5 L10000\nM30\nO5\nM99\n", (1, 8), "L10000 is 10000, outside of 1 to 9999")]);
    // What is just within is read.
    let ends = moves(
        "X99999.999\nX-99999.999\nX99999999\nN99999999 S99999999 T99999999 F1000000\nG01 F0.001 X0.",
    );
    assert_eq!(ends.len(), 4);
}

#[test]
fn contradictions_within_a_block_are_refused() {
    refuse_blocks(&[
        ("G00 G01 X1.", 5, "already sets the kind of motion"),
        ("G17 G18", 5, "already sets the plane"),
        ("G20 G21", 5, "inch or metric"),
        ("G90 G90", 5, "absolute or incremental"),
        ("G54 X1. G55", 9, "the work offset"),
        ("G61 G64", 5, "exact stop"),
        ("G94 G94", 5, "the kind of feed"),
        ("G04 G53 P1", 5, "functions of one block"),
        ("G00 X1. X2.", 9, "a second X"),
        ("F100 F200", 6, "a second F"),
        ("M03 M08", 5, "a second M"),
    ]);
}

#[test]
fn a_block_has_no_more_words_than_a_control_takes() {
    let block = "M00".repeat(201);
    refuse_blocks(&[(block.as_str(), 601, "too many words")]);
}

#[test]
fn a_dwell_has_one_time() {
    refuse_blocks(&[
        ("G04", 1, "one time"),
        ("G04 P100 X1.", 1, "one time"),
        ("G04 P1.5", 5, "has a decimal point"),
        ("G04 P-5", 5, "negative"),
        ("G04 P100 Y1.", 10, "Y1 has no meaning"),
        ("G01 G04 P100", 1, "G01 beside G04"),
        ("G04 P100 M98", 10, "M98 beside G04"),
    ]);
}

#[test]
fn a_feed_move_needs_a_feed() {
    refuse_blocks(&[
        ("G01 X1.", 5, "without a feed"),
        ("G01 X1. F0", 5, "without a feed"),
        ("G02 I1.", 5, "without a feed"),
    ]);
    refuse(&[
        ("G90 G00 X0. Y0. Z0. F100\nG20\nG01 X1.\nM30\n", (3, 5), "without a feed"),
        ("G90 G00 X0. Y0. Z0. F-100\nM30\n", (1, 21), "negative"),
    ]);
}

#[test]
fn a_move_from_an_unknown_place_is_refused() {
    refuse(&[
        ("G90 G01 X1. F60\nM30\n", (1, 9), "X and Y and Z that is not known"),
        ("G90 G00 X1. Y1.\nG01 X2. F60\nM30\n", (2, 5), "place of Z"),
        ("G90 G00 X1. Y1.\nG01 X2. Y2. Z2. F60\nM30\n", (2, 5), "place of Z"),
        ("G90 G00 X1. Y1.\nG03 I1. F60\nM30\n", (2, 5), "place of Z"),
        ("G91 G00 X1.\nM30\n", (1, 9), "place of X"),
        ("G90 X1.\nM30\n", (1, 5), "before the first G00"),
        ("G90 G56 G00 X1.\nM30\n", (1, 13), "G56, which is not known"),
    ]);
}

#[test]
fn machine_coordinates_are_refused_where_controls_differ() {
    refuse_blocks(&[
        ("G01 G53 X1. F60", 5, "G53 without G00"),
        ("G91 G53 X1.", 5, "G53 with G91"),
        ("G53", 1, "G53 without X"),
    ]);
}

#[test]
fn an_arc_that_does_not_exist_is_refused() {
    refuse_blocks(&[
        ("G02 X10. F60", 1, "without I, J, K and R"),
        ("G02 X10. I4.98 F60", 10, "radius 4.9800 mm and ends at radius 5.0200 mm"),
        ("G02 I0. F60", 5, "the centre of the arc is its start"),
        ("G02 X10. I5. R5. F60", 14, "by centre and by radius"),
        ("G02 X10. R4.9 F60", 10, "radius 4.9000 mm is too small for ends 10.0000 mm apart"),
        ("G02 X10. R0. F60", 10, "too small"),
        ("G02 X0. R5. F60", 9, "ends where it starts"),
        ("G02 R5. F60", 5, "ends where it starts"),
        ("G02 X10. I5. K1. F60", 14, "K is not in the plane of the arc, XY (G17)"),
        ("G18 G02 X10. J5. F60", 14, "J is not in the plane of the arc, ZX (G18)"),
        ("G19 G02 Y10. I5. F60", 14, "I is not in the plane of the arc, YZ (G19)"),
    ]);
}

#[test]
fn a_program_has_one_beginning_and_one_end() {
    refuse(&[
        ("%\nO1\nG90\nG00 X1.\n", (4, 0), "ends at line 4 without M30"),
        ("%\nO1\nG90\n%\n", (3, 0), "ends at line 3 without M30"),
        ("%\nO1\n%\n", (2, 0), "ends at line 2 without M30"),
        ("O1\nG90\nO2\nM99\n", (2, 0), "ends at line 2 without M30"),
        ("%\nO1\nM30\n", (3, 0), "does not end with it"),
        ("HEADER\n%\nO1\nM30\n", (4, 0), "does not end with it"),
        ("O1\nM30\n%\n", (3, 0), "stands at its end"),
        ("O1\nM99\n", (2, 1), "repeats it for ever"),
        ("O0\nM30\n", (1, 1), "O0 is not a program number"),
        ("O1.5\nM30\n", (1, 1), "O1.5 is not a program number"),
        ("O1\nM30\nO1\nM99\n", (3, 1), "two programs O1"),
    ]);
}

#[test]
fn a_call_that_leads_nowhere_is_refused() {
    refuse(&[
        ("M98 P1000\nM30\n", (1, 5), "no subprogram O1000"),
        ("M98 P1000.\nM30\nO1000\nM99\n", (1, 5), "no subprogram O1000"),
        ("M98\nM30\n", (1, 1), "M98 without P"),
        ("M98 P5 L0\nM30\nO5\nM99\n", (1, 8), "L0 is 0, outside of 1 to 9999"),
        ("M98 P5 L2.\nM30\nO5\nM99\n", (1, 8), "number of repeats"),
        ("M98 P5\nM30\nO5\nG90\n", (4, 0), "O5 ends at line 4 without M99"),
        ("M98 P5\nM30\nO5\nM99 P10\n", (4, 5), "P10 has no meaning"),
        ("M98 P5\nM30\nO5\nM98 P5\nM99\n", (4, 1), "more than 4 deep"),
        ("M98 P5 L9999\nM30\nO5\nM98 P6 L9999\nM99\nO6\nM99\n", (7, 0), "more than 10000 blocks"),
    ]);
}

#[test]
fn a_message_shows_the_block_and_what_to_do() {
    let error = try_text("%\nO1\nN10 G90 G54\nN20 G28 Z0.\nM30\n%\n").unwrap_err();
    let expected = "G28 is not known
  --> O1.nc:4:5
  |
4 | N20 G28 Z0.
  |     ^^^
hint: where the reference point is and how it is reached is not known here: position with G00 G53";
    assert_eq!(error.to_string(), expected);
}
