//! Files of Ballbar 20 by what is known of them, and files that are none.

use std::fmt::Write as _;
use std::path::Path;

use super::*;
use crate::error::{Error, Result};
use crate::plan::log_format::ClockwiseOrder;

/// What a file has of a run: readings in mm, evenly over an arc.
fn readings(arc_deg: f64) -> Vec<f64> {
    let angle = |k: i32| (arc_deg * (f64::from(k) + 0.5) / 400.0).to_radians();
    (0..400).map(|k| 0.02 + 0.03 * angle(k).cos() + 0.004 * (2.0 * angle(k)).sin()).collect()
}

/// Of a full circle: the width of the second harmonic.
const ROUND_MM: f64 = 0.008;

struct Written {
    scale: f64,
    runs: usize,
    name: &'static str,
    round_mm: Option<f64>,
    arc_deg: f64,
}

const PLAIN: Written = Written {
    scale: 1.0,
    runs: 2,
    name: "XY 360 grad 150mm",
    round_mm: Some(ROUND_MM),
    arc_deg: 360.0,
};

impl Written {
    fn text(&self) -> String {
        let mut text = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<TEST_DOCUMENT>\n<TEST_SPEC NAME=\"{}\" version=\"1\">\n\
             <INSTRUMENT MANUFACTURER=\"Renishaw\" MODEL=\"QC20-W\"/>\n<NOMINAL_LENGTH>150</NOMINAL_LENGTH>\n\
             <PROGRAMMED_FEEDRATE>1000</PROGRAMMED_FEEDRATE>\n<PLANE TEST_PLANE=\"XY\" VIEW=\"+A+B\"/>\n</TEST_SPEC>\n\
             <OPERATOR>M. Meier &amp; Sohn</OPERATOR>\n<DATE_STARTED>20251218-194332</DATE_STARTED>\n\
             <MACHINE_TESTED NAME=\"DMU 50\"/>\n<SERIAL_NUMBER>0AF3</SERIAL_NUMBER>\n\
             <LAST_CALIBRATED>20250301</LAST_CALIBRATED>\n<RUN_RESULTS>\n",
            self.name
        );
        for run in 0..self.runs {
            let direction = if run % 2 == 0 { "CW" } else { "CCW" };
            write!(text, "<BALLBAR_RUN>\n<RUN_DIRECTION>{direction}</RUN_DIRECTION>\n<READINGS>")
                .unwrap();
            for reading in readings(self.arc_deg) {
                write!(text, "{:.6} ", reading * self.scale).unwrap();
            }
            text += "</READINGS>\n";
            if let Some(round_mm) = self.round_mm {
                writeln!(
                    text,
                    "<FEATURE NAME=\"AF_CIRCULARITY\" DT=\"UT_LENGTH_MM\">{round_mm}</FEATURE>"
                )
                .unwrap();
            }
            text += "<FEATURE NAME=\"AF_CALCULATED_FEEDRATE\" DT=\"UT_FEEDRATE\">998</FEATURE>\n</BALLBAR_RUN>\n";
        }
        text + "</RUN_RESULTS>\n<ANALYSIS NAME=\"RENISHAW_DIAGNOSTICS\"><FEATURE NAME=\"AF_SQUARENESS\" DT=\"UT_SQUARENESS\">-12.5</FEATURE></ANALYSIS>\n</TEST_DOCUMENT>\n"
    }
}

fn with(text: &str, format: &Format) -> Result<Log> {
    read_bytes(text.as_bytes(), Path::new("run.b5r"), format)
}

fn log(text: &str) -> Log {
    with(text, &Format::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[track_caller]
fn refused(text: &str) -> Error {
    let error = with(text, &Format::default()).expect_err("the file should be refused");
    assert!(error.hint.is_some(), "{error}");
    error
}

fn is_plain(log: &Log) {
    let expected = readings(360.0);
    let found: Vec<f64> = log.readings().iter().filter_map(|r| r.deviation_mm).collect();
    assert!(found.iter().zip(expected.iter().cycle()).all(|(a, b)| (a - b).abs() < 1e-6));
    let by_angle = log.by_angle().expect("angles");
    assert_eq!(by_angle.plane, [0, 1]);
    assert_eq!(found.len(), 400 * by_angle.turns.len());
    let ways = [false, true];
    assert!(by_angle.turns.iter().zip(ways).all(|(turn, way)| turn.counter_clockwise == way));
}

#[test]
fn millimetres_and_micrometres_one_run_and_two() {
    for (scale, unit) in [(1.0, "mm"), (1e3, "um")] {
        for runs in [1, 2] {
            for round_mm in [Some(ROUND_MM), None] {
                let log = log(&Written { scale, runs, round_mm, ..PLAIN }.text());
                is_plain(&log);
                assert!(log.notes()[0].contains(&format!("taken for {unit}")), "{:?}", log.notes());
            }
        }
    }
}

#[test]
fn the_same_in_other_clothes() {
    let plain = PLAIN.text();
    for text in [
        plain
            .replace("<BALLBAR_RUN>", "<r:BALLBAR_RUN xmlns:r=\"urn:x\">")
            .replace("</BALLBAR_RUN>", "</r:BALLBAR_RUN>"),
        plain.replace("<TEST_DOCUMENT>", "<TEST_DOCUMENT xmlns=\"urn:renishaw\">"),
        plain.replace("<OPERATOR>", "<UNKNOWN a=\"1\"><DEEP/>x</UNKNOWN><OPERATOR>"),
        plain.replace("</READINGS>", "</READINGS><!-- a remark --><FEATURE/>"),
        plain.replace('\n', "\r\n"),
        format!("\u{feff}{plain}"),
        plain.replace("<READINGS>", "<READINGS><![CDATA[").replace("</READINGS>", "]]></READINGS>"),
    ] {
        is_plain(&log(&text));
    }
    let utf16: Vec<u8> =
        format!("\u{feff}{plain}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    is_plain(&read_bytes(&utf16, Path::new("run.b5r"), &Format::default()).unwrap());
    let comma = PLAIN.text();
    let at = comma.find("<READINGS>").unwrap();
    let comma = format!("{}{}", &comma[..at], comma[at..].replace("0.0", "0,0"));
    is_plain(&log(&comma));
}

#[test]
fn what_is_in_a_file() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("run.b5r");
    std::fs::write(&file, PLAIN.text()).unwrap();
    let Content::Ballbar(found) = look_into(&file, None).unwrap() else { panic!("a table") };
    assert_eq!(found.operator.as_deref(), Some("M. Meier & Sohn"));
    assert_eq!(found.machine.as_deref(), Some("DMU 50"));
    assert_eq!(found.instrument.as_deref(), Some("Renishaw QC20-W"));
    assert_eq!((found.serial.as_deref(), found.nominal_length_mm), (Some("0AF3"), Some(150.0)));
    assert_eq!(found.features[0].value, -12.5);
    assert_eq!(found.runs[1].feature("AF_CALCULATED_FEEDRATE", "UT_FEEDRATE"), Some(998.0));
}

#[test]
fn readings_that_are_not_as_round_as_the_file_says_are_refused() {
    let other = Written { round_mm: Some(0.0095), ..PLAIN }.text();
    let error = refused(&other);
    assert!(
        error.what.contains("9.5 um round as Ballbar 20 says") && error.what.contains("8.0 um"),
        "{}",
        error.what
    );
    assert!(error.hint.is_some_and(|hint| hint.contains("`data_arc_deg`")));
    // Who states both has them as they are, and is told.
    let format = Format {
        data_arc_deg: Some(360.0),
        stated_unit: Some(LengthUnit::Millimetre),
        ..Format::default()
    };
    let log = with(&other, &format).unwrap();
    assert_eq!(log.notes().len(), 4);
    // The arc stands in the name; with another the circle that is taken off is another.
    let part = Written { arc_deg: 220.0, ..PLAIN };
    let open =
        BarRun { readings: readings(220.0).into_iter().map(Some).collect(), ..BarRun::default() };
    let both = by_angle::circularities(&open.readings, 220f64.to_radians()).unwrap();
    // By least squares or by minimum zone: on a part of a circle they are far from each other.
    assert!(both[0] > 1.1 * both[1], "{both:?}");
    for round_mm in both {
        let part = Written { round_mm: Some(round_mm), ..part };
        assert!(refused(&part.text()).what.contains("over 360 degrees"));
        is_partial(&Written { name: "YZ 220grad 150mm", ..part });
        is_partial(&Written { name: "XY 220\u{5ea6} 150mm", ..part });
    }
}

fn is_partial(written: &Written) {
    let log = log(&written.text());
    let angles = &log.by_angle().unwrap().turns[0].angles;
    assert_eq!(*angles, Angles::Even(220f64.to_radians()));
}

/// The same clockwise run as it was driven and as a plot has it: the balls that are 0.03 mm off along the first axis tell.
#[test]
fn a_clockwise_run_is_the_same_in_either_order() {
    let angle = |k: i32| (220.0 * (f64::from(k) + 0.5) / 400.0).to_radians();
    let reading = |k: i32| 0.03 * angle(k).cos() + 0.002 * (3.0 * angle(k)).sin();
    let words = |order: &mut dyn Iterator<Item = i32>| {
        order.map(|k| format!("{:.6}", reading(k))).collect::<Vec<_>>().join(" ")
    };
    let (rising, falling) = (words(&mut (0..400)), words(&mut (0..400).rev()));
    let run = |direction: &str, readings: &str| {
        format!(
            "<BALLBAR_RUN><RUN_DIRECTION>{direction}</RUN_DIRECTION><READINGS>{readings}</READINGS></BALLBAR_RUN>"
        )
    };
    let of = |clockwise: &str| {
        let runs = run("CCW", &rising) + &run("CW", clockwise);
        log(&format!("<A><TEST_SPEC NAME=\"220 grad\"/><PLANE TEST_PLANE=\"XY\"/>{runs}</A>"))
    };
    let (driven, listed) = (of(&falling), of(&rising));
    let told = |log: &Log| log.notes().iter().any(|note| note.contains("stand by rising angle"));
    assert!(!told(&driven) && told(&listed), "{:?} {:?}", driven.notes(), listed.notes());
    let mm = |log: &Log| log.readings().iter().map(|of| of.deviation_mm).collect::<Vec<_>>();
    assert_eq!(mm(&driven), mm(&listed));
    // Nothing to tell by: it is said, and nothing is turned.
    let flat = PLAIN.text();
    assert!(log(&flat).notes().iter().any(|note| note.contains("is not told")));
}

#[test]
fn files_that_are_broken_or_were_made_to_break() {
    let plain = PLAIN.text();
    for (text, told) in [
        (plain[..plain.len() / 2].to_owned(), "the file ends inside"),
        (plain.replacen("</BALLBAR_RUN>", "</BALLBAR>", 1), "the XML is broken"),
        (
            plain.replace(
                "<TEST_DOCUMENT>",
                "<!DOCTYPE x [<!ENTITY a \"aa\"><!ENTITY b \"&a;&a;\">]><TEST_DOCUMENT>",
            ),
            "document type",
        ),
        (plain.replace("Meier", "&b;"), "entity of its own"),
        (plain.replace("CCW", "left"), "neither CW nor CCW"),
        (plain.replace("<RUN_DIRECTION>CW</RUN_DIRECTION>", ""), "does not say its direction"),
        (plain.replacen("0.0", "o.o", 1), "is not a number"),
        (plain.replace("TEST_PLANE=\"XY\"", ""), "does not say its plane"),
        ("<html><body>".to_owned() + &"x".repeat(99) + "</body></html>", "has no BALLBAR_RUN"),
        ("<a>".repeat(100), "more than 64 elements"),
        (format!("<a>{}</a>", "<BALLBAR_RUN/>".repeat(100)), "more than 64 runs"),
        (
            "<BALLBAR_RUN><RUN_DIRECTION>CW</RUN_DIRECTION><READINGS>1 2</READINGS></BALLBAR_RUN>"
                .to_owned(),
            "less than 30 readings",
        ),
        (Written { scale: 1e6, round_mm: None, ..PLAIN }.text(), "no ball-bar reaches"),
        (plain.replacen("0.0", "1e3080.0", 1).replacen("1e3080.0", "1e308 0.0", 1), "in any unit"),
    ] {
        let error = refused(&text);
        assert!(error.what.contains(told), "{told}: {error}");
    }
    let error = refused(&plain.replacen("0.0500", "o.0500", 1));
    assert_eq!(error.place.map(|place| place.line), Some(17), "{}", error.what);
}

#[test]
fn a_table_of_angles() {
    let format = |plane| Format {
        time: TimeColumn::Angle { name: "angle_deg".to_owned() },
        plane,
        ..Format::default()
    };
    let mut text = String::from("angle_deg,deviation_um\n");
    let angles = (0..40)
        .map(|k| (350 + 9 * k) % 360)
        .chain((0..40).map(|k| (341_i32 - 9 * k).rem_euclid(360)));
    for angle in angles {
        writeln!(text, "{angle},{angle}").unwrap();
    }
    let log = with(&text, &format(Some([2, 0]))).unwrap();
    let by_angle = log.by_angle().unwrap();
    assert_eq!(by_angle.plane, [2, 0]);
    let ways: Vec<_> =
        by_angle.turns.iter().map(|turn| (turn.counter_clockwise, turn.readings.len())).collect();
    assert_eq!(ways, [(true, 40), (false, 40)]);
    assert!(
        with(&text, &format(None))
            .unwrap_err()
            .hint
            .is_some_and(|hint| hint.contains("`plane = \"xy\"`"))
    );
    assert!(with("angle_deg,deviation_um\n1,1\n1,1\n", &format(Some([0, 1]))).is_err());
}

/// Two circles both ways or a part of one, as they were driven and as a plot lists them.
#[test]
fn a_table_by_rising_angle_is_the_one_that_was_driven() {
    let format = |order| Format {
        time: TimeColumn::Angle { name: "angle_deg".to_owned() },
        plane: Some([0, 1]),
        clockwise: order,
        ..Format::default()
    };
    for (first, step, count, closed) in [
        (0, 9, 40, false),
        (0, 9, 41, true),
        (350, 9, 40, false),
        (340, 5, 45, false),
        (30, 5, 37, false),
    ] {
        let angles: Vec<i32> = (0..count).map(|k| first + step * k).collect();
        let write = |listed: bool| {
            let mut text = String::from("angle_deg,deviation_um\n");
            for way in 0..4 {
                let mut lines: Vec<(i32, i32)> =
                    angles.iter().map(|angle| (*angle, angle + 1000 * (way % 2))).collect();
                if way % 2 == 1 && !listed {
                    lines.reverse();
                }
                for (angle, um) in lines {
                    let angle = if closed { angle } else { angle % 360 };
                    writeln!(text, "{angle},{um}").unwrap();
                }
            }
            text
        };
        let listed = with(&write(true), &format(Some(ClockwiseOrder::Rising))).unwrap();
        let ways: Vec<bool> =
            listed.by_angle().unwrap().turns.iter().map(|turn| turn.counter_clockwise).collect();
        assert_eq!(ways, [true, false, true, false], "{first} {count}");
        let read = |log: &Log| {
            log.readings().iter().map(|of| (of.time_s, of.deviation_mm)).collect::<Vec<_>>()
        };
        let driven = with(&write(false), &format(None)).unwrap();
        assert_eq!(listed.by_angle(), driven.by_angle(), "{first} {count}");
        assert_eq!(read(&listed), read(&driven));
    }
    let falling = "angle_deg,deviation_um\n3,1\n2,1\n1,1\n";
    let error = with(falling, &format(Some(ClockwiseOrder::Rising))).unwrap_err();
    assert!(error.what.contains("do not rise"), "{error}");
}
