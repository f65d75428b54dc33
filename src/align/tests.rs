//! Truth put in, truth got back: logs of the virtual machine, whose clock is known, laid over their programs.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

mod chords;
mod clipped;
mod dropouts;

use super::engagement::expected;
use super::section::sections;
use super::*;
use crate::error::{Kind, Result};
use crate::log::{self, Log};
use crate::machine::{Machine, Mounting};
use crate::model::Coefficient;
use crate::motion::Trajectory;
use crate::nc::{self, Program};
use crate::plan::{self, BallBar, Test};
use crate::simulate::{self, Pauses, Scenario, SimulatedRun};

/// The equator both ways, and half a meridian.
const ARCS: &str = "[[plan.arc]]\nkind = \"equator\"\n\n\
    [[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = 36.0\nsweep_deg = 180.0\n";

/// A machine, a bar and a program to try things on.
struct Bench {
    machine: Machine,
    mounting: Mounting,
    bar: BallBar,
    program: Program,
}

impl Bench {
    /// With what stands in `[plan]` beside a feed of 1500 mm/min.
    fn new(plan: &str) -> Self {
        Self::fed(1500, plan)
    }

    /// The same at so many mm/min.
    fn fed(feed_mm_min: u32, plan: &str) -> Self {
        let text = format!(
            "name = \"Bench\"\nmachine = \"hu40t.toml\"\n[ball_bar]\nlength_mm = 150.0\n\
             [[mounting]]\nname = \"A\"\ncoincidence_mm = [20.0, -35.0, 40.0]\n\
             tool_ball_mm = [0.0, 0.0, -200.0]\n[plan]\nfeed_mm_min = {feed_mm_min}.0\n{plan}"
        );
        let test = Test::parse(&text, Path::new("bench.toml")).unwrap();
        let machine = Machine::read(Path::new("machines/hu40t.toml")).unwrap();
        let path = plan::Path::plan(&test, &machine, 0).unwrap();
        let program = nc::write(&test, &machine, &path).unwrap();
        let mounting = test.mountings()[0].mounting;
        let mut reading = nc::Reading::of(&machine);
        reading.work_offsets_mm.insert(54, mounting.coincidence_mm);
        let program = nc::read(&program, Path::new("O1.nc"), &reading).unwrap();
        Self { machine, mounting, bar: test.bar_of(0), program }
    }

    fn rig(&self) -> Rig<'_> {
        Rig { machine: &self.machine, mounting: &self.mounting, bar: &self.bar }
    }

    fn trajectory(&self) -> Trajectory {
        Trajectory::new(&self.program, &self.machine, 1.0)
    }

    fn simulated(&self, scenario: &Scenario) -> SimulatedRun {
        simulate::run(&self.machine, &self.mounting, &self.program, &self.bar, scenario).unwrap()
    }

    fn aligned(&self, log: &Log) -> Result<Alignment> {
        align(&self.run_of(log))
    }

    fn run_of<'a>(&'a self, log: &'a Log) -> Run<'a> {
        Run { log, program: &self.program, rig: self.rig(), feed_override: 1.0, driven: None }
    }
}

fn log_of(csv: &str) -> Log {
    log::read_bytes(csv.as_bytes(), Path::new("run.csv"), &log::Format::default()).unwrap()
}

/// Where a perfect map would put every sample, s away from where it is, in its own standard deviations.
fn worst_sigmas(alignment: &Alignment, run: &SimulatedRun) -> f64 {
    let samples = alignment.samples();
    let off = samples.iter().filter(|s| matches!(s.part, Part::Arc(_))).map(|sample| {
        (sample.program_s - run.clock.at(sample.log_s).program_s).abs() / sample.time_sigma_s
    });
    off.fold(0.0, f64::max)
}

#[test]
fn ramps_tell_when_the_bar_was_engaged_and_released() {
    let bench = Bench::new(ARCS);
    // At ten readings a second none falls on a ramp, and the edge of the range has to do.
    for (seed, sample_rate_hz, on_ramp) in [(1, 200.0, true), (2, 100.0, true), (7, 10.0, false)] {
        let scenario = Scenario::default().with_seed(seed);
        let scenario = Scenario { sample_rate_hz: Some(sample_rate_hz), ..scenario };
        let run = bench.simulated(&scenario);
        let alignment = bench.aligned(&log_of(&run.csv())).unwrap();
        let kinds: Vec<MarkKind> = alignment.marks.iter().map(|mark| mark.kind).collect();
        assert_eq!(kinds, [MarkKind::Engagement, MarkKind::Release]);
        for mark in &alignment.marks {
            let off_s = mark.program_s - run.clock.at(mark.log_s).program_s;
            assert!(off_s.abs() < 3.0 * mark.sigma_s, "{off_s} {mark:?}");
            assert_eq!(mark.samples > 0, on_ramp, "{mark:?}");
        }
    }
}

/// A slide that turns round between the end of an arc and the ramp away from it steps by its reversal error: the bar reads as some
/// milliseconds later.
#[test]
fn a_slide_that_turns_round_at_the_foot_of_a_ramp_makes_its_mark_uncertain() {
    let bench = Bench::fed(1000, "strategy = \"iso230-4\"\n");
    let mut scenario = Scenario { sample_rate_hz: Some(250.0), ..Scenario::default() };
    scenario.errors.set(Coefficient::parse("EXXb").unwrap(), 0.025);
    let run = bench.simulated(&scenario);
    let alignment = bench.aligned(&log_of(&run.csv())).unwrap();
    let mut most_s = 0.0_f64;
    for mark in &alignment.marks {
        let off_s = (mark.program_s - run.clock.at(mark.log_s).program_s).abs();
        assert!(off_s < 3.0 * mark.sigma_s, "{off_s} {mark:?}");
        most_s = most_s.max(off_s);
    }
    assert!(most_s > 2e-3, "{most_s}");
}

#[test]
fn the_map_is_the_clock_within_its_sigma() {
    let bench = Bench::new(ARCS);
    for (seed, clock_ppm) in [(1, 30.0), (2, -80.0), (3, 0.0)] {
        let scenario = Scenario { clock_ppm, ..Scenario::default().with_seed(seed) };
        let run = bench.simulated(&scenario);
        let alignment = bench.aligned(&log_of(&run.csv())).unwrap();
        let map = &alignment.time_map;
        assert!((map.rate - clock_ppm * 1e-6).abs() < 3.0 * map.rate_sigma, "{map:?}");
        assert!(worst_sigmas(&alignment, &run) < 3.0, "seed {seed}");
        let began_s = run.clock.start_s / (1.0 + clock_ppm * 1e-6);
        assert!((alignment.began_log_s - began_s).abs() < 3.0 * alignment.began_sigma_s);
    }
}

#[test]
fn pauses_of_the_operator_are_found_where_the_reading_stands_still() {
    let bench = Bench::new(&format!("stop_between_arcs = true\n{ARCS}"));
    let stops = bench.program.stops();
    let pauses_s: Vec<f64> = (0..stops).map(|k| 7.0 + 11.0 * k as f64).collect();
    let scenario = Scenario { pauses: Pauses::Fixed(pauses_s.clone()), ..Scenario::default() };
    let run = bench.simulated(&scenario);
    let alignment = bench.aligned(&log_of(&run.csv())).unwrap();
    assert!(stops > 2 && alignment.time_map.pauses_s().len() == stops);
    for (found_s, truth_s) in alignment.time_map.pauses_s().iter().zip(&pauses_s) {
        // Known to a second here: the fit does better.
        assert!(
            found_s.is_none_or(|found_s| (found_s - truth_s).abs() < 1.0),
            "{found_s:?} {truth_s}"
        );
    }
    assert!(worst_sigmas(&alignment, &run) < 3.0);
}

/// Marks of a clock that is known, with noise.
#[test]
fn rate_and_offsets_come_back_from_marks() {
    let trajectory = Bench::new(&format!("stop_between_arcs = true\n{ARCS}")).trajectory();
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let (rate, sigma_s, pivot_s) = (60e-6, 2e-3, 200.0);
    let empty = TimeMap::new(&trajectory, 0.0..0.0, pivot_s);
    let offsets_s: Vec<f64> = (0..empty.offsets_s.len()).map(|k| -4.0 + 9.5 * k as f64).collect();
    let mut truth = empty.clone();
    (truth.rate, truth.offsets_s) = (rate, offsets_s);
    let mut edges_s = vec![0.0];
    edges_s.extend(truth.stops_s());
    edges_s.push(trajectory.end_s());
    let mut marks = Vec::new();
    for (leg, ends) in edges_s.windows(2).enumerate() {
        for share in [0.2, 0.8] {
            let program_s = ends[0] + share * (ends[1] - ends[0]);
            let noise: f64 = random.sample(StandardNormal);
            let log_s = truth.log_time_s(program_s, leg) + sigma_s * noise;
            let kind = MarkKind::Engagement;
            marks.push(Mark { log_s, program_s, sigma_s, kind, samples: 1 });
        }
    }
    let mut map = empty;
    map.fit_marks(&marks, 100e-6, false).unwrap();
    assert!((map.rate - rate).abs() < 3.0 * map.rate_sigma, "{map:?}");
    for leg in 0..map.offsets_s.len() {
        let off_s = map.offsets_s[leg] - truth.offsets_s[leg];
        assert!(off_s.abs() < 3.0 * map.offset_sigmas_s[leg], "leg {leg}: {off_s} s, {map:?}");
    }
}

#[test]
fn a_time_in_a_pause_is_the_pause_and_any_other_comes_back() {
    let trajectory = Bench::new(&format!("stop_between_arcs = true\n{ARCS}")).trajectory();
    let mut map = TimeMap::new(&trajectory, 0.0..0.0, 100.0);
    map.rate = 40e-6;
    for leg in 0..map.offsets_s.len() {
        // The operator paused for ten seconds each time.
        (map.offsets_s[leg], map.offset_sigmas_s[leg]) = (10.0 * leg as f64, 1e-3);
    }
    for (leg, &stop_s) in map.stops_s().iter().enumerate() {
        let before = map.at(map.log_time_s(stop_s - 0.5, leg));
        assert_eq!((before.leg, before.in_stop), (leg, false));
        assert!((before.program_s - (stop_s - 0.5)).abs() < 1e-9);
        let within = map.at(map.log_time_s(stop_s, leg) + 5.0);
        let pause = Moment { program_s: stop_s, leg: leg + 1, in_stop: true };
        assert_eq!(within, pause);
    }
    assert!(map.pauses_s().iter().all(|pause| pause.is_some_and(|s| (s - 10.0).abs() < 1e-9)));
}

#[test]
fn where_two_legs_overlap_the_better_known_one_is_believed() {
    let trajectory = Bench::new(&format!("stop_between_arcs = true\n{ARCS}")).trajectory();
    let mut map = TimeMap::new(&trajectory, 0.0..0.0, 100.0);
    let stop_s = map.stops_s()[0];
    // The second leg begins two seconds before the first one ends.
    (map.offsets_s[0], map.offsets_s[1]) = (0.0, -2.0);
    for (sigmas_s, leg) in [([1e-3, 0.05], 0), ([0.05, 1e-3], 1)] {
        map.offset_sigmas_s[..2].copy_from_slice(&sigmas_s);
        assert_eq!(map.at(stop_s - 1.0).leg, leg);
        assert_eq!(map.at(stop_s - 2.5).leg, 0);
        assert_eq!(map.at(stop_s + 0.5).leg, 1);
    }
}

#[test]
fn an_engagement_lasts_from_one_edge_of_the_range_to_the_other() {
    let bench = Bench::new(ARCS);
    let (trajectory, rig) = (bench.trajectory(), bench.rig());
    let engagements = expected(&trajectory, &rig);
    let [engagement] = &engagements[..] else { panic!("{engagements:?}") };
    let at = |time_s: f64| rig.commanded_deviation_mm(&trajectory.at(time_s).position_mm).abs();
    for edge_s in [engagement.start_s, engagement.end_s] {
        assert!((at(edge_s) - bench.bar.range_mm).abs() < 1e-6);
    }
    let inside = |k: i32| engagement.start_s + engagement.duration_s() * f64::from(k) / 500.0;
    assert!((1..500).all(|k| at(inside(k)) < bench.bar.range_mm));
}

#[test]
fn sections_are_the_arcs_of_the_plan() {
    let bench = Bench::new(ARCS);
    let sections = sections(&bench.trajectory(), &bench.rig());
    let arcs: Vec<&Section> = sections.iter().filter(|section| !section.transit).collect();
    assert_eq!(arcs.len(), 4, "{sections:?}");
    for (circle, sweep_rad) in
        [(Circle::Equator, TAU), (Circle::Meridian { azimuth_deg: 36.0 }, PI)]
    {
        let of: Vec<&&Section> = arcs.iter().filter(|s| s.circle.is_same(&circle)).collect();
        let forward: Vec<bool> = of.iter().map(|section| section.forward).collect();
        assert_eq!(forward, [true, false], "{circle:?}");
        assert!(of.iter().all(|section| (section.sweep_rad - sweep_rad).abs() < 1e-3));
        assert!(of.iter().all(|section| (section.feed_mm_s - 25.0).abs() < 1e-9));
    }
}

#[test]
fn circles_in_planes_are_called_by_the_planes_and_tell_data_from_overshoot() {
    for interpolation in ["arcs", "chords"] {
        let plan = format!("strategy = \"iso230-4\"\ninterpolation = \"{interpolation}\"\n");
        let bench = Bench::new(&plan);
        let trajectory = bench.trajectory();
        let sections = sections(&trajectory, &bench.rig());
        let arcs: Vec<&Section> = sections.iter().filter(|section| !section.transit).collect();
        let told: Vec<String> = arcs
            .iter()
            .map(|arc| format!("{}: {} {}", arc.name, arc.circle.name(), arc.direction()))
            .collect();
        let of =
            |plane: &str| ["CCW", "CW"].map(|way| format!("{plane} {way}: {plane} plane {way}"));
        assert_eq!(told, ["XY", "YZ", "ZX"].map(of).concat());
        for arc in arcs {
            let angle_deg = |time_s: f64| {
                let ball = bench.rig().commanded_mm(&trajectory.at(time_s).position_mm);
                arc.circle.angle_rad(&ball).to_degrees()
            };
            // From the first axis of the plane: X; 20 degrees below Y; 110 degrees before Z.
            let [from_deg, to_deg] = match arc.circle.name().as_str() {
                "XY plane" => [0.0, 0.0],
                "YZ plane" => [340.0, 200.0],
                _ => [250.0, 110.0],
            };
            let expected = if arc.forward { [from_deg, to_deg] } else { [to_deg, from_deg] };
            for (time_s, expected_deg) in arc.data_s.into_iter().zip(expected) {
                let off_deg = (angle_deg(time_s) - expected_deg + 180.0).rem_euclid(360.0) - 180.0;
                assert!(off_deg.abs() < 0.01, "{} {time_s} s: {off_deg} deg", arc.name);
            }
            assert!(arc.start_s < arc.data_s[0] && arc.data_s[1] < arc.end_s, "{arc:?}");
        }
    }
}

/// As others write it: two whole turns in a row, and nothing that says which part is data.
#[test]
fn the_data_of_two_turns_without_comments_are_the_turn_in_the_middle() {
    let mut bench = Bench::new("strategy = \"xy\"\n");
    bench.program.labels.iter_mut().for_each(String::clear);
    let trajectory = bench.trajectory();
    for section in sections(&trajectory, &bench.rig()) {
        assert!((section.sweep_rad - 2.0 * TAU).abs() < 1e-3);
        for at_s in section.data_s {
            let ball = bench.rig().commanded_mm(&trajectory.at(at_s).position_mm);
            assert!(ball.x > 149.9 && ball.y.abs() < 0.05, "{ball}");
        }
        let share = (section.data_s[1] - section.data_s[0]) / (section.end_s - section.start_s);
        assert!((share - 0.5).abs() < 0.01, "{share}");
        let way = if section.forward { "CCW" } else { "CW" };
        assert_eq!(section.name, format!("XY plane {way}"));
    }
}

#[test]
fn a_knob_that_is_off_is_estimated_and_one_too_far_off_refused_with_a_hint() {
    let bench = Bench::new(ARCS);
    let at = |feed_override: f64| {
        let run = bench.simulated(&Scenario { feed_override, ..Scenario::default() });
        (bench.aligned(&log_of(&run.csv())), run)
    };
    let (alignment, run) = at(0.99);
    let map = alignment.unwrap().time_map;
    // The clock may be off by its tolerance, and nobody can tell the one from the other.
    assert!((map.override_excess - -0.01).abs() < 3.0 * map.override_sigma, "{map:?}");
    assert!(map.override_sigma < 3.0 * bench.bar.clock_tolerance, "{map:?}");
    assert!(run.clock.ppm.abs() * 1e-6 < bench.bar.clock_tolerance);
    for real in [0.6, 0.8, 0.97, 1.04, 1.4] {
        let map = at(real).0.unwrap().time_map;
        let off = map.override_excess - (real - 1.0);
        assert!(off.abs() < 3.0 * map.override_sigma, "{real}: {map:?}");
    }
    let error = at(0.45).0.unwrap_err();
    assert_eq!(error.kind, Kind::Mismatch);
    assert!(error.to_string().contains("`feed_override_percent = 45.0`"), "{error}");
}

/// The rounding of the chords tells the time of each arc, without any model.
#[test]
fn readings_that_were_lost_are_missed_where_they_were() {
    let bench = Bench::new("strategy = \"3d6\"\n");
    let scenario = Scenario { sample_rate_hz: Some(30.0), ..Scenario::default() };
    let run = bench.simulated(&scenario);
    let whole = bench.aligned(&log_of(&run.csv())).unwrap();
    let cut = |seconds: f64| {
        // From the middle of the transit before the seventh arc on.
        let arcs: Vec<&Section> = whole.sections.iter().filter(|s| !s.transit).collect();
        let program_s = 0.5 * (arcs[5].end_s + arcs[6].start_s);
        let from_s = whole.time_map.log_time_s(program_s, 0);
        let kept = |line: &str| {
            let (time, reading) = line.split_once(',').unwrap();
            let time_s: f64 = time.parse().unwrap();
            let earlier_s = if time_s < from_s { 0.0 } else { seconds };
            let lost = (from_s..from_s + seconds).contains(&time_s);
            (!lost).then(|| format!("{:.4},{reading}\n", time_s - earlier_s))
        };
        let csv = run.csv();
        let lines: String = csv.lines().skip(2).filter_map(kept).collect();
        let text = format!("time_s,deviation_um\n{lines}");
        (log_of(&text), program_s)
    };
    // Little enough that the clock's tolerance absorbs it.
    let (log, program_s) = cut(0.05);
    let alignment = bench.aligned(&log).unwrap();
    let step = alignment.time_step(0.5).unwrap();
    let sections = &alignment.sections;
    assert!(sections[step.before].start_s < program_s, "{step:?}");
    assert!(sections[step.after].end_s > program_s, "{step:?}");
    assert!((step.lost_s - 0.05).abs() < 0.02, "{step:?}");
    let error = bench.aligned(&cut(1.0).0).unwrap_err();
    assert!(error.what.contains("1.0 s is missing from the log"), "{error}");
}

/// Over whole chords the mean of a path lies two thirds of their sag inside, wherever it is taken.
#[test]
fn the_mean_of_chords_is_a_circle() {
    let bench = Bench::new("strategy = \"3d6\"\nchord_sag_um = 0.6\n");
    let run = bench.simulated(&Scenario::default());
    let mut alignment = bench.aligned(&log_of(&run.csv())).unwrap();
    alignment.look_up_means();
    for arc in alignment.sections.iter().filter(|arc| !arc.transit) {
        let leg = alignment.time_map.leg_of(arc.start_s);
        let over_s = 40.0 * alignment.time_map.chords[leg].lasts_s;
        let lasts_s = arc.end_s - arc.start_s;
        for k in 0..200 {
            let program_s = arc.start_s + (0.2 + 0.6 * f64::from(k) / 200.0) * lasts_s;
            let mean_um = 1e3 * alignment.mean_mm(leg, program_s, over_s);
            let sag_um = 1e3 * alignment.chord_sag_mm;
            // The ends of chords are rounded to 1 um: 0.3 um, of forty 0.05 um.
            assert!((mean_um + 2.0 / 3.0 * sag_um).abs() < 0.15, "{mean_um} um, sag {sag_um} um");
        }
    }
}

/// A program has arcs in the planes and chords on the way between them: an arc that is driven as one is no chord of seconds, which a
/// control would round out and a slide step across.
#[test]
fn an_arc_is_no_chord() {
    let bench = Bench::new("strategy = \"iso230-4\"\nchord_sag_um = 0.6\n");
    let run = bench.simulated(&Scenario::default());
    let mut alignment = bench.aligned(&log_of(&run.csv())).unwrap();
    alignment.look_up_means();
    let (mut of_arcs, mut of_chords) = (0, 0);
    for arc in &alignment.sections {
        let leg = alignment.time_map.leg_of(arc.start_s);
        let chords = alignment.time_map.chords[leg];
        assert_eq!(chords.there_are(), arc.transit, "{}: {} s", arc.name, chords.lasts_s);
        assert!(!alignment.steps(leg), "{}", arc.name);
        *(if arc.transit { &mut of_chords } else { &mut of_arcs }) += 1;
    }
    assert!(of_arcs >= 6 && of_chords >= 2, "{of_arcs} {of_chords}");
}
