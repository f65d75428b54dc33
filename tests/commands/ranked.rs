//! What is wrong in a plane, ranked by what repairing it would gain: on machines whose faults are known.

use serde_json::Value;

use crate::work::{Work, project};

/// A fault in both signs: what it is in a scenario, what the table must call it, and its value and words there.
#[derive(Clone, Copy)]
struct Fault {
    coefficient: Option<(&'static str, f64)>,
    hidden: Option<(&'static str, f64)>,
    feature: &'static str,
    value: f64,
    words: [&'static str; 2],
}

/// Both axes of this machine carry the workpiece: what a slide does to itself, the tool does the other way.
const FAULTS: [Fault; 8] = [
    Fault {
        coefficient: Some(("EXY1", -5e-5)),
        hidden: None,
        feature: "squareness XY",
        value: 50.0,
        words: ["+Y leans towards +X", "+Y leans away from +X"],
    },
    Fault {
        coefficient: Some(("EXX1", -2e-5)),
        hidden: None,
        feature: "scale mismatch XY",
        value: 6.0,
        words: ["X goes farther than Y", "Y goes farther than X"],
    },
    Fault {
        coefficient: Some(("EXXb", 1e-3)),
        hidden: None,
        feature: "backlash X",
        value: 2.0,
        words: ["lost motion", "over-compensated"],
    },
    Fault {
        coefficient: Some(("EYYb", 1.5e-3)),
        hidden: None,
        feature: "backlash Y",
        value: 3.0,
        words: ["lost motion", "over-compensated"],
    },
    Fault {
        coefficient: Some(("EXYb", -0.8e-3)),
        hidden: None,
        feature: "lateral play Y in X",
        value: 1.6,
        words: ["towards +X going +Y", "towards -X going +Y"],
    },
    Fault {
        coefficient: Some(("EYXb", -0.6e-3)),
        hidden: None,
        feature: "lateral play X in Y",
        value: 1.2,
        words: ["towards +Y going +X", "towards -Y going +X"],
    },
    Fault {
        coefficient: None,
        hidden: Some(("servo:on=X,delay_ms=", 0.3)),
        feature: "servo mismatch XY",
        value: 0.3,
        words: ["X follows later than Y", "Y follows later than X"],
    },
    Fault {
        coefficient: None,
        hidden: Some(("cyclic:on=EYY,period_mm=12,amplitude_um=", 1.5)),
        feature: "cyclic EYY",
        value: 1.5,
        words: ["period 12.0 mm", "period 12.0 mm"],
    },
];

/// A vertical machine with these faults and no others, its XY plane tested with a bar of 150 mm at 1000 mm/min.
fn analysed(faults: &[&Fault], sign: f64, rate_hz: u32, plan: &str) -> (Work, Value) {
    let work = Work::new();
    work.write("machine.toml", std::fs::read(project().join("machines/vertical.toml")).unwrap());
    work.test(&format!("[plan]\nfeed_mm_min = 1000.0\n{plan}\n"));
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    work.write("test.toml", test.replace("[20.0, -35.0, 40.0]", "[20.0, -35.0, -300.0]"));
    let coefficients = faults.iter().filter_map(|fault| fault.coefficient);
    let coefficients: Vec<String> =
        coefficients.map(|(name, value)| format!("{name} = {:e}\n", sign * value)).collect();
    let scenario = format!(
        "seed = 5\nsample_rate_hz = {rate_hz}\n[noise]\nwhite_um = 0.1\ncorrelated_um = 0.0\n[coefficients]\n{}",
        coefficients.concat()
    );
    work.write("scenario.toml", scenario);
    let hidden: Vec<String> = faults
        .iter()
        .filter_map(|fault| fault.hidden)
        .map(|(effect, size)| format!("{effect}{}", sign * size))
        .collect();
    let mut arguments = vec!["simulate", "test.toml", "--scenario", "scenario.toml"];
    arguments.extend(hidden.iter().flat_map(|effect| ["--hide", effect]));
    work.ballbar(&arguments).done();
    work.ballbar(&["analyse", "results/test.toml"]).done();
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let ranking = serde_json::from_str::<Value>(&analysis).unwrap()["ranking"].clone();
    (work, ranking)
}

/// What is left out by effects to first order, as a share.
const FIRST_ORDER: f64 = 0.002;

const XY: &str = "strategy = \"xy\"";

fn number(of: &Value, name: &str) -> f64 {
    of[name].as_f64().unwrap_or_else(|| unreachable!("{name} in {of}"))
}

fn features(of: &Value) -> &Vec<Value> {
    of["features"].as_array().unwrap()
}

fn named<'a>(of: &'a Value, feature: &str) -> &'a Value {
    let found = features(of).iter().find(|f| f["feature"].as_str() == Some(feature));
    found.unwrap_or_else(|| unreachable!("{feature} in {of:#}"))
}

/// The value is within 3 of *all* of the truth, or within a part of it where *all* is smaller: the columns of the fit are
/// effects to first order, and a thousand readings a second know them better than that. And the sign is said in words where the value is told.
#[track_caller]
fn check(test: &Value, fault: &Fault, sign: f64) {
    let found = named(test, fault.feature);
    let wave = fault.feature.starts_with("cyclic");
    let truth = if wave { fault.value } else { sign * fault.value };
    let (value, all) = (number(found, "value"), number(found, "all"));
    let near = (3.0 * all).max(FIRST_ORDER * truth.abs());
    assert!((value - truth).abs() < near, "{truth}: {found:#}");
    assert_eq!(found["told_apart_from_0"].as_bool(), Some(value.abs() > 2.0 * all));
    if value.abs() > 2.0 * all {
        let words = fault.words[usize::from(sign < 0.0)];
        assert_eq!(found["in_words"].as_str(), Some(words), "{found:#}");
    }
}

/// What Ballbar 20 ranks by, um, by the definition; the angle of a plane and positioning are no features of its.
fn size_um(feature: &Value) -> Option<f64> {
    let value = number(feature, "value").abs();
    match feature["feature"].as_str().unwrap().split(' ').next().unwrap() {
        "squareness" => Some(value * 0.15),
        "servo" => Some(value * 1000.0 / 60.0),
        "cyclic" => Some(2.0 * value),
        "scale" | "backlash" | "lateral" | "straightness" | "reversal" => Some(value),
        _ => None,
    }
}

#[track_caller]
fn check_shares(test: &Value) {
    let sum: f64 = features(test).iter().filter_map(size_um).sum();
    let mut shares = 0.0;
    for feature in features(test) {
        match size_um(feature) {
            Some(size) => {
                let share = number(feature, "share_percent");
                assert!((share - 100.0 * size / sum).abs() < 1e-6 * share + 1e-9, "{feature:#}");
                shares += share;
            }
            None => assert!(feature["share_percent"].is_null(), "{feature:#}"),
        }
    }
    assert!((shares - 100.0).abs() < 1e-9);
}

/// What is told apart comes first, and of that the largest fall; the others, the larger fall before the smaller one.
#[track_caller]
fn check_order(test: &Value) {
    let told = |f: &&Value| f["told_apart_from_0"].as_bool().unwrap();
    let (first, last): (Vec<&Value>, Vec<&Value>) = features(test).iter().partition(told);
    let order: Vec<&Value> = first.iter().chain(&last).copied().collect();
    assert_eq!(order, features(test).iter().collect::<Vec<_>>());
    if let Some(next) = first.first() {
        let falls_um = number(next, "fall_um");
        assert!(first.iter().all(|other| number(other, "fall_um") <= falls_um + 1e-9));
        // The readings at a reversal whose side is not known count for the deviation, and not for what falls.
        let left_um = number(test, "deviation_um") - falls_um;
        assert!(number(next, "left_um") < left_um + NOISE_UM, "{left_um}: {next:#}");
    }
    assert!(last.windows(2).all(|two| number(two[0], "fall_um") >= number(two[1], "fall_um")));
    assert!(last.iter().all(|of| of["left_um"].is_null()));
}

/// Features, what was commanded and what nothing explains are all that was read: ranges about a common centre do not grow
/// beyond their sum, but for what features do to second order.
#[track_caller]
fn check_sum(test: &Value) {
    let of = |name| number(test, name);
    let parts_um = of("unexplained_um") + of("commanded_um");
    assert!(of("left_um") < 1.1 * parts_um, "{test:#}");
}

/// Everything together, in both signs and at every rate.
#[test]
fn a_plane_with_every_fault_has_each_in_its_table() {
    let all: Vec<&Fault> = FAULTS.iter().collect();
    for (rate_hz, sign) in [(10, 1.0), (10, -1.0), (250, -1.0), (1000, 1.0), (1000, -1.0)] {
        let (_work, ranking) = analysed(&all, sign, rate_hz, XY);
        let test = &ranking["tests"][0];
        assert_eq!(
            (test["test"].as_str(), test["deviation"].as_str()),
            (Some("XY plane F1000"), Some("G(b)"))
        );
        for fault in &FAULTS {
            check(test, fault, sign);
        }
        check_shares(test);
        check_order(test);
        check_sum(test);
    }
}

/// What is foretold to fall without a fault falls where a machine has not got it: within 2 % or the noise.
#[test]
fn a_machine_without_a_fault_has_the_deviation_that_was_foretold() {
    let all: Vec<&Fault> = FAULTS.iter().collect();
    let (work, ranking) = analysed(&all, 1.0, 250, XY);
    let with = &ranking["tests"][0];
    for fault in &FAULTS {
        check(with, fault, 1.0);
    }
    check_shares(with);
    let told = std::fs::read_to_string(work.path("results/report.html")).unwrap();
    for words in ["What to repair", "X follows later than Y", "not told apart from 0", "share"] {
        assert!(told.contains(words), "{words}");
    }
    let deviation_um = number(with, "deviation_um");
    for fault in all
        .iter()
        .filter(|fault| ["backlash Y", "servo mismatch XY", "cyclic EYY"].contains(&fault.feature))
    {
        let others: Vec<&Fault> =
            FAULTS.iter().filter(|other| other.feature != fault.feature).collect();
        let (_work, ranking) = analysed(&others, 1.0, 250, XY);
        let falls_um = deviation_um - number(&ranking["tests"][0], "deviation_um");
        let foretold = named(with, fault.feature);
        let noise_um = 3.0 * number(foretold, "fall_noise_um") + NOISE_UM;
        let apart_um = (number(foretold, "fall_um") - falls_um).abs();
        assert!(apart_um < noise_um.max(0.02 * deviation_um), "{falls_um}: {foretold:#}");
    }
}

/// What is foretold to be left without the faults that are repaired first is left on a machine that has not got them, of the circle
/// and of the volume: within 2 % or the noise.
#[test]
fn repaired_in_its_order_a_machine_is_left_as_was_foretold() {
    // Not the scale of one axis: a mismatch that is repaired leaves both axes with their mean.
    let faults: Vec<Fault> =
        [(FAULTS[0], 10.0), (FAULTS[2], 8.0), (FAULTS[3], 4.0), (FAULTS[4], 6.0), (FAULTS[5], 5.0)]
            .map(|(fault, times)| Fault {
                coefficient: fault.coefficient.map(|(name, value)| (name, times * value)),
                value: times * fault.value,
                ..fault
            })
            .to_vec();
    let mut here: Vec<&Fault> = faults.iter().collect();
    for plan in [XY, "strategy = \"iso230-4\""] {
        let (_work, ranking) = analysed(&here, 1.0, 250, plan);
        let plane = |ranking: &Value| -> Value {
            let tests = ranking["tests"].as_array().unwrap();
            tests
                .iter()
                .find(|test| test["test"].as_str() == Some("XY plane F1000"))
                .unwrap()
                .clone()
        };
        let with = plane(&ranking);
        check_order(&with);
        let order: Vec<&Value> =
            features(&with).iter().filter(|f| f["told_apart_from_0"] == true).collect();
        for repaired in [1, 3] {
            let gone = |fault: &&Fault| {
                order[..repaired].iter().any(|f| f["feature"].as_str() == Some(fault.feature))
            };
            here = faults.iter().filter(|fault| !gone(fault)).collect();
            assert_eq!(here.len(), faults.len() - repaired, "{order:#?}");
            let (_work, ranking) = analysed(&here, 1.0, 250, plan);
            let without = plane(&ranking);
            let foretold = order[repaired - 1];
            for (was, left) in
                [("deviation_um", "left_um"), ("volumetric_um", "volumetric_left_um")]
            {
                if with[was].is_null() {
                    assert!(plan == XY && foretold[left].is_null());
                    continue;
                }
                let apart_um = number(foretold, left) - number(&without, was);
                let near_um = (0.02 * number(&without, was)).max(NOISE_UM);
                println!(
                    "{was}: {:.3}, {:.3} foretold, {:.3} simulated",
                    number(&with, was),
                    number(foretold, left),
                    number(&without, was)
                );
                assert!(apart_um.abs() < near_um, "{apart_um} of {near_um}: {foretold:#}");
            }
        }
        here = faults.iter().collect();
    }
}

/// G(b) of two logs with white noise of 0.1 um, means of five: it scatters by so much, um.
const NOISE_UM: f64 = 0.1;

/// Alone, a fault is all there is, and nothing else is told that is not there.
#[test]
fn one_fault_alone_is_the_whole_deviation() {
    for (name, sign) in
        [("backlash Y", -1.0), ("servo mismatch XY", 1.0), ("lateral play Y in X", 1.0)]
    {
        let fault = FAULTS.iter().find(|fault| fault.feature == name).unwrap();
        let (_work, ranking) = analysed(&[fault], sign, 250, XY);
        let test = &ranking["tests"][0];
        check(test, fault, sign);
        for other in features(test).iter().filter(|f| f["feature"].as_str() != Some(name)) {
            assert!(number(other, "value").abs() < 4.0 * number(other, "all"), "{other:#}");
        }
    }
}

/// A mean over 20 ms holds a sixth of what vibrates at 60 Hz: its size is that of the bar.
#[test]
fn a_vibration_that_is_faster_than_a_sample_has_its_own_size() {
    for (rate_hz, effect, percent) in [
        (100, "vibration:on=bar,frequency_hz=20,amplitude_um=", 81),
        (250, "vibration:on=bar,frequency_hz=60,amplitude_um=", 17),
        (1000, "vibration:on=bar,frequency_hz=13,amplitude_um=", 89),
    ] {
        let fault = Fault {
            coefficient: None,
            hidden: Some((effect, 2.0)),
            feature: "vibration bar",
            value: 2.0,
            words: [""; 2],
        };
        let (work, ranking) = analysed(&[&fault], 1.0, rate_hz, XY);
        let found = named(&ranking["tests"][0], fault.feature);
        let (value, all) = (number(found, "value"), number(found, "all"));
        println!("{effect}: {value} +- {all}");
        assert!((value - 2.0).abs() < 3.0 * all && all < 0.01, "{found:#}");
        let report = std::fs::read_to_string(work.path("results/report.html")).unwrap();
        assert!(report.contains(&format!("which hold {percent} % of it")), "{percent}");
    }
}

/// A squareness that is seen in all three directions is told, and is the whole error of the volume: s/2 (y, x, 0) is s R / sqrt 6 rms.
#[test]
fn squareness_over_a_sphere_is_the_whole_volumetric_error() {
    let fault = Fault { coefficient: Some(("EXY1", -2e-4)), value: 200.0, ..FAULTS[0] };
    let (_work, ranking) = analysed(&[&fault], 1.0, 20, "strategy = \"3d6\"");
    let test = ranking["tests"].as_array().unwrap();
    let equator = test.iter().find(|t| t["test"].as_str() == Some("Equator F1000")).unwrap();
    let squareness = named(equator, "squareness XY");
    check(equator, &fault, 1.0);
    assert_eq!(squareness["told_apart_from_0"].as_bool(), Some(true), "{squareness:#}");
    let rms_um = 200e-6 * 150e3 / 6.0_f64.sqrt();
    let (of_all, falls) =
        (number(equator, "volumetric_um"), number(squareness, "volumetric_fall_um"));
    assert!((of_all / rms_um - 1.0).abs() < 0.15, "{of_all} instead of {rms_um}");
    assert!(falls > 0.75 * of_all, "{falls} of {of_all}");
}

#[test]
fn one_way_alone_has_its_circular_deviation() {
    let plan = "strategy = \"xy\"\nboth_directions = false";
    let (_work, ranking) = analysed(&[&FAULTS[3]], 1.0, 250, plan);
    let test = &ranking["tests"][0];
    assert_eq!(test["deviation"].as_str(), Some("G"));
    check(test, &FAULTS[3], 1.0);
}

/// The paper's machine: rotations act beside the middle lines, and the plane stands where Z came to.
#[test]
fn everything_that_a_measured_circle_shows_has_its_line() {
    for set in ["hu40t", "motion-a"] {
        let work = Work::new();
        let test = project().join(format!("tests/data/{set}/test.toml"));
        work.ballbar(&["analyse", test.to_str().unwrap()]).done();
        let analysis: Value = serde_json::from_str(
            &std::fs::read_to_string(work.path("results/analysis.json")).unwrap(),
        )
        .unwrap();
        let tests = analysis["ranking"]["tests"].as_array().unwrap();
        assert!(tests.len() >= 8, "{tests:#?}");
        for test in tests {
            check_order(test);
            check_sum(test);
            assert!(number(test, "left_um") < 0.25 * number(test, "deviation_um"), "{test:#}");
        }
    }
}

/// Measured data with three effects: the table against what was put in.
#[test]
fn the_table_of_a_measured_plane_is_what_was_put_in() {
    let work = Work::new();
    let test = project().join("tests/data/planar250/test.toml");
    let told = work.ballbar(&["analyse", test.to_str().unwrap()]).done().stdout();
    assert!(told.contains("What to repair: XY plane F1000"), "{told}");
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let analysis: Value = serde_json::from_str(&analysis).unwrap();
    let tests = analysis["ranking"]["tests"].as_array().unwrap();
    assert_eq!(tests.len(), 2);
    for test in tests {
        for (feature, truth) in [
            // 20.7 um/m over 200 mm.
            ("scale mismatch XY", -4.14),
            ("squareness XY", 0.02),
            ("backlash X", 1.8),
            ("backlash Y", -2.8),
            ("lateral play X in Y", -0.6),
            ("lateral play Y in X", -1.2),
            ("servo mismatch XY", 0.3),
            ("cyclic EXX", 1.0),
            ("reversal spike Y", 4.0),
        ] {
            let found = named(test, feature);
            let (value, all) = (number(found, "value"), number(found, "all"));
            // What was found is a fit of its own, as in `tests/diagnose/everywhere.rs`.
            let near = (3.0 * all).max(0.05 * f64::abs(truth));
            assert!((value - truth).abs() < near, "{truth}: {found:#}");
        }
        check_order(test);
        check_sum(test);
        // The servo mismatch makes most of it, and a spike beside the extremes nothing.
        assert_eq!(features(test)[0]["feature"].as_str(), Some("servo mismatch XY"));
        assert!(number(named(test, "reversal spike Y"), "fall_um").abs() < 0.05);
        // What is left stands at the reversals, where a mean over 20 ms holds a part of a step and of a spike.
        assert!(number(test, "left_um") < 0.3 * number(test, "deviation_um"), "{test:#}");
    }
}

/// Effects that are named as terms are those of the table, and the fit lets no slide follow later beside them.
#[test]
fn a_servo_mismatch_that_is_a_term_of_the_model() {
    let work = Work::new();
    let set = project().join("tests/data/planar250");
    let text = std::fs::read_to_string(set.join("test.toml")).unwrap();
    let text = ["machine", "program", "log"].iter().fold(text, |text, key| {
        text.replace(&format!("{key} = \""), &format!("{key} = \"{}/", set.display()))
    });
    let terms = "terms = [\"local\", \"servo:on=X\", \"cyclic:on=EXX,period_mm=10\", \
                 \"reversal-spike:on=Y,decay_ms=50\"]";
    work.write("test.toml", format!("{text}\n[identify]\n{terms}\n"));
    work.ballbar(&["identify", "test.toml"]).done();
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let analysis: Value = serde_json::from_str(&analysis).unwrap();
    for test in analysis["ranking"]["tests"].as_array().unwrap() {
        let servo = named(test, "servo mismatch XY");
        let (value, all) = (number(servo, "value"), number(servo, "all"));
        assert!((value - 0.3).abs() < (3.0 * all).max(0.015), "{servo:#}");
    }
    let control = &analysis["repeats"][0]["runs"][0]["control"];
    let later = |slide: usize| control["later_ms"][slide].as_f64().unwrap();
    assert!((later(0) - later(1) - 0.3).abs() < 0.015, "{control:#}");
}
