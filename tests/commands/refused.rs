//! What must be refused: each with the place, a hint, its exit code, and nothing written.

use crate::work::{Outcome, Work, data, unpacked};

/// The log of the first measured run as lines.
fn measured_log() -> Vec<String> {
    unpacked(&data("hu40t").join("run1.csv.gz")).lines().map(str::to_owned).collect()
}

fn join(lines: &[String]) -> String {
    lines.join("\n") + "\n"
}

#[track_caller]
fn analysed(work: &Work, code: i32) -> String {
    work.ballbar(&["analyse", "test.toml"]).refused(code)
}

#[test]
fn a_key_with_another_unit_in_a_machine_file() {
    let work = Work::new();
    work.machine("rapid_mm_min = 15000.0", "rapid_m_min = 15.0")
        .test("[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 500.0\n");
    insta::assert_snapshot!(work.ballbar(&["program", "test.toml"]).refused(1));
    insta::assert_snapshot!(work.ballbar(&["machines", "machine.toml"]).refused(1));
}

#[test]
fn impossible_values_in_a_machine_file() {
    for (from, to, told) in [
        (
            "travel_mm = [-280.0, 280.0]",
            "travel_mm = [280.0, -280.0]",
            "travel of axis X goes from 280 to -280 mm",
        ),
        (
            "travel_mm = [-280.0, 280.0]",
            "travel_mm = [-1e300, 280.0]",
            "travel of axis X goes from -1e300 to 280 mm",
        ),
        ("rapid_mm_min = 15000.0", "rapid_mm_min = 1e-300", "got `1e-300`"),
        ("acceleration_mm_s2 = 500.0", "acceleration_mm_s2 = 1e300", "between 1 and 1000000"),
        ("screw_pitch_mm = 10.0", "screw_pitch_mm = 1e-9", "between 0.1 and 1000"),
        ("screw_pitch_mm = 10.0", "max_feed_mm_min = 0.5", "between 1 and 1000000"),
        ("screw_pitch_mm = 10.0", "feed_acceleration_mm_s2 = inf", "between 1 and 1000000"),
        ("path_acceleration_mm_s2 = 500.0", "path_acceleration_mm_s2 = 0.0", "between 1 and"),
        ("decimals = 3", "corner_speed_step_mm_min = 0.0", "between 0.1 and 1000000"),
        ("decimals = 3", "corner_tolerance_um = 1e-9", "between 0.01 and 100000"),
        ("decimals = 3", "memory_kb = 1e300", "between 0.1 and 65536"),
        ("length_mm = 120.0", "length_mm = 1e6", "between 0.1 and 10000"),
        ("topology = \"wCBXFZYSt\"", "topology = \"wCBXFZXSt\"", "names `X` more than once"),
        (
            "rapid_mm_min = 15000.0",
            "rapid_mm_min = -1.0",
            "must lie between 1 and 1000000, got `-1`",
        ),
        (
            "rapid_mm_min = 15000.0",
            "rapid_mm_min = nan",
            "must lie between 1 and 1000000, got `NaN`",
        ),
        ("pivot = \"carriage\"", "pivot = \"table\"", "unknown variant `table`"),
        ("decimals = 3", "decimals = 17", "cannot have 17 decimals"),
        ("direction = \"-Z\"", "direction = \"up\"", "`up` is not a direction"),
        ("diameter_mm = 20.0", "diameter_mm = 0.0", "`diameter_mm` must lie between 0.1 and 10000"),
        ("dialect = \"fanuc\"", "dialect = \"sinumerik\"", "unknown dialect `sinumerik`"),
        (
            "look_ahead_on = \"\"",
            "look_ahead_on = \"G05.1 Q1\\nM30\"",
            "does not switch a look-ahead",
        ),
    ] {
        let work = Work::new();
        let outcome: Outcome = work.machine(from, to).ballbar(&["machines", "machine.toml"]);
        let message = outcome.stderr();
        assert_eq!(outcome.code(), 1, "{message}");
        assert!(message.contains(told), "{message}");
        assert!(message.contains("machine.toml:") && message.contains('^'), "{message}");
    }
}

#[test]
fn wrong_keys_and_values_in_a_test_file() {
    let plan = "[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 500.0\n";
    for (rest, told) in [
        (plan.replace("feed_mm_min", "feed_m_min"), "unknown field `feed_m_min`"),
        (plan.replace("3d6", "3d7"), "unknown strategy `3d7`"),
        (plan.replace("500.0", "-500.0"), "`feed_mm_min` must lie between"),
        (format!("{plan}dwell_s = 0.0\n"), "`dwell_s` must lie between"),
        (format!("{plan}feed_in_mm = 0.5\n"), "begins inside the bar's range"),
        (format!("{plan}feed_in_mm = 1.209\n"), "where rounding puts it there"),
        (format!("{plan}program_number = 9001\n"), "program number 9001"),
        (
            format!(
                "{plan}[[plan.arc]]\nkind = \"circle\"\nstart = [1e300, 0, 0]\nnormal = [0, 0, 1]\n"
            ),
            "must be vectors that are not zero",
        ),
        (
            format!("{plan}[[plan.arc]]\nkind = \"meridian\"\npolar_deg = 3.0\n"),
            "does not belong to this kind of arc",
        ),
        (
            format!("{plan}[[plan.arc]]\nkind = \"equator\"\nmountings = [\"A\", \"B\"]\n"),
            "there is no mounting `B`",
        ),
        (
            format!("{plan}[[plan.arc]]\nkind = \"equator\"\nmountings = []\n"),
            "an arc of no mounting is never driven",
        ),
        (
            format!("{plan}[[run]]\nprogram = \"p\"\nlog = \"l\"\nmounting = \"B\"\n"),
            "there is no mounting `B`",
        ),
        (format!("{plan}[log]\nsample_rate_hz = 1e9\n"), "`sample_rate_hz` must lie between"),
        (
            format!(
                "{plan}program_number = 7999\n[[mounting]]\nname = \"B\"\n\
                 coincidence_mm = [0.0, 0.0, 0.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n"
            ),
            "program numbers 7999 to 8000 cannot be used",
        ),
        (
            format!(
                "{plan}[[mounting]]\nname = \"B\"\nbar_length_mm = 1.0\n\
                 coincidence_mm = [0.0, 0.0, 0.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n"
            ),
            "`bar_length_mm` must lie between 5 and 3000, got `1`",
        ),
        (format!("{plan}[identify]\nterms = [\"EXX7\"]\n"), "unknown term `EXX7`"),
        (format!("{plan}[log]\nreading_unit = \"furlong\"\n"), "unknown unit `furlong`"),
    ] {
        let work = Work::new();
        work.machine("name", "name").test(&rest);
        let outcome = work.ballbar(&["program", "test.toml"]);
        let message = outcome.stderr();
        assert_eq!(outcome.code(), 1, "{message}");
        assert!(outcome.files().is_empty());
        assert!(message.contains(told), "{told}: {message}");
        assert!(message.contains("test.toml:") && message.contains('^'), "{message}");
    }
}

#[test]
fn runs_whose_files_would_be_written_over_each_other_or_elsewhere() {
    let run = |rest: &str| format!("[[run]]\nprogram = \"p.nc\"\n{rest}\n");
    let two = |a: &str, b: &str| run(a) + &run(b);
    let long = format!("log = \"a.csv\"\nname = \"{}\"", "y".repeat(300));
    for (runs, told) in [
        (two("log = \"mon/a.csv\"", "log = \"tue/a.csv\""), "there is another run `a`"),
        (two("log = \"a.csv\"", "log = \"b.csv\"\nname = \"A\""), "there is another run `A`"),
        (run("log = \"a.csv\"\nname = \"../../a\""), "must be one that a file can have"),
        (run("log = \"a.csv\"\nname = \"\""), "must be one that a file can have"),
        (run("log = \"a.csv\"\nname = \"a\\u0000\""), "must be one that a file can have"),
        (run("log = \"\""), "must be one that a file can have"),
        (run(&long), "must be one that a file can have"),
    ] {
        let work = Work::new();
        work.machine("name", "name").test(&runs);
        let message = analysed(&work, 1);
        assert!(message.contains(told), "{told}: {message}");
        assert!(message.contains("test.toml:") && message.contains('^'), "{message}");
    }
}

#[test]
fn a_simulation_does_not_replace_what_it_was_made_from() {
    let work = Work::new();
    work.machine("name", "name").test("[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n");
    std::fs::create_dir(work.path("results")).unwrap();
    std::fs::rename(work.path("test.toml"), work.path("results/test.toml")).unwrap();
    std::fs::rename(work.path("machine.toml"), work.path("results/machine.toml")).unwrap();
    let before = std::fs::read(work.path("results/test.toml")).unwrap();
    let outcome = work.ballbar(&["simulate", "results/test.toml"]);
    assert_eq!(outcome.code(), 5, "{}", outcome.stderr());
    assert!(outcome.stderr().contains("would replace a file that was read"));
    assert_eq!(outcome.files(), ["machine.toml", "test.toml"]);
    assert_eq!(std::fs::read(work.path("results/test.toml")).unwrap(), before);
}

#[test]
fn travel_exceeded() {
    let work = Work::new();
    work.machine("travel_mm = [-280.0, 280.0]", "travel_mm = [-150.0, 150.0]")
        .test("[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 500.0\n");
    insta::assert_snapshot!(work.ballbar(&["program", "test.toml"]).refused(1));
}

#[test]
fn a_program_that_ends_inside_an_arc() {
    let work = Work::new();
    let program = unpacked(&data("hu40t").join("O1005.nc.gz"));
    let half: Vec<String> = program.lines().take(5000).map(str::to_owned).collect();
    work.run_of(join(&measured_log())).write("O1005.nc", join(&half));
    insta::assert_snapshot!(analysed(&work, 1));
}

#[test]
fn an_arc_with_inconsistent_centre() {
    let work = Work::new();
    let program = unpacked(&data("planar").join("O1001.nc.gz"));
    work.run_of(join(&measured_log())).write(
        "O1005.nc",
        program.replacen("G03 X-150.000 Y0. I150.000", "G03 X-149.000 Y3. I150.000 J2.", 1),
    );
    insta::assert_snapshot!(analysed(&work, 1));
}

#[test]
fn an_unknown_word_in_a_program() {
    let work = Work::new();
    let program = unpacked(&data("hu40t").join("O1005.nc.gz"));
    work.run_of(join(&measured_log()))
        .write("O1005.nc", program.replacen("N30 G64", "N30 G64 #100=3", 1));
    insta::assert_snapshot!(analysed(&work, 1));
}

#[test]
fn an_empty_a_short_and_a_binary_log() {
    let work = Work::new();
    work.run_of("");
    insta::assert_snapshot!(analysed(&work, 1));
    work.run_of("time_s,deviation_um\n0.0,1.0\n");
    insta::assert_snapshot!(analysed(&work, 1));
    work.run_of([0x89, b'P', b'N', b'G', 0, 1, 2, 3, 0xff, 0xfe]);
    insta::assert_snapshot!(analysed(&work, 1));
}

#[test]
fn not_a_number_repeated_and_backward_time() {
    let lines = measured_log();
    let changed = |line: usize, text: &str| {
        let mut lines = lines.clone();
        lines[line] = text.to_owned();
        join(&lines)
    };
    let work = Work::new();
    work.run_of(changed(600, "59.9000,1.O"));
    insta::assert_snapshot!(analysed(&work, 1));
    work.run_of(changed(600, &lines[599]));
    insta::assert_snapshot!(analysed(&work, 1));
    work.run_of(changed(600, "59.5000,1.0"));
    insta::assert_snapshot!(analysed(&work, 1));
}

#[test]
fn a_log_of_another_program() {
    let work = Work::new();
    // Two turns of 57 s instead of fifteen minutes.
    work.run_of(unpacked(&data("planar").join("xy.csv.gz")));
    insta::assert_snapshot!(analysed(&work, 3));
    // The same path at three times the feed: the override that would explain it is named.
    work.run_of(unpacked(&data("case-d").join("run4.csv.gz")));
    insta::assert_snapshot!(analysed(&work, 3));
}

#[test]
fn a_selection_that_the_test_cannot_see() {
    let work = Work::new();
    work.run_of(join(&measured_log()));
    let outcome = work.ballbar(&["identify", "test.toml", "--terms", "paper37"]);
    insta::assert_snapshot!(outcome.refused(4));
}

#[test]
fn an_output_directory_that_cannot_be_written() {
    let work = Work::new();
    work.machine("name", "name")
        .test("[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n")
        .write("results", "a file stands where the directory should be");
    let outcome = work.ballbar(&["program", "test.toml"]);
    assert_eq!(outcome.code(), 5, "{}", outcome.stderr());
    insta::assert_snapshot!(outcome.stderr());
}

#[test]
fn a_wrong_output_directory_is_told_before_the_work() {
    let work = Work::new();
    work.write("results", "a file stands where the directory should be");
    // Else the first thing that is wrong would be the test file.
    for command in ["analyse", "diagnose", "align", "identify", "simulate", "plan", "design"] {
        let message = work.ballbar(&[command, "nothing.toml"]).refused(5);
        assert!(message.contains("a file stands where the directory"), "{command}: {message}");
    }
}

#[test]
fn files_that_are_not_there() {
    let work = Work::new();
    assert_eq!(work.ballbar(&["analyse", "nothing.toml"]).refused(1).lines().count(), 3);
    work.test("[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n");
    let message = work.ballbar(&["program", "test.toml"]).refused(1);
    assert!(message.contains("machine.toml"), "{message}");
}

#[test]
fn a_wrong_command_line_has_its_own_exit_code() {
    let work = Work::new();
    let outcome = work.ballbar(&["analise", "test.toml"]);
    assert_eq!(outcome.code(), 2);
    assert!(outcome.stderr().contains("'analyse'"), "{}", outcome.stderr());
}
