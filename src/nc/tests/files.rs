//! The structure of a file: `%`, O and N, comments, subprograms, and files that are none.

use std::path::Path as FilePath;

use super::super::read_file;
use super::{Action, offsets, program, read, try_text};

/// The beginning and the end of a ball-bar program, with the first chords of two arcs.
const BALL_BAR: &str = "%
O1005 (BALL-BAR 3D6 R150 F500)
N10 G21 G17 G90 G94 G40 G49 G80
N20 G54
N30 G64
N40 G00 X171.500 Y-5. Z-5.
N45 G00 Y0. Z0.
N50 M00 (FIT BALL-BAR)
N60 G01 X151.500 Y0. Z0. F500.
N70 G04 P2000
N80 G01 X150.000
N90 G04 P3000
(EQUATOR CCW)
G01
X149.999 Y0.654 Z0.000
X149.994 Y1.309 Z0.000
G04 P3000
(EQUATOR CW)
G01
X149.999 Y0.654 Z0.000
X150.000 Y0.000 Z0.000
(RELEASE)
G01 X151.500
M05
M30
%
";

#[test]
fn a_ball_bar_program_is_read_as_it_runs() {
    let program = program(BALL_BAR);
    assert_eq!(program.number, Some(1005));
    assert_eq!(
        program.labels,
        ["", "BALL-BAR 3D6 R150 F500", "FIT BALL-BAR", "EQUATOR CCW", "EQUATOR CW", "RELEASE"]
    );
    let told: Vec<String> = program
        .steps
        .iter()
        .map(|step| {
            let action = match step.action {
                Action::Move(motion) if motion.rapid => "rapid".to_owned(),
                Action::Move(motion) => format!("to {:.3}", motion.end_mm.x),
                Action::Dwell { seconds } => format!("dwell {seconds}"),
                Action::Stop => "stop".to_owned(),
                Action::End => "end".to_owned(),
            };
            format!("{} {action} {}", step.line, program.labels[step.label])
        })
        .collect();
    assert_eq!(
        told,
        [
            "7 rapid BALL-BAR 3D6 R150 F500",
            "8 stop FIT BALL-BAR",
            "9 to 171.500 FIT BALL-BAR",
            "10 dwell 2 FIT BALL-BAR",
            "11 to 170.000 FIT BALL-BAR",
            "12 dwell 3 FIT BALL-BAR",
            "15 to 169.999 EQUATOR CCW",
            "16 to 169.994 EQUATOR CCW",
            "17 dwell 3 EQUATOR CCW",
            "20 to 169.999 EQUATOR CW",
            "21 to 170.000 EQUATOR CW",
            "23 to 171.500 RELEASE",
            "25 end RELEASE",
        ]
    );
}

#[test]
fn every_end_of_line_gives_the_same_program() {
    let plain = program(BALL_BAR);
    for end in ["\r\n", "\n\r\r", ";\n", " ; \r\n"] {
        // A header line % has no end of block.
        let other = BALL_BAR.replace('\n', end).replace("%;", "%").replace("% ;", "%");
        assert_eq!(program(&other), plain, "{end:?}");
    }
    assert_eq!(program(&format!("\u{feff}{BALL_BAR}")), plain, "byte order mark");
    assert_eq!(program(&BALL_BAR.to_lowercase()).steps, plain.steps, "lower case");
}

#[test]
fn what_stands_outside_the_two_percent_lines_is_not_read() {
    let plain = program(BALL_BAR);
    let framed = format!("FROM DRIVE C: 3,5 [#]\n{BALL_BAR}DONE (\n%\n");
    let framed = framed.replacen("\n%\n", "\n% TITLE = 1\n", 1);
    let steps = program(&framed).steps;
    assert_eq!(steps.len(), plain.steps.len());
    assert!(steps.iter().zip(&plain.steps).all(|(a, b)| a.line == b.line + 1));
    let bare = BALL_BAR.replace("%\n", "");
    assert_eq!(program(&bare).steps.len(), plain.steps.len());
}

#[test]
fn nothing_runs_after_the_end() {
    let steps = program("G90 G00 X0. Y0. Z0.\nX1. M02\nX2.\nG28\nM30\n").steps;
    assert!(matches!(steps[..], [_, _]), "{steps:?}");
}

#[test]
fn subprograms_run_as_often_as_they_are_called() {
    let source = "%
O1 (MAIN)
G90 G00 X0. Y0. Z0. F600
M98 P1000 L3
M98 P2000 (AFTER)
M30
O1000 (STEP)
G91 G01 X1.
M98 P2000
M99
O2000
G91 Y1.
M99
%
";
    let program = program(source);
    let lines: Vec<usize> = program.steps.iter().map(|step| step.line).collect();
    assert_eq!(lines, [8, 12, 8, 12, 8, 12, 12, 6]);
    let labels: Vec<&str> =
        program.steps.iter().map(|step| program.labels[step.label].as_str()).collect();
    assert_eq!(labels[0], "STEP");
    assert_eq!(labels[6..], ["AFTER", "AFTER"]);
    let Action::Move(last) = program.steps[6].action else { panic!("no move") };
    assert_eq!(last.end_mm, nalgebra::Vector3::new(23.0, -31.0, 40.0));
}

#[test]
fn four_calls_within_each_other_are_allowed() {
    let source = "G90 G00 X0. Y0. Z0.\nM98 P1\nM30\nO1\nM98 P2\nM99\nO2\nM98 P3\nM99\n\
                  O3\nM98 P4\nM99\nO4\nG01 X1. F60\nM99\n";
    assert_eq!(program(source).steps.len(), 2);
    let deeper = source.replace("G01 X1. F60", "M98 P5") + "O5\nM99\n";
    let error = try_text(&deeper).unwrap_err();
    assert!(error.what.contains("more than 4 deep"), "{error}");
}

#[test]
fn block_delete_and_optional_stop_are_switches() {
    let source = "G90 G00 X0. Y0. Z0.\n/X1. (LONG WAY)\nN5 /1 Y1.\n/ #100 = 1\nM01\nM30\n";
    let mut reading = offsets();
    reading.block_delete = true;
    let file = FilePath::new("O1.nc");
    let with = read(source, file, &reading).unwrap();
    assert_eq!(with.labels.len(), 1);
    assert_eq!(with.steps.len(), 1);
    reading.optional_stop = true;
    let stops = read(source, file, &reading).unwrap().steps;
    assert_eq!(stops[0].action, Action::Stop);
    let all = try_text(&source.replace("/ #100 = 1\n", "")).unwrap();
    assert_eq!(all.steps.len(), 3);
    assert_eq!(all.labels[all.steps[0].label], "LONG WAY");
}

#[test]
fn comments_stand_anywhere() {
    let source = "(FIRST)\nO7(SECOND)\nG90(A)G00 X0.( B )Y0. Z0.\nX1.(C)(D)\n()\nX2.\nM30\n";
    let program = program(source);
    assert_eq!(program.number, Some(7));
    assert_eq!(program.labels, ["", "FIRST", "SECOND", "A", "B", "C", "D", ""]);
    let labels: Vec<usize> = program.steps.iter().map(|step| step.label).collect();
    assert_eq!(labels, [6, 7, 7]);
}

#[test]
fn a_file_that_is_no_program_is_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, what, place) in [
        ("binary.nc", &b"%\nO1\n\x00\x01M30\n%\n"[..], "binary", (0, 0)),
        ("latin.nc", &b"%\nO1 (FR\xc4SEN)\nM30\n%\n"[..], "0xc4", (2, 7)),
        ("empty.nc", &b""[..], "empty", (0, 0)),
        ("blank.nc", &b" \r\n\n"[..], "empty", (0, 0)),
        ("marks.nc", &b"%\n%\n"[..], "no program", (0, 0)),
    ] {
        let file = folder.path().join(name);
        std::fs::write(&file, bytes).unwrap();
        let error = read_file(&file, &offsets()).unwrap_err();
        assert!(error.what.contains(what), "{name}: {error}");
        let found = error.place.unwrap();
        assert_eq!((found.line, found.column), place, "{name}");
    }
    let missing = read_file(&folder.path().join("none.nc"), &offsets()).unwrap_err();
    assert!(missing.what.contains("cannot read the program"), "{missing}");
    let file = folder.path().join("good.nc");
    std::fs::write(&file, BALL_BAR).unwrap();
    assert_eq!(read_file(&file, &offsets()).unwrap().file, file);
}
