//! Whether the uncertainties that are stated are the errors that are made: many simulated repeats, each
//! aligned and identified as a user would, each with the truth beside it. Those over hundreds are long: `cargo test
//! --release -- --ignored` runs them.
//!
//! Every ratio `(estimate - truth) / stated sigma` should scatter with a standard deviation of 1. Over
//! 200 repeats its rms is uncertain by 5 %, over 40 by 11 %.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use std::path::{Path, PathBuf};

use ballbar::design::PlannedProgram;
use ballbar::identify::{self, Campaign, Failure, Identification, Options, RunInput};
use ballbar::machine::{Machine, Mounting};
use ballbar::model::{self, Coefficient, Model, SetUp};
use ballbar::nc::{self, Program};
use ballbar::plan::{BallBar, Test};
use ballbar::simulate::{self, Noise, Pauses, Scenario, SimulatedRun};
use ballbar::{align, log};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// A test file, its machine and its program.
struct Bench {
    test: Test,
    machine: Machine,
    mounting: Mounting,
    program: Program,
}

impl Bench {
    fn new(set: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(set);
        let test = Test::read(&root.join("test.toml")).unwrap();
        let machine = test.machine().unwrap();
        let named = &test.mountings()[0];
        let mut reading = nc::Reading::default();
        reading.work_offsets_mm.insert(named.work_offset, named.mounting.coincidence_mm);
        let program = nc::read_file(&test.runs().unwrap()[0].program, &reading).unwrap();
        Self { mounting: named.mounting, machine, program, test }
    }

    fn bar(&self) -> &BallBar {
        self.test.ball_bar()
    }

    /// Simulates a run, writes its log, reads it, and goes the way of every log.
    fn repeat(&self, scenario: &Scenario) -> ballbar::Result<(SimulatedRun, Identification)> {
        let (machine, mounting, program) = (&self.machine, &self.mounting, &self.program);
        let run = simulate::run(machine, mounting, program, self.bar(), scenario).unwrap();
        let name = PathBuf::from("run1.csv");
        let log =
            log::read_bytes(run.csv().as_bytes(), &name, &self.test.log_format_of(0)).unwrap();
        let rig = align::Rig { machine, mounting, bar: self.bar() };
        let alignment = align::align(&align::Run {
            log: &log,
            program,
            rig,
            feed_override: 1.0,
            driven: None,
        })?;
        let terms = model::terms(&["observable35".to_owned()], &["A".to_owned()]).unwrap();
        let model = Model::new(machine, vec![*mounting], terms);
        let options = Options::of(&self.test);
        let input = RunInput::new("run1".to_owned(), 0, self.bar().length_mm, alignment);
        Ok((run, identify::identify(&model, vec![input], &options)?))
    }
}

/// Another machine of the same kind, another operator and another start for every seed.
fn drawn(seed: u64) -> Scenario {
    let mut scenario = Scenario::default().with_seed(seed);
    let mut random = Pcg64Mcg::seed_from_u64(1000 + seed);
    let normal = |random: &mut Pcg64Mcg| -> f64 { StandardNormal.sample(random) };
    for coefficient in Coefficient::all() {
        let value = scenario.errors.get(coefficient);
        scenario.errors.set(coefficient, value * (1.0 + 0.3 * normal(&mut random)));
    }
    for set_up in SetUp::all().skip(3) {
        scenario.set_set_up(set_up, 10e-3 * normal(&mut random));
    }
    scenario.noise = Noise { white_mm: 0.12e-3, correlated_mm: 0.10e-3, correlation_s: 0.3 };
    scenario.start_s = between(&mut random, 1.0, 30.0);
    scenario.clock_ppm = between(&mut random, -80.0, 80.0);
    scenario.pauses = Pauses::Between([5.0, 40.0]);
    scenario
}

fn between(random: &mut impl Rng, low: f64, high: f64) -> f64 {
    Uniform::new(low, high).unwrap().sample(random)
}

/// Ratios of error to stated sigma: of every parameter, and of the program time at every arc's start.
struct Ratios {
    parameters: Vec<f64>,
    /// With the error itself, s.
    starts: Vec<(f64, f64)>,
}

fn ratios(bench: &Bench, scenario: &Scenario) -> ballbar::Result<Ratios> {
    let (run, found) = bench.repeat(scenario)?;
    let truth = run.scenario.named_values();
    let true_value = |name: &str| truth.iter().find(|(n, _)| n == name).map_or(0.0, |(_, v)| *v);
    let parameters = found
        .estimates
        .iter()
        .map(|e| (e.value - true_value(&e.parameter.name)) / e.sigma)
        .collect();
    let alignment = &found.runs[0].alignment;
    let map = &alignment.time_map;
    let starts = alignment
        .sections
        .iter()
        .filter(|section| !section.transit)
        .map(|section| {
            let leg = map.leg_of(section.start_s + 1e-6);
            let log_s = run.clock.log_time_s(section.start_s, map.pauses_before(leg));
            let error_s = map.on_leg_s(log_s, leg) - section.start_s;
            (error_s / map.sigma_s(log_s, leg), error_s)
        })
        .collect();
    Ok(Ratios { parameters, starts })
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

fn all_repeats(bench: &Bench, count: u64) -> Vec<Ratios> {
    // Collected in the order of the seeds: the sums below do not depend on who was ready first.
    (1..=count)
        .into_par_iter()
        .map(|seed| match ratios(bench, &drawn(seed)) {
            Ok(ratios) => ratios,
            Err(error) => panic!("seed {seed}: {error}"),
        })
        .collect()
}

/// Rms of error over stated sigma at the start of each arc, told one by one.
fn starts(repeats: &[Ratios]) -> Vec<f64> {
    (0..repeats[0].starts.len())
        .map(|arc| {
            let ratio = rms(repeats.iter().map(|r| r.starts[arc].0));
            let error_s = rms(repeats.iter().map(|r| r.starts[arc].1));
            println!("start of arc {arc}: {:.3} ms, {ratio:.3} sigma", error_s * 1e3);
            ratio
        })
        .collect()
}

/// A few repeats tell whether all sigmas are too large or too small, by 456 ratios; the next test tells each.
#[test]
fn the_stated_sigma_is_honest_in_the_mean() {
    let repeats = all_repeats(&Bench::new("hu40t"), 12);
    let all = rms(repeats.iter().flat_map(|r| r.parameters.iter().copied()));
    let starts = rms(repeats.iter().flat_map(|r| r.starts.iter().map(|(ratio, _)| *ratio)));
    println!("parameters {all:.3}, starts {starts:.3}");
    assert!((0.9..1.1).contains(&all), "{all}");
    assert!((0.7..1.3).contains(&starts), "{starts}");
}

#[test]
#[ignore = "long: `cargo test --release -- --ignored` runs it, and .ci/run does"]
fn the_stated_sigma_is_honest() {
    let bench = Bench::new("hu40t");
    let repeats = all_repeats(&bench, 200);
    let names: Vec<String> = model::terms(&["observable35".to_owned()], &["A".to_owned()])
        .unwrap()
        .iter()
        .flat_map(|term| term.parameters())
        .map(|parameter| parameter.name)
        .collect();
    let mut honesty: Vec<(f64, &str)> = names
        .iter()
        .enumerate()
        .map(|(k, name)| (rms(repeats.iter().map(|r| r.parameters[k])), name.as_str()))
        .collect();
    honesty.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (ratio, name) in &honesty {
        println!("{name} {ratio:.3}");
    }
    println!("all {:.3}", rms(repeats.iter().flat_map(|r| r.parameters.iter().copied())));
    let (low, high) = (honesty[0], honesty[honesty.len() - 1]);
    assert!(low.0 > 0.93 && high.0 < 1.17, "lowest {low:?}, highest {high:?}");
    let starts = starts(&repeats);
    // Each arc has a time of its own: 200 of them tell a ratio to 5 %, three times that is chance.
    assert!(starts.iter().all(|ratio| (0.85..1.15).contains(ratio)), "{starts:?}");
}

#[test]
#[ignore = "long: `cargo test --release -- --ignored` runs it, and .ci/run does"]
fn the_stated_sigma_of_the_time_map_is_honest_over_pauses() {
    let bench = Bench::new("hu40t-stops");
    let repeats = all_repeats(&bench, 40);
    let starts = starts(&repeats);
    // A pause that is taken for motion, or a facet missed, is hundreds of sigmas.
    assert!(starts.iter().all(|ratio| (0.6..1.2).contains(ratio)), "{starts:?}");
    let all = rms(repeats.iter().flat_map(|r| r.parameters.iter().copied()));
    println!("all parameters {all:.3}");
    assert!((0.95..1.05).contains(&all), "{all}");
}

/// Scatter of the estimates over simulated tests over the sigma that was foretold before any was run, for
/// every parameter, sorted; over `count` tests, or as many as `BALLBAR_SIMULATIONS` asks for.
///
/// A ratio over `n` tests is uncertain by `1 / sqrt(2 n)`, 4 % for 300: of sixty ratios one or another is
/// off by 10 % by chance. docs/measured.md has the ratios over 2000.
fn scatter_over_foretold(file: &str, scenario: &Scenario, count: usize) -> Vec<(f64, String)> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(file);
    let test = Test::read(&file).unwrap();
    let machine = test.machine().unwrap();
    let places: Vec<(String, Mounting)> =
        test.mountings().iter().map(|m| (m.name.clone(), m.mounting)).collect();
    let names: Vec<String> = places.iter().map(|(name, _)| name.clone()).collect();
    let balls: Vec<Mounting> = places.iter().map(|(_, mounting)| *mounting).collect();
    let programs: Vec<PlannedProgram> = (0..names.len())
        .map(|mounting| PlannedProgram::new(&test, &machine, mounting).unwrap())
        .collect();
    let bar = |mounting: usize| {
        let mut bar = test.bar_of(mounting);
        bar.noise_mm = scenario.noise.sigma_mm();
        bar.correlated_mm = scenario.noise.correlated_mm;
        bar.correlation_s = scenario.noise.correlation_s;
        bar
    };
    let rehearsed = programs
        .iter()
        .map(|p| {
            let named = &test.mountings()[p.mounting];
            identify::rehearse(&p.program, &machine, &bar(p.mounting), p.mounting, named).unwrap()
        })
        .collect();
    let options = Options { noise_mm: bar(0).noise_mm, ..Options::of(&test) };
    let (terms, rehearsed) =
        identify::explicit_terms(&test.estimation().terms, &machine, &places, rehearsed, &options)
            .unwrap();
    let model = || Model::new(&machine, balls.clone(), model::terms(&terms, &names).unwrap());
    let noise = identify::stated_noise(&bar(0));
    let foretold = identify::predict(&model(), rehearsed, &options, &noise).unwrap();
    let count: usize = std::env::var("BALLBAR_SIMULATIONS").map_or(count, |n| n.parse().unwrap());
    let estimates: Vec<Vec<f64>> = (0..count as u64)
        .into_par_iter()
        .map(|repeat| {
            let inputs = programs
                .iter()
                .map(|p| {
                    let seed = 1 + repeat * programs.len() as u64 + p.mounting as u64;
                    let (bar, mounting) = (bar(p.mounting), &balls[p.mounting]);
                    let scenario = scenario.clone().with_seed(seed);
                    let run =
                        simulate::run(&machine, mounting, &p.program, &bar, &scenario).unwrap();
                    let format = test.log_format_of(p.mounting);
                    let log = log::read_bytes(run.csv().as_bytes(), Path::new("run.csv"), &format)
                        .unwrap();
                    let rig = align::Rig { machine: &machine, mounting, bar: &bar };
                    let program = &p.program;
                    let aligned =
                        align::Run { log: &log, program, rig, feed_override: 1.0, driven: None };
                    let alignment = align::align(&aligned).unwrap();
                    let name = names[p.mounting].clone();
                    RunInput::new(name, p.mounting, bar.length_mm, alignment)
                })
                .collect();
            identify::identify(&model(), inputs, &options).unwrap().values()
        })
        .collect();
    let mut ratios: Vec<(f64, String)> = foretold
        .parameters
        .iter()
        .enumerate()
        .map(|(k, parameter)| {
            let mean = estimates.iter().map(|e| e[k]).sum::<f64>() / count as f64;
            let squares: f64 = estimates.iter().map(|e| (e[k] - mean).powi(2)).sum();
            let deviation = (squares / (count - 1) as f64).sqrt();
            (deviation / foretold.sigmas[k], parameter.name.clone())
        })
        .collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (ratio, name) in &ratios {
        println!("{name} {ratio:.3}");
    }
    println!("all {:.4}", rms(ratios.iter().map(|(ratio, _)| *ratio)));
    ratios
}

#[test]
#[ignore = "long: `cargo test --release -- --ignored` runs it, and .ci/run does"]
fn the_foretold_sigma_is_the_scatter_of_simulated_tests() {
    let ratios = scatter_over_foretold("hu40t/test.toml", &drawn(1), 300);
    assert_eq!(ratios.len(), 38);
    let (low, high) = (&ratios[0], &ratios[ratios.len() - 1]);
    assert!(low.0 > 0.9 && high.0 < 1.1, "{low:?} to {high:?}");
}

/// Three mountings that `ballbar design` chose: every coefficient that the volume needs.
#[test]
#[ignore = "long: `cargo test --release -- --ignored` runs it, and .ci/run does"]
fn the_foretold_sigma_of_a_designed_test_is_the_scatter_of_simulated_tests() {
    // At the corners of the travel the machine errs by more than the bar reaches: the operator brings the
    // balls together there.
    let scenario = Scenario { coincidence: simulate::Coincidence::Touched, ..drawn(1) };
    let ratios = scatter_over_foretold("designed/test.toml", &scenario, 60);
    assert_eq!(ratios.len(), 53 + 9);
    // 60 tests tell each ratio to 9 %, and their mean square to some 3 %.
    let (low, high) = (&ratios[0], &ratios[ratios.len() - 1]);
    assert!(low.0 > 0.7 && high.0 < 1.3, "{low:?} to {high:?}");
    let all = rms(ratios.iter().map(|(ratio, _)| *ratio));
    assert!((0.91..1.09).contains(&all), "{all}");
}

/// On logs that this code did not make: with the noise stated as they show it, the rehearsal of the test
/// foretells what the fit of each log then states.
#[test]
fn the_foretold_sigma_is_what_measured_logs_state() {
    let bench = Bench::new("hu40t");
    let measured =
        Campaign::of(&bench.test, &bench.machine, Failure::Refuse, &|| ()).unwrap().repeats;
    // As docs/guide.md says.
    let noise = &measured[0].noise;
    let rho = noise.autocorrelation(3);
    let mut bar = bench.bar().clone();
    bar.noise_mm = noise.sigma();
    bar.correlated_mm = noise.sigma() * rho[1] / rho[2].sqrt();
    bar.correlation_s = -bar.sample_rate_hz.recip() / (rho[2] / rho[1]).ln();
    // The steps of the reading are in the noise that was found.
    bar.resolution_mm = 1e-9;
    let named = &bench.test.mountings()[0];
    let run = identify::rehearse(&bench.program, &bench.machine, &bar, 0, named).unwrap();
    let terms = model::terms(&bench.test.estimation().terms, &["A".to_owned()]).unwrap();
    let model = Model::new(&bench.machine, vec![bench.mounting], terms);
    let options = Options { noise_mm: bar.noise_mm, ..Options::of(&bench.test) };
    let noise = identify::stated_noise(&bar);
    let foretold = identify::predict(&model, vec![run], &options, &noise).unwrap();
    assert_eq!((measured.len(), foretold.sigmas.len()), (5, 38));
    let mut ratios: Vec<f64> = measured
        .iter()
        .flat_map(|repeat| repeat.estimates.iter().zip(&foretold.sigmas))
        .map(|(estimate, sigma)| estimate.sigma / sigma)
        .collect();
    ratios.sort_by(f64::total_cmp);
    println!("{:.3} to {:.3}, all {:.3}", ratios[0], ratios[189], rms(ratios.iter().copied()));
    assert!(ratios[0] > 0.9 && ratios[189] < 1.1, "{} to {}", ratios[0], ratios[189]);
}
