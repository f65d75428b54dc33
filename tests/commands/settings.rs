//! What the machine file, the test file or the knob have otherwise than stated, found by `ballbar diagnose`.

use ballbar::diagnose::search;
use ballbar::identify::{Campaign, Failure};
use ballbar::plan::Test;
use serde_json::Value;

use crate::work::{Work, data, unpacked};

/// Simulates a test with an effect and diagnoses it: the key `diagnosis` of the analysis, and what was printed.
fn diagnosed(test: &str, hide: &str, work: &Work) -> (Value, String) {
    work.ballbar(&["simulate", "--paper", test, "--hide", hide]).done();
    let outcome = work.ballbar(&["diagnose", "results/test.toml"]).done();
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let analysis: Value = serde_json::from_str(&analysis).unwrap();
    // Without the ends of its lines.
    let text = outcome.stdout().split_whitespace().collect::<Vec<_>>().join(" ");
    (analysis["diagnosis"].clone(), text)
}

/// The designed test of three mountings.
fn designed() -> String {
    data("designed").join("test.toml").to_str().unwrap().to_owned()
}

#[test]
fn a_pivot_on_the_base_that_the_machine_file_has_on_the_carriage() {
    let work = Work::new();
    let (found, text) = diagnosed(&designed(), "pivot:on=Z", &work);
    let told = "The pivot of Z is not on the carriage, as the machine file states";
    assert!(text.contains(told) && text.contains("`pivot = \"base\"`"), "{text}");
    let wrong = &found["wrong_settings"][0];
    assert_eq!(wrong["effect"], "pivot:on=Z", "{wrong}");
    assert!(wrong["after_um"].as_f64().unwrap() < 0.165, "{wrong}");
    // Nothing else is named for it.
    assert_eq!(found["findings"].as_array().unwrap().len(), 0, "{text}");
    assert_eq!(found["nothing_found"], false);
}

#[test]
fn a_model_file_has_the_terms_of_its_coefficients() {
    let work = Work::new();
    let simulated = ["simulate", "--paper", &designed(), "--hide", "pivot:on=Z", "--hide"];
    let cyclic = "cyclic:on=EXX,amplitude_um=0.25,period_mm=10";
    work.ballbar(&[simulated.as_slice(), &[cyclic]].concat()).done();
    work.ballbar(&["diagnose", "results/test.toml"]).done();
    let model = std::fs::read_to_string(work.path("results/model.toml")).unwrap();
    let model: toml::Table = toml::from_str(&model).unwrap();
    let names =
        |key: &str| -> Vec<String> { model[key].as_table().unwrap().keys().cloned().collect() };
    let terms = model["terms"].as_array().unwrap().iter().map(|term| term.as_str().unwrap());
    let mut terms: Vec<String> =
        terms.filter(|t| !t.contains([':', '@'])).map(Into::into).collect();
    let mut estimated = names("coefficients");
    terms.retain(|term| !term.ends_with(['t', 'w']));
    terms.sort();
    estimated.sort();
    assert_eq!(terms, estimated);
}

#[test]
fn a_tool_that_is_longer_in_one_of_the_mountings() {
    let work = Work::new();
    let (found, text) = diagnosed(&designed(), "ball-place:on=EZt,offset_mm=20,mounting=2", &work);
    let effect = found["wrong_settings"][0]["effect"].as_str().unwrap_or_default();
    let offset = effect.strip_prefix("ball-place:on=EZt,offset_mm=").unwrap_or_default();
    let (offset, mounting) = offset.split_once(",mounting=").unwrap_or_default();
    // Stated as +- 1.3 mm.
    let off_mm = (offset.parse::<f64>().unwrap() - 20.0).abs();
    assert!(off_mm < 3.0 * 1.3 && mounting == "2", "{text}");
    assert!(text.contains("+- 1.3 mm"), "{text}");
    assert!(text.contains("read `tool_ball_mm` from the control again"), "{text}");
}

/// Two runs of a case, without its plan.
fn two_feeds() -> Work {
    let work = Work::new();
    work.machine("name", "name");
    let mut rest = vec!["[identify]\nterms = [\"observable35\"]\n".to_owned()];
    for program in ["O1005", "O1015"] {
        work.write(
            &format!("{program}.nc"),
            unpacked(&data("case-d").join(format!("{program}.nc.gz"))),
        );
        work.write(&format!("{program}.csv"), "time_s,deviation_um\n0,0\n");
        rest.push(format!("[[run]]\nprogram = \"{program}.nc\"\nlog = \"{program}.csv\"\n"));
    }
    work.test(&rest.join("\n"));
    work
}

/// At a mark, and between two: no clock is so far off.
#[test]
fn a_knob_that_stood_elsewhere() {
    for stood in [99.0, 98.5] {
        let work = two_feeds();
        let hidden = format!("feed-override:percent={stood}");
        let (found, text) = diagnosed("test.toml", &hidden, &work);
        assert!(text.contains(&format!("`feed_override_percent = {stood:.1}`")), "{text}");
        for off in found["off_times"].as_array().unwrap() {
            assert_eq!(off["cause"], "feed-override", "{off}");
            let (percent, sigma) = (off["percent"].as_f64(), off["sigma_percent"].as_f64());
            assert!((percent.unwrap() - stood).abs() < 3.0 * sigma.unwrap(), "{off}");
        }
        assert_eq!(found["off_times"].as_array().unwrap().len(), 2);
    }
}

#[test]
fn a_clock_that_runs_wrong() {
    let work = two_feeds();
    let (found, text) = diagnosed("test.toml", "clock:ppm=800", &work);
    assert!(text.contains("the clock is off by"), "{text}");
    for off in found["off_times"].as_array().unwrap() {
        assert_eq!(off["cause"], "clock", "{off}");
        // Some of it may be standstills that take longer than the program says.
        let sigma_ppm = 1e4 * off["sigma_percent"].as_f64().unwrap();
        assert!((off["clock_ppm"].as_f64().unwrap() - 800.0).abs() < 3.0 * sigma_ppm, "{off}");
    }
    assert_eq!(found["off_times"].as_array().unwrap().len(), 2);
}

#[test]
fn a_knob_that_stood_far_elsewhere_takes_part_and_is_told() {
    let work = two_feeds();
    work.ballbar(&["simulate", "test.toml", "--repeats", "2"]).done();
    let right = std::fs::read_to_string(work.path("results/run1-O1015.csv")).unwrap();
    let slower = ["simulate", "test.toml", "--hide", "feed-override:percent=80"];
    work.ballbar(&slower).done();
    let wrong = std::fs::read_to_string(work.path("results/run1-O1015.csv")).unwrap();
    work.write("right.csv", right).write("wrong.csv", wrong).test(
        "[[run]]\nprogram = \"O1015.nc\"\nlog = \"right.csv\"\n\n\
         [[run]]\nprogram = \"O1015.nc\"\nlog = \"wrong.csv\"\n",
    );
    work.ballbar(&["diagnose", "test.toml"]).done();
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let analysis: Value = serde_json::from_str(&analysis).unwrap();
    let diagnosis = &analysis["diagnosis"];
    assert!(diagnosis["left_out"].as_array().unwrap().is_empty(), "{diagnosis}");
    assert!(diagnosis["findings"].as_array().unwrap().is_empty(), "{diagnosis}");
    let off = &diagnosis["off_times"][0];
    assert_eq!((&off["run"], &off["cause"]), (&"wrong".into(), &"feed-override".into()), "{off}");
    assert!((off["percent"].as_f64().unwrap() - 80.0).abs() < 0.1, "{off}");
}

/// Every pose is another one then: the logs are laid over their programs again, those that were read.
#[test]
fn a_workpiece_ball_elsewhere_is_found_when_the_files_are_gone() {
    let work = Work::new();
    let hidden = "ball-place:on=EXw,offset_mm=20,mounting=2";
    work.ballbar(&["simulate", "--paper", &designed(), "--hide", hidden]).done();
    let test = Test::read(&work.path("results/test.toml")).unwrap();
    let machine = test.machine().unwrap();
    let campaign = Campaign::of(&test, &machine, Failure::Refuse, &|| ()).unwrap();
    std::fs::remove_dir_all(work.path("results")).unwrap();
    let found = search(&test, &machine, &campaign).unwrap();
    let effects: Vec<String> = found.wrong_settings.iter().map(|w| w.effect.to_string()).collect();
    let wrong = found.wrong_settings.first().expect("the place of the ball is wrong");
    let (effect, sigma_mm) = (&wrong.effect, wrong.sigma_mm.unwrap());
    assert_eq!((effect.seat.to_string(), effect.get("mounting")), ("EXw".to_owned(), 2.0));
    // Coefficients follow most of it: it is known to 0.7 mm.
    let off_mm = effect.get("offset") - 20.0;
    assert!(off_mm.abs() < 4.0 * sigma_mm && sigma_mm < 0.8, "{off_mm} {sigma_mm} {effects:?}");
}
