//! One log as Windows, Excel and other loggers write it.

use std::path::Path;

use super::*;
use crate::error::{Error, Result};
use crate::plan::Test;

/// The format that lines under `[log]` make.
fn format(lines: &str) -> Format {
    let source = format!(
        "name = \"t\"\nmachine = \"m.toml\"\n[ball_bar]\nlength_mm = 150.0\n[log]\n{lines}\n[[mounting]]\nname = \"A\"\n\
         coincidence_mm = [0, 0, 0]\ntool_ball_mm = [0, 0, -200]\n"
    );
    Test::parse(&source, "t.toml".as_ref()).unwrap_or_else(|e| panic!("{e}")).log_format_of(0)
}

fn with(content: impl AsRef<[u8]>, lines: &str) -> Result<Log> {
    read_bytes(content.as_ref(), Path::new("run1.csv"), &format(lines))
}

fn samples(log: &Log) -> Vec<(f64, Option<f64>)> {
    log.readings().iter().map(|r| (r.time_s, r.deviation_mm)).collect()
}

/// Three readings, the first out of range.
fn plain() -> Vec<(f64, Option<f64>)> {
    vec![(0.0, None), (0.1, Some(0.0063)), (0.2, Some(-0.0015))]
}

#[track_caller]
fn is_plain(content: impl AsRef<[u8]>, lines: &str) -> Log {
    let shown = String::from_utf8_lossy(content.as_ref()).into_owned();
    let log = with(content, lines).unwrap_or_else(|e| panic!("{shown}\n{e}"));
    assert_eq!(samples(&log), plain(), "{shown}");
    log
}

#[track_caller]
fn refused(content: impl AsRef<[u8]>, lines: &str) -> Error {
    let error = with(content, lines).expect_err("the log should not be readable");
    assert!(error.hint.is_some(), "no hint in: {error}");
    error
}

/// What the refusal says to write makes the log readable.
#[track_caller]
fn cured(content: &str, lines: &str, line: &str) {
    let hint = refused(content, lines).hint.unwrap_or_default();
    assert!(
        line.split('\n').all(|line| hint.contains(&format!("`{line}`"))),
        "{line} is not in: {hint}"
    );
    is_plain(content, &format!("{lines}\n{line}"));
}

const CSV: &str = "time_s,deviation_um\n0.0,\n0.1,6.3\n0.2,-1.5\n";

fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(bytes).collect()
}

#[test]
fn utf_16_with_and_without_its_mark() {
    let micro = "Zeit [s];Abweichung [µm]\n0,0;\n0,1;6,3\n0,2;-1,5\n";
    let columns = "time_column = \"Zeit [s]\"\nreading_column = \"Abweichung [µm]\"";
    for mark in ["", "\u{feff}"] {
        for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
            is_plain(utf16(&format!("{mark}{CSV}"), bytes), "");
            is_plain(utf16(&format!("{mark}{}", CSV.replace('\n', "\r\n")), bytes), "");
            is_plain(utf16(&format!("{mark}{micro}"), bytes), columns);
        }
    }
    is_plain(utf16(CSV, u16::to_be_bytes), "encoding = \"utf-16be\"");
    let odd = [utf16(CSV, u16::to_le_bytes), vec![b'x']].concat();
    assert!(refused(odd, "").what.contains("not text in UTF-16LE"));
}

#[test]
fn code_pages_of_windows() {
    let log = b"Zeit [s];Abweichung [\xB5m]\r\n0,0;\r\n0,1;6,3\r\n0,2;\x961,5\r\n";
    is_plain(log, "time_column = \"Zeit [s]\"\nreading_column = \"Abweichung [µm]\"");
    // Greek: in its own code page a mu is another byte.
    let greek = b"t [s];l [\xECm]\r\n0,0;\r\n0,1;6,3\r\n0,2;-1,5\r\n";
    is_plain(
        greek,
        "encoding = \"windows-1253\"\ntime_column = \"t [s]\"\nreading_column = \"l [μm]\"",
    );
}

#[test]
fn what_stands_before_the_names() {
    is_plain(CSV.replace("time_s", "sep=,\r\ntime_s"), "");
    is_plain("\u{feff}sep=;\r\ntime_s;deviation_um\r\n0,0;\r\n0,1;6,3\r\n0,2;-1,5\r\n", "");
    is_plain("\"sep=\t\"\ntime_s\tdeviation_um\n0,0\t\n0,1\t6,3\n0,2\t-1,5\n", "");
    let preamble = "Ball-bar log\nOperator: Meier; 23.11.2026\n\nRate,10,Hz\n";
    let log = is_plain(format!("{preamble}{CSV}"), "");
    assert_eq!(log.readings()[0].line, 6);
    // Names that stand twice: the first is not the table.
    let twice = format!("channels,time_s,deviation_um\n{CSV}");
    assert!(refused(&twice, "").what.contains("where the header has 3"));
    is_plain(&twice, "skip_lines = 1");
}

#[test]
fn a_refusal_names_the_columns_of_the_table() {
    let log = "Ball-bar log\n23.11.2026, Meier\nZeit [ms];Abweichung [mm];Temp [C]\n0;;20\n100;0,0063;20\n200;-0,0015;20\n";
    cured(log, "", "time_column = \"Zeit [ms]\"\nreading_column = \"Abweichung [mm]\"");
    let error = refused(log, "");
    assert_eq!(error.place.map(|place| place.line), Some(3));
    assert!(
        error.what.ends_with("it has `Zeit [ms]`, `Abweichung [mm]`, `Temp [C]`"),
        "{}",
        error.what
    );
}

#[test]
fn times_of_day() {
    let at = |times: [&str; 3]| {
        format!("time_s,deviation_um\n{},\n{},6.3\n{},-1.5\n", times[0], times[1], times[2])
    };
    for times in [
        ["08:00:00.0", "08:00:00.1", "08:00:00.2"],
        ["23:59:59.9", "00:00:00.0", "00:00:00.1"],
        ["2026-11-23T23:59:59.9Z", "2026-11-24T00:00:00.0Z", "2026-11-24T00:00:00.1Z"],
        ["11:59:59.9 PM", "12:00:00.0 AM", "12:00:00.1 AM"],
        ["59:59.9", "00:00.0", "00:00.1"],
    ] {
        let log = with(at(times), "").unwrap_or_else(|e| panic!("{e}"));
        let first_s = log.readings()[0].time_s;
        let steps: Vec<f64> = log.readings().iter().map(|r| r.time_s - first_s).collect();
        let apart = steps.iter().zip([0.0, 0.1, 0.2]).all(|(s, of)| (s - of).abs() < 1e-9);
        assert!(apart, "{times:?}: {steps:?}");
    }
    let back = refused(at(["08:00:00.2", "08:00:00.1", "08:00:00.3"]), "");
    assert_eq!(back.what, "time 08:00:00.1 s goes back behind 08:00:00.2 s of line 2");
    let coarse = refused(at(["08:00:00", "08:00:00", "08:00:01"]), "");
    assert!(coarse.hint.is_some_and(|hint| hint.contains("`sample_rate_hz`")));
    assert!(refused(at(["08:00", "08:01", "08:02"]), "").what.contains("not a time of day"));
}

#[test]
fn excel_days_as_numbers() {
    let log = "t_d,deviation_um\n46349.5,\n46349.75,6.3\n46350.0,-1.5\n";
    let log = with(log, "time_column = \"t_d\"").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(log.span_s(), 43_200.0);
}

#[test]
fn out_of_range_is_no_reading_and_is_counted() {
    for word in [
        "NaN",
        "OVER",
        "over range",
        "---",
        "-",
        "***",
        "#N/A",
        "inf",
        "-1.#IND",
        "OL",
        "9999.9",
        "-9999.99",
        "99999",
    ] {
        let log = is_plain(CSV.replace("0.0,", &format!("0.0,{word}")), "");
        assert_eq!(log.notes(), [format!("1 reading(s) are `{word}` and count as out of range")]);
    }
    // Where a bar reads as far, nines are readings: 999.9 um, and 9.999 mm of a bar of 10 mm.
    let log = with(CSV.replace("0.0,", "0.0,999.9"), "").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((log.readings()[0].deviation_mm, log.notes().len()), (Some(0.9999), 0));
    for (word, line) in [
        ("no", "out_of_range = \"no\""),
        ("32767", "out_of_range = 32767"),
        ("-1e30", "out_of_range = -1e30"),
    ] {
        cured(&CSV.replace("0.0,", &format!("0.0,{word}")), "", line);
    }
    let several = "time_s,deviation_um\n0.0,Fehler\n0.1,6.3\n0.2,-1.5\n";
    let log = is_plain(several, "out_of_range = [\"FEHLER\", 8888.8]");
    assert_eq!(log.notes().len(), 1);
}

#[test]
fn signs_blanks_and_ends() {
    is_plain(CSV.replace("-1.5", "\u{2212}1.5"), "");
    is_plain(CSV.replace(',', "\u{a0},\u{202f}"), "");
    is_plain(CSV.replace('\n', "\r"), "");
    is_plain(CSV.replace('\n', "\r\r\n"), "");
    is_plain(format!("{CSV}\u{1a}"), "");
    is_plain(format!("{CSV}\u{1a}\u{1a}\r\n"), "");
    is_plain("time_s   deviation_um\n 0.0  NaN\n 0.1\t6.3\n 0.2 -1.5  \n", "");
    assert!(
        refused("time_s deviation_um\n0.0\n0.1 1\n", "").hint.is_some_and(|h| h.contains("NaN"))
    );
}

#[test]
fn decimal_commas_where_commas_separate() {
    is_plain("time_s,deviation_um\n\"0,0\",\n\"0,1\",\"6,3\"\n\"0,2\",\"-1,5\"\n", "");
    let bare = refused("time_s,deviation_um\n0,0,\n0,1,6,3\n", "");
    assert!(bare.hint.is_some_and(|hint| hint.contains("semicolons or tabs")));
    let thousands = "time_s,deviation_um\n0,\n0.1,\"1,012\"\n";
    assert!(refused(thousands, "").what.contains("another decimal mark"));
    let either = "time_s,deviation_mm\n0,\n\"1,125\",\"0,006\"\n\"2,250\",-1\n";
    let lines = "reading_column = \"deviation_mm\"";
    assert!(
        refused(either, lines).hint.is_some_and(|hint| hint.contains("`decimal_mark = \",\"`"))
    );
    let log =
        with(either, &format!("{lines}\ndecimal_mark = \",\"")).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(samples(&log), [(0.0, None), (1.125, Some(0.006)), (2.25, Some(-1.0))]);
}

#[test]
fn keys_of_a_test_file_that_mean_nothing() {
    for (line, told) in [
        ("encoding = \"klingon\"", "unknown encoding"),
        ("skip_lines = 1.5", "`skip_lines` cannot be 1.5"),
        ("skip_lines = -1", "between 0 and 100000"),
        ("decimal_mark = \";\"", "no decimal mark"),
        ("out_of_range = [true]", "a word, a number, or a list"),
        ("reading_unit = \"m\"", "unknown unit"),
    ] {
        let source = format!(
            "name = \"t\"\nmachine = \"m\"\n[ball_bar]\nlength_mm = 150.0\n[log]\n{line}\n[[mounting]]\nname = \"A\"\ncoincidence_mm = [0, 0, 0]\ntool_ball_mm = [0, 0, 0]\n"
        );
        let error = Test::parse(&source, "t.toml".as_ref()).expect_err(line);
        assert!(error.what.contains(told) && error.hint.is_some(), "{error}");
        assert_eq!(error.place.map(|place| place.line), Some(6));
    }
    assert_eq!(format("reading_unit = \"µm\"").reading.unit, LengthUnit::Micrometre);
}
