//! `ballbar check` and `ballbar time` as they are typed.

use crate::work::Work;

const PLAN: &str = "[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n";

/// A test, its program, and the same program edited.
fn written(from: &str, to: &str) -> Work {
    let work = Work::new();
    work.machine("name", "name").test(PLAN);
    work.ballbar(&["program", "test.toml"]).done();
    let program = std::fs::read_to_string(work.path("results/O1001.nc")).unwrap();
    std::fs::remove_dir_all(work.path("results")).unwrap();
    assert!(program.contains(from), "{from}");
    work.write("edited.nc", program.replacen(from, to, 1)).write("O1001.nc", program);
    work
}

#[test]
fn a_program_as_written_passes_with_and_without_its_test() {
    let work = written("M30", "M30");
    for on in [["--test", "test.toml"], ["--machine", "machine.toml"]] {
        let outcome = work.ballbar(&["check", "O1001.nc", on[0], on[1]]).done();
        assert_eq!(outcome.stdout(), "");
        assert!(outcome.stderr().contains("0 error(s), 0 warning(s)"), "{}", outcome.stderr());
        let left_out = outcome.stderr().contains("without --test");
        assert_eq!(left_out, on[0] == "--machine");
    }
}

#[test]
fn errors_make_the_exit_code_one_and_warnings_do_not() {
    let work = written("X150.000 ", "X150000 ");
    let outcome = work.ballbar(&["check", "edited.nc", "--machine", "machine.toml"]);
    assert_eq!(outcome.code(), 1);
    insta::assert_snapshot!(outcome.stdout() + "---\n" + &outcome.stderr());
    let work = written("(RELEASE)", "(Release)");
    let outcome = work.ballbar(&["check", "edited.nc", "--test", "test.toml"]).done();
    assert!(outcome.stdout().starts_with("warning: `e` in a comment"), "{}", outcome.stdout());
}

/// A sign that is lost turns the way outside into one through the workpiece ball, before and after the bar is fitted.
#[test]
fn a_feed_move_through_the_workpiece_ball_is_an_error() {
    let through = [
        ("G01 X151.500", "G01 X-151.500"),
        ("M00 (FIT BALL-BAR)", "M00 (FIT BALL-BAR)\nG01 X0. Y0. Z0.\nG01 X151.500"),
        ("M00 (TAKE BALL-BAR OFF)", "M00 (TAKE BALL-BAR OFF)\nG01 X0. Y0. Z0."),
    ];
    for (from, to) in through {
        let work = written(from, to);
        let outcome = work.ballbar(&["check", "edited.nc", "--test", "test.toml", "--json"]);
        assert_eq!(outcome.code(), 1, "{to}: {}", outcome.stdout());
        let told: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
        let mut findings = told["findings"].as_array().unwrap().iter();
        let first = findings.find(|finding| finding["severity"] == "error").unwrap();
        assert_eq!(first["rule"], "too-near", "{to}");
    }
}

/// A radius of 150 m, whose point was lost, is a line through the workpiece ball, and turns by a tenth of a degree.
#[test]
fn an_arc_that_is_nearly_a_line_is_an_error() {
    let work = written("\nG01 X149.99", "\nG03 X-150. Y0. Z0. R99999.\nG01 X149.99");
    let outcome = work.ballbar(&["check", "edited.nc", "--test", "test.toml", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
    let found = |finding: &serde_json::Value| {
        let block = finding["block"].as_str().unwrap_or("");
        finding["rule"] == "sphere" && block.contains("R99999")
    };
    assert!(told["findings"].as_array().unwrap().iter().any(found), "{told:#}");
}

/// A bar that was pulled off hangs loose: one digit leads out along the radius, and the next point runs into the bar.
#[test]
fn a_path_that_comes_back_to_a_bar_that_it_has_released_is_an_error() {
    for (from, to, rule) in [
        ("\nG01 X149.99", "\nG01 X249.99", "engagement"),
        // Far out, a way looks more like a radius than where it leaves the bar.
        ("\nG01 X149.99", "\nG01 X250.000 Y11.000 Z0.000\nX149.99", "sphere"),
    ] {
        let work = written(from, to);
        let outcome = work.ballbar(&["check", "edited.nc", "--test", "test.toml", "--json"]);
        let told: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
        let findings = told["findings"].as_array().unwrap();
        let found =
            |finding: &serde_json::Value| finding["severity"] == "error" && finding["rule"] == rule;
        assert!(findings.iter().any(found), "{to}: {told:#}");
    }
}

/// Whatever the program does first, it does from wherever somebody left the machine.
#[test]
fn a_first_positioning_that_passes_the_workpiece_ball_from_some_place_is_an_error() {
    for (from, to) in [
        // No retract, a retract by the wrong zero, a crossing that was lost, a retract that is too low.
        ("G00 G53 Z399.000\n", "M00\n"),
        ("G00 G53 Z399.000", "G00 Z99.000"),
        ("G00 G53 X", "M00 (G00 G53 X"),
        ("G00 G53 Z399.000", "G00 G53 Z150.000"),
    ] {
        let work = written(from, to);
        let outcome = work.ballbar(&["check", "edited.nc", "--test", "test.toml", "--json"]);
        let told: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
        let findings = told["findings"].as_array().unwrap();
        let found = |finding: &serde_json::Value| {
            finding["severity"] == "error" && finding["rule"] == "start"
        };
        assert!(findings.iter().any(found), "{to}: {told:#}");
    }
}

/// Somebody may have left another plane, and an arc is then another one.
#[test]
fn an_arc_in_a_plane_that_nobody_stated_is_an_error() {
    let work = written("G21 G17 G90", "G21 G90");
    work.ballbar(&["check", "edited.nc", "--test", "test.toml"]).done();
    let program = std::fs::read_to_string(work.path("edited.nc")).unwrap();
    let arc =
        program.replacen("\nG01 X149.99", "\nG03 X150.000 Y0. Z0. I-150.000 J0.\nG01 X149.99", 1);
    for (with, code) in [(arc.clone(), 1), (arc.replacen("\nG03", "\nG17 G03", 1), 0)] {
        work.write("edited.nc", with);
        let outcome = work.ballbar(&["check", "edited.nc", "--test", "test.toml"]);
        assert_eq!(outcome.code(), code, "{}", outcome.stdout());
        assert_eq!(outcome.stdout().contains("stated the plane of its arcs"), code == 1);
    }
}

/// The bar of the mounting counts, not that of the test.
#[test]
fn a_program_is_held_against_the_bar_of_its_mounting() {
    let work = Work::new();
    work.machine("name", "name").test(PLAN);
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    let shorter = test.replacen("tool_ball_mm", "bar_length_mm = 100.0\ntool_ball_mm", 1);
    work.write("shorter.toml", shorter);
    work.ballbar(&["program", "test.toml"]).done();
    let longer = std::fs::read_to_string(work.path("results/O1001.nc")).unwrap();
    work.write("longer.nc", longer);
    work.ballbar(&["program", "shorter.toml"]).done();
    let own = work.ballbar(&["check", "results/O1001.nc", "--test", "shorter.toml"]).done();
    assert!(own.stderr().contains("0 error(s), 0 warning(s)"), "{}", own.stderr());
    assert_eq!(work.ballbar(&["check", "longer.nc", "--test", "shorter.toml"]).code(), 1);
}

#[test]
fn findings_are_there_for_other_programs() {
    let work = written("G64", "G61");
    let outcome = work.ballbar(&["check", "edited.nc", "--test", "test.toml", "--json"]).done();
    let told: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
    let finding = &told["findings"][0];
    assert_eq!((&finding["severity"], &finding["rule"]), (&"warning".into(), &"exact-stop".into()));
    assert_eq!(finding["line"], 34);
    assert!(finding["block"].as_str().unwrap().starts_with("G01 X149.99"));
    assert_eq!(
        told["warnings"].as_u64().unwrap(),
        3 + finding["more"].as_u64().unwrap_or(0) + told["findings"][2]["more"].as_u64().unwrap()
    );
    assert_eq!((&told["errors"], &told["sphere_checked"]), (&0.into(), &true.into()));
}

#[test]
fn the_picture_shows_every_arc_and_needs_a_test() {
    let work = written("M30", "M30");
    let arguments = ["check", "O1001.nc", "--test", "test.toml", "--plot"];
    assert_eq!(work.ballbar(&arguments).done().files(), ["O1001-path.html"]);
    let page = std::fs::read_to_string(work.path("results/O1001-path.html")).unwrap();
    for name in
        ["EQUATOR CCW", "MERIDIAN 90 BACKWARD", "TRANSIT", "class=\"stop\"", "class=\"speed\""]
    {
        assert!(page.contains(name), "{name}");
    }
    let outcome = work.ballbar(&["check", "O1001.nc", "--machine", "machine.toml", "--plot"]);
    assert_eq!(outcome.code(), 2);
}

#[test]
fn the_time_is_that_of_the_plan() {
    let work = written("M30", "M30");
    let planned = work.ballbar(&["program", "test.toml", "--json"]).done().stdout();
    let timed = work.ballbar(&["time", "O1001.nc", "--test", "test.toml", "--json"]).done();
    // The way from a place in machine coordinates to one in the work offset is known with the test only.
    let without = work.ballbar(&["time", "O1001.nc", "--machine", "machine.toml", "--json"]).done();
    let planned: serde_json::Value = serde_json::from_str(&planned).unwrap();
    let timed: serde_json::Value = serde_json::from_str(&timed.stdout()).unwrap();
    let without: serde_json::Value = serde_json::from_str(&without.stdout()).unwrap();
    let apart = |timed: &serde_json::Value, key: &str| {
        (planned["programs"][0][key].as_f64().unwrap() - timed[key].as_f64().unwrap()).abs()
    };
    for key in ["feed_s", "dwell_s", "rapid_s", "operator_stops"] {
        assert!(apart(&timed, key) < 1e-6, "{key}");
        assert!(key == "rapid_s" || apart(&without, key) < 1e-6, "{key} without the test");
    }
    let equator = &timed["by_comment"].as_array().unwrap();
    let equator = equator.iter().find(|part| part["comment"] == "EQUATOR CCW").unwrap();
    // A turn of 150 mm at 500 mm/min, 17 ms to get to speed and to stand, and a dwell of 3 s.
    let expected = std::f64::consts::TAU * 150.0 / (500.0 / 60.0) + 0.017 + 3.0;
    assert!((equator["duration_s"].as_f64().unwrap() - expected).abs() < 0.01);
}
