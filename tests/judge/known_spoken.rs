//! The same of Siemens and Klartext: the judge finds what each program does, and lets the right one pass.

use ballbar::machine::Dialect;

use crate::known::{judged, setting};
use crate::power::Unstated;
use crate::setting::Setting;
use crate::tongue::Tongue;
use crate::verdict::Verdict;
use crate::walk::{Bar, Harm};

/// A quarter of the equator there and back, in the words of a Siemens.
const OF_SIEMENS: &str = "\
; BALLBAR_1001
G710 G17 G90 G94 G40
D0
MCALL
TRAFOOF
TRANS
COMPOF
G54
G64
M0 ; BALL-BAR MUST BE OFF - Z RETRACTS
G0 SUPA Z399.000
G0 SUPA X191.500 Y-40.000
M0 ; IN G54 THIS MUST BE X171.500 Y-5.000 Z359.000
G0 X171.500 Y-5.000 Z45.000
G1 X171.500 Y-5.000 Z-5.000 F500
N10 G1 X=151.500 Y0.000 Z0.000
M0 ; FIT BALL-BAR
G4 F2.0
g1 X150.000 Y0.000 Z0.000
G3 X0.000 Y150.000 Z0.000 I-150.000 J0.000
G2 X150.000 Y0.000 CR=150.000
G1 X151.500 Y0.000 Z0.000
M0 ; TAKE BALL-BAR OFF
G0 X151.500 Y0.000 Z359.000
M30
";

/// The same in Klartext, without the numbers of its blocks.
const OF_TNC: &str = "\
BEGIN PGM BALLBAR_1001 MM
TOOL CALL Z
CYCL DEF 7.0 DATUM SHIFT
CYCL DEF 7.1 X+0
CYCL DEF 7.2 Y+0
CYCL DEF 7.3 Z+0
CYCL DEF 8.0 MIRROR IMAGE
CYCL DEF 8.1
CYCL DEF 10.0 ROTATION
CYCL DEF 10.1 ROT+0
CYCL DEF 11.0 SCALING
CYCL DEF 11.1 SCL 1
; BALL-BAR MUST BE OFF - Z RETRACTS
STOP
L Z+399.000 R0 FMAX M91
L X+191.500 Y-40.000 R0 FMAX M91
; IN DATUM THIS MUST BE X+171.500 Y-5.000 Z+359.000
STOP
L X+171.500 Y-5.000 Z+45.000 R0 FMAX
L X+171.500 Y-5.000 Z-5.000 R0 F500
L X+151.500 Y+0.000 Z+0.000
; FIT BALL-BAR
STOP
CYCL DEF 9.0 DWELL TIME
CYCL DEF 9.1 DWELL 2.0
L X+150.000 Y+0.000 Z+0.000
CC X+0.000 Y+0.000
C X+0.000 Y+150.000 DR+ R0
C X+150.000 Y+0.000 DR- R0
L X+151.500 Y+0.000 Z+0.000
; TAKE BALL-BAR OFF
STOP
L X+151.500 Y+0.000 Z+359.000 R0 FMAX
M30
END PGM BALLBAR_1001 MM
";

/// Judges the program of a control with something else in the place of a part of it.
fn spoken(dialect: Dialect, from: &str, to: &str) -> Verdict {
    let tnc = dialect == Dialect::Heidenhain;
    let text = if tnc { OF_TNC } else { OF_SIEMENS };
    assert!(text.contains(from), "{from}");
    let lines: Vec<String> = text.replacen(from, to, 1).lines().map(str::to_owned).collect();
    judged(&Tongue::of(dialect).text(&lines), &Setting { dialect, ..setting() })
}

#[test]
fn other_languages_do_the_same() {
    for dialect in [Dialect::Siemens, Dialect::Heidenhain] {
        let verdict = spoken(dialect, "M30", "M30");
        assert!(verdict.is_harmless(), "{verdict:?}");
        assert_eq!(verdict.end.map(|(_, bar)| bar), Some(Bar::Off));
    }
}

#[test]
fn harms_in_other_languages_have_their_names() {
    use Dialect::{Heidenhain as Tnc, Siemens};
    for (dialect, from, to, harm) in [
        (Siemens, "G1 X=151.500", "G1 X=-151.500", Harm::TooNear),
        (Siemens, "I-150.000 J0.000\nG2", "I-150.000 J0.000\nG3", Harm::Crushed),
        (Siemens, "G2 X150.000 Y0.000 CR=150.000", "G1 X150.000 Y0.000", Harm::Crushed),
        (Siemens, "M0 ; TAKE BALL-BAR OFF\n", "", Harm::Dragged),
        (Siemens, "X151.500 Y0.000 Z359", "X151.500 Y0.000 Z361", Harm::Travel),
        (Siemens, "M0 ; FIT", "M3\nM0 ; FIT", Harm::Spindle),
        (Siemens, "F500", "F501", Harm::TooFast),
        (Siemens, "G0 SUPA X191.500 Y-40.000", "G0 SUPA X191.500 Y-40.000 Z40", Harm::TooNear),
        (Tnc, "L X+151.500 Y+0.000 Z+0.000\n; FIT", "L X-151.500\n; FIT", Harm::TooNear),
        (Tnc, "C X+150.000 Y+0.000 DR- R0", "L X+150.000 Y+0.000", Harm::Crushed),
        (Tnc, "CC X+0.000 Y+0.000", "CC X+75.000 Y+75.000", Harm::Stretched),
        (Tnc, "; TAKE BALL-BAR OFF\nSTOP\n", "", Harm::Dragged),
        (Tnc, "; TAKE BALL-BAR OFF\n", "", Harm::Dragged),
        (Tnc, "Z+359.000 R0", "Z+361.000 R0", Harm::Travel),
        (Tnc, "M30", "M3\nM30", Harm::Spindle),
        (Tnc, "L X+150.000", "L X+150.000 F501", Harm::TooFast),
        (Tnc, "L X+151.500 Y+0.000 Z+0.000\n; FIT", "L X+151.000 FMAX\n; FIT", Harm::TooNear),
    ] {
        let verdict = spoken(dialect, from, to);
        let named = verdict.harms.iter().any(|(_, harmful)| harmful.harm == harm);
        assert!(named, "{to}: {verdict:?}");
    }
}

#[test]
fn what_other_languages_leave_unstated_is_found() {
    use Dialect::{Heidenhain as Tnc, Siemens};
    for (dialect, from, to, group) in [
        (Siemens, "G710 ", "", Unstated::Unit),
        (Siemens, "G17 ", "", Unstated::Plane),
        (Siemens, "D0\n", "", Unstated::Length),
        (Siemens, "MCALL\n", "", Unstated::Cycle),
        (Siemens, "TRAFOOF\n", "", Unstated::Transformation),
        (Siemens, "TRANS\n", "", Unstated::Shift),
        (Siemens, "G54\n", "", Unstated::Offset),
        (Tnc, "TOOL CALL Z\n", "", Unstated::Plane),
        (Tnc, "CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1\n", "", Unstated::Mirror),
        (Tnc, "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0\n", "", Unstated::Rotation),
        (Tnc, "CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 1\n", "", Unstated::Scaling),
        (Tnc, "R0 FMAX M91", "FMAX M91", Unstated::Cutter),
    ] {
        let verdict = spoken(dialect, from, to);
        assert!(verdict.refused.is_none(), "{from}: {verdict:?}");
        assert!(verdict.depends.contains(&group) && !verdict.is_harmless(), "{from}: {verdict:?}");
    }
}

#[test]
fn what_a_siemens_or_a_tnc_does_not_take_is_refused() {
    use Dialect::{Heidenhain as Tnc, Siemens};
    for (dialect, from, to) in [
        (Siemens, "M30", "M5"),
        (Siemens, "G64", "G642"),
        (Siemens, "G64", "ROT Z45"),
        (Siemens, "SUPA", "SUPER"),
        (Siemens, "G0 SUPA", "G1 SUPA"),
        (Siemens, "CR=150", "CR=100"),
        (Siemens, "CR=150", "R150"),
        (Siemens, "D0", "D1"),
        (Siemens, "G4 F2.0", "G4 F2.0 M5"),
        (Siemens, "F500", "F0.0001"),
        (Siemens, "X=151.500", "X=151500"),
        (Tnc, "M30", "M5"),
        (Tnc, "STOP", "START"),
        (Tnc, "TOOL CALL Z", "TOOL CALL 5 Z"),
        (Tnc, "7.2 Y+0", "7.2 Y+1"),
        (Tnc, "CYCL DEF 7.3 Z+0\n", ""),
        (Tnc, "DR+", ""),
        (Tnc, "CC X+0.000 Y+0.000", "CC X+0.000"),
        (Tnc, "L Z+399.000 R0 FMAX M91", "L Z+399.000 R0 F100 M91"),
        (Tnc, "X+150.000", "IX+150.000"),
        (Tnc, "END PGM BALLBAR_1001 MM\n", ""),
        (Tnc, "F500", "F1000001"),
        (Tnc, "X+171.500 Y-5.000 Z+45", "X+171500 Y-5.000 Z+45"),
    ] {
        let verdict = spoken(dialect, from, to);
        assert!(verdict.refused.is_some(), "{to}: {verdict:?}");
    }
    let unnumbered = judged(OF_TNC, &Setting { dialect: Tnc, ..setting() });
    assert!(unnumbered.refused.is_some());
}
