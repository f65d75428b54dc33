//! The test that every user of a ball-bar knows, through every command, in the words that he knows.

use crate::work::{Work, data, project};

const PLAN: &str =
    "[plan]\nstrategy = \"iso230-4\"\nfeed_mm_min = [1000.0, 2000.0]\nchord_sag_um = 1.0\n";

/// A bench with one of the machines of the project.
fn bench(machine: &str, coincidence: &str, plan: &str) -> Work {
    let work = Work::new();
    let source = std::fs::read(project().join("machines").join(machine)).unwrap();
    work.write("machine.toml", source).test(plan);
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    work.write("test.toml", test.replace("[20.0, -35.0, 40.0]", coincidence));
    work
}

#[test]
fn three_planes_at_two_feeds_go_through_every_command() {
    for (machine, coincidence) in
        [("hu40t.toml", "[20.0, -35.0, 40.0]"), ("vertical.toml", "[20.0, -35.0, -300.0]")]
    {
        let work = bench(machine, coincidence, PLAN);
        let plan = work.ballbar(&["plan", "test.toml"]).done().stdout();
        for told in ["strategy iso230-4, feed 1000, 2000 mm/min", "squareness YZ"] {
            assert!(plan.contains(told), "{told}\n{plan}");
        }
        work.ballbar(&["program", "test.toml"]).done();
        let check = ["check", "results/O1001.nc", "--test", "test.toml", "--plot"];
        assert!(work.ballbar(&check).done().stderr().contains("0 error(s), 0 warning(s)"));
        let time = work.ballbar(&["time", "results/O1001.nc", "--test", "test.toml"]).done();
        assert!(time.stdout().contains("and 15 stop(s) for the operator"), "{}", time.stdout());
        // On one of the two a servo loop is late: at two feeds that is no geometry.
        let late = machine == "vertical.toml";
        let hide = if late { &["--hide", "servo:on=Y,delay_ms=0.5"][..] } else { &[] };
        work.ballbar(&[&["simulate", "test.toml"], hide].concat()).done();
        let test = "results/test.toml";
        let align = work.ballbar(&["align", test]).done().stdout();
        assert!(align.contains("11 of"), "the pauses between the arcs\n{align}");
        work.ballbar(&["identify", test]).done();
        let diagnosis = work.ballbar(&["diagnose", test]).done().stdout();
        let found = "Servo mismatch: following error of an axis, Y: delay 0.";
        assert_eq!(diagnosis.contains(found), late, "{diagnosis}");
        let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
        let report = std::fs::read_to_string(work.path("results/report.html")).unwrap();
        for told in ["XY plane", "YZ plane", "ZX plane", "XY F1000 CCW", "ZX F2000 CW"] {
            assert!(analysis.contains(told) && report.contains(told), "{told}");
        }
        assert!(report.contains("measured, CCW") && !report.contains("measured, forward"));
        for word in ["Equator", "Meridian", "EQUATOR"] {
            assert!(!report.contains(word) && !analysis.contains(word), "{word}");
        }
    }
}

#[test]
fn what_cannot_be_a_plane_is_refused_with_its_line() {
    for (plan, line, told) in [
        ("strategy = \"xz\"\nfeed_mm_min = 500.0", 13, "unknown strategy `xz`"),
        ("strategy = \"3d6\"\nsweep_deg = 220.0\nfeed_mm_min = 500.0", 14, "`sweep_deg` belongs"),
        ("overshoot_deg = 180.0\nfeed_mm_min = 500.0", 13, "`overshoot_deg` belongs"),
        ("strategy = \"xy\"\nsweep_deg = 0.5\nfeed_mm_min = 500.0", 14, "between 1 and 360"),
        ("strategy = \"xy\"\novershoot_deg = -1\nfeed_mm_min = 500.0", 14, "between 0 and 720"),
        ("strategy = \"xy\"\nstart_deg = nan\nfeed_mm_min = 500.0", 14, "between -360 and 360"),
        ("strategy = \"xy\"\nfeed_mm_min = []", 14, "has 0 feeds"),
        ("strategy = \"xy\"\nfeed_mm_min = [500, 500.0]", 14, "has 500 twice"),
        ("strategy = \"xy\"\nfeed_mm_min = [500, 1e9]", 14, "between 1 and 60000"),
        ("strategy = \"xy\"\nfeed_mm_min = \"F500\"", 14, "number or a list of numbers"),
        (
            "strategy = \"xy\"\ninterpolation = \"G02\"\nfeed_mm_min = 5.0",
            14,
            "unknown interpolation",
        ),
    ] {
        let work = bench("hu40t.toml", "[20.0, -35.0, 40.0]", &format!("[plan]\n{plan}\n"));
        let message = work.ballbar(&["program", "test.toml"]).refused(1);
        assert!(message.contains(told), "{message}");
        assert!(message.contains(&format!("test.toml:{line}:")), "{line}: {message}");
    }
}

/// The test file of this set says 3d6, and its programs drive one circle.
#[test]
fn what_was_driven_is_told_and_not_what_was_planned() {
    let work = Work::new();
    let test = data("planar250").join("test.toml");
    let told = work.ballbar(&["identify", test.to_str().unwrap()]).done().stdout();
    assert!(told.contains(", XY plane,") && !told.contains("3d6"), "{told}");
    let analysis = std::fs::read_to_string(work.path("results/analysis.json")).unwrap();
    let analysis: serde_json::Value = serde_json::from_str(&analysis).unwrap();
    assert_eq!(analysis["strategy"], serde_json::Value::Null);
    assert_eq!(analysis["driven"], serde_json::json!(["XY plane"]));
}

/// The bar stays on, and the operator looks between the two ways: by `[plan]`, or with an M00 written into the program.
#[test]
fn an_operator_may_stop_between_the_arcs_of_a_plane() {
    let plan = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 1000.0\nrelease_between_arcs = false\n";
    for (more, stops) in [("stop_between_arcs = true\n", "6 stop(s)"), ("", "5 stop(s)")] {
        let work = bench("vertical.toml", "[20.0, -35.0, -300.0]", &format!("{plan}{more}"));
        work.ballbar(&["program", "test.toml"]).done();
        let mut program = std::fs::read_to_string(work.path("results/O1001.nc")).unwrap();
        if more.is_empty() {
            let (before, after) = program.split_once("(XY CW OVERSHOOT)").unwrap();
            program = format!("{before}M00\n(XY CW OVERSHOOT){after}");
        }
        let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
        work.write("mine.nc", program).write(
            "mine.toml",
            format!("{test}\n[[run]]\nprogram = \"mine.nc\"\nlog = \"none.csv\"\n"),
        );
        let check = work.ballbar(&["check", "mine.nc", "--test", "mine.toml"]).done();
        assert!(check.stderr().contains("0 error(s)"), "{}", check.stderr());
        let time = work.ballbar(&["time", "mine.nc", "--test", "mine.toml"]).done().stdout();
        assert!(time.contains(stops), "{time}");
        work.ballbar(&["simulate", "mine.toml"]).done();
        let told = work.ballbar(&["analyse", "results/test.toml"]).done().stdout();
        assert!(told.contains("XY plane F1000"), "{told}");
    }
}

/// A ball that stands so far off that the bar still reads where it is retracted.
#[test]
fn a_ball_that_stands_nearly_a_millimetre_off() {
    let plan = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 1000.0\n";
    let work = bench("vertical.toml", "[20.0, -35.0, -300.0]", plan);
    let off = "[coefficients]\n[set_up]\nEXt = 0.8\nEYt = -0.5\nEZt = 0.3\n";
    work.write("off.toml", off);
    work.ballbar(&["simulate", "test.toml", "--scenario", "off.toml"]).done();
    std::fs::rename(work.path("results"), work.path("runs")).unwrap();
    let told = work.ballbar(&["analyse", "runs/test.toml"]).refused(3);
    // Along the plane; nothing is said across it.
    assert!(told.contains("the tool ball was 0.94 mm from"), "{told}");
    assert!(told.contains("hint: bring the balls together again"), "{told}");
}

/// Half a millimetre brings the bar into its range at stops too, and its arcs still read less than its stops; four fifths
/// do not.
#[test]
fn a_ball_that_stands_half_a_millimetre_off() {
    for strategy in ["xy", "3d6"] {
        let plan = format!("[plan]\nstrategy = \"{strategy}\"\nfeed_mm_min = 1000.0\n");
        let work = bench("vertical.toml", "[20.0, -35.0, -300.0]", &plan);
        let measured = |x_mm: f64, runs: &str| {
            let off = format!("seed = 2\n[coefficients]\nEXXb = -0.02\n[set_up]\nEXt = {x_mm}\n");
            work.write("off.toml", off);
            work.ballbar(&["simulate", "test.toml", "--scenario", "off.toml"]).done();
            std::fs::rename(work.path("results"), work.path(runs)).unwrap();
        };
        measured(0.5, "half");
        let told = work.ballbar(&["identify", "half/test.toml", "--json"]).done().stdout();
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        let cautions = told["cautions"].to_string();
        assert!(cautions.contains("the tool ball was 0.50 mm (X +0.50"), "{cautions}");
        assert!(
            cautions.contains("readings beyond 0.75 mm were taken as out of range"),
            "{cautions}"
        );
        assert!(told["repeats"][0]["residual_rms_um"].as_f64().unwrap() < 0.16, "{strategy}");
        let place = told["at_the_place"].as_array().unwrap();
        let reversal = place.iter().find(|at| at["quantity"] == "reversal X").unwrap();
        let [value_um, all_um] = ["value", "all"].map(|key| reversal[key].as_f64().unwrap());
        assert!((value_um - 40.0).abs() < 3.0 * all_um && all_um < 0.1, "{reversal}");

        measured(0.8, "far");
        let told = work.ballbar(&["identify", "far/test.toml"]).refused(3);
        assert!(told.contains("the tool ball was 0.8"), "{strategy}\n{told}");
    }
}

/// A machine that is out by a third of what its ball stands off: the log is not one of a feed that would make up for the bar that
/// reads while the machine waits.
#[test]
fn a_ball_that_stands_off_on_a_machine_that_is_out() {
    let work = bench(
        "vertical.toml",
        "[20.0, -35.0, -300.0]",
        "[plan]\nstrategy = \"3d6\"\nfeed_mm_min = 2200.0\n",
    );
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    let short = test.replace("length_mm = 150.0", "length_mm = 100.0\nrange_mm = 1.2");
    work.write("test.toml", short).write(
        "off.toml",
        "seed = 8\nsample_rate_hz = 50\nfeed_override_percent = 96.0\n\
         [set_up]\nEXt = -0.28\nEYt = 0.07\n",
    );
    work.ballbar(&["simulate", "test.toml", "--scenario", "off.toml"]).done();
    let told = work.ballbar(&["identify", "results/test.toml", "--json"]).done().stdout();
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    let cautions = told["cautions"].to_string();
    assert!(cautions.contains("the tool ball was 0.28 mm (X -0.27"), "{cautions}");
    assert!(told["repeats"][0]["residual_rms_um"].as_f64().unwrap() < 0.16, "{cautions}");
}

/// At 5 m/min a quarter of a circle of 100 mm takes two seconds, and half a meridian of 50 mm at 3 m/min three: what is kept from
/// reversals until times are known leaves some of it. A log too slow for that is told as one.
#[test]
fn a_short_bar_at_a_high_feed() {
    for (strategy, length_mm, feed_mm_min) in [("xy", 100.0, 5000.0), ("3d6", 50.0, 3000.0)] {
        let plan = format!("[plan]\nstrategy = \"{strategy}\"\nfeed_mm_min = {feed_mm_min:.1}\n");
        let work = bench("vertical.toml", "[20.0, -35.0, -300.0]", &plan);
        let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
        work.write("test.toml", test.replace("150.0", &format!("{length_mm:.1}")));
        let scenario = |rate_hz: f64| {
            format!("seed = 3\nsample_rate_hz = {rate_hz}\n[coefficients]\nEXXb = -0.02\n")
        };
        work.write("fast.toml", scenario(100.0)).write("slow.toml", scenario(1.0));
        work.ballbar(&["simulate", "test.toml", "--scenario", "fast.toml"]).done();
        let told = work.ballbar(&["identify", "results/test.toml", "--json"]).done().stdout();
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        let place = told["at_the_place"].as_array().unwrap();
        let reversal = place.iter().find(|at| at["quantity"] == "reversal X").unwrap();
        let [value_um, all_um] = ["value", "all"].map(|key| reversal[key].as_f64().unwrap());
        assert!((value_um - 40.0).abs() < 3.0 * all_um && all_um < 0.2, "{strategy} {reversal}");
        if strategy == "3d6" {
            std::fs::rename(work.path("results"), work.path("fast")).unwrap();
            work.ballbar(&["simulate", "test.toml", "--scenario", "slow.toml"]).done();
            std::fs::rename(work.path("results"), work.path("slow")).unwrap();
            let told = work.ballbar(&["identify", "slow/test.toml"]).refused(4);
            assert!(
                told.contains("hint: drive slower, log faster, or take a longer bar"),
                "{told}"
            );
        }
    }
}

/// Slides that follow unlike, in one direction on a short bar. Of 0.3 ms the few readings tell the servo mismatch; of 0.1 ms they are
/// too few to name it, and the residual with it and the one without are both printed. It is said why they differ.
#[test]
fn two_residuals_are_told_apart_where_nothing_is_found() {
    let plan =
        "[plan]\nstrategy = \"xy\"\nfeed_mm_min = [5000.0, 2500.0]\nboth_directions = false\n";
    let work = bench("vertical.toml", "[-284.0, -65.0, -174.0]", plan);
    let test = std::fs::read_to_string(work.path("test.toml")).unwrap();
    work.write("test.toml", test.replace("150.0", "50.0"));
    let told = |following_ms: &str, runs: &str| {
        let scenario = format!(
            "seed = 47\nsample_rate_hz = 1715.2\nresolution_um = 0.5\n\
             [noise]\nwhite_um = 0.1\ncorrelated_um = 0.3\ncorrelation_s = 1.0\n\
             [motion]\nfollowing_ms = {following_ms}\n"
        );
        work.write("unlike.toml", scenario);
        work.ballbar(&["simulate", "test.toml", "--scenario", "unlike.toml"]).done();
        std::fs::rename(work.path("results"), work.path(runs)).unwrap();
        let told = work.ballbar(&["analyse", &format!("{runs}/test.toml")]).done().stdout();
        std::fs::remove_dir_all(work.path("results")).unwrap();
        told.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let named = told("[21.7, 21.4, 21.2]", "apart");
    assert!(named.contains("Servo mismatch: following error of an axis, X: delay 0.30"), "{named}");
    let told = told("[21.7, 21.6, 21.5]", "near");
    let between = |before: &str, after: &str| {
        let rest = told.split_once(before).unwrap_or_else(|| panic!("{before}: {told}")).1;
        rest.split_once(after).unwrap().0
    };
    let number = |um: &str| um.parse::<f64>().unwrap();
    let fit_um = between("Residual ", " um rms over");
    let model_um =
        between("Nothing was found that the model does not explain. The residual is ", " um");
    assert!(number(model_um) > 3.0 * number(fit_um), "{model_um} {fit_um}");
    assert_eq!(between("The residual of ", " um rms counts a slide that follows later"), model_um);
    assert_eq!(between("The fit lets them follow unlike and leaves ", " um rms."), fit_um);
}

/// A loop that is slower by a tenth makes its circle smaller, and lets it turn corners later: neither is a scale.
#[test]
fn a_loop_that_is_tuned_unlike_is_no_scale() {
    let plan = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = [1000.0, 2000.0]\n";
    let work = bench("vertical.toml", "[20.0, -35.0, -300.0]", plan);
    work.write(
        "late.toml",
        "sample_rate_hz = 250\nresolution_um = 0.1\nseed = 4\n[noise]\nwhite_um = 0.05\ncorrelated_um = 0.0\n\
         [motion]\nfollowing_ms = [22, 20, 21]\n",
    );
    work.ballbar(&["program", "test.toml"]).done();
    work.ballbar(&["simulate", "test.toml", "--scenario", "late.toml"]).done();
    let told = work.ballbar(&["identify", "results/test.toml", "--json"]).done().stdout();
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    // Of 20 ms, five readings, the mean; and steps of 0.1 um.
    let left_um = told["repeats"][0]["residual_rms_um"].as_f64().unwrap();
    assert!(
        left_um < 1.05 * ((0.05_f64.powi(2) + 0.1_f64.powi(2) / 12.0) / 5.0).sqrt(),
        "{left_um}"
    );
    let truth: toml::Table =
        toml::from_str(&std::fs::read_to_string(work.path("results/truth.toml")).unwrap()).unwrap();
    for (quantity, key) in [
        ("scale X", "scale_X_um_m"),
        ("scale Y", "scale_Y_um_m"),
        ("reversal X", "reversal_X_um"),
        ("reversal Y", "reversal_Y_um"),
    ] {
        let asked = told["at_the_place"].as_array().unwrap();
        let of = asked.iter().find(|of| of["quantity"] == quantity).unwrap();
        let off = of["value"].as_f64().unwrap() - truth["at_the_place"][key].as_float().unwrap();
        assert!(off.abs() < 3.0 * of["all"].as_f64().unwrap(), "{off} of {of}");
    }
}

/// Slides that follow late turn round where the lag lets them, not where the program's chords meet: a mean of readings across
/// a reversal is explained as well as any other.
#[test]
fn noise_alone_makes_little_of_a_circle_where_slides_follow_late() {
    let plan = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 1600.0\nchord_sag_um = 1.0\n";
    let work = bench("vertical.toml", "[20.0, -35.0, -300.0]", plan);
    work.write(
        "late.toml",
        "sample_rate_hz = 1000\nresolution_um = 0.1\nseed = 4\n[noise]\nwhite_um = 0.1\ncorrelated_um = 0.0\n\
         [motion]\nfollowing_ms = [13, 13, 13]\n",
    );
    work.ballbar(&["simulate", "test.toml", "--scenario", "late.toml"]).done();
    work.ballbar(&["analyse", "results/test.toml"]).done();
    let analysis: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(work.path("results/analysis.json")).unwrap())
            .unwrap();
    let told = analysis["ranking"]["tests"][0]["unexplained_um"].as_f64().unwrap();
    let left_um = analysis["diagnosis"]["after_um"].as_f64().unwrap();
    // A mean of twenty readings, one of which may be taken for one of the other side.
    let truth: toml::Table =
        toml::from_str(&std::fs::read_to_string(work.path("results/truth.toml")).unwrap()).unwrap();
    let of_sense = truth["at_the_place"].as_table().unwrap().iter();
    let of_sense = of_sense.filter(|(key, _)| key.starts_with("reversal") || key.contains("play"));
    let largest_um = of_sense.map(|(_, um)| um.as_float().unwrap().abs()).fold(0.0, f64::max);
    assert!(told < 2.0 * largest_um / 20.0 + 12.0 * left_um, "{told} of {left_um}, {largest_um}");
}

/// A step that differs with the direction of the bar is no slip of the bar, though a plane says nothing of one across it.
#[test]
fn a_ball_that_is_knocked_in_one_plane_is_no_bar_that_slipped() {
    let plan = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 1550.0\novershoot_deg = 0.0\n";
    let work = bench("vertical.toml", "[20.0, -35.0, -300.0]", plan);
    let noise = "[noise]\nwhite_um = 0.1\ncorrelated_um = 0.2\n";
    work.write("fast.toml", format!("sample_rate_hz = 250.0\n{noise}"));
    for moment_s in [83, 86] {
        let knock = format!("repeated-step:on=EYt,step_um=-14,moment_s={moment_s}");
        let simulate =
            ["simulate", "test.toml", "--scenario", "fast.toml", "--seed", "2", "--hide"];
        work.ballbar(&[&simulate[..], &[&knock]].concat()).done();
        let told = work.ballbar(&["analyse", "results/test.toml"]).done().stdout();
        assert!(!told.contains("slipped"), "{told}");
        assert!(told.contains("Knock: a ball moved once, EYt"), "{told}");
    }
}

/// A circle in arcs tells times by its reversals alone: a spike that is over before readings take part again is in no number, and what
/// the bar reads there is told all the same.
#[test]
fn a_spike_within_what_is_kept_from_reversals_is_told() {
    let plan = "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 500.0\n";
    let work = bench("vertical.toml", "[20.0, -35.0, -300.0]", plan);
    let noise = "[noise]\nwhite_um = 0.3\ncorrelated_um = 0.2\n";
    work.write("fast.toml", format!("sample_rate_hz = 250.0\n{noise}"));
    let simulate = ["simulate", "test.toml", "--scenario", "fast.toml", "--seed", "2"];
    let spike = ["--hide", "reversal-spike:on=Y,amplitude_um=-11,decay_ms=20"];
    let sentence = "where Y turns round the bar reads";
    for (hidden, told) in [(&spike[..], true), (&[], false)] {
        work.ballbar(&[&simulate[..], hidden].concat()).done();
        let text = work.ballbar(&["analyse", "results/test.toml"]).done().stdout();
        assert_eq!(text.contains(sentence), told, "{text}");
        assert!(!text.contains("where X turns round"), "{text}");
        // It is not said to be none on the same page.
        assert_eq!(text.contains("reversal spikes of Y"), !told, "{text}");
        assert!(text.contains("Not found: reversal spikes of X"), "{text}");
    }
}
