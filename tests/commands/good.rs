//! What users do, and what they find afterwards.

use crate::work::{Work, data, project};

#[test]
fn the_demonstration_leaves_program_report_and_samples() {
    let work = Work::new();
    let outcome = work.ballbar(&["demo"]).done();
    assert_eq!(
        outcome.files(),
        [
            "O1005.nc",
            "analysis.json",
            "report.html",
            "samples-run1.csv",
            "samples-run2.csv",
            "samples-run3.csv",
            "samples-run4.csv",
            "samples-run5.csv"
        ]
    );
    assert!(outcome.stdout().contains("38 of 38 parameters observed"), "{}", outcome.stdout());
    let report = std::fs::read_to_string(work.path("results/report.html")).unwrap();
    // Terminal and page tell the same of how the control drove.
    let drove = report.split("<h3>How the control drove</h3>").nth(1).unwrap();
    assert!(drove.contains("corners rounded") && drove.contains("<td class=\"name\">run1</td>"));
    assert!(report.contains("Meridian 36") && report.trim_end().ends_with("</html>"));
}

#[test]
fn the_same_input_gives_the_same_bytes_on_any_number_of_threads() {
    let results = |threads: &str| {
        let work = Work::new();
        let test = data("hu40t").join("test.toml");
        let output = std::process::Command::new(assert_cmd::cargo::cargo_bin!("ballbar"))
            .current_dir(work.path("."))
            .env("RAYON_NUM_THREADS", threads)
            .args(["analyse", test.to_str().unwrap(), "-o", "results", "--quiet"])
            .output()
            .unwrap();
        assert!(output.status.success());
        let files = ["report.html", "analysis.json", "samples-run3.csv"];
        files.map(|name| std::fs::read(work.path("results").join(name)).unwrap())
    };
    assert!(results("1") == results("2"));
}

#[test]
fn a_simulated_test_is_ready_to_be_analysed() {
    let work = Work::new();
    work.machine("name", "name").test("[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 500.0\n");
    work.ballbar(&["simulate", "test.toml", "--repeats", "2", "--seed", "7"]).done();
    let outcome = std::process::Command::new(assert_cmd::cargo::cargo_bin!("ballbar"))
        .current_dir(work.path("results"))
        .args(["identify", "test.toml", "-o", "again", "--json"])
        .output()
        .unwrap();
    assert!(outcome.status.success(), "{}", String::from_utf8_lossy(&outcome.stderr));
    let analysis: serde_json::Value = serde_json::from_slice(&outcome.stdout).unwrap();
    assert_eq!(analysis["repeats"].as_array().unwrap().len(), 2);
    let truth: toml::Table =
        toml::from_str(&std::fs::read_to_string(work.path("results/truth.toml")).unwrap()).unwrap();
    // A machine that was drawn: three scales, three squarenesses, three reversals, six lateral plays.
    let asked = analysis["at_the_place"].as_array().unwrap();
    let true_of_it = truth["at_the_place"].as_table().unwrap();
    assert_eq!(true_of_it.len(), 15);
    for (key, truth) in true_of_it {
        let name = key.trim_end_matches("_um_m").trim_end_matches("_um").replace('_', " ");
        let found = asked.iter().find(|asked| asked["quantity"] == name.as_str()).unwrap();
        let off = found["value"].as_f64().unwrap() - truth.as_float().unwrap();
        assert!(off.abs() < 4.0 * found["all"].as_f64().unwrap(), "{name}: {off} {found}");
    }
}

#[test]
fn a_simulation_names_its_files_as_json() {
    let work = Work::new();
    work.machine("name", "name").test("[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n");
    let outcome = work.ballbar(&["simulate", "test.toml", "--json"]).done();
    let told: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
    assert_eq!(told["files"].as_array().unwrap().len(), outcome.files().len());
}

/// The analysis of a simulated 3D6 with an M00 after every arc.
fn with_stops(feed: &str, decimals: &str, scenario: &str, seed: &str) -> serde_json::Value {
    let work = Work::new();
    work.machine("decimals = 3", decimals)
        .test(&format!(
            "[plan]\nstrategy = \"3d6\"\nfeed_mm_min = {feed}\nstop_between_arcs = true\n"
        ))
        .write("scenario.toml", scenario);
    work.ballbar(&["simulate", "test.toml", "--scenario", "scenario.toml", "--seed", seed]).done();
    std::fs::rename(work.path("results"), work.path("virtual")).unwrap();
    let outcome = work.ballbar(&["identify", "virtual/test.toml", "--json"]).done();
    serde_json::from_str(&outcome.stdout()).unwrap()
}

fn residual_um(analysis: &serde_json::Value) -> f64 {
    analysis["repeats"][0]["runs"][0]["residual_rms_um"].as_f64().unwrap()
}

#[test]
fn an_operator_may_take_a_quarter_of_an_hour_at_every_stop() {
    let scenario = "[pauses]\nbetween_s = [1000, 1000]\n";
    let rms_um = residual_um(&with_stops("500.0", "decimals = 3", scenario, "1"));
    assert!(rms_um < 0.2, "{rms_um}");
}

#[test]
fn names_of_circles_have_no_minus_zero() {
    let work = Work::new();
    work.machine("name", "name").test(
        "[plan]\nfeed_mm_min = 1000.0\nchord_sag_um = 4.0\n[[plan.arc]]\nkind = \"meridian\"\n\
         [[plan.arc]]\nkind = \"parallel\"\npolar_deg = 50.0\n\
         [identify]\nterms = [\"EYYb\", \"EXt\", \"EYt\", \"EZt\"]\n",
    );
    work.ballbar(&["simulate", "test.toml"]).done();
    let outcome = work.ballbar(&["identify", "results/test.toml", "--json"]).done();
    assert!(outcome.stdout().contains("Meridian 0\u{b0}"), "{}", outcome.stdout());
    assert!(!outcome.stdout().contains("-0\u{b0}") && !outcome.stdout().contains("-0.00,"));
}

#[test]
fn samples_of_an_alignment_are_written_with_their_places() {
    let work = Work::new();
    let test = data("hu40t-stops").join("test.toml");
    let outcome = work.ballbar(&["align", test.to_str().unwrap()]).done();
    assert_eq!(outcome.files(), ["samples-run1.csv", "samples-run2.csv"]);
    let samples = std::fs::read_to_string(work.path("results/samples-run1.csv")).unwrap();
    for place in ["arc", "ramp", "dwell", "stop"] {
        assert!(samples.lines().any(|line| line.contains(&format!(",{place},"))), "{place}");
    }
}

#[test]
fn three_planes_make_one_test() {
    let work = Work::new();
    let test = data("planar").join("test.toml");
    let outcome = work.ballbar(&["analyse", test.to_str().unwrap()]).done();
    assert!(outcome.stdout().contains("32 of 38 parameters observed"), "{}", outcome.stdout());
    assert!(outcome.stdout().contains("Not observable"), "{}", outcome.stdout());
}

#[test]
fn machine_files_are_listed() {
    let work = Work::new();
    let directory = project().join("machines");
    let files: Vec<String> = ["hu40t.toml", "vertical.toml"]
        .iter()
        .map(|name| directory.join(name).to_str().unwrap().to_owned())
        .collect();
    let outcome = work.ballbar(&["machines", &files[0], &files[1]]).done();
    assert!(outcome.stdout().contains("wCBXFZYSt") && outcome.stdout().contains("wXYFZSt"));
    let outcome = work.ballbar(&["machines", "--json", &files[0]]).done();
    let list: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
    assert_eq!(list["machines"][0]["axes"]["X"]["pivot"], "carriage");
}

#[test]
fn quiet_says_nothing_but_results() {
    let work = Work::new();
    work.machine("name", "name").test("[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n");
    let outcome = work.ballbar(&["program", "test.toml", "--quiet"]).done();
    assert_eq!(outcome.stderr(), "");
    assert_eq!(outcome.stdout().trim_end(), "results/O1001.nc");
    assert_eq!(outcome.files(), ["O1001.nc"]);
}

#[test]
fn completions_and_man_pages_are_made() {
    let work = Work::new();
    let completions = work.ballbar(&["completions", "bash"]).done();
    let completions = completions.stdout();
    let pages = work.ballbar(&["man"]).done().files();
    let commands = [
        "align",
        "analyse",
        "blind",
        "check",
        "compare",
        "compensate",
        "completions",
        "correct",
        "demo",
        "design",
        "diagnose",
        "history",
        "identify",
        "init",
        "machines",
        "man",
        "paper",
        "plan",
        "program",
        "reference",
        "show",
        "simulate",
        "time",
        "volume",
    ];
    for command in commands {
        assert!(completions.contains(&format!("ballbar,{command})")), "{command}");
    }
    let expected = commands.map(|command| format!("ballbar-{command}.1"));
    assert_eq!(pages, [expected.as_slice(), &["ballbar.1".to_owned()]].concat());
}

#[test]
fn the_tables_of_the_paper_are_computed_again() {
    let work = Work::new();
    let outcome = work.ballbar(&["paper", "--json"]).done();
    let paper: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
    let last = paper["strategies"][2]["stages"].as_array().unwrap().last().unwrap().clone();
    assert_eq!(last["columns"], 40);
    assert_eq!((&last["carriage"]["rank"], &last["base"]["rank"]), (&36.into(), &40.into()));
    assert_eq!(paper["mountings"][8]["of_53"], 53);
    assert!(!work.path("results").exists());
}
