//! Programs that are broken in one way each, and what `ballbar check` says of them.

use std::path::Path;

use ballbar::machine::Machine;
use ballbar::nc::{self, Checked, Reading, Severity, Sphere};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::cases::At::{Edit as Here, File, Line};
use crate::cases::Rs274::{OnlyItself, Passes, Refuses};
use crate::cases::{BASE, CASES};
use crate::outside::installed;
use crate::rs274;

fn machine() -> Machine {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("machines/hu40t.toml");
    Machine::read(&file).unwrap()
}

fn sphere() -> Sphere {
    Sphere {
        centre_mm: Vector3::new(20.0, -35.0, 40.0),
        length_mm: 150.0,
        range_mm: 1.2,
        chord_sag_mm: Some(0.0004),
        feeds_mm_s: vec![500.0 / 60.0],
    }
}

fn checked(source: &str, machine: &Machine, sphere: &Sphere) -> Checked {
    nc::check(source, "O1001.nc".as_ref(), machine, &reading(machine), Some(sphere)).unwrap()
}

fn reading(machine: &Machine) -> Reading {
    let mut reading = Reading::of(machine);
    reading.work_offsets_mm.insert(54, Vector3::new(20.0, -35.0, 40.0));
    reading
}

#[test]
fn nothing_is_wrong_with_the_unbroken_program() {
    let checked = checked(BASE, &machine(), &sphere());
    assert_eq!(checked.findings, []);
}

#[test]
fn a_program_that_is_wrong_all_along_is_not_followed_to_its_end() {
    // Past the workpiece ball and back, a million times.
    let calls =
        "G91 F100.\nM98 P2 L600\nM30\nO0002\nM98 P3 L900\nM99\nO0003\nG01 X1.\nX-1.\nM99\n%\n";
    let (start, _) = BASE.split_once("G01").unwrap();
    let source = format!("{start}G00 X0. Y0. Z0.\n{calls}");
    let checked = checked(&source, &machine(), &sphere());
    let whats: Vec<_> = checked.findings.iter().map(|found| found.error.what.as_str()).collect();
    assert!(whats.iter().any(|what| what.contains("nearer than the bar is short")), "{whats:?}");
    let last = "more than 100000 errors: not all of the program was looked at";
    assert_eq!(whats.last(), Some(&last));
    assert!((100_001..200_000).contains(&checked.count(Severity::Error)));
}

#[test]
fn a_text_of_another_control_is_no_program_after_so_many_lines() {
    let machine = machine();
    let error =
        nc::check(&"?\n".repeat(200_000), "O1.nc".as_ref(), &machine, &reading(&machine), None);
    let told = error.unwrap_err().to_string();
    assert!(told.contains("more than 100000 lines cannot be read"), "{told}");
    assert!(told.contains("`dialect`"), "{told}");
}

#[test]
fn every_kind_of_broken_program_is_found_in_the_right_block() {
    let (machine, sphere) = (machine(), sphere());
    let mut wrong = Vec::new();
    for case in CASES.iter().filter(|case| !case.told.is_empty()) {
        let (source, edited) = case.program();
        let line_of = |text: &str| source.lines().position(|line| line.contains(text)).unwrap() + 1;
        let (line, column) = match case.at {
            Here(column) => (edited, column),
            Line(text, column) => (line_of(text), column),
            File => (0, 0),
        };
        let findings = checked(&source, &machine, &sphere).findings;
        let found = findings.iter().any(|finding| {
            let place = finding.error.place.as_ref().unwrap();
            finding.severity == case.severity
                && finding.error.what.contains(case.told)
                && finding.error.hint.is_some()
                && (place.line, place.column) == (line, column)
        });
        if !found {
            let all: Vec<String> = findings.iter().map(ToString::to_string).collect();
            wrong.push(format!("{} at {line}:{column}\n{}", case.name, all.join("\n")));
        }
    }
    println!("{} kinds of broken programs", CASES.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Rules that need a key of the machine file.
#[test]
fn keys_of_the_machine_file_have_rules() {
    let source = std::fs::read_to_string(machine().file()).unwrap();
    for (from, to, rule, line, told) in [
        ("decimals = 3", "decimals = 3\nblock_time_ms = 100.0", "block-rate", 21, "lasts 78.48 ms"),
        ("decimals = 3", "decimals = 3\nmemory_kb = 0.5", "memory", 0, "program O1001 has 0.8 KB"),
        (
            "look_ahead_on = \"\"",
            "look_ahead_on = \"G05.1 Q1\"",
            "look-ahead",
            0,
            "no block `G05.1 Q1`",
        ),
        ("pivot", "max_feed_mm_min = 100.0\npivot", "feed", 14, "axis X would feed at 471 mm/min"),
        ("decimals = 3", "decimals = 2", "decimals", 21, "X149.999 has more than 2 decimals"),
    ] {
        let changed = source.replacen(from, to, 1);
        assert!(changed != source, "{from}");
        let machine = Machine::parse(&changed, "m.toml".as_ref()).unwrap();
        let findings = checked(BASE, &machine, &sphere()).findings;
        let found = findings.iter().any(|finding| {
            let place = finding.error.place.as_ref().unwrap();
            finding.rule == rule && place.line == line && finding.error.what.contains(told)
        });
        assert!(found, "{to}: {findings:?}");
    }
}

/// What a Fanuc trips over and LinuxCNC means otherwise.
#[test]
fn the_dialect_decides_what_is_wrong() {
    let source = std::fs::read_to_string(machine().file()).unwrap();
    let source = source.replace("\"fanuc\"", "\"linuxcnc\"");
    let machine = Machine::parse(&source, "m.toml".as_ref()).unwrap();
    let spoken = rs274::translated(BASE).replace("G64", "G64 P0.01 Q0");
    assert_eq!(checked(&spoken, &machine, &sphere()).findings, []);
    let lenient = spoken
        .replacen("X150.000 Y0.000", "x150 y0", 1)
        .replacen("(RELEASE)", "; out, schön langsam", 1)
        .replacen("N100", "N0", 1);
    assert_eq!(checked(&lenient, &machine, &sphere()).findings, []);
    for (from, to, told) in [
        ("G04 P3.000", "G04 X3.0", "X3 has no meaning in this block"),
        ("G01 X149.999", "G09 G01 X149.999", "G09 is not known"),
        ("G64 P0.01 Q0", "G64 P0.01", "G64 without Q0 lets the control put chords together"),
        (
            "G64 P0.01 Q0",
            "G64 P0.01 Q0.005",
            "G64 with Q0.005 lets the control put chords together",
        ),
        ("(ARC 1 FORWARD)", "G05.1 Q1", "G05.1 is not known"),
    ] {
        let findings = checked(&spoken.replacen(from, to, 1), &machine, &sphere()).findings;
        let found = findings.iter().any(|finding| finding.error.what.contains(told));
        assert!(found, "{to}: {findings:?}");
    }
}

/// What stands alone in a program must not be told twice, or as something else.
#[test]
fn one_mistake_makes_few_findings() {
    let (machine, sphere) = (machine(), sphere());
    let mut worst = (0, "");
    for case in CASES.iter().filter(|case| case.told.is_empty()) {
        let findings = checked(&case.program().0, &machine, &sphere).findings;
        assert_eq!(findings, [], "{} is allowed", case.name);
    }
    for case in CASES {
        let count = checked(&case.program().0, &machine, &sphere).findings.len();
        worst = worst.max((count, case.name));
    }
    println!("most findings: {} for `{}`", worst.0, worst.1);
}

/// What LinuxCNC's interpreter refuses is refused here, unless a Fanuc allows it; the table says what it
/// lets pass although a Fanuc or the bar would come to harm.
#[test]
fn what_rs274_refuses_is_refused() {
    if !installed("rs274") {
        return;
    }
    assert!(rs274::interpret(&rs274::translated(BASE)).unwrap().ended);
    let mut wrong = Vec::new();
    let mut counts = [0; 3];
    for case in CASES {
        let (source, _) = case.program();
        let alone = matches!(case.rs274, OnlyItself(_));
        let answer = rs274::interpret(&if alone { source } else { rs274::translated(&source) });
        let refused = answer.is_err();
        let expected = case.rs274 != Passes;
        if refused != expected {
            wrong.push(format!("{}: {:?}", case.name, answer.err()));
        }
        if case.rs274 == Refuses && case.severity == Severity::Warning {
            wrong.push(format!("{}: refused there, a warning here", case.name));
        }
        if let OnlyItself(why) = case.rs274 {
            println!("only rs274 refuses `{}`: {why}", case.name);
        }
        counts[match case.rs274 {
            Refuses => 0,
            Passes => 1,
            OnlyItself(_) => 2,
        }] += 1;
    }
    println!("{counts:?} refused by both, found here only, refused by rs274 only");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// One change of a program, as a slip of a finger or a bad transfer makes it.
fn mutate(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    const LIKELY: &[u8] = b"0123456789.-+GMXYZIJKRFNOPQLST%()/;# \n\r\x00\x7f\xc3\x96";
    let at = random.random_range(0..bytes.len().max(1)).min(bytes.len());
    let byte = LIKELY[random.random_range(0..LIKELY.len())];
    match random.random_range(0..8_u8) {
        0 | 1 if at < bytes.len() => bytes[at] = byte,
        2 => bytes.insert(at, byte),
        3 if at < bytes.len() => drop(bytes.remove(at)),
        4 => bytes.truncate(at),
        5 => {
            // A piece stands somewhere else.
            let end = (at + random.random_range(1..40)).min(bytes.len());
            let piece: Vec<u8> = bytes.drain(at..end).collect();
            let to = random.random_range(0..=bytes.len());
            bytes.splice(to..to, piece);
        }
        6 => {
            // A line is there twice.
            let start = bytes[..at].iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
            let end = bytes[at..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |i| at + i);
            let line = bytes[start..end].to_vec();
            let to = end.min(bytes.len());
            bytes.splice(to..to, [b"\n".as_slice(), &line].concat());
        }
        _ => {
            let word: &[&[u8]] = &[
                b"G00",
                b"G02",
                b"G03",
                b"G91",
                b"G20",
                b"G53",
                b"G61",
                b"M98 P2000 L99999",
                b"M99",
                b"O2000",
                b"I-150.",
                b"R150.",
                b"F0",
                b"X99999999",
                b"G04",
                b"N99999",
                b"M30",
            ];
            bytes.splice(at..at, word[random.random_range(0..word.len())].iter().copied());
        }
    }
}

/// `BALLBAR_MUTATIONS=1000000 cargo test --release --test programs mutated -- --nocapture` for a long run.
#[test]
fn mutated_programs_are_checked_without_panic_and_read_if_no_error_is_found() {
    let count: u64 = std::env::var("BALLBAR_MUTATIONS")
        .ok()
        .and_then(|count| count.parse().ok())
        .unwrap_or(20_000);
    let (fanuc, sphere) = (machine(), sphere());
    let source = std::fs::read_to_string(fanuc.file()).unwrap();
    let linuxcnc =
        Machine::parse(&source.replace("\"fanuc\"", "\"linuxcnc\""), fanuc.file()).unwrap();
    let mut random = Pcg64Mcg::new(0x00ba_11ba);
    let (mut clean, mut refused, mut findings) = (0_u64, 0_u64, 0_u64);
    for round in 0..count {
        let mut bytes = BASE.as_bytes().to_vec();
        for _ in 0..random.random_range(1..6) {
            mutate(&mut bytes, &mut random);
        }
        let text = String::from_utf8_lossy(&bytes);
        let machine = if round % 2 == 0 { &fanuc } else { &linuxcnc };
        let around = if round % 3 == 0 { None } else { Some(&sphere) };
        let mut reading = reading(machine);
        if around.is_none() {
            // Without a test file an offset that is not known counts as zero.
            for number in 54..=59 {
                reading.work_offsets_mm.entry(number).or_default();
            }
        }
        let checked = nc::check(&text, "O1.nc".as_ref(), machine, &reading, around);
        let read = nc::read(&text, "O1.nc".as_ref(), &reading);
        match checked {
            // Nothing to check is the only error.
            Err(_) => assert!(read.is_err(), "round {round}"),
            Ok(checked) => {
                findings += checked.findings.len() as u64;
                if checked.count(Severity::Error) == 0 {
                    clean += 1;
                    let program =
                        read.unwrap_or_else(|error| panic!("round {round}: {error}\n{text}"));
                    assert_eq!(program.steps, checked.program.steps, "round {round}");
                } else {
                    refused += 1;
                }
            }
        }
    }
    println!(
        "{count} mutated programs: {refused} with errors, {clean} without, {findings} findings"
    );
    assert!(clean > 0 && refused > clean / 2);
}
