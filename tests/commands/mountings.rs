//! Tests of several mountings, from the test file to the report.

use std::fmt::Write as _;

use ballbar::model::Coefficient;
use serde_json::Value;

use crate::work::Work;

/// What the paper's volume does not need: 37 of the 90.
const NOT_NEEDED: &str = "EXX0 EYX0 EZX0 EAX0 EBX0 ECX0 EXY0 EYY0 EZY0 EAY0 EBY0 ECY0 EXZ0 EYZ0 EZZ0 EBZ0 \
    EAY1 EAY2 EAY3 EAYb EBY1 EBY2 EBY3 EBYb ECY1 ECY2 ECY3 ECYb EBZ1 EBZ2 EBZ3 EBZb \
    EXY1 EZY1 EYX1 EZX1 EYZ1";

/// The other 53.
fn needed() -> Vec<Coefficient> {
    let not: Vec<&str> = NOT_NEEDED.split_whitespace().collect();
    Coefficient::all().filter(|c| !not.contains(&c.to_string().as_str())).collect()
}

/// A machine on which every one of the 53 errs, by as much as machines do, and what its operator does to
/// the tool ball, mm.
fn scenario(set_up_mm: [f64; 3]) -> String {
    let mut text = "[coefficients]\n".to_owned();
    for (k, coefficient) in needed().into_iter().enumerate() {
        let angular = coefficient.component.is_angular();
        let size = match coefficient.to_string().as_bytes()[3] {
            b'0' => 2e-4,
            b'1' => {
                if angular {
                    4e-6
                } else {
                    5e-5
                }
            }
            b'2' => {
                if angular {
                    3e-8
                } else {
                    3e-7
                }
            }
            b'3' => {
                if angular {
                    6e-11
                } else {
                    1.5e-9
                }
            }
            _ => {
                if angular {
                    1e-5
                } else {
                    5e-4
                }
            }
        };
        let value = size * (0.6 + 0.1 * (k * 7 % 5) as f64) * if k % 2 == 0 { 1.0 } else { -1.0 };
        writeln!(text, "{coefficient} = {value:e}").unwrap();
    }
    let [x_mm, y_mm, z_mm] = set_up_mm;
    text + &format!("[set_up]\nEXt = {x_mm:?}\nEYt = {y_mm:?}\nEZt = {z_mm:?}\n")
}

/// A test file of mountings: name, machine coordinates of the coincidence, and what else it says.
fn test_of(mountings: &[(&str, [f64; 3], &str)], rest: &str) -> String {
    let mut text = "name = \"Places\"\nmachine = \"machine.toml\"\n\
        [ball_bar]\nlength_mm = 150.0\n"
        .to_owned();
    for (name, at_mm, more) in mountings {
        write!(
            text,
            "[[mounting]]\nname = \"{name}\"\ncoincidence_mm = {at_mm:?}\n\
             tool_ball_mm = [0.0, 0.0, -200.0]\n{more}\n"
        )
        .unwrap();
    }
    text + rest
}

/// Every estimate lies where its stated sigma says, seen from what was put in.
#[track_caller]
fn came_back(analysis: &Value, put_in: impl Fn(&str) -> f64) {
    let repeats = analysis["repeats"].as_array().unwrap();
    let parameters = repeats.iter().flat_map(|repeat| repeat["parameters"].as_array().unwrap());
    let shares: Vec<(f64, &str)> = parameters
        .map(|parameter| {
            let name = parameter["name"].as_str().unwrap();
            let off = parameter["value"].as_f64().unwrap() - put_in(name);
            (off / parameter["sigma"].as_f64().unwrap(), name)
        })
        .collect();
    let beyond = |limit: f64| shares.iter().filter(|(share, _)| share.abs() > limit).count();
    let worst = shares.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap();
    println!("{} estimates, worst {worst:?}", shares.len());
    assert!(beyond(4.0) * 20 <= shares.len(), "{} beyond 4 sigma", beyond(4.0));
    assert_eq!(beyond(6.0), 0, "{worst:?}");
}

/// What was put into the first simulated run; what the file does not name is 0.
fn truth(work: &Work) -> impl Fn(&str) -> f64 {
    let file = std::fs::read_to_string(work.path("virtual/truth.toml")).unwrap();
    let file: toml::Table = file.parse().unwrap();
    move |name| {
        let name = name.split('@').next().unwrap();
        file["run"][0]["coefficients"].get(name).map_or(0.0, |value| value.as_float().unwrap())
    }
}

/// Simulates into `virtual` and analyses into `results`.
fn simulated(work: &Work, test: &str, scenario: &str) -> Value {
    work.machine("name", "name").write("test.toml", test).write("scenario.toml", scenario);
    let simulate = ["simulate", "--paper", "test.toml", "--scenario", "scenario.toml"];
    work.ballbar(&simulate).done();
    std::fs::rename(work.path("results"), work.path("virtual")).unwrap();
    analysed(work)
}

fn analysed(work: &Work) -> Value {
    let outcome = work.ballbar(&["analyse", "virtual/test.toml", "--json"]).done();
    serde_json::from_str(&outcome.stdout()).unwrap()
}

#[test]
fn three_places_not_on_one_line_find_all_that_the_volume_needs() {
    let work = Work::new();
    let mut terms: Vec<String> = needed().iter().map(ToString::to_string).collect();
    assert_eq!(terms.len(), 53);
    terms.extend(["EXt", "EYt", "EZt"].map(str::to_owned));
    let places = [
        ("A", [-100.0, -100.0, 0.0], ""),
        ("B", [100.0, -60.0, 60.0], ""),
        ("C", [0.0, 100.0, 120.0], ""),
    ];
    let rest =
        format!("[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 500.0\n[identify]\nterms = {terms:?}\n");
    work.machine("name", "name").write("test.toml", test_of(&places, &rest));
    // Every place is set up anew: its logs are those of a simulation with set-up errors of its own.
    let set_ups_mm = [[0.005, -0.003, 0.002], [-0.004, 0.007, 0.001], [0.0, -0.006, -0.008]];
    for (place, set_up_mm) in set_ups_mm.into_iter().enumerate() {
        work.write("scenario.toml", scenario(set_up_mm));
        let simulate =
            ["simulate", "--paper", "test.toml", "--scenario", "scenario.toml", "--repeats", "2"];
        work.ballbar(&simulate).done();
        if place == 0 {
            std::fs::rename(work.path("results"), work.path("virtual")).unwrap();
            continue;
        }
        for repeat in [1, 2] {
            let log = format!("run{repeat}-O100{}.csv", place + 1);
            std::fs::rename(work.path("results").join(&log), work.path("virtual").join(&log))
                .unwrap();
        }
    }
    let analysis = analysed(&work);
    for repeat in analysis["repeats"].as_array().unwrap() {
        assert_eq!((&repeat["rank"], &repeat["parameter_count"]), (&62.into(), &62.into()));
        let mountings: Vec<&Value> =
            repeat["runs"].as_array().unwrap().iter().map(|run| &run["mounting"]).collect();
        assert_eq!(mountings, ["A", "B", "C"]);
        let rms_um = repeat["residual_rms_um"].as_f64().unwrap();
        assert!(rms_um < 0.17, "0.156 um of noise were put in, {rms_um} are left");
    }
    let of_machine = truth(&work);
    came_back(&analysis, |name| match name.split_once('@') {
        None => of_machine(name),
        Some((set_up, place)) => {
            let place = places.iter().position(|of| of.0 == place).unwrap();
            set_ups_mm[place]["XYZ".find(&set_up[1..2]).unwrap()]
        }
    });
    let report = std::fs::read_to_string(work.path("results/report.html")).unwrap();
    for told in
        ["Equator, A", "Equator, B", "Meridian 144°, C", "run2-O1002, B", "<th>mounting</th>"]
    {
        assert!(report.contains(told), "{told}");
    }
}

#[test]
fn two_mountings_may_use_bars_of_different_lengths() {
    let work = Work::new();
    let places =
        [("long", [-60.0, -60.0, 0.0], ""), ("short", [80.0, 60.0, 90.0], "bar_length_mm = 100.0")];
    let rest =
        "[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 500.0\n[identify]\nterms = [\"complete\"]\n";
    // The machine of the paper's Table 5 errs in what `observable35` holds.
    let analysis = simulated(&work, &test_of(&places, rest), "seed = 3\n");
    let program = std::fs::read_to_string(work.path("virtual/O1002.nc")).unwrap();
    assert!(program.contains("R100 F500"), "{}", &program[..60]);
    assert_eq!(analysis["test"]["mountings"][0]["bar_length_mm"], 150.0);
    assert_eq!(analysis["test"]["mountings"][1]["bar_length_mm"], 100.0);
    for run in analysis["repeats"][0]["runs"].as_array().unwrap() {
        assert!(run["residual_rms_um"].as_f64().unwrap() < 0.17, "{run:#}");
    }
    came_back(&analysis, truth(&work));
    let report = std::fs::read_to_string(work.path("results/report.html")).unwrap();
    assert!(report.contains("150 and 100 mm") && report.contains("bar of 100 mm"));

    let file = work.path("virtual/test.toml");
    let source = std::fs::read_to_string(&file).unwrap();
    // With another length the program never reaches the bar's range.
    std::fs::write(&file, source.replace("bar_length_mm = 100.0", "bar_length_mm = 90.0")).unwrap();
    let outcome = work.ballbar(&["align", "virtual/test.toml"]);
    assert_eq!(outcome.code(), 3, "{}", outcome.stderr());
    assert!(
        outcome.stderr().contains("never brings the bar into its range"),
        "{}",
        outcome.stderr()
    );

    // The same logs as whole lengths of either bar.
    for (log, nominal_mm) in [("run1-O1001.csv", 150.0), ("run1-O1002.csv", 100.0)] {
        let text = std::fs::read_to_string(work.path("virtual").join(log)).unwrap();
        let mut lengths = "time_s,length_mm\n".to_owned();
        for line in text.lines().skip(2) {
            let (time, deviation_um) = line.split_once(',').unwrap();
            let length =
                deviation_um.parse::<f64>().map(|um| format!("{:.4}", nominal_mm + um * 1e-3));
            writeln!(lengths, "{time},{}", length.unwrap_or_default()).unwrap();
        }
        std::fs::write(work.path("virtual").join(log), lengths).unwrap();
    }
    let as_lengths =
        source.clone() + "\n[log]\nreading_column = \"length_mm\"\nreading = \"length\"\n";
    std::fs::write(&file, &as_lengths).unwrap();
    let again = analysed(&work);
    let parameters = |of: &Value| of["repeats"][0]["parameters"].as_array().unwrap().clone();
    for (one, other) in parameters(&analysis).iter().zip(&parameters(&again)) {
        let off = one["value"].as_f64().unwrap() - other["value"].as_f64().unwrap();
        assert!(off.abs() < 1e-3 * one["sigma"].as_f64().unwrap(), "{one} {other}");
    }
}

#[test]
fn one_program_may_run_in_several_mountings() {
    let work = Work::new();
    let places = [("A", [-60.0, -60.0, 0.0], ""), ("B", [80.0, 60.0, 90.0], "")];
    let arcs =
        "[plan]\nfeed_mm_min = 2000.0\nchord_sag_um = 4.0\n[[plan.arc]]\nkind = \"equator\"\n";
    work.machine("name", "name").write("test.toml", test_of(&places, arcs));
    work.ballbar(&["program", "test.toml"]).done();
    std::fs::rename(work.path("results"), work.path("programs")).unwrap();
    let runs = |name: &str| {
        format!(
            "[[run]]\nprogram = \"programs/O1001.nc\"\nlog = \"{name}.csv\"\nmounting = \"{name}\"\nrepeat = 1\n"
        )
    };
    let terms = "[identify]\nterms = [\"EYYb\", \"EXt\", \"EYt\"]\n";
    work.write("test.toml", test_of(&places, &[runs("A"), runs("B"), terms.to_owned()].concat()));
    work.ballbar(&["simulate", "test.toml"]).done();
    let outcome = work.ballbar(&["identify", "results/test.toml", "--json"]).done();
    let analysis: Value = serde_json::from_str(&outcome.stdout()).unwrap();
    let runs = analysis["repeats"][0]["runs"].as_array().unwrap();
    assert_eq!(runs.iter().map(|run| &run["mounting"]).collect::<Vec<_>>(), ["A", "B"]);
    assert_ne!(runs[0]["log"], runs[1]["log"]);
}

#[test]
fn places_that_no_repeat_puts_together_are_told() {
    let work = Work::new();
    let places = [("A", [0.0, 0.0, 0.0], ""), ("B", [60.0, 40.0, 50.0], "work_offset = \"G55\"")];
    let rest = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 1000.0\n";
    work.machine("name", "name").write("test.toml", test_of(&places, rest));
    work.ballbar(&["simulate", "test.toml"]).done();
    std::fs::rename(work.path("results"), work.path("virtual")).unwrap();
    let told = |analysis: &Value| -> bool {
        let cautions = analysis["cautions"].as_array().unwrap().iter();
        cautions.map(|caution| caution.as_str().unwrap()).any(|of| of.contains("the same `repeat`"))
    };
    let together = analysed(&work);
    assert_eq!(together["repeats"].as_array().unwrap().len(), 1);
    assert!(!told(&together), "{:#}", together["cautions"]);
    let test = std::fs::read_to_string(work.path("virtual/test.toml")).unwrap();
    let apart: Vec<&str> = test.lines().filter(|line| !line.starts_with("repeat")).collect();
    work.write("virtual/test.toml", apart.join("\n"));
    let apart = analysed(&work);
    assert_eq!(apart["repeats"].as_array().unwrap().len(), 2);
    assert!(told(&apart), "{:#}", apart["cautions"]);
}
