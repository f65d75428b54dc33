//! Effects laid over the logs of `case-d`, which were not made with this code: what an effect does is worked out
//! here, from the position of the machine alone, and added to the readings.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use ballbar::align::Sample;
use ballbar::diagnose::{Diagnosis, Feature, Finding, Owner};
use ballbar::identify::{Campaign, Failure};
use ballbar::machine::Axis;
use ballbar::model::Variable;
use ballbar::plan::Test;

use crate::judge::{self, explained, near};

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/case-d")
}

/// The campaign as it was measured.
static MEASURED: LazyLock<Campaign> = LazyLock::new(|| {
    let test = Test::read(&data().join("test.toml")).unwrap();
    Campaign::of(&test, &test.machine().unwrap(), Failure::Refuse, &|| ()).unwrap()
});

/// A reading as an effect sees it.
struct Seen<'a> {
    sample: &'a Sample,
    /// Number of the run, from 0.
    run: usize,
    /// Unit vector along the bar, workpiece to tool.
    u: [f64; 3],
}

impl Seen<'_> {
    fn at(&self, axis: Axis) -> f64 {
        self.sample.pose.position_mm[axis.index()]
    }
}

/// What is found in the logs with an effect (um) added to the readings.
fn with(effect: impl Fn(&Seen) -> f64) -> Diagnosis {
    let directory = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(data().join("test.toml")).unwrap();
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("machines");
    let text = text
        .replace("../../../machines", machines.to_str().unwrap())
        .replace("program = \"", &format!("program = \"{}/", data().display()));
    std::fs::write(directory.path().join("test.toml"), text).unwrap();
    for (run, repeat) in MEASURED.repeats.iter().enumerate() {
        let input = &repeat.runs[0];
        let name = format!("{}.csv.gz", input.name);
        let mut log = String::new();
        let file = std::fs::File::open(data().join(&name)).unwrap();
        flate2::read::GzDecoder::new(file).read_to_string(&mut log).unwrap();
        let mut added = vec![0.0; log.lines().count() + 1];
        for sample in input.records.iter().map(|record| &record.sample) {
            let ball_mm = sample.pose.position_mm - input.alignment.coincidence_mm();
            let u = (ball_mm / ball_mm.norm()).into();
            added[sample.line] = effect(&Seen { sample, run, u });
        }
        let mut changed = String::new();
        for (number, line) in (1..).zip(log.lines()) {
            match line.split_once(',').and_then(|(time, um)| Some((time, um.parse::<f64>().ok()?)))
            {
                Some((time, um)) => writeln!(changed, "{time},{:.1}", um + added[number]).unwrap(),
                None => writeln!(changed, "{line}").unwrap(),
            }
        }
        std::fs::write(directory.path().join(name), changed).unwrap();
    }
    let test = Test::read(&directory.path().join("test.toml")).unwrap();
    judge::diagnosed(&test).2
}

/// Cause and seat, and whether the runs cannot tell it from that.
fn is(finding: &Finding, cause: &str, seat: &str) -> bool {
    let named = |element: &ballbar::diagnose::Element| {
        element.shape().is_some_and(|s| s.cause.id == cause && s.seat.to_string() == seat)
    };
    let same =
        |rival: &ballbar::diagnose::Rival| rival.separation == ballbar::diagnose::Separation::Same;
    named(&finding.element)
        || finding.rivals.iter().any(|rival| same(rival) && named(&rival.element))
}

#[test]
fn a_dent_in_a_guideway_is_unexplained_and_has_its_place() {
    // The table carries X: what displaces it shortens where the bar points.
    let found = with(|seen| {
        let aside = (seen.at(Axis::X) - 42.0) / 9.0;
        -2.0 * seen.u[1] * (-0.5 * aside * aside).exp()
    });
    explained(&found);
    assert_eq!(found.findings.len(), 1, "{:?}", found.findings);
    let curve = found.findings[0].element.curve().unwrap();
    assert_eq!(curve.variable, Variable::Position(Axis::X));
    let feature = Feature::of(&found.findings[0].element, &found.findings[0].amplitudes).unwrap();
    // 9 mm sigma are 21 mm at half the height.
    assert!((feature.at - 42.0).abs() < 2.0 && (feature.width - 21.2).abs() < 3.0, "{feature:?}");
}

#[test]
fn a_vibration_on_the_clock_of_the_logs() {
    let found =
        with(|seen| 0.5 * seen.u[2] * (TAU * 2.3 * seen.sample.log_s + seen.run as f64).sin());
    explained(&found);
    assert_eq!(found.findings.len(), 1, "{:?}", found.findings);
    assert!(is(&found.findings[0], "vibration", "EZt"));
    near(&found.findings[0], "amplitude_um", 0.5);
    // The clocks of the logs differ by up to 75 ppm.
    near(&found.findings[0], "frequency_hz", 2.3);
}

#[test]
fn a_ball_that_was_knocked_in_the_second_run() {
    let found =
        with(|seen| if seen.run == 1 && seen.sample.log_s > 400.0 { 3.0 * seen.u[0] } else { 0.0 });
    explained(&found);
    assert_eq!(found.findings.len(), 1, "{:?}", found.findings);
    let finding = &found.findings[0];
    assert!(is(finding, "knock", "EXt"));
    assert_eq!(finding.owner(), Owner::One { repeat: 1, run: 0 });
    near(finding, "step_um", 3.0);
    let began_s = MEASURED.repeats[1].runs[0].alignment.began_log_s;
    assert!((finding.effects[0].get("moment") + began_s - 400.0).abs() < 0.5);
}

#[test]
fn a_hose_that_snags_at_the_same_moment_of_every_run() {
    let moment_s = 250.0;
    let found = with(|seen| if seen.sample.program_s > moment_s { -2.0 * seen.u[1] } else { 0.0 });
    explained(&found);
    assert_eq!(found.findings.len(), 1, "{:?}", found.findings);
    let finding = &found.findings[0];
    assert!(is(finding, "repeated-step", "EYt"));
    assert_eq!(finding.owner(), Owner::All);
    near(finding, "step_um", -2.0);
    // Between two readings.
    assert!((finding.effects[0].get("moment") - moment_s).abs() < 0.1, "{:?}", finding.effects);
}

#[test]
fn backlash_that_grows_along_a_slide() {
    let found = with(|seen| {
        let z = Axis::Z;
        12e-3 * seen.u[0] * seen.sample.pose.sense[z.index()] * seen.at(z)
    });
    explained(&found);
    assert_eq!(found.findings.len(), 1, "{:?}", found.findings);
    assert!(is(&found.findings[0], "growing-backlash", "EXZ"));
    near(&found.findings[0], "slope_um_m", 12.0);
}

#[test]
fn a_screw_and_a_spindle_at_once() {
    let found = with(|seen| {
        let wave = 0.8 * (TAU * seen.at(Axis::Y) / 16.0 + 1.0).sin();
        wave * seen.u[1] - 4.0 * seen.u[0] * (-(-seen.sample.log_s / 600.0).exp_m1())
    });
    explained(&found);
    assert_eq!(found.findings.len(), 2, "{:?}", found.findings);
    let of = |cause, seat| found.findings.iter().find(|f| is(f, cause, seat)).unwrap();
    near(of("cyclic", "EYY"), "period_mm", 16.0);
    near(of("cyclic", "EYY"), "amplitude_um", 0.8);
    near(of("drift", "EXt"), "time_constant_s", 600.0);
    near(of("drift", "EXt"), "amplitude_um", -4.0);
}
