//! Programs of Siemens and Klartext: what their words do, and what is refused with its place.

use std::path::Path as FilePath;

use nalgebra::Vector3;

use super::super::read::read_at_most;
use super::super::{Action, Path, Program, Reading};
use crate::error::Result;
use crate::machine::Dialect;

const ZERO_MM: Vector3<f64> = Vector3::new(20.0, -35.0, 40.0);

fn read(dialect: Dialect, source: &str) -> Result<Program> {
    let mut reading = Reading { dialect, ..Reading::default() };
    reading.work_offsets_mm.insert(54, ZERO_MM);
    read_at_most(source, FilePath::new("P"), &reading, 10_000)
}

/// The blocks of a TNC, numbered, in a program.
fn klartext(blocks: &str) -> String {
    let lines = format!("BEGIN PGM P MM\n{blocks}\nM30\nEND PGM P MM");
    let lines = lines.lines().enumerate().map(|(number, line)| format!("{number} {line}\n"));
    lines.collect()
}

/// What a program does, from the zero of its work offset.
fn does(dialect: Dialect, source: &str) -> Vec<String> {
    let program = read(dialect, source).unwrap_or_else(|error| panic!("{error}\n{source}"));
    let place = |at: Vector3<f64>| {
        let [x, y, z] = (at - ZERO_MM).map(|mm| (mm * 1e6).round() / 1e6 + 0.0).into();
        format!("{x},{y},{z}")
    };
    let told = |action: &Action| match action {
        Action::Move(motion) => {
            let turn = match motion.path {
                Path::Line => String::new(),
                Path::Arc { sweep_rad, axis, .. } => {
                    format!(" turn {:.1} about {axis}", sweep_rad.to_degrees())
                }
            };
            let stop = if motion.exact_stop { " and stop" } else { "" };
            format!("F{:.0} to {}{turn}{stop}", motion.feed_mm_s * 60.0, place(motion.end_mm))
        }
        Action::Dwell { seconds } => format!("wait {seconds}"),
        Action::Stop => "stop".to_owned(),
        Action::End => "end".to_owned(),
    };
    program.steps.iter().map(|step| told(&step.action)).collect()
}

#[test]
fn words_of_a_siemens_control() {
    let source = "%_N_P_MPF\n; A COMMENT\nN10 G710 G17 G90 G94 G40 D0\nMCALL\nTRAFOOF\nTRANS\nG54 G64\n\
                  G0 SUPA Z90\nG0 X=100 Y0 Z0\nM0 ; FIT\ng1 x110 F600\nG4 F2.5\n\
                  G3 X110 Y0 I-110 J0\nG2 X0 Y110 CR=-110 F=300\nG18 G3 X0 Z0 I0 K-5 F1200\n\
                  G60\nG1 X1\nG64 G9 X2\nG91 X1\nSOFT FFWON COMPOF\nM30\n";
    let found = does(Dialect::Siemens, source);
    let expected = [
        "stop",
        "F600 to 110,0,0",
        "wait 2.5",
        "F600 to 110,0,0 turn 360.0 about 2",
        "F300 to 0,110,0 turn -270.0 about 2",
        "F1200 to 0,110,0 turn 360.0 about 1",
        "F1200 to 1,110,0 and stop",
        "F1200 to 2,110,0 and stop",
        "F1200 to 3,110,0",
        "end",
    ];
    assert_eq!(found, expected);
}

#[test]
fn words_of_klartext() {
    let source = klartext(
        "; A COMMENT\n* - A HEADING\nTOOL CALL Z S0\nCYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+0\n\
         CYCL DEF 7.2 Y+0\nCYCL DEF 7.3 Z+0\nCYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0.000\n\
         L Z+90 R0 FMAX M91\nL X100 Y+0 Z-0.5 R0 FMAX\nSTOP\nL X+110 F600 ; IN\n\
         CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 2.5\nCC X+0 Y+0\nC X+110 Y+0 DR+\n\
         C X+0 Y+110 DR- F300\nL Z+5 FMAX\nL Z+6",
    );
    let found = does(Dialect::Heidenhain, &source);
    let expected = [
        "stop",
        "F600 to 110,0,-0.5",
        "wait 2.5",
        "F600 to 110,0,-0.5 turn 360.0 about 2",
        "F300 to 0,110,-0.5 turn -270.0 about 2",
        "F0 to 0,110,5",
        "F300 to 0,110,6",
        "end",
    ];
    assert_eq!(found, expected);
}

#[track_caller]
fn refused(dialect: Dialect, source: &str, place: (usize, usize), what: &str) {
    let error = match read(dialect, source) {
        Err(error) => error,
        Ok(program) => panic!("read {source:?} as {:?}", program.steps),
    };
    assert!(error.what.contains(what), "{source:?}:\n{error}");
    let found = error.place.as_ref().expect("a place");
    assert_eq!((found.line, found.column), place, "{source:?}:\n{error}");
    assert!(error.hint.is_some() && !error.what.ends_with('.'), "{error}");
}

#[test]
fn what_a_siemens_program_says_is_never_skipped() {
    for (block, column, what) in [
        ("CYCLE832(0.01)", 1, "CYCLE is not known"),
        ("TRAORI", 1, "TRAORI is not known"),
        ("ROT Z45", 1, "ROT is not known"),
        ("G642", 1, "G642 is not known"),
        ("G500", 1, "G500 is not known"),
        ("G505", 1, "G505 is not known"),
        ("G58 X1", 1, "G58 is not known"),
        ("G70", 1, "G70 is not known"),
        ("G53 G0 Z1", 1, "G53 is not known"),
        ("G75 Z0", 1, "G75 is not known"),
        ("D1", 1, "D1 has no meaning"),
        ("L100", 1, "L100 has no meaning"),
        ("M98 P1", 1, "M98 is not known"),
        ("M17", 1, "M17 is not known"),
        ("R1=5", 1, "R parameters are not followed"),
        ("G1 X=AC(5) F100", 4, "a value that is not a number"),
        ("G1 X=R1 F100", 4, "a value that is not a number"),
        ("G3 X0 Y10 CR 5", 11, "CR without ="),
        ("G3 X0 Y10 I5 CR=5 F100", 14, "by centre and by radius at once"),
        ("(A COMMENT)", 1, "`(` has no meaning"),
        ("O100", 1, "no O numbers"),
        ("G4 X2", 4, "X2 has no meaning"),
        ("G4 F2 M5", 1, "not alone in its block"),
        ("G4 F-1", 4, "is negative"),
        ("G4", 1, "a dwell needs one time"),
        ("G1 SUPA Z5 F100", 4, "SUPA without G0"),
        ("LABEL: G1", 1, "LABEL is not known"),
        ("MSG(\"HI\")", 1, "MSG is not known"),
        ("G1 X1,5 F100", 6, "`,` has no meaning"),
        ("TURN=2", 1, "TURN is not known"),
        ("X=100000", 1, "X100000 is 100000 mm, outside of -99999.999 to 99999.999 mm"),
        ("G700 X3938", 6, "X3938 is 100025.2 mm"),
        ("G3 X5 Y5 CR=-100000 F100", 10, "R-100000 is -100000 mm"),
        ("F=1000001", 1, "F1000001 is 1000001 mm/min, outside of 0.001 to 1000000 mm/min"),
        ("G4 F100000", 4, "99999.999 s at the most"),
        ("N100000000 X1", 1, "N100000000 is 100000000, outside of 0 to 99999999"),
    ] {
        let source = format!("G90 G0 X0 Y0 Z0\n{block}\nM30\n");
        refused(Dialect::Siemens, &source, (2, column), what);
    }
    refused(Dialect::Siemens, "G90 G0 X0 Y0 Z0\n", (1, 0), "without M30");
    refused(
        Dialect::Siemens,
        "G90 G0 X0 Y0\nG1 Z5 F100\nM30\n",
        (2, 4),
        "place of Z that is not known",
    );
}

#[test]
fn what_a_klartext_program_says_is_never_skipped() {
    for (block, column, what) in [
        ("L IX+5 F100", 5, "an incremental coordinate"),
        ("L X+5 RL F100", 9, "RL is not known"),
        ("L X+5,5 F100", 5, "a decimal comma"),
        ("L X+5 A+30 F100", 9, "`A+30` has no meaning"),
        ("L X+Q1 F100", 5, "no number"),
        ("L X+5..5 F100", 5, "more than one decimal point"),
        ("L X+5 FAUTO", 9, "no number"),
        ("L X+5 F100 M91", 14, "M91 without FMAX"),
        ("L X+5 F100 M128", 14, "M128 is not known"),
        ("C X+5 Y+5", 3, "without DR+ or DR-"),
        ("C X+5 Y+5 DR+ DR-", 3, "two senses"),
        ("CR X+5 Y+5 R+5 DR+", 3, "`CR` is not followed"),
        ("CP IPA+360 DR+", 3, "`CP` is not followed"),
        ("TOOL CALL 5 Z S100", 13, "a tool is changed"),
        ("TOOL CALL", 3, "without a tool axis"),
        ("CALL LBL 1", 3, "`CALL` is not followed"),
        ("FN 0: Q1 = 5", 3, "`FN` is not followed"),
        ("BLK FORM 0.1 Z X+0 Y+0 Z+0", 3, "`BLK` is not followed"),
        ("CYCL DEF 32.0 TOLERANCE", 12, "cycle 32.0 is not followed"),
        ("CYCL DEF 247 DATUM SETTING", 12, "cycle 247 is not followed"),
        ("CYCL DEF 7.1 X+10", 12, "cycle 7 lacks its block 7.0"),
        ("PLANE SPATIAL SPA+0", 3, "`PLANE` is not followed"),
        ("STOP M6", 3, "`STOP` is not followed"),
        ("BEGIN PGM Q MM", 3, "`BEGIN` is not followed"),
        ("L X+100000 R0 F100", 5, "X100000 is 100000 mm, outside of -99999.999 to 99999.999 mm"),
        ("CC Y-100000", 6, "Y-100000 is -100000 mm"),
        ("L X+5 F0.0001", 9, "F0.0001 is 0.0001 mm/min, outside of 0.001 to 1000000 mm/min"),
        ("TOOL CALL Z S100000000", 15, "S100000000 is 100000000"),
    ] {
        let source = klartext(&format!("L X+0 Y+0 Z+0 R0 FMAX\n{block}"));
        refused(Dialect::Heidenhain, &source, (3, column), what);
    }
    for (blocks, place, what) in [
        ("CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+30", (3, 12), "cycle 10 moves the path"),
        ("CYCL DEF 9.0 DWELL TIME\nL X+5 F100", (3, 3), "cycle 9 lacks its block 9.1"),
        ("CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 3601", (3, 22), "3600 s at the most"),
        ("L X+5 Y+0 Z+0 R0 FMAX\nL Y+1", (3, 5), "a feed move without a feed"),
        ("L X+5 Y+0 Z+0 R0 FMAX\nC X+5 Y+0 DR+ F100", (3, 3), "whose pole has no X"),
        ("L X+5 Y+0 Z+0 R0 FMAX\nCC X+0\nC X+5 Y+0 DR+ F100", (4, 3), "whose pole has no Y"),
        (
            "TOOL CALL Y\nL X+5 Y+0 Z+0 R0 FMAX\nCC X+0 Y+0\nC X+5 Y+0 DR+ F100",
            (5, 3),
            "whose pole has no Z",
        ),
    ] {
        refused(Dialect::Heidenhain, &klartext(blocks), place, what);
    }
    let whole = klartext("L X+0 Y+0 Z+0 R0 FMAX");
    refused(Dialect::Heidenhain, &whole.replace("1 L X", "2 L X"), (2, 1), "block 2 where block 1");
    refused(
        Dialect::Heidenhain,
        &whole.replace("1 L X", "L X"),
        (2, 1),
        "a block without a number",
    );
    let cut = whole.replace("3 END PGM P MM\n", "");
    refused(Dialect::Heidenhain, &cut, (3, 0), "does not end with it");
    refused(
        Dialect::Heidenhain,
        "0 L X+1 R0 FMAX\n1 M30\n",
        (1, 3),
        "does not begin with BEGIN PGM",
    );
}

/// A file says whose it is before half of it is taken for something else.
#[test]
fn a_program_of_another_control_is_told_as_a_whole() {
    let fanuc = "%\nO1\nG90 G00 X0. Y0. Z0.\nM30\n%\n";
    let siemens = "%_N_P_MPF\nG0 X0 Y0 Z0\nM30\n";
    let tnc = klartext("L X+0 Y+0 Z+0 R0 FMAX");
    for (source, of) in [
        (fanuc, [Dialect::Siemens, Dialect::Heidenhain].as_slice()),
        (siemens, &[Dialect::Fanuc, Dialect::LinuxCnc, Dialect::Heidenhain]),
        (&tnc, &[Dialect::Fanuc, Dialect::LinuxCnc, Dialect::Siemens]),
    ] {
        for dialect in of {
            refused(*dialect, source, (0, 0), "the machine file names another dialect");
        }
    }
    let reading = Reading { dialect: Dialect::Fanuc, ..Reading::default() };
    for (name, spoken) in [("P.MPF", "siemens"), ("p.h.gz", "heidenhain")] {
        let error = super::read("G0 X0\n", FilePath::new(name), &reading).unwrap_err();
        assert!(error.hint.unwrap().contains(spoken), "{name}");
    }
}
