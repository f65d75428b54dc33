//! What the words of motion do.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Vector3;

use super::super::{Action, Path};
use super::{actions, assert_near, end_mm, moves, program};

/// Sweeps of all arcs, rad.
fn sweeps(blocks: &str) -> Vec<f64> {
    let sweep = |path| match path {
        Path::Arc { sweep_rad, .. } => Some(sweep_rad),
        Path::Line => None,
    };
    moves(blocks).into_iter().filter_map(|motion| sweep(motion.path)).collect()
}

#[test]
fn a_coordinate_without_a_point_counts_least_increments() {
    for (block, x_mm) in [
        ("G00 X10.", 10.0),
        ("G00 X10", 0.010),
        ("G00 X-2500", -2.5),
        ("G00 X.5", 0.5),
        ("G00 X+1.25", 1.25),
        ("G00 X123.456", 123.456),
        ("g00 x7.", 7.0),
        ("G20 G00 X1.", 25.4),
        ("G20 G00 X10000", 25.4),
        ("G20 G00 X1", 0.00254),
        ("G00 X1. G20", 25.4),
    ] {
        assert_near(end_mm(block), [x_mm, 0.0, 0.0], block);
    }
}

#[test]
fn the_feed_is_per_minute_with_and_without_a_point() {
    for (block, feed_mm_s) in [
        ("G01 X1. F600", 10.0),
        ("G01 X1. F600.", 10.0),
        ("F600\nG01 X1.", 10.0),
        ("G20 G01 X1. F60.", 25.4),
        ("F60 G20\nG01 X1.", 25.4),
    ] {
        let motion = moves(block)[0];
        assert!((motion.feed_mm_s - feed_mm_s).abs() < 1e-12, "{block}");
        assert!(!motion.rapid);
    }
    assert_eq!(moves("G00 X1. F600")[0].feed_mm_s.to_bits(), 0);
}

#[test]
fn the_kind_of_motion_stays_in_force() {
    let moves = moves("G01 F600\nX1.\nY1. Z1.\nG00\nX2.\n");
    let rapid: Vec<bool> = moves.iter().map(|motion| motion.rapid).collect();
    assert_eq!(rapid, [false, false, true]);
    assert_near(moves[1].start_mm, [21.0, -35.0, 40.0], "continues");
    assert_near(moves[1].end_mm, [21.0, -34.0, 41.0], "continues");
}

#[test]
fn a_move_that_goes_nowhere_is_no_step() {
    assert_eq!(actions("G01 F600\nG01 X0. Y0.\nX0.000\nG00 Z0."), []);
    assert_eq!(actions("G91 G01 F600 X0.1\nX0.1\nX0.1\nG90 X0.3").len(), 3);
}

#[test]
fn incremental_moves_add_up_and_absolute_ones_do_not() {
    assert_near(end_mm("G91 G00 X1. Y2.\nX1.\nG90 Z5."), [2.0, 2.0, 5.0], "mixed");
}

#[test]
fn work_offsets_and_machine_coordinates_move_the_zero() {
    let found = moves("G55 G00 X1.\nG53 Y5.\nG54 X1. Y1.");
    assert_near(found[0].end_mm, [101.0, -35.0, 40.0], "G55");
    assert_near(found[1].end_mm, [101.0, 5.0, 40.0], "G53 for one block");
    assert_near(found[2].end_mm, [21.0, -34.0, 40.0], "G54");
}

#[test]
fn exact_stop_holds_for_a_block_or_until_it_is_cancelled() {
    let stops: Vec<bool> = moves("G01 X1. F600\nG09 X2.\nX3.\nG61 X4.\nX5.\nG64 X6.")
        .iter()
        .map(|motion| motion.exact_stop)
        .collect();
    assert_eq!(stops, [false, true, false, true, true, false]);
}

#[test]
fn a_dwell_is_in_milliseconds_or_with_a_point_in_seconds() {
    for (block, seconds) in [
        ("G04 P2000", 2.0),
        ("G04 X2000", 2.0),
        ("G04 X2.5", 2.5),
        ("G4 U.5", 0.5),
        ("G20 G04 X2.5", 2.5),
        ("G04 P0", 0.0),
    ] {
        assert_eq!(actions(block), [Action::Dwell { seconds }], "{block}");
    }
    assert_eq!(actions("G01 F60 X1.\nG04 X1.\nX2.").len(), 3, "G01 goes on after a dwell");
}

#[test]
fn arcs_turn_by_the_right_hand_about_the_normal_of_their_plane() {
    for (plane, ends, axis) in [
        ("G17", "X10. Y10. I0. J10.", 2),
        ("G18", "Z10. X10. K0. I10.", 1),
        ("G19", "Y10. Z10. J0. K10.", 0),
    ] {
        for (word, sweep) in [("G03", FRAC_PI_2), ("G02", -3.0 * FRAC_PI_2)] {
            let block = format!("{plane} {word} {ends} F600");
            let Path::Arc { axis: found, sweep_rad, center_mm } = moves(&block)[0].path else {
                panic!("{block} is no arc")
            };
            assert_eq!(found, axis, "{block}");
            assert!((sweep_rad - sweep).abs() < 1e-12, "{block}: {sweep_rad}");
            let mut center = Vector3::new(20.0, -35.0, 40.0);
            center[(axis + 2) % 3] += 10.0;
            assert!((center_mm - center).norm() < 1e-12, "{block}: {center_mm}");
        }
    }
}

#[test]
fn full_circles_close_with_and_without_their_end() {
    for (block, sweep) in [
        ("G03 X0. Y0. I150. F600", TAU),
        ("G03 I150. F600", TAU),
        ("G02 I150. F600", -TAU),
        ("G02 X0. I150000 F600", -TAU),
        ("G91 G02 X0. Y0. J-20. F600", -TAU),
        ("G19 G02 J3. K4. F600", -TAU),
    ] {
        assert_eq!(sweeps(block), [sweep], "{block}");
    }
}

#[test]
fn a_negative_radius_takes_the_longer_arc() {
    for (block, sweep) in [
        ("G03 X10. Y10. R10. F600", FRAC_PI_2),
        ("G03 X10. Y10. R-10. F600", 3.0 * FRAC_PI_2),
        ("G02 X10. Y10. R10000 F600", -FRAC_PI_2),
        ("G02 X10. Y10. R-10. F600", -3.0 * FRAC_PI_2),
        ("G02 X20. R10. F600", -PI),
        ("G03 X20. R10. F600", PI),
        ("G03 X20. R-10. F600", PI),
    ] {
        let found = sweeps(block);
        assert!((found[0] - sweep).abs() < 1e-9, "{block}: {found:?}");
    }
}

#[test]
fn a_helix_ends_at_the_height_of_its_third_axis() {
    let found = moves("G03 I10. Z-5. F600")[0];
    assert_near(found.end_mm, [20.0, -35.0, 35.0], "helix");
    let Path::Arc { center_mm, .. } = found.path else { panic!("a line") };
    assert_near(center_mm, [30.0, -35.0, 40.0], "centre");
}

#[test]
fn an_arc_ends_where_it_is_programmed_although_its_radius_is_rounded() {
    assert_near(end_mm("G03 X10. Y10.009 J10. F600"), [10.0, 10.009, 0.0], "arc");
}

#[test]
fn nothing_is_known_of_a_positioning_from_an_unknown_place() {
    let source = "G90 G00 X1.\nY1.\nZ1.\nX2.\nG91 X1.\nM30\n";
    let steps = program(source).steps;
    let lines: Vec<usize> = steps.iter().map(|step| step.line).collect();
    assert_eq!(lines, [4, 5, 6]);
    let partly = program("G90 G00 X1.\nG91 X1.\nG90 G53 G00 Y0. Z0.\nX1.\nM30\n");
    assert_eq!(partly.steps.len(), 2);
    let Action::Move(motion) = partly.steps[0].action else { panic!("no move") };
    assert_near(motion.start_mm, [22.0, 0.0, 0.0], "X moved by G91 where it was known");
}

#[test]
fn words_without_effect_on_the_path_are_accepted() {
    let quiet = "G17 G21 G40 G49 G54 G64 G80 G90 G94 S1000 T1 M03\nM04\nM05\nM08\nM09\n\
                 G05.1 Q1\nG05.1 Q0\nG05 P10000\nG05 P0\nG08 P1\nN10 G08 P0 (OFF)\n";
    assert_eq!(actions(quiet), []);
}

#[test]
fn stops_stand_after_the_motion_of_their_block() {
    let found = actions("G01 X1. F60 M00\nM01");
    assert!(matches!(found[..], [Action::Move(_), Action::Stop]), "{found:?}");
}
