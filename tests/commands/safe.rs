//! What is not safe is not written, and what cannot be is refused before it takes time or memory.

use crate::work::Work;

const PLAN: &str = "[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n";
/// A meridian below the workpiece ball, where its post is.
const THROUGH_THE_POST: &str = "[plan]\nfeed_mm_min = 500.0\n[[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = 0.0\nsweep_deg = -180.0\n";

#[test]
fn a_program_that_collides_is_refused_and_forced_with_its_reason() {
    let work = Work::new();
    work.machine("name", "name").test(THROUGH_THE_POST);
    let refused = work.ballbar(&["program", "test.toml"]);
    assert_eq!(refused.code(), 1, "{}", refused.stderr());
    for told in ["and support touch on ARC 1 FORWARD", "`--force`"] {
        assert!(refused.stderr().contains(told), "{}", refused.stderr());
    }
    assert!(!work.path("results/O1001.nc").exists());
    work.ballbar(&["program", "test.toml", "--force"]).done();
    let forced = std::fs::read_to_string(work.path("results/O1001.nc")).unwrap();
    let reason = forced.lines().nth(2).unwrap();
    assert!(reason.starts_with("(NOT SAFE - SPINDLE NOSE AND SUPPORT TOUCH ON "), "{reason}");
}

#[test]
fn a_feed_beyond_the_rapid_traverse_is_refused() {
    let work = Work::new();
    work.machine("name", "name").test(&PLAN.replace("500.0", "60000.0"));
    let refused = work.ballbar(&["program", "test.toml"]);
    assert_eq!(refused.code(), 1, "{}", refused.stderr());
    assert!(refused.stderr().contains("would feed at"), "{}", refused.stderr());
}

/// A block around every arc could start the spindle with the bar in it.
#[test]
fn look_ahead_words_do_nothing_else() {
    for words in ["M03 S20000", "M00", "F60000.", "G04 P1000000", "G05.1 Q1 M03", "G91"] {
        let work = Work::new();
        let on = format!("look_ahead_on = \"{words}\"");
        work.machine("look_ahead_on = \"\"", &on).test(PLAN);
        let refused = work.ballbar(&["program", "test.toml"]);
        assert_eq!(refused.code(), 1, "{words}");
        let told = refused.stderr();
        assert!(told.contains("does not switch a look-ahead"), "{words}: {told}");
    }
    for words in ["G05.1 Q1", "G08 P1", "G05 P10000"] {
        let work = Work::new();
        let on = format!("look_ahead_on = \"{words}\"");
        work.machine("look_ahead_on = \"\"", &on).test(PLAN);
        work.ballbar(&["program", "test.toml"]).done();
    }
}

#[test]
fn numbers_have_bounds() {
    for (from, to, told) in [
        ("sequence_step = 10", "sequence_step = 4294967295", "blocks cannot be numbered"),
        ("sequence_step = 10", "sequence_step = 1001", "blocks cannot be numbered"),
        ("pivot = \"carriage\"", "retract_mm = 900.0", "`retract_mm` must lie between"),
    ] {
        let work = Work::new();
        work.machine(from, to).test(PLAN);
        let refused = work.ballbar(&["program", "test.toml"]);
        assert_eq!(refused.code(), 1, "{to}");
        assert!(refused.stderr().contains(told), "{to}: {}", refused.stderr());
    }
    for length_mm in ["1e15", "1e300", "3000.1", "nan"] {
        let work = Work::new();
        work.machine("name", "name").test(PLAN);
        let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
        work.write(
            "test.toml",
            test.replacen("length_mm = 150.0", &format!("length_mm = {length_mm}"), 1),
        );
        let refused = work.ballbar(&["plan", "test.toml"]);
        assert_eq!(refused.code(), 1, "{length_mm}: {}", refused.stderr());
        assert!(refused.stderr().contains("`length_mm` must"), "{}", refused.stderr());
    }
}

#[test]
fn numbers_of_the_bar_have_bounds() {
    for (key, value, told) in [
        ("range_mm", "1e-9", "between 0.01 and 10, got `1e-9`"),
        ("range_mm", "11.0", "between 0.01 and 10, got `11`"),
        ("noise_um", "1e-300", "between 0.0001 and 1000, got `1e-300`"),
        ("noise_um", "1e300", "between 0.0001 and 1000, got `1e300`"),
        ("resolution_um", "0.0", "between 0.000001 and 1000, got `0`"),
        ("correlation_s", "inf", "between 0.0001 and 100000, got `inf`"),
        ("clock_ppm", "1e300", "between 0.001 and 10000, got `1e300`"),
        ("length_mm", "1e-9", "between 5 and 3000, got `1e-9`"),
    ] {
        let work = Work::new();
        work.machine("name", "name").test(PLAN);
        let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
        let test = match key {
            "length_mm" => test.replacen("length_mm = 150.0", &format!("{key} = {value}"), 1),
            _ => test.replacen("[ball_bar]", &format!("[ball_bar]\n{key} = {value}"), 1),
        };
        work.write("test.toml", test);
        let refused = work.ballbar(&["plan", "test.toml"]);
        assert_eq!(refused.code(), 1, "{key} = {value}: {}", refused.stderr());
        let told = format!("`{key}` must lie {told}");
        assert!(refused.stderr().contains(&told), "{told}: {}", refused.stderr());
    }
}

/// A column of line ends is a reading each, and packed it is a thousand times smaller.
#[test]
fn a_log_of_too_many_readings_is_refused() {
    let work = Work::new();
    work.machine("name", "name").test(&format!(
        "{PLAN}[log]\nsample_rate_hz = 1000.0\n[[run]]\nprogram = \"O1.nc\"\nlog = \"run.csv\"\n"
    ));
    work.write("O1.nc", "O1\nM30\n");
    work.write("run.csv", "deviation_um\n1\n".to_owned() + &"\n".repeat(4_000_000));
    let refused = work.ballbar(&["align", "test.toml"]);
    assert_eq!(refused.code(), 1, "{}", refused.stderr());
    assert!(refused.stderr().contains("more than 4000000 readings"), "{}", refused.stderr());
    work.write("run.csv", "time_s,deviation_um\n0,1\n1e11,1\n");
    work.test(&format!("{PLAN}[[run]]\nprogram = \"O1.nc\"\nlog = \"run.csv\"\n"));
    let refused = work.ballbar(&["align", "test.toml"]);
    assert!(refused.stderr().contains("is more than 10000000000 s"), "{}", refused.stderr());
    assert!(refused.stderr().contains("run.csv:3:1"), "{}", refused.stderr());
}

#[test]
fn a_large_file_of_keys_is_refused_before_it_is_taken_apart() {
    let work = Work::new();
    work.write("machine.toml", "# none\n".repeat(700_000));
    let refused = work.ballbar(&["machines", "machine.toml"]);
    assert_eq!(refused.code(), 1, "{}", refused.stderr());
    assert!(refused.stderr().contains("more than 4 MiB"), "{}", refused.stderr());
}

#[test]
fn a_model_without_a_number_is_refused() {
    let work = Work::new();
    work.machine("name", "name").test(PLAN);
    for value in ["nan", "-inf", "1e9"] {
        let model = format!("terms = [\"EXX1\"]\n[coefficients]\nEXX1 = {value}\n");
        work.write("model.toml", model);
        let refused = work.ballbar(&["simulate", "test.toml", "--model", "model.toml"]);
        assert_eq!(refused.code(), 1, "{value}");
        assert!(refused.stderr().contains("`EXX1` must lie between"), "{}", refused.stderr());
        assert!(refused.stderr().contains("model.toml:3"), "{}", refused.stderr());
    }
}

#[test]
fn what_never_ends_is_refused_before_it_begins() {
    let work = Work::new();
    work.machine("name", "name").test(PLAN);
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    let slow = test.replace("500.0", "1.0") + "[log]\nsample_rate_hz = 500.0\n";
    work.write("slow.toml", slow);
    let refused = work.ballbar(&["simulate", "slow.toml"]);
    assert_eq!(refused.code(), 1, "{}", refused.stderr());
    assert!(refused.stderr().contains("are the most"), "{}", refused.stderr());
    work.write("late.toml", "sample_rate_hz = 0.001\n[motion]\nfollowing_ms = [15, 15, 15]\n[pauses]\nbetween_s = [1e5, 1e5]\n");
    let refused = work.ballbar(&["simulate", "test.toml", "--scenario", "late.toml"]);
    assert_eq!(refused.code(), 1, "{}", refused.stderr());
    assert!(refused.stderr().contains("followed for 20000 s at the most"), "{}", refused.stderr());
    // Two hundred moves, called ten thousand times.
    let moves = "G01 X10. F500.\nX0.\n".repeat(100);
    let start = "G21 G17 G90 G94 G40 G49 G80 G54 G00 X0. Y0. Z0.\n";
    let program = format!("%\nO1\n{start}M98 P2 L9999\nM30\nO2\n{moves}M99\n%\n");
    work.write("calls.nc", program);
    let refused = work.ballbar(&["time", "calls.nc", "--machine", "machine.toml"]);
    assert_eq!(refused.code(), 1, "{}", refused.stderr());
    assert!(refused.stderr().contains("more than 1040000 moves"), "{}", refused.stderr());
    if cfg!(unix) {
        let refused = work.ballbar(&["check", "/dev/zero", "--machine", "machine.toml"]);
        assert_eq!(refused.code(), 1);
        assert!(refused.stderr().contains("not a file but a device"), "{}", refused.stderr());
    }
}
