//! What noise does to numbers is what they say it may do, also where the fit follows it.

use std::fs;

use crate::lag::{three_planes, told_of};
use crate::work::{Work, project};

/// Arcs of 15 s, and noise that hangs together for a second: the fit takes out of it more than half, and moves by that. Reversals and
/// lateral plays, which nothing but noise moves, err by what is stated.
#[test]
fn noise_that_lasts_is_stated_though_little_of_it_is_left() {
    let mut squares = Vec::new();
    for (rate, seeds) in [("10.0", 0..8), ("250.0", 8..12)] {
        for seed in seeds {
            let work = three_planes("2450.");
            work.write(
                "noisy.toml",
                format!("sample_rate_hz = {rate}\nresolution_um = 1.0\n[noise]\nwhite_um = 0.0\ncorrelated_um = 0.24\ncorrelation_s = 1.0\n"),
            );
            let seed = seed.to_string();
            work.ballbar(&["simulate", "test.toml", "--scenario", "noisy.toml", "--seed", &seed])
                .done();
            let (told, truth) = told_of(&work);
            for of in told["at_the_place"].as_array().unwrap() {
                let quantity = of["quantity"].as_str().unwrap();
                let key = format!("{}_um", quantity.replace(' ', "_"));
                let Some(truth) = truth["at_the_place"].get(&key) else { continue };
                let off = of["value"].as_f64().unwrap() - truth.as_float().unwrap();
                let sigma = of["noise"].as_f64().unwrap();
                println!("{rate} {seed} {quantity} {off:.3} {sigma:.3}");
                squares.push((off / sigma).powi(2));
            }
        }
    }
    assert_eq!(squares.len(), 12 * 9);
    // Some five numbers of a campaign are independent: 60 tell an rms to 9 %.
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!((0.75..1.25).contains(&rms), "{rms}");
}

/// Two days of two machines: no mean of both, and none of them, is known better than they differ, and the reader is told what does.
#[test]
fn repeats_that_differ_are_told_and_stated() {
    let work = Work::new();
    let test = "[plan]\nstrategy = \"iso230-4\"\nfeed_mm_min = 1000.0\n";
    let mut rest = vec![test.to_owned()];
    work.write("machine.toml", fs::read(project().join("machines/hu40t.toml")).unwrap());
    for day in ["1", "2"] {
        work.test(test).ballbar(&["simulate", "test.toml", "--seed", day]).done();
        let log = format!("day{day}.csv");
        for (from, to) in [("O1001.nc", "O1001.nc"), ("run1.csv", &log)] {
            work.write(to, fs::read(work.path(&format!("results/{from}"))).unwrap());
        }
        rest.push(format!("[[run]]\nprogram = \"O1001.nc\"\nlog = \"{log}\"\n"));
        fs::remove_dir_all(work.path("results")).unwrap();
    }
    work.test(&rest.join("\n"));
    let text = work.ballbar(&["analyse", "test.toml"]).done().stdout();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let told: serde_json::Value =
        serde_json::from_slice(&fs::read(work.path("results/analysis.json")).unwrap()).unwrap();
    let mut differing = Vec::new();
    for of in told["at_the_place"].as_array().unwrap() {
        let number = |name: &str| of[name].as_f64().unwrap();
        let (scatter, noise) = (number("deviation") / 2_f64.sqrt(), number("noise"));
        assert!(noise > 0.999_999 * scatter && number("all") >= noise, "{of}");
        let quantity = of["quantity"].as_str().unwrap();
        if ["reversal X", "reversal Y", "reversal Z"].contains(&quantity) && scatter > 1.0 {
            differing.push(quantity);
        }
    }
    assert!(differing.contains(&"reversal X"), "{told}");
    let deviation = |quantity: &str| {
        let mut all = told["at_the_place"].as_array().unwrap().iter();
        all.find(|of| of["quantity"] == quantity).unwrap()["deviation"].as_f64().unwrap()
    };
    let tests = told["ranking"]["tests"].as_array().unwrap();
    assert_eq!(tests.len(), 6);
    for of in tests.iter().flat_map(|test| test["features"].as_array().unwrap()) {
        let feature = of["feature"].as_str().unwrap().replace("backlash", "reversal");
        if ["reversal X", "reversal Y", "squareness XY", "lateral play X in Y"].contains(&&*feature)
        {
            assert!(of["noise"].as_f64().unwrap() > 0.999_999 * deviation(&feature), "{of}");
        }
    }
    let caution = text.split("Between the repeats").nth(1).unwrap_or_else(|| panic!("{text}"));
    let changed = caution.split("changed by more than").next().unwrap();
    assert!(differing.iter().all(|of| changed.contains(of)), "{changed}: {differing:?}");
    // Nor is the volume of which machine it is: each by itself tells its own to a micrometre.
    let volume = work.plain(&["volume", "results/analysis.json", "--json"]).done().stdout();
    let volume: serde_json::Value = serde_json::from_str(&volume).unwrap();
    assert!(volume["near"]["unknown_noise_um"].as_f64().unwrap() > 20.0, "{volume}");
}

/// Three planes of one machine, each identified by itself: one that another does not drive has not changed there, and what each tells
/// of its own is known as well as by itself.
#[test]
fn planes_by_themselves_are_no_repeats_of_each_other() {
    let work = Work::new();
    let test = |plane: &str| format!("[plan]\nstrategy = \"{plane}\"\nfeed_mm_min = 1000.0\n");
    let mut rest = vec![test("xy")];
    work.write("machine.toml", fs::read(project().join("machines/hu40t.toml")).unwrap());
    for plane in ["xy", "yz", "zx"] {
        work.test(&test(plane)).ballbar(&["simulate", "test.toml", "--seed", "1"]).done();
        for (from, kind) in [("O1001.nc", "nc"), ("run1.csv", "csv")] {
            let bytes = fs::read(work.path(&format!("results/{from}"))).unwrap();
            work.write(&format!("{plane}.{kind}"), bytes);
        }
        rest.push(format!("[[run]]\nprogram = \"{plane}.nc\"\nlog = \"{plane}.csv\"\n"));
        fs::remove_dir_all(work.path("results")).unwrap();
    }
    work.test(&rest.join("\n"));
    let text = work.ballbar(&["analyse", "test.toml"]).done().stdout();
    assert!(!text.contains("Between the repeats"), "{text}");
    let told: serde_json::Value =
        serde_json::from_slice(&fs::read(work.path("results/analysis.json")).unwrap()).unwrap();
    let tests = told["ranking"]["tests"].as_array().unwrap();
    assert_eq!(tests.len(), 3);
    for test in tests {
        let features = test["features"].as_array().unwrap();
        let plays = features.iter().filter(|of| {
            let name = of["feature"].as_str().unwrap();
            name.starts_with("lateral play") || name.starts_with("backlash")
        });
        let noises: Vec<f64> = plays.map(|of| of["noise"].as_f64().unwrap()).collect();
        assert_eq!(noises.len(), 4, "{test}");
        assert!(noises.iter().all(|um| *um < 0.2), "{test}");
    }
}
