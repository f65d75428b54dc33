//! A log with a comment at its end is read row by row, without one in pieces side by side: what it says is the same.

use std::fmt::Write as _;
use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::error::Result;

fn read(content: &str, format: &Format) -> Result<Log> {
    read_bytes(content.as_bytes(), Path::new("run1.csv"), format)
}

/// What a log says when its rows are read one after the other.
fn one_by_one(content: &str, format: &Format) -> Result<Log> {
    read(&format!("{}\n# end\n", content.trim_end_matches('\n')), format)
}

/// Everything of the readings, to the bit: a zero has a sign.
fn bits(log: &Log) -> Vec<(u64, Option<u64>, usize)> {
    let all = log.readings().iter();
    all.map(|r| (r.time_s.to_bits(), r.deviation_mm.map(f64::to_bits), r.line)).collect()
}

#[track_caller]
fn same(content: &str, format: &Format) {
    match (read(content, format), one_by_one(content, format)) {
        (Ok(plain), Ok(careful)) => {
            assert_eq!(bits(&plain), bits(&careful), "{content}");
            assert_eq!(plain.notes(), careful.notes(), "{content}");
        }
        (Err(plain), Err(careful)) => {
            assert_eq!(plain.to_string(), careful.to_string(), "{content}");
        }
        (plain, careful) => panic!("{plain:?} and {careful:?} of\n{content}"),
    }
}

/// Some pieces of rows, ten a second.
fn long(rows: usize) -> String {
    let mut text = "time_s,deviation_um\n".to_owned();
    for row in 0..rows {
        let um = 20.0 * (0.01 * row as f64).sin();
        // Every hundredth sample is out of range.
        let _ = match row % 100 {
            99 => writeln!(text, "{:.4},", 0.1 * row as f64),
            _ => writeln!(text, "{:.4},{um:.1}", 0.1 * row as f64),
        };
    }
    text
}

#[test]
fn whatever_loggers_write_is_read_alike() {
    let named = |column: &str| Format {
        reading: ReadingColumn { name: column.to_owned(), ..Format::default().reading },
        ..Format::default()
    };
    let beyond = Format {
        out_of_range: OutOfRange { words: vec!["OUT".to_owned()], numbers: vec![-999.5] },
        ..Format::default()
    };
    let usual = Format::default();
    for (rows, format) in [
        ("0,1\n0.1,-0\n.2,+3.\n0.3,-.5\n", &usual),
        ("0.0,0.12345678901234567\n0.1,1234.567890123456789\n1e0,2\n", &usual),
        ("0,1\r\n0.1,2\r\n0.2,\r\n", &usual),
        (" 0 , 1 \n 0.1 ,  \n 0.2 , 2.5\n", &usual),
        ("0,1\n0.1,NaN\n0.2,2\n", &usual),
        ("0,1\n0.1,-9999.9\n0.2,99999\n", &usual),
        ("0,1\n0.1,-999.5\n0.2,OUT\n", &beyond),
        ("0,1\n0.1,-999.5\n0.2,3\n", &beyond),
        ("0,1\n\n0.1,2\n", &usual),
        ("0,1\n0.1,2,3\n", &usual),
        ("0,1\n0.1,\"2\"\n", &usual),
        ("0,1\n0.1,2\n0.1,3\n", &usual),
        ("0,1\n0.1,20000\n", &usual),
        ("0,1\n20000000000,2\n", &usual),
        ("0,1\n0.1,-\n0.2,3\n", &usual),
        ("0,1\n0.1\n", &usual),
        ("0:00.1,1\n0:00.2,2\n", &usual),
        ("", &usual),
    ] {
        same(&format!("time_s,deviation_um\n{rows}"), format);
        same(&format!("time_s;deviation_um\n{}", rows.replace(',', ";")), format);
        same(&format!("time_s\tdeviation_um\n{}", rows.replace(',', "\t")), format);
    }
    // Columns that nobody asked for may hold anything.
    same("note,deviation_um,time_s\nwärm,1,0\nkalt,2,0.1\n", &usual);
    same("note,deviation_um,time_s\n#1,1,0\nb,2,0.1\nc,3,0.2\n", &usual);
    same("note,deviation_um,time_s\n\"a,b\",1,0\nc,2,0.1\n", &usual);
    same("time_s,a,bar_um,b\n0,,1,\n0.1,x,2,y\n", &named("bar_um"));
}

#[test]
fn long_logs_are_the_same_on_any_number_of_threads() {
    let text = long(120_000);
    let careful = bits(&one_by_one(&text, &Format::default()).unwrap());
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let log = pool.install(|| read(&text, &Format::default())).unwrap();
        assert_eq!(bits(&log), careful, "{threads} threads");
        assert_eq!(log.readings()[100_000].line, 100_002);
    }
}

#[test]
fn what_is_wrong_far_down_is_told_with_its_line() {
    let text = long(120_000);
    let lines: Vec<&str> = text.lines().collect();
    for (number, wrong) in [(100_000, "9999.8000,l2"), (70_001, "7,1.0"), (119_999, "11999.7000")] {
        let mut changed = lines.clone();
        changed[number - 1] = wrong;
        let error = read(&changed.join("\n"), &Format::default()).unwrap_err();
        assert_eq!(error.place.unwrap().line, number);
    }
    // A time may go back where one piece ends and another begins, too.
    let joined = format!("{text}{}", &long(60_000)["time_s,deviation_um\n".len()..]);
    let error = read(&joined, &Format::default()).unwrap_err();
    assert_eq!(error.place.unwrap().line, 120_002);
    assert!(error.what.contains("goes back behind"), "{}", error.what);
}

proptest! {
    #[test]
    fn any_rows_are_read_alike(rows in proptest::collection::vec(
        ("[-+]?[0-9]{0,18}\\.?[0-9]{0,18}", "([-+]?[0-9]{1,4}\\.?[0-9]{0,12}|[ 0-9.eE#\"x:-]{0,6})"), 0..6
    ), sorted: bool) {
        let mut text = "time_s,deviation_um\n".to_owned();
        for (index, (time, reading)) in rows.iter().enumerate() {
            let time = if sorted { format!("{index}.{}", time.trim_matches(['-', '+']).replace('.', "")) } else { time.clone() };
            let _ = writeln!(text, "{time},{reading}");
        }
        same(&text, &Format::default());
    }
}
