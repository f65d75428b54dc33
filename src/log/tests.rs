use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use proptest::prelude::*;

use super::*;
use crate::error::{Error, Kind, Result};

fn with(content: impl AsRef<[u8]>, format: &Format) -> Result<Log> {
    read_bytes(content.as_ref(), Path::new("run1.csv"), format)
}

fn log(content: impl AsRef<[u8]>) -> Log {
    with(content, &Format::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn error_with(content: impl AsRef<[u8]>, format: &Format) -> Error {
    let error = with(content, format).expect_err("the log should not be readable");
    assert_eq!(error.kind, Kind::Input);
    assert!(error.hint.is_some(), "no hint in: {error}");
    error
}

fn error(content: impl AsRef<[u8]>) -> Error {
    error_with(content, &Format::default())
}

/// Line, column and width of the caret.
fn caret(error: &Error) -> (usize, usize, usize) {
    let place = error.place.as_ref().expect("a place");
    (place.line, place.column, place.width)
}

/// Times in s and deviations in mm.
fn samples(log: &Log) -> Vec<(f64, Option<f64>)> {
    log.readings().iter().map(|r| (r.time_s, r.deviation_mm)).collect()
}

fn rate(hz: f64) -> Format {
    Format { time: TimeColumn::Rate { hz }, ..Format::default() }
}

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(content).unwrap();
    encoder.finish().unwrap()
}

const PLAIN: &str = "time_s,deviation_um\n0.0,\n0.1,6.3\n0.2,-1.5\n";

fn plain() -> Vec<(f64, Option<f64>)> {
    vec![(0.0, None), (0.1, Some(0.0063)), (0.2, Some(-0.0015))]
}

// What is read.

#[test]
fn the_default_format() {
    let log = log(PLAIN);
    assert_eq!(samples(&log), plain());
    assert_eq!(log.readings().iter().map(|r| r.line).collect::<Vec<_>>(), [2, 3, 4]);
    assert_eq!(log.file(), Path::new("run1.csv"));
}

#[test]
fn the_same_log_in_other_clothes() {
    for content in [
        "\u{feff}time_s,deviation_um\n0.0,\n0.1,6.3\n0.2,-1.5\n",
        "time_s,deviation_um\r\n0.0,\r\n0.1,6.3\r\n0.2,-1.5\r\n",
        "time_s,deviation_um\n0.0,\n0.1,6.3\n0.2,-1.5",
        "# a\n\ntime_s,deviation_um\n0.0,\n# b, c\n0.1,6.3\n\n   \n  # d\n0.2,-1.5\n\n",
        "time_s;deviation_um\n0,0;\n0,1;6,3\n0,2;-1,5\n",
        "time_s;deviation_um\n0.0;\n0.1;6.3\n0.2;-1.5\n",
        "time_s\tdeviation_um\n0,0\t\n0,1\t6,3\n0,2\t-1,5\n",
        " Time_S , DEVIATION_UM \n 0.0 , \n 0.1 , 6.3 \n 0.2 , -1.5 \n",
        "\"time_s\",\"deviation_um\"\n\"0.0\",\"\"\n\"0.1\",\" 6.3\"\n\"0.2\",\"-1.5\"\n",
        "n,deviation_um,note,time_s\n1,,\"a, b\",0\n2,6.3,,1e-1\n3,-1.5,x,+.2\n",
        "time_s;deviation_um;Length, mm, raw, hot\n0;;\n0.1;6.3;\n0.2;-1.5;\n",
        "time_s,deviation_um,\n0.0,,\n0.1,6.3,\n0.2,-1.5,\n",
    ] {
        assert_eq!(samples(&log(content)), plain(), "{content}");
    }
}

#[test]
fn gzip_is_known_by_its_content() {
    assert_eq!(samples(&log(gzip(PLAIN.as_bytes()))), plain());
    let (head, tail) = PLAIN.split_at(25);
    let mut members = gzip(head.as_bytes());
    members.extend(gzip(tail.as_bytes()));
    assert_eq!(samples(&log(members)), plain());
}

#[test]
fn units() {
    for (unit, scale) in [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("min", 1.0 / 60.0)] {
        let format = Format {
            time: TimeColumn::Named { name: "t".to_owned(), unit: TimeUnit::parse(unit).unwrap() },
            ..Format::default()
        };
        let content = format!("t,deviation_um\n0,1\n{},2\n", 120.0 * scale);
        assert_eq!(with(content, &format).unwrap().span_s(), 120.0, "{unit}");
    }
    for (unit, value) in [("mm", 0.254), ("um", 254.0), ("nm", 254e3), ("inch", 0.01)] {
        let mut format = Format::default();
        format.reading.unit = LengthUnit::parse(unit).unwrap();
        let read = with(format!("time_s,deviation_um\n0,{value}\n1,\n"), &format).unwrap();
        assert_eq!(read.readings()[0].deviation_mm, Some(0.254), "{unit}");
    }
    assert!(TimeUnit::NAMES.iter().all(|n| TimeUnit::parse(n).unwrap().name() == *n));
    assert!(LengthUnit::NAMES.iter().all(|n| LengthUnit::parse(n).unwrap().name() == *n));
    assert_eq!(TimeUnit::parse("S"), None);
    assert_eq!(LengthUnit::parse("m"), None);
}

#[test]
fn lengths_lose_the_nominal_length() {
    let format = Format {
        reading: ReadingColumn {
            inverted: false,
            name: "length_mm".to_owned(),
            unit: LengthUnit::Millimetre,
            kind: ReadingKind::Length { nominal_mm: 150.0 },
        },
        ..Format::default()
    };
    let read = with("time_s,length_mm\n0,150.25\n1,149.5\n", &format).unwrap();
    assert_eq!(samples(&read), [(0.0, Some(0.25)), (1.0, Some(-0.5))]);
    let e = error_with("time_s,length_mm\n0,0.25\n1,0.5\n", &format);
    assert!(e.what.contains("a deviation of -149.750 mm"), "{e}");
}

#[test]
fn a_rate_counts_samples() {
    let read = with("n,deviation_um\n1,1\n# c\n2,\n3,3\n", &rate(8.0)).unwrap();
    assert_eq!(samples(&read), [(0.0, Some(0.001)), (0.125, None), (0.25, Some(0.003))]);
}

#[test]
fn at_a_rate_a_sample_out_of_range_takes_its_time() {
    let times = |content: &str| {
        let read = with(content, &rate(10.0)).unwrap();
        read.readings()
            .iter()
            .filter(|r| r.deviation_mm.is_some())
            .map(|r| r.time_s)
            .collect::<Vec<_>>()
    };
    assert_eq!(times("deviation_um\n1\n\n\r\n4\n"), [0.0, 0.3]);
    assert_eq!(times("n\tdeviation_um\n1\t1\n\t\n\t\n4\t4\n"), [0.0, 0.3]);
    assert_eq!(times("n;deviation_um\n1;1\n;\n;\n4;4\n"), [0.0, 0.3]);
}

#[test]
fn an_exact_name_wins_over_a_similar_one() {
    let read = log("TIME_S,time_s,deviation_um\n9,0,1\n8,1,2\n");
    assert_eq!(read.span_s(), 1.0);
}

#[test]
fn a_delimiter_can_be_given() {
    let format = Format { delimiter: Some(Delimiter::Semicolon), ..rate(1.0) };
    let read = with("deviation_um\n0,5\n1,5\n", &format).unwrap();
    assert_eq!(read.readings()[1].deviation_mm, Some(0.0015));
}

#[test]
fn period_span_and_intervals() {
    let read = log(
        "time_s,deviation_um\n1.0,\n1.1,1\n1.2,1\n1.34,1\n1.44,\n1.5,1\n1.6,1\n1.7,1\n1.9,1\n2.0,\n",
    );
    assert!((read.sample_period_s() - 0.1).abs() < 1e-12);
    assert_eq!(read.span_s(), 1.0);
    // 1.2 to 1.34 is an uneven step, 1.7 to 1.9 is a gap.
    assert_eq!(read.in_range_intervals(), [1..4, 5..8, 8..9]);
    assert_eq!(log(PLAIN).in_range_intervals().first(), Some(&(1..3)));
    let read = log("time_s,deviation_um\n0,1\n1,\n2,1\n");
    assert_eq!(read.in_range_intervals(), [0..1, 2..3]);
}

// What is wrong.

#[test]
fn a_message_has_the_place_and_the_remedy() {
    let e = error("time_s,deviation_um\n0.0,\n0.1,6.3um\n");
    assert_eq!(
        e.to_string(),
        "`6.3um` is not a number
  --> run1.csv:3:5
  |
3 | 0.1,6.3um
  |     ^^^^^
hint: a reading is a plain number; where the bar is out of range, leave the field empty, or, if that is what `6.3um` means, write `out_of_range = \"6.3um\"` under `[log]` in the test file"
    );
}

#[test]
fn files_that_cannot_be_read() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("run.csv");
    for (file, part) in [(file.as_path(), "cannot read the log"), (dir.path(), "directory")] {
        let e = read(file, &Format::default()).unwrap_err();
        assert!(e.what.contains(part), "{e}");
        assert!(e.hint.is_some());
        assert_eq!(e.place.unwrap().file, file);
    }
    std::fs::write(&file, PLAIN).unwrap();
    let read = read(&file, &Format::default()).unwrap();
    assert_eq!(samples(&read), plain());
    assert_eq!(read.file(), file);
}

#[test]
fn logs_without_data() {
    for (content, part) in [
        ("", "is empty"),
        ("\u{feff}\n# nothing\n\n", "is empty"),
        ("time_s,deviation_um\n# nothing\n", "no samples"),
        ("time_s,deviation_um\n0,1\n", "too short"),
        ("time_s,deviation_um\n0,\n1,\n2,\n", "out of range in all 3 samples"),
    ] {
        assert!(error(content).what.contains(part), "{content}");
    }
    assert!(error(gzip(b"")).what.contains("is empty"));
    let far = "\n".repeat(100_000) + "time_s,deviation_um\n0,1\n1,2\n";
    assert!(error(far).what.contains("the first 100000 lines of the log are blank or comments"));
}

/// A reading of 150.5 mm may be one of 150.5 um or a length: the name of its column tells what to write first.
#[test]
fn a_column_that_is_named_after_lengths_probably_holds_them() {
    for (name, first) in
        [("length_mm", "reading = \"length\""), ("ball-bar mm", "reading_unit = \"um\"")]
    {
        let mut format = Format::default();
        format.reading.name = name.to_owned();
        format.reading.unit = LengthUnit::Millimetre;
        let hint = error_with(format!("time_s,{name}\n0,150.5\n1,150.4\n"), &format).hint.unwrap();
        assert!(hint.contains(&format!("write `{first}`")), "{hint}");
    }
}

#[test]
fn content_that_is_not_text() {
    let e = error(b"time_s,deviation_um\n0,1\n1,\x002\n");
    assert!(e.what.contains("NUL"), "{e}");
    assert_eq!(caret(&e), (3, 3, 1));
    // Neither UTF-8 nor text of a code page: it rings a bell.
    let e = error(b"# \xC3\xA9t\xC3\xA9\ntime_s,deviation_\xB5m\n0,1\n1,\x072\n");
    assert!(e.what.contains("0xB5"), "{e}");
    assert_eq!(caret(&e), (2, 18, 1));
}

#[test]
fn damaged_gzip() {
    let whole = gzip(PLAIN.repeat(100).as_bytes());
    assert!(error(&whole[..whole.len() / 2]).what.contains("truncated"));
    assert!(error(&whole[..whole.len() - 3]).what.contains("truncated"));
    let mut flipped = whole.clone();
    let end = flipped.len();
    flipped[end - 6] ^= 0xFF; // the checksum
    assert!(error(flipped).what.contains("corrupt"));
    assert!(error([0x1F, 0x8B]).what.contains("truncated"));
}

#[test]
fn columns_that_are_not_there() {
    let e = error("Time;Length\n0;1\n");
    assert_eq!(e.what, "the log has no column `time_s`; it has `Time`, `Length`");
    assert_eq!(caret(&e), (1, 0, 0));
    let hint = e.hint.unwrap();
    for key in [
        "`time_column`",
        "`time_unit`",
        "`reading_column`",
        "`reading_unit`",
        "`reading`",
        "`sample_rate_hz`",
    ] {
        assert!(hint.contains(key), "{key} is not in: {hint}");
    }
    assert!(error("time_s,um\n0,1\n").what.contains("no column `deviation_um`"));
    let wide: Vec<String> = (0..50).map(|i| format!("c{i}")).collect();
    assert!(error(wide.join(",")).what.ends_with("`c19`, and 30 more"));
    assert!(error("0.0,\n0.1,6.3\n").what.contains("no header"));
}

#[test]
fn columns_that_are_there_twice() {
    let e = error("time_s,deviation_um,deviation_um\n0,1,2\n");
    assert_eq!(e.what, "the log has 2 columns `deviation_um`");
    assert_eq!(caret(&e), (1, 21, 12));
    assert!(error("time_s,Deviation_um,DEVIATION_UM\n0,1,2\n").what.contains("2 columns"));
}

#[test]
fn fields_that_are_not_numbers() {
    for (row, part, column) in [
        ("NaN,1", "`NaN` is not a finite number", 1),
        ("2,1e999", "`1e999` is not a finite number", 3),
        ("2,+-+", "`+-+` is not a number", 3),
        ("2, out", "`out` is not a number", 4),
        ("12:00:01,1", "`12:00:01` among times that are written otherwise", 1),
        (",1", "the time is missing", 1),
    ] {
        let e = error(format!("time_s,deviation_um\n0,1\n1,1\n{row}\n"));
        assert_eq!(e.what, part);
        assert_eq!((caret(&e).0, caret(&e).1), (4, column), "{row}");
    }
    let e = error(format!("time_s,deviation_um\n0,{}\n", "x".repeat(9999)));
    assert!(e.to_string().len() < 1000);
}

#[test]
fn decimal_commas_and_thousands() {
    for (row, part) in [
        ("2;1,234,567", "not a number"),
        ("2;1.234,5", "another decimal mark"),
        ("2;1.5", "another decimal mark"),
    ] {
        let e = error(format!("time_s;deviation_um\n0;1,5\n{row}\n"));
        assert!(e.what.contains(part), "{e}");
        assert_eq!(caret(&e).0, 3);
    }
    let e = error("time_s;deviation_um\n0.5;1\n1.0;1,234\n");
    assert!(e.what.contains("another decimal mark"), "{e}");
    assert!(e.hint.unwrap().contains("thousands"));
}

#[test]
fn times_that_do_not_increase() {
    let e = error("time_s,deviation_um\n0.0,1\n0.1,1\n\n0.10,1\n");
    assert_eq!(e.what, "time 0.10 s repeats 0.1 s of line 3");
    assert_eq!(caret(&e), (5, 1, 4));
    let e = error("time_s,deviation_um\n0.0,1\n0.2,1\n0.1,1\n");
    assert_eq!(e.what, "time 0.1 s goes back behind 0.2 s of line 3");
    assert!(e.hint.unwrap().contains("`sample_rate_hz`"));
}

#[test]
fn rows_of_another_width() {
    let e = error("time_s,deviation_um\n0.0,1\n0.1\n");
    assert_eq!(e.what, "1 field where the header has 2");
    assert_eq!(caret(&e), (3, 4, 1));
    let e = error("time_s,deviation_um\n0.0,1\n0,1,6,3\n");
    assert_eq!(e.what, "4 fields where the header has 2");
    assert_eq!(caret(&e), (3, 5, 3));
    assert!(e.hint.unwrap().contains("decimal comma"));
    // A quote that is never closed takes its own line with it, no more.
    let e = error("time_s,deviation_um\n0.0,1\n\"0.1,6\n0.2,3\n");
    assert_eq!(caret(&e).0, 3);
    assert_eq!(caret(&error_with("deviation_um\n0,5\n", &rate(1.0))), (2, 3, 1));
}

#[test]
fn deviations_no_bar_can_show() {
    let e = error("time_s,deviation_um\n0,\n1,150012.3\n");
    assert_eq!(
        e.what,
        "reading 150012.3 um is a deviation of 150.012 mm, which no ball-bar reaches"
    );
    assert_eq!(caret(&e), (3, 3, 8));
    assert!(e.hint.unwrap().contains("`reading_unit` is \"um\""));
    assert_eq!(log("time_s,deviation_um\n0,10000\n1,\n").readings()[0].deviation_mm, Some(10.0));
}

#[test]
fn formats_that_make_no_sense() {
    for hz in [0.0, -1.0, 1e300, 1e-300, f64::NAN, f64::INFINITY] {
        assert!(error_with(PLAIN, &rate(hz)).what.contains("Hz"));
    }
    for nominal_mm in [0.0, -150.0, f64::NAN, f64::INFINITY] {
        let mut format = Format::default();
        format.reading.kind = ReadingKind::Length { nominal_mm };
        assert!(error_with(PLAIN, &format).what.contains("mm long"));
    }
    let mut format = Format::default();
    format.reading.name = " TIME_S".to_owned();
    assert!(error_with(PLAIN, &format).what.contains("both"));
}

// What nobody thought of.

fn assert_promises(result: Result<Log>) {
    let Ok(log) = result else { return };
    let readings = log.readings();
    assert!(readings.len() >= 2);
    assert!(readings.iter().all(|r| r.time_s.is_finite()));
    assert!(readings.windows(2).all(|w| w[0].time_s < w[1].time_s && w[0].line < w[1].line));
    assert!(readings.iter().all(|r| r.deviation_mm.is_none_or(|d| d.abs() <= 10.0)));
    assert!(log.sample_period_s() > 0.0);
    let inside: usize = log.in_range_intervals().iter().map(ExactSizeIterator::len).sum();
    assert_eq!(inside, readings.iter().filter(|r| r.deviation_mm.is_some()).count());
    assert!(inside > 0);
}

proptest! {
    #[test]
    fn any_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..400), zipped: bool) {
        let mut content = if zipped { vec![0x1F, 0x8B, 8, 0] } else { Vec::new() };
        content.extend(&bytes);
        assert_promises(with(&content, &Format::default()));
        assert_promises(with(gzip(&bytes), &rate(1.0)));
    }

    #[test]
    fn nearly_a_log(body in "([0-9]{1,3}[,;\t][-0-9.,;\t# \"eµn]{0,6}\r?\n){0,6}", mark in "[,;\t]") {
        let content = format!("time_s{mark}deviation_um\n{body}");
        for format in [Format::default(), rate(100.0)] {
            match with(&content, &format) {
                Err(e) => prop_assert!(!e.to_string().is_empty()),
                ok => assert_promises(ok),
            }
        }
        assert_promises(with(format!("deviation_um\n{body}"), &rate(100.0)));
    }

    #[test]
    fn what_was_written_is_read(
        steps in proptest::collection::vec((1u32..5000, proptest::option::of(-12_000i32..12_000)), 2..60),
        delimiter in proptest::sample::select(&Delimiter::ALL[..3]),
        comma: bool, crlf: bool, bom: bool, zipped: bool, comments: bool,
    ) {
        prop_assume!(steps.iter().any(|(_, reading)| reading.is_some()));
        let mark = char::from(delimiter.byte());
        let mut content = String::new();
        if bom {
            content.push('\u{feff}');
        }
        writeln!(content, "time_s{mark}deviation_um").unwrap();
        let (mut ticks, mut expected) = (0, Vec::new());
        for (step, reading) in steps {
            ticks += step;
            let time_s = f64::from(ticks) / 1e4;
            let deviation_um = reading.map(|r| f64::from(r) / 10.0);
            let mut row = format!("{time_s:.4}{mark}");
            if let Some(um) = deviation_um {
                write!(row, "{um:.1}").unwrap();
            }
            if comma && delimiter != Delimiter::Comma {
                row = row.replace('.', ",");
            }
            if comments {
                content.push_str("# between\n\n");
            }
            writeln!(content, "{row}").unwrap();
            expected.push((time_s, deviation_um.map(|um| um / 1e3)));
        }
        if crlf {
            content = content.replace('\n', "\r\n");
        }
        let bytes = if zipped { gzip(content.as_bytes()) } else { content.into_bytes() };
        prop_assert_eq!(samples(&log(bytes)), expected);
    }
}
