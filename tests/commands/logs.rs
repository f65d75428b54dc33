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

/// A file of Ballbar 20 with what a log by time has read over the middle of each arc.
fn ballbar_file(samples: &str, arc_deg: f64) -> String {
    let names: Vec<&str> = samples.lines().next().unwrap().split(',').collect();
    let at = |name: &str| names.iter().position(|of| *of == name).unwrap();
    let (place, arc, angle, deviation) =
        (at("place"), at("arc"), at("angle_deg"), at("deviation_um"));
    let rows = samples.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    let rows: Vec<Vec<&str>> = rows.filter(|row| row[place] == "arc").collect();
    let mut text = String::from(
        "<TEST><TEST_SPEC NAME=\"XY 340 grad\"/><PROGRAMMED_FEEDRATE>1000</PROGRAMMED_FEEDRATE><PLANE TEST_PLANE=\"XY\"/><NOMINAL_LENGTH>150</NOMINAL_LENGTH><OPERATOR>Meier</OPERATOR><SERIAL_NUMBER>0AF3</SERIAL_NUMBER><LAST_CALIBRATED>20260301</LAST_CALIBRATED>",
    );
    for driven in rows.chunk_by(|a, b| a[arc] == b[arc]) {
        let mut points: Vec<[f64; 2]> =
            driven.iter().map(|row| [angle, deviation].map(|k| row[k].parse().unwrap())).collect();
        let counter_clockwise = points[1][0] > points[0][0];
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let direction = if counter_clockwise { "CCW" } else { "CW" };
        write!(text, "<BALLBAR_RUN><RUN_DIRECTION>{direction}</RUN_DIRECTION><READINGS>").unwrap();
        for k in 0..1000 {
            let along = arc_deg * ((f64::from(k) + 0.5) / 1000.0 - 0.5);
            let angle = 180.0 + if counter_clockwise { along } else { -along };
            let after = points.partition_point(|point| point[0] < angle);
            let (before, after) = (points[after - 1], points[after]);
            let share = (angle - before[0]) / (after[0] - before[0]);
            write!(text, "{:.6} ", 1e-3 * (before[1] + share * (after[1] - before[1]))).unwrap();
        }
        text += "</READINGS></BALLBAR_RUN>";
    }
    text + "</TEST>"
}

/// What `identify` says of the machine: quantities with value and uncertainty.
fn answers(work: &Work, test: &str) -> Vec<(String, f64, f64)> {
    let json = work.ballbar(&["identify", test, "--json"]).done().stdout();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let number = |of: &serde_json::Value| of.as_f64().unwrap_or(0.0);
    let all = json["at_the_place"].as_array().unwrap().iter();
    all.map(|of| {
        (of["quantity"].as_str().unwrap().to_owned(), number(&of["value"]), number(&of["noise"]))
    })
    .collect()
}

#[test]
fn a_file_of_ballbar_20_tells_what_the_log_by_time_tells() {
    let work = Work::new();
    let plan = "[plan]\nfeed_mm_min = 1000.0\n[[plan.arc]]\nkind = \"equator\"\n";
    work.machine("name", "name")
        .test(&format!("[log]\nsample_rate_hz = 250.0\ntime_column = \"time_s\"\n{plan}"));
    work.ballbar(&["simulate", "test.toml"]).done();
    work.ballbar(&["align", "results/test.toml"]).done();
    let samples = std::fs::read_to_string(work.path("results/samples-run1.csv")).unwrap();
    work.write("results/run1.b5r", ballbar_file(&samples, 340.0));
    let test = std::fs::read_to_string(work.path("results/test.toml")).unwrap();
    let record = "[record]\ndate = 2026-11-23\noperator = \"Huber\"\nmachine_temperature_c = 25.0\nmachine_expansion_um_m_k = 10.0\n";
    work.write(
        "results/by-angle.toml",
        format!("{}\n{record}", test.replace("run1.csv", "run1.b5r")),
    );
    let (by_time, by_angle) =
        (answers(&work, "results/test.toml"), answers(&work, "results/by-angle.toml"));
    let found = |name: &str| by_angle.iter().find(|of| of.0 == name).unwrap();
    for (name, tolerance) in [
        ("scale X", 3.0),
        ("squareness XY", 3.0),
        ("reversal X", 0.3),
        ("reversal Y", 0.3),
        ("lateral play X in Y", 0.3),
    ] {
        let expected = by_time.iter().find(|of| of.0 == name).unwrap();
        assert!(
            (found(name).1 - expected.1).abs() < tolerance,
            "{name}: {expected:?}, {:?}",
            found(name)
        );
    }
    // 5 K at 10 um/m/K.
    assert!((found("scale X").1 - found("scale X at 20 C").1 - 50.0).abs() < 1e-9);
    let shown = work.ballbar(&["show", "results/run1.b5r"]).done().stdout();
    assert!(shown.contains("operator        Meier") && shown.contains("CCW"), "{shown}");
    // The file says who and with what; what the test file says counts more.
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let analysis: serde_json::Value = serde_json::from_str(&analysis).unwrap();
    let record = &analysis["test"]["record"];
    assert_eq!((&record["operator"], &record["bar_serial"]), (&"Huber".into(), &"0AF3".into()));
    assert_eq!(record["bar_calibrated"], "2026-03-01");
    let by_angle = test.replace("run1.csv", "run1.b5r");
    for (from, to, told) in [
        (
            "[[mounting]]",
            "[log]\nplane = \"yz\"\n\n[[mounting]]",
            "in the plane YZ, and the program drives 0",
        ),
        (
            "length_mm = 150",
            "length_mm = 148.0 # 150",
            "a bar of 150 mm, and the test of one of 148 mm",
        ),
    ] {
        assert!(by_angle.contains(from) && !by_angle.contains("[log]"), "{by_angle}");
        work.write("results/by-angle.toml", by_angle.replacen(from, to, 1));
        let outcome = work.ballbar(&["identify", "results/by-angle.toml"]);
        assert_eq!(outcome.code(), 3, "{}", outcome.stderr());
        assert!(outcome.stderr().contains(told), "{}", outcome.stderr());
    }
}

#[test]
fn any_log_is_shown_before_there_is_a_test() {
    let work = Work::new();
    let mut german = String::from("Ball-bar\r\nZeit [s];Temperatur;Abweichung [\u{b5}m]\r\n");
    for sample in 0..200 {
        // A second is lost behind line 102; ten readings have no number.
        let time = f64::from(sample) * 0.04 + if sample < 100 { 0.0 } else { 1.0 };
        let reading = if sample < 10 { "OVER".to_owned() } else { format!("{},5", sample - 100) };
        write!(german, "{};20,1;{reading}\r\n", format!("{time:.2}").replace('.', ",")).unwrap();
    }
    let windows: Vec<u8> =
        german.chars().map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?')).collect();
    work.write("german.csv", &windows);
    let shown = work.ballbar(&["show", "german.csv"]).done().stdout();
    for told in [
        "text in windows-1252, columns named in line 2, apart by semicolons",
        "`Zeit [s]`, s",
        "`Abweichung [\u{b5}m]`, deviations in um",
        "not read        `Temperatur`",
        "200 in 8.960 s, 25.0000 a second",
        "1, the longest of 1.040 s behind line 102",
        "190 samples in 2 stretches, -90.50 to 99.50 um; 10 out of range",
        "10 reading(s) are `OVER`",
        "time_column = \"Zeit [s]\"",
        "reading_column = \"Abweichung [\u{b5}m]\"",
    ] {
        assert!(shown.contains(told), "{told}\n{shown}");
    }
    // With a test file its columns count, and nothing is left to write.
    work.machine("name", "name")
        .test("[log]\ntime_column = \"Zeit [s]\"\nreading_column = \"Temperatur\"\n");
    let shown = work.ballbar(&["show", "german.csv", "--test", "test.toml"]).done().stdout();
    assert!(shown.contains("20.10 to 20.10 um") && !shown.contains("in a test file"), "{shown}");

    let mut angles = String::from("angle_deg,deviation_mm\n");
    for step in 0..=720_i32 {
        let degrees = 360 - (step - 360).abs();
        // Cut off at 1.2 mm for 41 readings of each way.
        writeln!(angles, "{degrees},{:.4}", (f64::from((degrees - 180).abs()) / 100.0).min(1.2))
            .unwrap();
    }
    work.write("angles.csv", angles);
    let shown = work.ballbar(&["show", "--json", "angles.csv"]).done().stdout();
    let shown: serde_json::Value = serde_json::from_str(&shown).unwrap();
    let file = &shown["files"][0];
    assert_eq!(shown["format"], "ballbar.show/1");
    assert_eq!(file["time"]["angle_column"], "angle_deg");
    assert_eq!(
        (&file["arcs"][0]["direction"], &file["arcs"][1]["direction"]),
        (&"CCW".into(), &"CW".into())
    );
    assert_eq!((&file["span_s"], &file["samples"]), (&serde_json::Value::Null, &721.into()));
    assert_eq!(file["cut_off"][0]["at_um"], 1200.0);
    assert!(
        work.ballbar(&["show", "angles.csv"]).done().stdout().contains("the plane is not said")
    );
}
