//! Programs of which it is known what they do: the judge finds each of them, and lets the right one pass.

use ballbar::machine::{Dialect, Machine};

use crate::bodies::Bodies;
use crate::power::Unstated;
use crate::setting::Setting;
use crate::verdict::{From, Verdict, judge};
use crate::walk::Harm;

/// A horizontal machine with a bar of 150 mm at the test's place.
pub(crate) fn setting() -> Setting {
    Setting {
        dialect: Dialect::Fanuc,
        travel_mm: [[-280.0, 280.0], [-280.0, 280.0], [-200.0, 400.0]],
        rapid_mm_s: [250.0, 250.0, 250.0],
        centre_mm: [20.0, -35.0, 40.0],
        offset: 54,
        length_mm: 150.0,
        range_mm: 1.2,
        feed_mm_s: 500.0 / 60.0,
        bodies: None,
    }
}

/// Travels of a machine file.
const AXES: &str = "[axes.X]\ntravel_mm = [-280.0, 280.0]\nrapid_mm_min = 15000.0\nacceleration_mm_s2 = 1000.0\n\
    [axes.Y]\ntravel_mm = [-280.0, 280.0]\nrapid_mm_min = 15000.0\nacceleration_mm_s2 = 1000.0\n\
    [axes.Z]\ntravel_mm = [-200.0, 400.0]\nrapid_mm_min = 15000.0\nacceleration_mm_s2 = 1000.0\n";

/// A quarter of the equator there and back.
const RIGHT: &str = "\
%
O1001 (BALL-BAR)
G21 G17 G90 G94 G40 G49 G80
G69 G15 G50
G54
G64
M00 (BALL-BAR MUST BE OFF - Z RETRACTS)
G00 G53 Z399.000
G00 G53 X191.500 Y-40.000
M00 (IN G54 THIS MUST BE X171.500 Y-5.000 Z359.000)
G00 X171.500 Y-5.000 Z45.000
G01 X171.500 Y-5.000 Z-5.000 F500.
G01 X151.500 Y0.000 Z0.000
M00 (FIT BALL-BAR)
G04 P2000
G01 X150.000 Y0.000 Z0.000
G03 X0.000 Y150.000 Z0.000 I-150.000 J0.000
G04 P3000
G02 X150.000 Y0.000 Z0.000 R150.000
G04 P3000
G01 X151.500 Y0.000 Z0.000
M00 (TAKE BALL-BAR OFF)
G00 X151.500 Y0.000 Z359.000
M30
%
";

pub(crate) fn judged(text: &str, setting: &Setting) -> Verdict {
    judge(text, setting, &setting.places())
}

/// The judgement of the program with something else in the place of a part of it.
fn with(from: &str, to: &str) -> Verdict {
    assert!(RIGHT.contains(from), "{from}");
    judged(&RIGHT.replacen(from, to, 1), &setting())
}

fn found(verdict: &Verdict, from: From, harm: Harm) -> bool {
    verdict.harms.iter().any(|(at, harmful)| *at == from && harmful.harm == harm)
}

#[test]
fn the_right_program_is_harmless() {
    let verdict = with("M30", "M30");
    assert!(verdict.is_harmless(), "{verdict:?}");
    let mut linuxcnc = setting();
    linuxcnc.dialect = Dialect::LinuxCnc;
    let spoken = RIGHT.replace("G69 G15 G50\n", "").replace("G04 P2000", "G04 P2.");
    let verdict = judged(&spoken, &linuxcnc);
    assert!(verdict.is_harmless(), "{verdict:?}");
}

/// One program for a bar of another mounting: the shorter sphere is too near, and of the longer one the bar reads nothing.
#[test]
fn a_program_of_another_bar_is_no_test_of_this_one() {
    let longer = Setting { length_mm: 250.0, ..setting() };
    assert!(found(&judged(RIGHT, &longer), From::Anywhere, Harm::TooNear));
    let shorter = Setting { length_mm: 100.0, ..setting() };
    let verdict = judged(RIGHT, &shorter);
    assert!(!verdict.is_test && !verdict.is_harmless(), "{verdict:?}");
}

/// A sign is lost on the way to where the bar is fitted; there and back before it is fitted; with it; after it.
#[test]
fn ways_through_the_workpiece_ball_are_found() {
    let sign = with("G01 X151.500", "G01 X-151.500");
    assert!(found(&sign, From::Anywhere, Harm::TooNear), "{sign:?}");
    assert!(found(&sign, From::Anywhere, Harm::Crushed), "{sign:?}");
    let there = with("M00 (FIT", "G01 X0. Y0. Z0.\nG01 X151.500\nM00 (FIT");
    assert!(found(&there, From::Anywhere, Harm::TooNear), "{there:?}");
    let fitted = with("G04 P2000", "G01 X0. Y0. Z0.\nG01 X151.500");
    assert!(found(&fitted, From::Anywhere, Harm::Crushed), "{fitted:?}");
    let after = with("BALL-BAR OFF)\nG00", "BALL-BAR OFF)\nG01 X-151.500\nG00");
    assert!(found(&after, From::Anywhere, Harm::TooNear), "{after:?}");
}

/// As programs were written before: they ended with the bar in, and began with a positioning in three axes.
#[test]
fn a_second_start_that_crashes_is_found() {
    let (head, rest) = RIGHT.split_once("M00 (BALL-BAR MUST").unwrap();
    let (_, rest) = rest.split_once("Z45.000\n").unwrap();
    let text = format!("{head}G00 X171.500 Y-5.000 Z-5.000\n{rest}");
    let text = text.replace("M00 (TAKE BALL-BAR OFF)\nG00 X151.500 Y0.000 Z359.000\n", "");
    let text =
        text.replace("G03 X0.000 Y150.000 Z0.000 I-150.000", "G03 X-150.000 Y0. Z0. I-150.000");
    let text = text.replace("G02 X150.000 Y0.000 Z0.000 R150.000\n", "");
    let text = text.replace("G04 P3000\nG01 X151.500", "G01 X-151.500");
    let verdict = judged(&text, &setting());
    assert!(verdict.refused.is_none(), "{verdict:?}");
    assert!(found(&verdict, From::SomePlace, Harm::TooNear), "{verdict:?}");
    assert!(found(&verdict, From::Again, Harm::Dragged), "{verdict:?}");
}

#[test]
fn each_harm_has_its_name() {
    for (from, to, harm) in [
        ("G03 X0.000 Y150.000 Z0.000 I-150.000 J0.000", "G03 X0. Y150. R140.", Harm::Stretched),
        ("G03 X0.000 Y150.000 Z0.000 I-150.000 J0.000", "G01 X0. Y150.", Harm::Crushed),
        // A radius of 100 m is nearly a line.
        ("G03 X0.000 Y150.000 Z0.000 I-150.000 J0.000", "G03 X0. Y150. R99999.", Harm::Crushed),
        ("G01 X150.000", "G01 X150. Y1.\nG00 X150.000", Harm::Dragged),
        ("G04 P3000\nG01 X151.500", "G01 X249.\nG01 X150.2\nG01 X151.500", Harm::Crushed),
        ("M00 (TAKE BALL-BAR OFF)\n", "", Harm::Dragged),
        ("G00 X151.500 Y0.000 Z359.000", "G00 X151.500 Y0.000 Z360.001", Harm::Travel),
        ("G04 P2000", "G04 P2000 M03", Harm::Spindle),
        ("G01 X150.000 Y0.000", "G01 F501. X150.000 Y0.000", Harm::TooFast),
    ] {
        let verdict = with(from, to);
        assert!(found(&verdict, From::Anywhere, harm), "{to}: {verdict:?}");
    }
}

/// A straight positioning keeps off; with every axis at its own rapid traverse it goes through the bar's reach.
#[test]
fn every_axis_by_itself_is_another_way() {
    let around = "BALL-BAR OFF)\nG00 X250.000 Y-20.000\nG00 X-20.000 Y250.000\nG00";
    let text = RIGHT.replacen("BALL-BAR OFF)\nG00", around, 1);
    let text = text.replacen("G00 X151.500 Y0.000 Z359", "G00 X-20.000 Y250.000 Z359", 1);
    let mut unlike = setting();
    unlike.rapid_mm_s = [1000.0, 250.0, 250.0];
    assert!(found(&judged(&text, &unlike), From::Anywhere, Harm::TooNear));
    let alike = judged(&text, &setting());
    assert!(alike.is_harmless(), "{alike:?}");
    unlike.dialect = Dialect::LinuxCnc;
    let verdict = judged(&text.replace("G69 G15 G50\n", ""), &unlike);
    assert!(verdict.is_harmless(), "{verdict:?}");
}

/// A spindle nose just above the tool ball that reaches over to the post when it comes below its top.
#[test]
fn what_stands_behind_the_balls_touches() {
    let machine = |direction: &str| {
        let source = format!(
            "name = \"Wide\"\ntopology = \"wCBXFZYSt\"\n[controller]\ndialect = \"fanuc\"\n[clearance.tool]\ndiameter_mm = 9.0\nlength_mm = 10.0\n\
             [clearance.spindle_nose]\ndiameter_mm = 320.0\nlength_mm = 50.0\n[clearance.support]\ndiameter_mm = 25.0\nlength_mm = 70.0\ndirection = \"{direction}\"\n{AXES}"
        );
        Bodies::of(&Machine::parse(&source, "m.toml".as_ref()).unwrap())
    };
    for (direction, from, to, touches) in [
        ("-Z", "M30", "M30", false),
        ("-Z", "Z-5.000 F500.", "Z-15.000 F500.", true),
        // The post lies: its side is 12.5 mm above the ball.
        ("-Y", "M30", "M30", true),
        ("+Z", "M30", "M30", true),
    ] {
        let setting = Setting { bodies: machine(direction), ..setting() };
        let verdict = judged(&RIGHT.replacen(from, to, 1), &setting);
        assert_eq!(found(&verdict, From::Anywhere, Harm::Touching), touches, "{verdict:?}");
    }
}

#[test]
fn what_is_not_stated_is_found_and_what_it_does() {
    // The equator of a bar does not mind being turned, or lifted by a tool length: the bar reads nothing then.
    for (from, to, group, harms) in [
        ("G21 ", "", Unstated::Unit, true),
        ("G54\n", "", Unstated::Offset, true),
        ("X171.500 Y-5.000 Z-5", "X171.500 Y-5000 Z-5", Unstated::Point, true),
        ("G17 ", "", Unstated::Plane, false),
        ("G49 ", "", Unstated::Length, false),
        ("G69 ", "", Unstated::Rotation, false),
    ] {
        let verdict = with(from, to);
        assert!(verdict.depends.contains(&group) && !verdict.is_harmless(), "{to}: {verdict:?}");
        let left = verdict.harms.iter().any(|(from, _)| *from == From::Left(group));
        assert_eq!(left, harms, "{group:?}: {verdict:?}");
    }
}

#[test]
fn what_no_control_takes_is_refused() {
    for (from, to) in [
        ("M30", "M05"),
        ("X150.000 Y0.000 Z0.000\nG03", "X150..000\nG03"),
        (" F500.", ""),
        ("I-150.000", "I-140.000"),
        ("G64", "G67"),
        ("Y-5.000 Z45", "Y-5.000 Y3. Z45"),
        ("R150.000", "R100.000"),
        ("G04 P2000", "M98 P2000"),
        ("(FIT BALL-BAR)", "(FIT BALL-BAR"),
    ] {
        let verdict = with(from, to);
        assert!(verdict.refused.is_some(), "{to}: {verdict:?}");
    }
}
