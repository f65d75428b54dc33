//! Files of Ballbar 20: XML that is not described in public.

use std::f64::consts::TAU;

use ballbar::log::{Format, read_bytes};

use super::{Target, accepted};

pub const TARGET: Target = Target {
    name: "b5r",
    seeds: || {
        let full = file("XY 360 grad 150mm", &[run("CW", 1.0), run("CCW", 1.0)].concat());
        let part = file("XY 220 grad", &run("CCW", 1000.0).replace("mm", "um"));
        vec![full, part]
    },
    words: &[
        "<READINGS>",
        "</READINGS>",
        "<BALLBAR_RUN>",
        "</BALLBAR_RUN>",
        "<RUN_DIRECTION>CCW</RUN_DIRECTION>",
        "<FEATURE NAME=\"AF_CIRCULARITY\" DT=\"UT_LENGTH_UM\">8</FEATURE>",
        "DT=\"UT_LENGTH_MM\"",
        "TEST_PLANE=\"ZX\"",
        "xmlns:b=\"urn:b\"",
        "<b:READINGS>",
        "<![CDATA[",
        "]]>",
        "&amp;",
        "&#0;",
        "<!DOCTYPE x [<!ENTITY x \"xxxx\">]>",
        "<!--",
        "-0,5",
        "1e308",
        "NaN",
    ],
    made: &[
        // As deep as it is long, and a value as long as the file.
        || b"<T>".repeat(3_000_000),
        || [&b"<T><BALLBAR_RUN><READINGS>"[..], &b"0 ".repeat(10_000_000)].concat(),
    ],
    read,
};

fn file(name: &str, runs: &str) -> Vec<u8> {
    format!(
        "<?xml version=\"1.0\"?>\n<TEST_DOCUMENT><TEST_SPEC NAME=\"{name}\"><NOMINAL_LENGTH>150</NOMINAL_LENGTH>\
         <PROGRAMMED_FEEDRATE>1000</PROGRAMMED_FEEDRATE><PLANE TEST_PLANE=\"XY\"/></TEST_SPEC>\
         <OPERATOR>M. Meier &amp; Sohn</OPERATOR><DATE_STARTED>20251218-194332</DATE_STARTED>\n{runs}</TEST_DOCUMENT>\n"
    )
    .into_bytes()
}

/// A run over a circle that is 0.008 mm out of round.
fn run(direction: &str, unit: f64) -> String {
    let angle = |k: u32| TAU * (f64::from(k) + 0.5) / 40.0;
    let readings = (0..40).map(|k| format!("{:.6} ", unit * 0.004 * (2.0 * angle(k)).sin()));
    let readings: String = readings.collect();
    format!(
        "<BALLBAR_RUN><RUN_DIRECTION>{direction}</RUN_DIRECTION><READINGS>{readings}</READINGS>\
         <FEATURE NAME=\"AF_CALCULATED_FEEDRATE\" DT=\"UT_FEEDRATE\">998</FEATURE></BALLBAR_RUN>\n"
    )
}

fn read(input: &[u8]) -> bool {
    let log = read_bytes(input, "run.b5r".as_ref(), &Format::default());
    if let Ok(log) = &log {
        let readings = log.readings();
        assert!(readings.windows(2).all(|pair| pair[0].time_s < pair[1].time_s), "times increase");
        assert!(readings.iter().all(|r| r.deviation_mm.is_none_or(f64::is_finite)));
    }
    accepted(&log)
}
