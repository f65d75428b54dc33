//! What hidden effects do to the length, held against physics worked out here by another road.

use std::path::Path;

use nalgebra::Vector3;

use crate::machine::{Machine, Mounting, Side};
use crate::model::{CAUSES, Coefficient, Effect};
use crate::nc::{self, Program};
use crate::plan::BallBar;
use crate::simulate::{Pauses, Scenario, SimulatedRun, TruePoint, TrueRun, run, truth_toml};

mod columns;
mod readings;
mod settings;
mod slides;

struct Bench {
    machine: Machine,
    mounting: Mounting,
    program: Program,
    bar: BallBar,
}

/// A ball vector that goes once round the equator and climbs to 60 deg above and below it twice, so that
/// every slide turns round several times; an M00 on the way and a pause of known length before the end.
fn bench(machine: &str) -> Bench {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let machine = Machine::read(&root.join("machines").join(machine)).unwrap();
    let mounting = Mounting {
        coincidence_mm: Vector3::new(20.0, -35.0, 40.0),
        tool_ball_mm: Vector3::new(0.0, 0.0, -200.0),
    };
    let program = program(&machine, &mounting);
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

fn program(machine: &Machine, mounting: &Mounting) -> Program {
    let point = |k: i32| {
        let turn = f64::from(k).to_radians();
        let (height, round) = (60_f64.to_radians() * (2.0 * turn).sin(), turn);
        let (sin, cos) = height.sin_cos();
        let at = 150.0 * Vector3::new(cos * round.cos(), cos * round.sin(), sin);
        format!("G01 X{:.3} Y{:.3} Z{:.3} F500.\n", at.x, at.y, at.z)
    };
    let mut source = String::from(
        "%\nO1 (T)\nG21 G17 G90 G94\nG54\nG00 X171.5 Y-1. Z-1.\nG00 X171. Y0. Z0.\nG01 X150. F500.\n",
    );
    source.extend((1..=100).map(point));
    source.push_str("M00\n");
    source.extend((101..=360).map(point));
    source.push_str("G04 P2000\nG01 X171.5\nM30\n%\n");
    let mut reading = nc::Reading::of(machine);
    reading.work_offsets_mm.insert(54, mounting.coincidence_mm);
    nc::read(&source, Path::new("T.nc"), &reading).unwrap()
}

impl Bench {
    fn run(&self, scenario: &Scenario) -> SimulatedRun {
        run(&self.machine, &self.mounting, &self.program, &self.bar, scenario).unwrap()
    }

    /// What effects add to the length of a perfect machine, mm, with what was true without them.
    fn added(&self, effects: &[&str], rate_hz: f64) -> Vec<(TruePoint, f64)> {
        let clean = Scenario { sample_rate_hz: Some(rate_hz), ..perfect() };
        let bent = self.run(&hiding(clean.clone(), effects));
        let clean = self.run(&clean);
        assert_eq!(clean.truth.len(), bent.truth.len());
        let pairs = clean.truth.into_iter().zip(&bent.truth);
        pairs.map(|(clean, bent)| (clean, bent.exact_mm - clean.exact_mm)).collect()
    }

    /// Unit vector from the workpiece ball to the tool ball of a perfect machine.
    fn bar_direction(&self, at: &TruePoint) -> Vector3<f64> {
        (at.state.position_mm - self.mounting.coincidence_mm).normalize()
    }

    /// By which sign a displacement of a slide in `F` moves the tool relative to the workpiece.
    fn sign(&self, effect: &Effect) -> f64 {
        let slide = slide_of(effect);
        if self.machine.topology().slides(Side::Tool).contains(&slide) { 1.0 } else { -1.0 }
    }
}

fn perfect() -> Scenario {
    Scenario { pauses: Pauses::Fixed(vec![7.0]), ..Scenario::perfect() }
}

fn hiding(mut scenario: Scenario, effects: &[&str]) -> Scenario {
    for effect in effects {
        scenario.hide(Effect::parse(effect).unwrap()).unwrap();
    }
    scenario
}

fn slide_of(effect: &Effect) -> crate::machine::Axis {
    use crate::model::Seat;
    match effect.seat {
        Seat::Function(slide, _) | Seat::Slide(slide) => slide,
        Seat::Coefficient(of) => of.slide,
        other => panic!("{other} is no slide"),
    }
}

/// Seconds since the program began on the machine's clock: the log of a perfect clock begins 3 s earlier.
fn elapsed_s(index: usize, rate_hz: f64) -> f64 {
    (index as f64 / rate_hz - 3.0).max(0.0)
}

/// One effect of every cause, and of every kind of seat.
const EXAMPLES: [&str; 26] = [
    "cyclic:on=EXX,amplitude_um=1.2,period_mm=10,phase_rad=0",
    "cyclic:on=EBZ,amplitude_urad=5,period_mm=20,phase_rad=1",
    "servo:on=Y,delay_ms=0.4",
    "reversal-spike:on=X,amplitude_um=3,decay_ms=500",
    "growing-backlash:on=EYY,slope_um_m=10,from_mm=50",
    "pre-sliding:on=EYY,amplitude_um=2,distance_mm=3",
    "drift:on=EZt,amplitude_um=6,time_constant_s=500",
    "drift:on=EXX1,amplitude_um_m=12,time_constant_s=600",
    "drift:on=bar,amplitude_um=2,time_constant_s=600",
    "knock:on=EXw,step_um=5,moment_s=60,run=1",
    "bar-length:amplitude_um=3",
    "roundness:amplitude_um=0.3,degree=3,order=-2",
    "degree:on=EZX,amplitude_um=2,degree=5",
    "vibration:on=bar,amplitude_um=1,frequency_hz=50,phase_rad=0",
    "vibration:on=EYt,amplitude_um=1,frequency_hz=0.7,phase_rad=0",
    "stick-slip:on=Z,amplitude_um=1,speed_mm_min=20",
    "feed-override:percent=97",
    "clock:ppm=80",
    "ball-place:on=EXw,offset_mm=20,mounting=0",
    "ball-place:on=EZt,offset_mm=20,mounting=0",
    "pivot:on=Z",
    "coefficient:on=EBX3,value=0.0000000001",
    "bump:on=EYZ,amplitude_um=3,at_mm=40,width_mm=9",
    "joint:on=EYZ,amplitude_um=3,at_mm=40,width_mm=9",
    "friction-tilt:on=EBZ,amplitude_urad=10",
    "repeated-step:on=EYt,step_um=5,moment_s=60",
];

#[test]
fn every_cause_can_be_hidden_and_is_told_in_the_truth() {
    let bench = bench("hu40t.toml");
    let scenario = Scenario { pauses: Pauses::Fixed(vec![7.0]), ..Scenario::default() };
    let clean = bench.run(&scenario);
    for cause in CAUSES {
        assert!(EXAMPLES.iter().any(|text| text.split(':').next() == Some(cause.id)), "{cause:?}");
    }
    for text in EXAMPLES {
        let hidden = hiding(scenario.clone(), &[text]);
        let bent = bench.run(&hidden);
        assert!(bent.readings != clean.readings, "{text}");
        assert!(bent == bench.run(&hidden), "the same seed, the same bits: {text}");
        assert!(bent.truth.iter().all(|point| point.exact_mm.is_finite()), "{text}");
        let truth = truth_toml(&[TrueRun { log: "run1.csv", program: "T.nc", run: &bent }], &[]);
        let truth: toml::Table = toml::from_str(&truth).unwrap();
        assert_eq!(truth["effect"].as_str(), Some(text));
    }
}

#[test]
fn what_is_not_hidden_leaves_every_bit_as_it_was() {
    let bench = bench("hu40t.toml");
    let clean = bench.run(&perfect());
    // In another run than this one.
    let other = hiding(perfect(), &["knock:on=EXw,step_um=5,moment_s=0,run=2"]);
    assert_eq!(bench.run(&other).readings, clean.readings);
    // The noise is the same whatever is hidden: streams do not touch each other.
    let noisy = Scenario { pauses: Pauses::Fixed(vec![7.0]), ..Scenario::default() };
    let fine = Scenario { resolution_mm: Some(1e-9), ..noisy };
    let shaken = hiding(fine.clone(), &["vibration:on=bar,amplitude_um=1,frequency_hz=50"]);
    let (fine, shaken) = (bench.run(&fine), bench.run(&shaken));
    for k in 0..fine.readings.len() {
        let (Some(a), Some(b)) = (fine.readings[k].1, shaken.readings[k].1) else { continue };
        let noise = |read_mm: f64, run: &SimulatedRun| read_mm - run.truth[k].exact_mm;
        assert!((noise(a, &fine) - noise(b, &shaken)).abs() < 2e-9);
    }
}

#[test]
fn effects_add_up() {
    let bench = bench("hu40t.toml");
    let effects = [EXAMPLES[0], EXAMPLES[1], EXAMPLES[2], EXAMPLES[6], EXAMPLES[11], EXAMPLES[15]];
    let all = bench.added(&effects, 10.0);
    let each: Vec<_> = effects.iter().map(|effect| bench.added(&[effect], 10.0)).collect();
    for (k, (_, together)) in all.iter().enumerate() {
        let sum: f64 = each.iter().map(|one| one[k].1).sum();
        // Products of two effects: some 10 um · 10 um / 150 mm.
        assert!((together - sum).abs() < 2e-6, "{together} {sum}");
    }
}

#[test]
fn effects_that_cannot_be_together_are_refused() {
    let parsed = |text: &str| Effect::parse(text).unwrap();
    let mut scenario = hiding(perfect(), &["clock:ppm=80", "pivot:on=X"]);
    for (text, what) in
        [("clock:ppm=90", "`clock` is hidden twice"), ("pivot:on=X", "`pivot` is hidden twice")]
    {
        let error = scenario.hide(parsed(text)).unwrap_err();
        assert_eq!(error.what, what);
        assert!(error.hint.is_some());
        let bench = bench("hu40t.toml");
        let mut unchecked = scenario.clone();
        unchecked.hidden.push(parsed(text));
        let refused = run(&bench.machine, &bench.mounting, &bench.program, &bench.bar, &unchecked);
        assert_eq!(refused.unwrap_err().what, what);
    }
    assert_eq!(scenario.hidden.len(), 2);
    scenario.hide(parsed("pivot:on=Y")).unwrap();
}

#[test]
fn a_coefficient_is_hidden_in_the_machine_s_own() {
    let bench = bench("hu40t.toml");
    let bent = bench.run(&hiding(Scenario::default(), &["coefficient:on=EXX1,value=1e-5"]));
    let mut stated = Scenario::default();
    let scale = Coefficient::parse("EXX1").unwrap();
    stated.errors.set(scale, stated.errors.get(scale) + 1e-5);
    assert_eq!(bent.readings, bench.run(&stated).readings);
    assert_eq!(bent.scenario.errors, stated.errors);
}
