//! Logs laid over programs that they do not belong to, and logs that lost something.

use ballbar::Result;
use ballbar::error::{Error, Kind};
use ballbar::identify::Identification;

use crate::chain::Set;
use crate::common::repository;

/// Identifies a log over a program, as the set's test file would.
fn identify(
    set: &Set,
    log: &str,
    program: &str,
    edit: impl Fn(&str) -> String,
) -> Result<Identification> {
    let data = repository("tests/data");
    let log = set.log(&data.join(log), edit)?;
    let alignment = set.align(&log, &set.program(&data.join(program)))?;
    let run = &set.test.runs()?[0];
    set.identify(vec![set.input(run, alignment)])
}

/// The log of `hu40t` after an edit that maps or drops each `(line, time, reading)`.
fn edited(edit: impl Fn(usize, f64, &str) -> Option<(f64, String)>) -> Result<Identification> {
    identify(&Set::read("hu40t"), "hu40t/run1.csv.gz", "hu40t/O1005.nc.gz", |text| {
        let mut log = String::from("time_s,deviation_um\n");
        for (k, line) in text.lines().filter(|line| line.starts_with(char::is_numeric)).enumerate()
        {
            let (time, reading) = line.split_once(',').unwrap();
            if let Some((time_s, reading)) = edit(k, time.parse().unwrap(), reading) {
                log += &[format!("{time_s:.4}"), reading].join(",");
                log.push('\n');
            }
        }
        log
    })
}

fn refused(what: &str, found: Result<Identification>, parts: &[&str]) -> Error {
    let error = match found {
        Err(error) => error,
        Ok(found) => panic!("{what}: accepted with {:.3} um rms", 1e3 * found.rms_mm),
    };
    println!("--- {what}\n{error}");
    assert_eq!(error.kind, Kind::Mismatch, "{what}");
    for part in parts {
        assert!(error.to_string().contains(part), "{what}: `{part}` is not in\n{error}");
    }
    error
}

fn accepted(what: &str, found: Result<Identification>) -> Identification {
    let found = found.unwrap_or_else(|error| panic!("{what}: {error}"));
    println!("--- {what}: accepted, {:.4} um rms, {:?}", 1e3 * found.rms_mm, cautions(&found));
    found
}

/// What speaks against it: all sets here are of one machine.
fn cautions(found: &Identification) -> Vec<String> {
    Set::read("hu40t").cautions(found)
}

#[test]
fn a_log_of_another_program_is_refused() {
    let (hu40t, planar) = (Set::read("hu40t"), Set::read("planar"));
    let (case_d, stops) = (Set::read("case-d"), "hu40t-stops/run1.csv.gz");
    let same = str::to_owned;
    let (whole, circles) = ("hu40t/O1005.nc.gz", "planar/O1001.nc.gz");
    refused(
        "hu40t over a planar program",
        identify(&hu40t, "hu40t/run1.csv.gz", circles, same),
        &["engages the bar 2 time(s), the log shows 1", "56.8, 56.8", "888.5"],
    );
    refused(
        "a planar log over 3D6",
        identify(&planar, "planar/xy.csv.gz", whole, same),
        &["engages the bar 1 time(s), the log shows 0 of such a length", "56.7, 56.7"],
    );
    // At another feed the dwells stay: no position of the knob makes one of the other.
    for (log, program, lengths) in [
        ("case-d/run4.csv.gz", "case-d/O1005.nc.gz", ["888.5", "330.9"]),
        ("case-d/run1.csv.gz", "case-d/O1015.nc.gz", ["330.9", "888.5"]),
    ] {
        let error = refused("another feed", identify(&case_d, log, program, same), &lengths);
        assert!(!error.to_string().contains("override"), "a false hint:\n{error}");
    }
    refused(
        "pauses that the program does not have",
        identify(&hu40t, stops, whole, same),
        &["is in the log and not in the program", "write an M00 into the program"],
    );
}

/// The other way round no harm is done: the pauses that did not happen come out as none.
#[test]
fn a_log_without_the_pauses_of_its_program_is_read() {
    let stops = Set::read("hu40t-stops");
    let found = identify(&stops, "hu40t/run1.csv.gz", "hu40t-stops/O1005.nc.gz", str::to_owned);
    let found = accepted("no pauses", found);
    assert!(found.rms_mm < 1.01 * 0.1515e-3);
    assert!(cautions(&found).is_empty());
}

#[test]
fn a_log_that_was_cut_off_says_which_end_is_missing() {
    type Keep = fn(f64) -> bool;
    for (what, keep, part) in [
        ("first half", (|s| s < 490.0) as Keep, "its end is missing"),
        ("last half", |s| s > 490.0, "its beginning is missing"),
        ("first 97 %", |s| s < 910.0, "its end is missing"),
        ("the middle", |s| (300.0..600.0).contains(&s), "its beginning and its end are missing"),
    ] {
        let found = edited(|_, s, reading| keep(s).then(|| (s, reading.to_owned())));
        let error = refused(what, found, &[part]);
        assert!(!error.to_string().contains("override"), "{what}: a false hint:\n{error}");
    }
}

/// Time that the log's clock does not know of.
#[test]
fn readings_cut_out_without_a_gap_are_found_where_they_are_missing() {
    for lost_s in [0.5, 1.0, 3.0, 10.0] {
        let found = edited(|_, s, reading| match s {
            s if s < 490.0 => Some((s, reading.to_owned())),
            s if s < 490.0 + lost_s => None,
            s => Some((s - lost_s, reading.to_owned())),
        });
        // They were cut out at the beginning of the way back on the second meridian.
        refused(
            &format!("{lost_s} s cut out"),
            found,
            &["MERIDIAN 2 FORWARD", "MERIDIAN 2 BACKWARD", &format!("{lost_s:.1} s is missing")],
        );
    }
    // A longer log: the machine stood, and nobody wrote it down.
    let held =
        edited(|_, s, reading| Some((if s < 490.0 { s } else { s + 2.0 }, reading.to_owned())));
    refused("2 s of feed hold", held, &["2.0 s is in the log and not in the program"]);
    // As much as a clock within its tolerance may lose is no ground to refuse, but it is said.
    let little = edited(|_, s, reading| match s {
        s if s < 490.0 => Some((s, reading.to_owned())),
        s if s < 490.0999 => None,
        s => Some((s - 0.1, reading.to_owned())),
    });
    let found = accepted("0.1 s cut out", little);
    assert!(cautions(&found).iter().any(|c| c.contains("MERIDIAN 2") && c.contains("0.1")));
}

/// Gaps that the clock counts cost nothing but their samples.
#[test]
fn gaps_and_dropouts_do_no_harm() {
    let blank = |s: f64, is: bool, reading: &str| (s, if is { "" } else { reading }.to_owned());
    let hole = |s: f64| (490.0..493.0).contains(&s);
    for (what, found) in [
        ("3 s missing", edited(|_, s, r| (!hole(s)).then(|| (s, r.to_owned())))),
        ("3 s blank", edited(|_, s, r| Some(blank(s, hole(s), r)))),
        ("1 % blank", edited(|k, s, r| Some(blank(s, (k * 7919) % 100 == 3, r)))),
        ("30 % missing", edited(|k, s, r| ((k * 7919) % 10 > 2).then(|| (s, r.to_owned())))),
    ] {
        let found = accepted(what, found);
        assert!(found.rms_mm < 1.01 * 0.1515e-3, "{what}");
        assert!(cautions(&found).is_empty(), "{what}: {:?}", cautions(&found));
    }
}

/// One per cent of feed, everywhere alike, is the feed and not a loss.
#[test]
fn a_faster_feed_is_not_taken_for_lost_readings() {
    let set = Set::read("hu40t");
    let data = repository("tests/data");
    let log = set.log(&data.join("hu40t/run1.csv.gz"), |text| {
        let faster = |line: &str| {
            let (time, reading) = line.split_once(',').unwrap();
            time.parse().map_or(line.to_owned(), |s: f64| format!("{:.4},{reading}", s / 1.01))
        };
        text.lines().map(faster).collect::<Vec<_>>().join("\n")
    });
    let program = set.program(&data.join("hu40t/O1005.nc.gz"));
    let alignment = set.align(&log.unwrap(), &program).unwrap();
    println!("override excess {:.4}", alignment.time_map.override_excess);
    assert!((alignment.time_map.override_excess - 0.0105).abs() < 0.000_2);
}

#[test]
fn readings_far_off_are_said() {
    let spikes = edited(|k, s, reading| {
        let spike = (1000..9000).contains(&k) && k % 1000 == 3;
        Some((s, if spike { "400.0" } else { reading }.to_owned()))
    });
    let found = accepted("spikes", spikes);
    // Those in dwells and at reversals are not used anyhow.
    let used = found.runs[0].used().filter(|record| record.sample.deviation_mm > 0.3).count();
    assert!(used >= 5);
    let said = format!("{used} reading(s)");
    assert!(cautions(&found).iter().any(|c| c.starts_with(&said) && c.contains("huber")));
}

/// The three planes take the same times, so durations cannot tell their logs apart; the fit of all
/// three can when two are exchanged.
///
/// By itself every log fits every plane: 13 to 15 directions of 38 describe one plane, and those of one
/// are those of the other by another name. Turned round all together, too.
#[test]
fn exchanged_planes_are_said_when_the_three_are_identified_together() {
    let set = Set::read("planar");
    let runs = set.test.runs().unwrap();
    for (order, exchanged) in
        [([0, 1, 2], false), ([1, 0, 2], true), ([0, 2, 1], true), ([2, 1, 0], true)]
    {
        let inputs = runs.iter().zip(order).map(|(run, log)| {
            let log = set.log(&runs[log].log, str::to_owned).unwrap();
            let alignment = set.align(&log, &set.program(&run.program)).unwrap();
            set.input(run, alignment)
        });
        // Times run away from what is another plane's.
        let said = match set.identify(inputs.collect()) {
            Err(error) => error.kind == Kind::Undetermined,
            Ok(found) => cautions(&found).iter().any(|c| c.contains("another program")),
        };
        assert_eq!(said, exchanged, "logs {order:?}");
    }
    for (log, program) in [("xy", 2), ("zx", 1), ("yz", 3)] {
        let (log_file, program) =
            (format!("planar/{log}.csv.gz"), format!("planar/O100{program}.nc.gz"));
        // One alone fits as another plane, or its times do not come to rest.
        match identify(&set, &log_file, &program, str::to_owned) {
            Err(error) => assert_eq!(error.kind, Kind::Undetermined, "{log} over {program}"),
            found => drop(accepted(&format!("{log} over {program}"), found)),
        }
    }
}
