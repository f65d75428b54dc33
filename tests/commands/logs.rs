//! One measured log as Excel, Windows and loggers write it: the same samples come out, or the line to write.

use std::fmt::Write as _;

use crate::work::{Work, data, unpacked};

/// The samples of a run whose log is written like this, with lines under `[log]`, and what was said.
fn samples(log: impl AsRef<[u8]>, lines: &str) -> (String, String) {
    let work = Work::new();
    work.run_of(log);
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    work.write("test.toml", test.replace("[[mounting]]", &format!("[log]\n{lines}\n[[mounting]]")));
    let analysis = work.ballbar(&["analyse", "test.toml"]).done().stdout();
    let samples = std::fs::read_to_string(work.path("results/samples-run.csv")).unwrap_or_default();
    (samples, analysis)
}

#[test]
fn a_log_in_the_clothes_of_windows() {
    let plain = unpacked(&data("hu40t").join("run1.csv.gz"));
    let (expected, _) = samples(&plain, "");
    assert!(expected.lines().count() > 1000);
    // Semicolons, decimal commas, a time of day that passes midnight, words out of range, UTF-16: a German Excel.
    let rows = plain.lines().filter(|line| !line.starts_with('#'));
    let mut german = String::from("sep=;\r\nBall-bar\r\nZeit;Abweichung [\u{b5}m]\r\n");
    for row in rows.skip(1) {
        let (time, reading) = row.split_once(',').unwrap();
        let tenths_ms = (time.parse::<f64>().unwrap() * 1e4).round() as u64;
        let of_day = (tenths_ms + 23 * 36_000_000 + 55 * 600_000) % 864_000_000;
        let (seconds, rest) = (of_day / 10_000, of_day % 10_000);
        let clock =
            format!("{:02}:{:02}:{:02},{rest:04}", seconds / 3600, seconds / 60 % 60, seconds % 60);
        let reading =
            if reading.is_empty() { "OVER".to_owned() } else { reading.replace('.', ",") };
        write!(german, "{clock};{}\r\n", reading.replace('-', "\u{2212}")).unwrap();
    }
    let utf16: Vec<u8> = german.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let columns = "time_column = \"Zeit\"\nreading_column = \"Abweichung [\u{b5}m]\"";
    let (found, said) = samples(utf16, columns);
    assert!(said.contains("reading(s) are `OVER` and count as out of range"), "{said}");
    let columns = |text: &str| -> Vec<[f64; 2]> {
        let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        let at =
            ["deviation_um", "x_mm"].map(|name| names.iter().position(|n| *n == name).unwrap());
        let rows = text.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
        rows.map(|row| at.map(|index| row[index].parse().unwrap())).collect()
    };
    let (found, expected) = (columns(&found), columns(&expected));
    assert_eq!(found.len(), expected.len());
    let farthest =
        found.iter().zip(&expected).map(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()));
    // The clock of the log begins elsewhere: other rounding, the same readings at the same places.
    assert!(farthest.fold(0.0, f64::max) < 2e-3);
}
