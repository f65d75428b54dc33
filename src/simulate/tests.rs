use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::*;
use crate::log;
use crate::machine::{Machine, Mounting};
use crate::model::{Coefficient, SetUp};
use crate::motion::{BlockKind, Trajectory};
use crate::nc::{self, Action, Program};
use crate::plan::BallBar;

struct Bench {
    machine: Machine,
    mounting: Mounting,
    program: Program,
    bar: BallBar,
}

/// A quarter of the equator and back; the bar is fitted at an M00 out of range, and there is another
/// M00 between the two ways.
fn bench() -> Bench {
    let mut source = String::from(
        "%\nO1 (T)\nG21 G17 G90 G94\nG54\nG00 X171.5 Y0. Z0.\nG00 X171. Y0. Z0.\nM00\nG01 X150. F500.\nG04 P2000\n",
    );
    let point = |k: i32| {
        let (sin, cos) = f64::from(k).to_radians().sin_cos();
        format!("G01 X{:.3} Y{:.3}\n", 150.0 * cos, 150.0 * sin)
    };
    source.extend((1..=90).map(point));
    source.push_str("M00\n");
    source.extend((0..90).rev().map(point));
    source.push_str("G04 P2000\nG01 X171.5\nM30\n%\n");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let machine = Machine::read(&root.join("machines/hu40t.toml")).unwrap();
    let mounting = Mounting {
        coincidence_mm: Vector3::new(20.0, -35.0, 40.0),
        tool_ball_mm: Vector3::new(0.0, 0.0, -200.0),
    };
    let mut reading = nc::Reading::default();
    reading.work_offsets_mm.insert(54, mounting.coincidence_mm);
    let program = nc::read(&source, Path::new("T.nc"), &reading).unwrap();
    let bar = BallBar {
        length_mm: 150.0,
        range_mm: 1.2,
        resolution_mm: 1e-4,
        noise_mm: 1.5e-4,
        correlated_mm: 0.0,
        correlation_s: 0.3,
        sample_rate_hz: 10.0,
        clock_tolerance: 1e-4,
        length_sigma_mm: None,
        scale_sigma: 0.002,
    };
    Bench { machine, mounting, program, bar }
}

impl Bench {
    fn run(&self, scenario: &Scenario) -> SimulatedRun {
        run(&self.machine, &self.mounting, &self.program, &self.bar, scenario).unwrap()
    }
}

fn fixed(mut scenario: Scenario) -> Scenario {
    scenario.pauses = Pauses::Fixed(vec![7.0, 11.0]);
    scenario
}

#[test]
fn a_perfect_machine_reads_the_commanded_length() {
    let bench = bench();
    let run = bench.run(&Scenario::perfect());
    let mut in_range = 0;
    for ((_, deviation_mm), truth) in run.readings.iter().zip(&run.truth) {
        let commanded = truth.state.position_mm - bench.mounting.coincidence_mm;
        let expected_mm = commanded.norm() - bench.bar.length_mm;
        match deviation_mm {
            Some(mm) => {
                assert!((mm - expected_mm).abs() < 0.5001e-4);
                in_range += 1;
            }
            None => assert!(expected_mm.abs() > bench.bar.range_mm - 1e-4),
        }
    }
    assert!(in_range > 500, "{in_range}");
}

#[test]
fn a_set_up_error_shows_as_its_projection() {
    let bench = bench();
    for (name, sign) in [("EXt", 1.0), ("EYt", 1.0), ("EZt", 1.0), ("EXw", -1.0), ("EYw", -1.0)] {
        let set_up = SetUp::parse(name).unwrap();
        let mut scenario = Scenario::perfect();
        scenario.set_set_up(set_up, 0.01);
        assert_eq!(scenario.named_values(), [(name.to_owned(), 0.01)]);
        let (clean, bent) = (bench.run(&Scenario::perfect()), bench.run(&scenario));
        for (clean, bent) in clean.truth.iter().zip(&bent.truth) {
            let ball = clean.state.position_mm - bench.mounting.coincidence_mm;
            let projected = sign * 0.01 * ball.normalize()[set_up.axis.index()];
            // What is left is of second order: 0.01² / (2 · 150) mm.
            assert!((bent.exact_mm - clean.exact_mm - projected).abs() < 4e-7, "{name}");
        }
    }
}

#[test]
fn a_hysteresis_keeps_its_sign_while_the_machine_stands() {
    let bench = bench();
    let mut scenario = fixed(Scenario::perfect());
    scenario.errors.set(Coefficient::parse("EYYb").unwrap(), 1e-3);
    let (clean, bent) = (bench.run(&fixed(Scenario::perfect())), bench.run(&scenario));
    // In the pause between the ways the Y slide still leans the way it came, upwards at the end of
    // the quarter, where the bar points along Y.
    let mut paused = 0;
    for (clean, bent) in clean.truth.iter().zip(&bent.truth) {
        if clean.moment.in_pause && clean.moment.leg == 1 {
            assert!((bent.exact_mm - clean.exact_mm - 1e-3).abs() < 1e-8);
            paused += 1;
        }
    }
    assert_eq!(paused, 110);
}

#[test]
fn noise_has_its_sigma_and_its_correlation() {
    let noise = Noise { white_mm: 0.12e-3, correlated_mm: 0.10e-3, correlation_s: 0.3 };
    let count = 400_000_usize;
    let mut source = super::noise::NoiseSource::new(noise, 0.1, 5);
    let n: Vec<f64> = (0..count).map(|_| source.next_mm()).collect();
    let mean = n.iter().sum::<f64>() / count as f64;
    let covariance = |lag: usize| {
        n[lag..].iter().zip(&n).map(|(a, b)| a * b).sum::<f64>() / (count - lag) as f64
    };
    // Standard errors here: 4e-7 of the mean, some 5e-11 of a covariance.
    assert!(mean.abs() < 2e-6, "{mean}");
    assert!((covariance(0) - noise.sigma_mm().powi(2)).abs() < 2e-10, "{}", covariance(0));
    for lag in [1, 3, 10] {
        let expected = 1e-8 * (-0.1 * lag as f64 / 0.3).exp();
        assert!((covariance(lag) - expected).abs() < 2e-10, "{lag}: {}", covariance(lag));
    }
    // The first sample is as noisy as all others.
    let first: f64 = (0..4000)
        .map(|seed| super::noise::NoiseSource::new(noise, 0.1, seed).next_mm().powi(2))
        .sum::<f64>()
        / 4000.0;
    assert!((first / noise.sigma_mm().powi(2) - 1.0).abs() < 0.1, "{first}");
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let bench = bench();
    let dropouts = Some(Dropouts { per_s: 0.05, mean_s: 1.0, missing_rows: true });
    let mut scenario = Scenario { dropouts, ..Scenario::default() };
    let once = bench.run(&scenario);
    assert_eq!(once, bench.run(&scenario));
    let other = bench.run(&scenario.clone().with_seed(2));
    assert_ne!(once.clock, other.clock);
    assert_ne!(once.readings, other.readings);
    // Streams do not touch each other: without dropouts the rows that are left are the same.
    scenario.dropouts = None;
    let whole = bench.run(&scenario);
    assert!(once.readings.len() < whole.readings.len());
    assert!(once.readings.iter().all(|row| whole.readings.contains(row)));
}

#[test]
fn program_time_follows_the_convention() {
    let bench = bench();
    let mut scenario = fixed(Scenario::perfect());
    scenario.start_s = 12.5;
    scenario.clock_ppm = 80.0;
    let run = bench.run(&scenario);
    let stops = run.clock.stops_s();
    assert_eq!(stops.len(), 2);
    for ((time_s, _), truth) in run.readings.iter().zip(&run.truth) {
        let machine_s = time_s * (1.0 + 80e-6) - 12.5;
        let passed = [7.0, 11.0].iter().take(truth.moment.leg).sum::<f64>();
        if truth.moment.in_pause {
            let stop = stops[truth.moment.leg];
            assert_eq!(truth.moment.program_s.to_bits(), stop.to_bits());
            assert!(machine_s - passed >= stop - 1e-9);
        } else {
            assert!((truth.moment.program_s - (machine_s - passed)).abs() < 1e-9);
            let back = run.clock.log_time_s(truth.moment.program_s, truth.moment.leg);
            assert!((back - time_s).abs() < 1e-9);
        }
    }
}

#[test]
fn pauses_lengthen_the_log_and_the_bar_reads_on() {
    let bench = bench();
    let short = bench.run(&fixed(Scenario::perfect()));
    let mut scenario = Scenario::perfect();
    scenario.pauses = Pauses::Fixed(vec![7.0, 31.0]);
    let long = bench.run(&scenario);
    assert_eq!(long.readings.len() - short.readings.len(), 200);
    let in_range = |run: &SimulatedRun| run.readings.iter().filter(|r| r.1.is_some()).count();
    assert_eq!(in_range(&long) - in_range(&short), 200, "the second M00 is on the sphere");
    let drawn = bench.run(&Scenario::perfect()).clock.pauses_s;
    assert!(
        drawn.iter().all(|s| (5.0..40.0).contains(s)) && drawn[0].to_bits() != drawn[1].to_bits()
    );
    let error = run(
        &bench.machine,
        &bench.mounting,
        &bench.program,
        &bench.bar,
        &Scenario { pauses: Pauses::Fixed(vec![1.0]), ..Scenario::perfect() },
    )
    .unwrap_err();
    assert!(error.what.contains("1 pause(s), the program has 2 M00"), "{error}");
}

#[test]
fn beyond_the_range_the_log_is_blank() {
    let bench = bench();
    let mut scenario = fixed(Scenario::default());
    scenario.sample_rate_hz = Some(200.0);
    scenario.range_mm = Some(1.0);
    let run = bench.run(&scenario);
    let (first, last) = (run.readings.first().unwrap(), run.readings.last().unwrap());
    assert!(first.1.is_none() && last.1.is_none());
    let largest = run.readings.iter().filter_map(|r| r.1).fold(0.0, f64::max);
    assert!(largest <= 1.0 && largest > 0.95, "{largest}");
    for ((_, deviation_mm), truth) in run.readings.iter().zip(&run.truth) {
        assert_eq!(deviation_mm.is_some(), truth.exact_mm < 1.0, "no sample is that near the edge");
    }
}

#[test]
fn dropouts_are_as_frequent_and_as_long_as_stated() {
    let bench = bench();
    let mut scenario = fixed(Scenario::perfect());
    scenario.after_s = 20_000.0;
    scenario.range_mm = Some(100.0);
    scenario.dropouts = Some(Dropouts { per_s: 0.05, mean_s: 2.0, missing_rows: false });
    let run = bench.run(&scenario);
    let lost: Vec<bool> = run.readings.iter().map(|r| r.1.is_none()).collect();
    let share = lost.iter().filter(|l| **l).count() as f64 / lost.len() as f64;
    // A cycle lasts 20 s + 2 s; some 900 of them.
    assert!((share / (2.0 / 22.0) - 1.0).abs() < 0.15, "{share}");
    scenario.dropouts = Some(Dropouts { per_s: 0.05, mean_s: 2.0, missing_rows: true });
    let missing = bench.run(&scenario);
    assert_eq!(missing.readings.len(), lost.iter().filter(|l| !**l).count());
}

#[test]
fn the_log_reads_back() {
    let bench = bench();
    for (resolution_mm, rate_hz) in [(1e-4, 10.0), (1e-3, 30.0), (2.5e-5, 1000.0)] {
        let mut scenario = fixed(Scenario::default());
        scenario.resolution_mm = Some(resolution_mm);
        scenario.sample_rate_hz = Some(rate_hz);
        let run = bench.run(&scenario);
        let log = log::read_bytes(
            run.csv().as_bytes(),
            &PathBuf::from("run1.csv"),
            &log::Format::default(),
        )
        .unwrap();
        let read: Vec<(f64, Option<f64>)> =
            log.readings().iter().map(|r| (r.time_s, r.deviation_mm)).collect();
        assert_eq!(read, run.readings, "bit by bit");
    }
}

#[test]
fn the_truth_is_toml_and_complete() {
    let bench = bench();
    let run = bench.run(&fixed(Scenario::default()));
    let text = truth_toml(&[TrueRun { log: "run1.csv", program: "T.nc", run: &run }], &[]);
    let table: toml::Table = toml::from_str(&text).unwrap();
    let entry = table["run"][0].as_table().unwrap();
    assert_eq!(entry["pauses_s"].as_array().unwrap()[1].as_float(), Some(11.0));
    assert_eq!(entry["start_s"].as_float(), Some(3.0));
    assert_eq!(entry["clock_ppm"].as_float(), Some(-30.0));
    assert_eq!(entry["feed_mm_min"].as_integer(), Some(500));
    let coefficients = entry["coefficients"].as_table().unwrap();
    assert_eq!(coefficients.len(), 38, "every name of the built-in machine is known");
    assert_eq!(coefficients["EAZ3"].as_float(), Some(1.2e-11));
}

#[test]
fn a_low_override_lengthens_the_log() {
    let bench = bench();
    let mut scenario = fixed(Scenario::perfect());
    scenario.feed_override = 0.8;
    let slow = bench.run(&scenario);
    let trajectory = Trajectory::new(&bench.program, &bench.machine, 0.8);
    assert!(trajectory.blocks().iter().any(|block| block.kind == BlockKind::Feed));
    let end_s = trajectory.end_s() + 18.0 + 3.0 + 5.0;
    assert!((slow.readings.last().unwrap().0 - end_s).abs() < 0.2);
}

#[test]
fn a_scenario_file_is_checked() {
    let parse = |text: &str| Scenario::parse(text, Path::new("s.toml"));
    assert_eq!(parse("").unwrap(), Scenario::default());
    let crowd = "[[hide]]\ncause = \"drift\"\non = \"EZt\"\n".repeat(101);
    let error = parse(&crowd).unwrap_err();
    assert!(error.what.contains("101 hidden effects, and 100 are the most"), "{}", error.what);
    assert_eq!(error.place.map(|place| place.line), Some(301));
    let full = parse(
        "seed = 9\nsample_rate_hz = 50\nresolution_um = 1\nrange_mm = 2.0\nafter_s = 1\n\
         feed_override_percent = 90\n[coefficients]\nEXX1 = 1e-5\n[set_up]\nEZw = 0.5\n\
         [noise]\nwhite_um = 0\ncorrelated_um = 2\ncorrelation_s = 1\n[clock]\nstart_s = 300\nppm = 100\n\
         [pauses]\nfixed_s = [0.5]\n[dropouts]\nper_s = 0.05\nmean_s = 1\nrows = \"missing\"\n",
    )
    .unwrap();
    assert_eq!(full.named_values(), [("EXX1".to_owned(), 1e-5), ("EZw".to_owned(), 0.5)]);
    assert_eq!(full.pauses, Pauses::Fixed(vec![0.5]));
    assert!(full.dropouts.unwrap().missing_rows);
    assert!((full.noise.sigma_mm() - 2e-3).abs() < 1e-15);
    for (text, line, part) in [
        ("[coefficients]\nEXX1 = 1.0\nEXX9 = 1.0\n", 3, "unknown name `EXX9`"),
        ("[coefficients]\nEXt = 1.0\n", 2, "[set_up]"),
        ("[set_up]\nEXX1 = 1.0\n", 2, "[coefficients]"),
        ("[set_up]\nEAt = 1.0\n", 2, "`EXw`, `EYw`"),
        ("[coefficients]\nEXX1 = nan\n", 2, "between -1000 and 1000"),
        ("[noise]\nwhite_mm = 1.0\n", 2, "write `white_um`"),
        ("[noise]\nwhite_um = -1.0\n", 2, "between 0 and 1000"),
        ("seed = 1\nnoise_um = 1.0\n", 2, "unknown field `noise_um`"),
        ("[pauses]\nbetween_s = [9, 5]\n", 2, "shorter one first"),
        ("[pauses]\n", 1, "either"),
        ("[dropouts]\nper_s = 0\nmean_s = 1\n", 2, "must lie between"),
    ] {
        let error = parse(text).unwrap_err();
        assert_eq!(error.place.as_ref().unwrap().line, line, "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
}

/// A slide that follows by the first order lags by its time constant times its speed, and catches up where it stands.
#[test]
fn a_slide_that_follows_late_lags_by_its_speed() {
    let bench = bench();
    let following_s = 0.02;
    let mut late = fixed(Scenario::perfect());
    late.control.following_s = Vector3::repeat(following_s);
    let (on_time, late) = (bench.run(&fixed(Scenario::perfect())), bench.run(&late));
    let mut ramps = 0;
    for (now, then) in on_time.truth.iter().zip(&late.truth) {
        let lag_mm = then.exact_mm - now.exact_mm;
        let speed_mm_s = now.state.velocity_mm_s.norm();
        let block = now.state.block;
        let trajectory = Trajectory::new(&bench.program, &bench.machine, 1.0);
        let along = &trajectory.blocks()[block];
        let into_s = now.moment.program_s - along.start_s;
        // On the feed-in from 171 to 150 mm: well after it began and before it ends.
        let radial = along.kind == BlockKind::Feed && along.duration_s > 1.0;
        if radial && (0.3..along.duration_s - 0.3).contains(&into_s) && speed_mm_s > 8.0 {
            assert!((lag_mm.abs() - following_s * speed_mm_s).abs() < 1e-4, "{lag_mm}");
            ramps += 1;
        }
    }
    assert!(ramps > 5, "{ramps}");
}

/// What is drawn is the same for a seed, another machine for another, and nowhere beyond two deviations.
#[test]
fn a_machine_is_drawn_from_what_is_plausible() {
    let bench = bench();
    let drawn =
        |seed: u64| PlaceErrors::drawn(&bench.machine, &[bench.mounting], 100.0, seed).unwrap();
    assert_eq!(drawn(3), drawn(3));
    assert_ne!(drawn(3), drawn(4));
    let plausible = bench.machine.plausible();
    let mut squares = 0.0;
    for seed in 0..50 {
        for (local, (_, value)) in crate::model::Local::all().zip(drawn(seed).named_values()) {
            let share = value / local.plausible(plausible, 100.0);
            assert!(share.abs() <= 2.0, "{local}: {share}");
            squares += share * share;
        }
    }
    // A normal variable within two deviations has the variance 0.774.
    assert!((squares / (50.0 * 72.0) - 0.774).abs() < 0.05, "{squares}");
}

/// Two operator's stops come before the first move, as in every program that begins with a retraction.
#[test]
fn longer_standstills_stand_where_the_program_does() {
    let bench = bench();
    let mut program = bench.program.clone();
    let stop = *program.steps.iter().find(|step| step.action == Action::Stop).unwrap();
    program.steps.splice(0..0, [stop, stop]);
    let control = Control { standing_s: [0.01, 0.02], ..Control::AS_PLANNED };
    let [planned, longer] = [Control::AS_PLANNED, control]
        .map(|control| control.trajectory(&program, &bench.machine, 1.0, 3).unwrap());
    let stands = |kind: BlockKind| matches!(kind, BlockKind::Dwell | BlockKind::Stop);
    let moves = |of: &Trajectory| -> Vec<(usize, bool)> {
        let moves = of.blocks().iter().filter(|block| !stands(block.kind));
        moves.map(|block| (block.line, block.ends_at_rest())).collect()
    };
    assert_eq!(moves(&longer), moves(&planned));
    let stops = |of: &Trajectory| of.blocks().iter().filter(|b| b.kind == BlockKind::Stop).count();
    assert_eq!(stops(&longer), stops(&planned));
    let dwells = |of: &Trajectory| of.duration().dwell_s;
    let rests =
        longer.blocks().iter().filter(|block| block.kind == BlockKind::Dwell).count() as f64;
    let more_s = dwells(&longer) - dwells(&planned);
    assert!(more_s > 0.01 * rests && more_s < 0.02 * rests, "{more_s} s in {rests}");
}
