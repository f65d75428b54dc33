//! Somebody's first day, with the binary and nothing else.

use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};

use crate::work::{Work, project};

/// The first section of the guide is the five commands, word for word; no file is edited.
#[test]
fn five_commands_lead_from_nothing_to_a_report() {
    let guide = std::fs::read_to_string(project().join("docs/guide.md")).unwrap();
    let first = guide.split("\n## ").nth(1).unwrap();
    let lines: Vec<&str> =
        first.lines().filter_map(|line| line.strip_prefix("    ballbar ")).collect();
    assert_eq!(lines.len(), 5, "{first}");
    let readme = std::fs::read_to_string(project().join("README.md")).unwrap();
    let work = Work::new();
    for line in lines {
        assert!(readme.contains(&format!("ballbar {line}\n")), "README has other words: {line}");
        let outcome = Command::new(assert_cmd::cargo::cargo_bin!("ballbar"))
            .current_dir(work.path(""))
            .args(line.split_whitespace())
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&outcome.stderr);
        assert!(outcome.status.success(), "{line}: {told}");
    }
    let report = std::fs::read_to_string(work.path("vmc/results/report.html")).unwrap();
    assert!(report.contains("XY plane"));
    let test = std::fs::read_to_string(work.path("vmc/virtual/test.toml")).unwrap();
    assert!(test.contains("machine = \"../machine.toml\""), "{test}");
    // The folder can be mailed.
    std::fs::rename(work.path("vmc"), work.path("elsewhere")).unwrap();
    work.ballbar(&["identify", "elsewhere/virtual/test.toml"]).done();
}

#[test]
fn what_was_not_given_is_told_and_what_was_given_is_taken() {
    let work = Work::new();
    let given = [
        "init",
        "mine",
        "--topology",
        "wFYXZSt",
        "--travel=-900..0,-500..0,-450..0",
        "--control",
        "linuxcnc",
        "--bar",
        "100",
        "--tool",
        "95.5",
        "--test",
        "iso230-4",
        "--feed",
        "1200",
    ];
    let outcome = work.ballbar(&given).done();
    let told = outcome.stderr();
    assert!(told.contains("--machine  vertical") && told.contains("--name "), "{told}");
    assert!(
        !told.contains("--travel") && told.contains("next: ballbar plan mine/test.toml"),
        "{told}"
    );
    assert_eq!(outcome.stdout(), "mine/machine.toml\nmine/test.toml\n");
    let machine = work.ballbar(&["machines", "mine/machine.toml"]).done().stdout();
    assert!(machine.contains("wFYXZSt") && machine.contains("linuxcnc"), "{machine}");
    assert!(machine.contains("-900.0 to    0.0 mm"), "{machine}");
    let test = std::fs::read_to_string(work.path("mine/test.toml")).unwrap();
    for key in ["length_mm = 100.0 ", "tool_ball_mm = [0.0, 0.0, -95.5] ", "feed_mm_min = 1200.0 "]
    {
        assert!(test.contains(key), "{key}\n{test}");
    }
    work.ballbar(&["plan", "mine/test.toml"]).done();
    work.ballbar(&["program", "mine/test.toml"]).done();
    let check = ["check", "results/O1001.nc", "--test", "mine/test.toml"];
    assert!(work.ballbar(&check).done().stderr().contains("0 error(s), 0 warning(s)"));
}

/// Of a plane of Ballbar 20 in the order of driving, the CCW run second; readings are eccentric, X is 60 um/m too long, and
/// the axes are 80 um/m out of square.
fn measured_plane(plane: &str, name: &str, arc_deg: f64, um: bool) -> String {
    measured_at(1800, plane, name, arc_deg, um)
}

/// The same with so many readings a run.
fn measured_at(count: u32, plane: &str, name: &str, arc_deg: f64, um: bool) -> String {
    let mut text = format!(
        "<TEST><TEST_SPEC NAME=\"{name}\"/><NOMINAL_LENGTH>150</NOMINAL_LENGTH><PROGRAMMED_FEEDRATE>1500</PROGRAMMED_FEEDRATE>\
         <PLANE TEST_PLANE=\"{plane}\"/><MACHINE_TESTED NAME=\"DMU 50\"/><DATE_STARTED>20251218-194332</DATE_STARTED>"
    );
    let begins = if arc_deg < 360.0 { 90.0 - 0.5 * arc_deg } else { 0.0 };
    for direction in ["CW", "CCW"] {
        write!(text, "<BALLBAR_RUN><RUN_DIRECTION>{direction}</RUN_DIRECTION><READINGS>").unwrap();
        for k in 0..count {
            let along = arc_deg * (f64::from(k) + 0.5) / f64::from(count);
            let angle = begins + if direction == "CW" { arc_deg - along } else { along };
            let (sin, cos) = angle.to_radians().sin_cos();
            let um_read = 7.0 * cos - 4.0 * sin + 150e-3 * (60.0 * cos * cos + 80.0 * cos * sin);
            write!(text, "{:.5} ", if um { um_read } else { um_read * 1e-3 }).unwrap();
        }
        text += "</READINGS></BALLBAR_RUN>";
    }
    text + "</TEST>"
}

#[test]
fn what_ballbar_20_measured_is_analysed_with_two_commands() {
    let work = Work::new();
    for (plane, name, arc_deg, um, axes) in [
        ("XY", "XY 360 grad 150mm", 360.0, false, ["X", "Y"]),
        ("ZY", "YZ 220grad", 220.0, true, ["Y", "Z"]),
    ] {
        work.write("monday.b5r", measured_plane(plane, name, arc_deg, um));
        let mine = format!("mine-{plane}");
        let outcome = work.ballbar(&["init", &mine, "--from", "monday.b5r"]).done();
        let test = format!("{mine}/test.toml");
        assert!(outcome.stdout().contains("O1001.nc"), "{}", outcome.stdout());
        let told = outcome.stderr();
        for part in [
            &format!("{arc_deg} degrees, 150 mm, 1500 mm/min, DMU 50"),
            &format!("next: ballbar analyse {test}"),
            "--travel",
        ] {
            assert!(told.contains(part), "{part}\n{told}");
        }
        assert!(!told.contains("--feed") && !told.contains("--bar"), "not left open: {told}");
        let json = work.ballbar(&["analyse", &test, "--json"]).done().stdout();
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["test"]["date"], "2025-12-18");
        let quantity = |name: &str| {
            let all = json["at_the_place"].as_array().unwrap();
            let of = all.iter().find(|of| of["quantity"] == name).unwrap();
            [&of["value"], &of["all"]].map(|value| value.as_f64().unwrap())
        };
        let [first, second] = axes;
        // An angle that is too wide or too narrow: its sign is that of the axes' order.
        let [squareness, all] = quantity(&format!("squareness {first}{second}"));
        assert!((squareness.abs() - 80.0).abs() < 3.0 * all, "{plane}: {squareness} +- {all}");
        let [longer, all] = quantity(&format!("scale {first}"));
        let shorter = quantity(&format!("scale {second}"))[0];
        assert!((longer - shorter - 60.0).abs() < 3.0 * all, "{plane}: {longer} {shorter} {all}");
    }
}

/// Fewer readings than the model has numbers: what is plausible determines the others, and *all* says so.
#[test]
fn a_few_readings_are_enough_where_the_rest_is_plausible() {
    let work = Work::new();
    work.write("few.b5r", measured_at(36, "XY", "XY 360 grad", 360.0, false));
    work.ballbar(&["init", "few", "--from", "few.b5r"]).done();
    let json = work.ballbar(&["identify", "few/test.toml", "--json"]).done().stdout();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let all = json["at_the_place"].as_array().unwrap();
    let squareness = all.iter().find(|of| of["quantity"] == "squareness XY").unwrap();
    let [value, all] = [&squareness["value"], &squareness["all"]].map(|of| of.as_f64().unwrap());
    assert!((value.abs() - 80.0).abs() < 3.0 * all, "{value} +- {all}");
    // One run of 30 leaves nothing for the noise.
    let one = measured_at(30, "XY", "XY 360 grad", 360.0, false);
    let end = one.find("</BALLBAR_RUN>").unwrap() + "</BALLBAR_RUN>".len();
    work.write("one.b5r", format!("{}</TEST>", &one[..end]));
    work.ballbar(&["init", "one", "--from", "one.b5r"]).done();
    let refused = work.ballbar(&["identify", "one/test.toml"]);
    assert!(
        refused.stderr().contains("30 samples on arcs cannot determine"),
        "{}",
        refused.stderr()
    );
}

#[test]
fn what_a_file_of_ballbar_20_leaves_open_is_told_by_options() {
    let work = Work::new();
    let plain = measured_plane("XY", "XY 360 grad", 360.0, false);
    let partial = measured_plane("YZ", "test", 220.0, false);
    let no_plane = plain.replace("<PLANE TEST_PLANE=\"XY\"/>", "");
    let twice = plain.replace(">CCW<", ">CW<");
    let round = "<FEATURE NAME=\"AF_CIRCULARITY\" DT=\"UT_LENGTH_MM\">0.5</FEATURE></BALLBAR_RUN>";
    let other = plain.replace("</BALLBAR_RUN>", round);
    for (text, given, told) in [
        (&no_plane, &[][..], "`--test xy`, `--test yz` or `--test zx`"),
        (&plain, &["--test", "yz"], "the plane xy, and `--test yz` is another"),
        (&twice, &[], "0 run(s) CCW and 2 CW"),
        (&partial, &[], "with `--arc` the degrees that were measured"),
        (&other, &[], "such as `--unit um --arc 220`"),
        (&"time_s,deviation_um\n0,1\n1,1\n".to_owned(), &[], "this is a table of readings"),
    ] {
        work.write("monday.b5r", text);
        let message =
            work.ballbar(&[&["init", "mine", "--from", "monday.b5r"], given].concat()).refused(1);
        assert!(message.contains(told), "{told}\n{message}");
        assert!(!work.path("mine").exists(), "nothing half-written");
    }
    for (folder, text, given) in [
        ("a", &no_plane, &["--test", "xy"][..]),
        ("b", &partial, &["--arc", "220"]),
        ("c", &other, &["--unit", "mm", "--arc", "360"]),
    ] {
        work.write("monday.b5r", text);
        work.ballbar(&[&["init", folder, "--from", "monday.b5r"], given].concat()).done();
        work.ballbar(&["align", &format!("{folder}/test.toml")]).done();
    }
    assert_eq!(work.ballbar(&["init", "mine", "--arc", "220"]).code(), 2, "an arc of nothing");
}

#[test]
fn a_design_can_be_planned_before_it_is_designed() {
    let work = Work::new();
    work.ballbar(&["init", "mine", "--machine", "hu40t", "--test", "design"]).done();
    let plan = work.ballbar(&["plan", "mine/test.toml"]).done().stdout();
    assert!(plan.contains("strategy 3d6"), "{plan}");
}

#[test]
fn what_is_there_stays() {
    let work = Work::new();
    work.ballbar(&["init", "mine"]).done();
    let before = std::fs::read(work.path("mine/test.toml")).unwrap();
    // The same again changes nothing; anything else is refused, also where nobody has edited the files.
    work.ballbar(&["init", "mine"]).done();
    for more in [&["--bar", "100"][..], &["--bar", "100", "--overwrite"]] {
        let refused = work.ballbar(&[&["init", "mine"], more].concat());
        assert_eq!(refused.code(), 5, "{}", refused.stderr());
        assert!(refused.stderr().contains("there is such a file already"), "{}", refused.stderr());
    }
    assert_eq!(std::fs::read(work.path("mine/test.toml")).unwrap(), before);
}

#[test]
fn what_cannot_be_begun_is_refused_with_what_to_write() {
    let work = Work::new();
    for (given, code, told) in [
        (&["--machine", "lathe"][..], 2, "`vertical`, `horizontal`, `hu40t`"),
        (&["--topology", "XYZ"], 2, "wCBXFZYSt"),
        (&["--travel", "100,200"], 2, "2 travels instead of three"),
        (&["--test", "xz"], 2, "`xy`, `yz`, `zx`, `iso230-4`"),
        (&["--control", "siemens9000"], 2, "`fanuc`, `linuxcnc`"),
        (&["--travel", "1..2"], 2, "1 travel instead of three"),
        (&["--travel", "1..2,1..2,1..2"], 1, "the travel is 1..2,1..2,1..2 (`--travel`"),
        (&["--bar", "-5"], 2, "`-5` is no number from 5 to 3000"),
        (&["--bar", "150mm"], 2, "length between the balls in mm"),
        (&["--tool", "-120"], 2, "sticks out of the spindle nose"),
        (&["--tool", "5000"], 2, "from 1 to 2000"),
        (&["--feed", "nan"], 2, "from 1 to 60000"),
        (&["--feed", "70000"], 2, "from 1 to 60000"),
        (&["--feed", "59999"], 1, "a lower `--feed`"),
        (&["--bar", "600"], 1, "a shorter `--bar`"),
        (&["--zero", "upper", "--travel=-5..5,0..9,0..9"], 1, "`--zero` is for travels"),
        (&["--travel", "120,120,120"], 1, "of axis X"),
    ] {
        let outcome = work.ballbar(&[&["init", "mine"], given].concat());
        assert_eq!(outcome.code(), code, "{given:?}: {}", outcome.stderr());
        assert!(outcome.stderr().contains(told), "{given:?}: {}", outcome.stderr());
        assert!(!outcome.stderr().contains("-->"), "no such file: {}", outcome.stderr());
        assert!(!work.path("mine").exists(), "nothing half-written");
    }
}

#[test]
fn the_built_in_machines_are_listed_anywhere() {
    let work = Work::new();
    let told = work.ballbar(&["machines"]).done().stdout();
    for part in ["built in  vertical", "built in  horizontal", "built in  hu40t", "wXYFZSt"] {
        assert!(told.contains(part), "{part}\n{told}");
    }
}

#[test]
fn help_and_the_other_spelling_are_known() {
    let work = Work::new();
    let help = Command::new(assert_cmd::cargo::cargo_bin!("ballbar"))
        .args(["help", "analyse"])
        .output()
        .unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    assert!(help.contains("Usage: ballbar analyse"), "{help}");
    let other = work.ballbar(&["analyze", "--help"]).done().stdout();
    assert!(other.contains("Usage: ballbar analyse"), "{other}");
    let coloured = work.ballbar(&["plan", "none.toml", "--color", "always"]);
    assert!(coloured.stderr().contains("\u{1b}["), "{}", coloured.stderr());
    let plain = work.ballbar(&["plan", "none.toml", "--color", "never"]);
    assert!(!plain.stderr().contains('\u{1b}'), "{}", plain.stderr());
}

#[test]
fn slips_of_the_first_day_have_a_hint() {
    let work = Work::new();
    let text = "name = \"T\"\nmachine = \"C:\\Users\\Mueller\\vmc.toml\"\n";
    for (line, told) in [
        ("log = \"C:\\Users\\m.csv\"", "write slashes, `\"C:/Users/m.csv\"`"),
        ("log = \"logs\\plain.csv\"", "or single quotes, `'logs\\plain.csv'`"),
        ("length_mm = 100,0", "write a decimal point: `length_mm = 100.0`"),
        ("length_mm = -0,25  # mm", "write a decimal point: `length_mm = -0.25`"),
        ("length_mm = ?", "`ballbar reference KEY`"),
    ] {
        work.write("test.toml", format!("{line}\n{text}"));
        let message = work.ballbar(&["plan", "test.toml"]).refused(1);
        assert!(message.contains(told), "{line}: {message}");
    }
}

#[test]
fn a_program_from_a_pipe_is_checked() {
    let work = Work::new();
    work.ballbar(&["init", "mine"]).done();
    work.ballbar(&["program", "mine/test.toml"]).done();
    let program = std::fs::read(work.path("results/O1001.nc")).unwrap();
    for (text, code, told) in [
        (program.as_slice(), 0, "0 error(s), 0 warning(s)"),
        (b"%\nO1\nG01 X10 F500.\nM30\n%\n", 1, "-:3:"),
    ] {
        let mut check = Command::new(assert_cmd::cargo::cargo_bin!("ballbar"))
            .current_dir(work.path(""))
            .args(["check", "-", "--test", "mine/test.toml"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        check.stdin.take().unwrap().write_all(text).unwrap();
        let outcome = check.wait_with_output().unwrap();
        let said = [outcome.stdout, outcome.stderr].concat();
        let said = String::from_utf8(said).unwrap();
        assert_eq!(outcome.status.code(), Some(code), "{said}");
        assert!(said.contains(told), "{said}");
    }
}

/// From nothing to a program that was checked, timed and aligned, in the language of the control; nothing is edited.
#[test]
fn every_control_has_its_programs_from_the_first_command_on() {
    for (control, program) in [("siemens", "BALLBAR_1001.MPF"), ("heidenhain", "BALLBAR_1001.H")] {
        let work = Work::new();
        work.ballbar(&["init", "mine", "--control", control, "--test", "zx", "--defaults"]).done();
        let machine = std::fs::read_to_string(work.path("mine/machine.toml")).unwrap();
        assert!(machine.contains(&format!("dialect = \"{control}\"")), "{machine}");
        work.ballbar(&["program", "mine/test.toml"]).done();
        let file = format!("results/{program}");
        let checked = work.ballbar(&["check", &file, "--test", "mine/test.toml", "--plot"]).done();
        assert!(checked.stderr().contains("0 error(s), 0 warning(s)"), "{}", checked.stderr());
        let time = work.ballbar(&["time", &file, "--test", "mine/test.toml"]).done().stdout();
        // Four for the bar, and one between the two directions.
        assert!(time.contains("and 5 stop(s) for the operator"), "{time}");
        work.ballbar(&["simulate", "mine/test.toml"]).done();
        work.ballbar(&["align", "results/test.toml"]).done();
        // The same file on a machine that speaks otherwise.
        work.machine("name", "name");
        let other = work.ballbar(&["check", &file, "--machine", "machine.toml"]);
        assert_eq!(other.code(), 1);
        let told = other.stderr();
        assert!(told.contains(&format!("dialect = \"{control}\"")), "{told}");
    }
}
