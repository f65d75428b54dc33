//! One run: the program on the virtual machine, read by the virtual instrument.

use super::bend::{Bent, Drive};
use super::clock::ClockMoment;
use super::clock::{self, Clock};
use super::instrument::{Instrument, Outcome, Reads};
use super::random::{Purpose, Stream};
use super::scenario::{Pauses, Scenario};
use crate::error::{Error, Place, Result};
use crate::machine::{Machine, Mounting};
use crate::motion::{State, Trajectory};
use crate::nc::{Action, Program};
use crate::plan::BallBar;

/// Times are written with four decimals.
const TIME_STEPS_PER_S: f64 = 1e4;

/// Readings of one run: more than half an hour at 2000 a second, and some 1 GB.
const MOST_SAMPLES: f64 = 4e6;

/// Slides that follow with a lag are worked out every millisecond: five hours take half a GB.
const LONGEST_FOLLOWED_S: f64 = 20_000.0;

/// What was true when a reading was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruePoint {
    /// Where the program was.
    pub moment: ClockMoment,
    /// Where the machine was commanded to be as the test file has it, and the sense of every slide.
    pub state: State,
    /// Length minus nominal length through the exact chain, without noise, steps and range, mm.
    pub exact_mm: f64,
}

/// A log with the truth behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedRun {
    /// Time on the instrument's clock, s, and the deviation from the nominal length, mm, positive
    /// outward; `None` out of range and in dropouts.
    pub readings: Vec<(f64, Option<f64>)>,
    /// What was true, one entry for each reading.
    pub truth: Vec<TruePoint>,
    /// The two clocks, with the length of every operator's pause.
    pub clock: Clock,
    /// What was asked for, with the set-up errors that came of it and the coefficients, the feed override
    /// and the clock that effects hide.
    pub scenario: Scenario,
    /// Samples a second.
    pub sample_rate_hz: f64,
    /// Smallest step of a reading, mm.
    pub resolution_mm: f64,
    /// Highest programmed feed, mm/s.
    pub feed_mm_s: f64,
}

/// Lets a machine run a program and an instrument read it.
///
/// `bar` says how long the bar is and, where the scenario does not, how far, how finely and how often
/// it reads; its noise and its clock tolerance are what the user believes and are not used.
///
/// # Errors
/// When the scenario lists another number of pauses than the program has, or hides what cannot be.
///
/// ```
/// use ballbar::machine::Machine;
/// use ballbar::simulate::{self, Scenario};
///
/// let test = ballbar::plan::Test::read("tests/data/hu40t/test.toml".as_ref())?;
/// let machine = test.machine()?;
/// let mounting = test.mountings()[0].mounting;
/// let mut reading = ballbar::nc::Reading::default();
/// reading.work_offsets_mm.insert(54, mounting.coincidence_mm);
/// let program = ballbar::nc::read_file(&test.runs()?[0].program, &reading)?;
/// let run = simulate::run(&machine, &mounting, &program, test.ball_bar(), &Scenario::default())?;
/// assert!(run.csv().contains("time_s,deviation_um\n0.0000,\n"), "the log begins before the bar is fitted");
/// # Ok::<(), ballbar::Error>(())
/// ```
pub fn run(
    machine: &Machine,
    mounting: &Mounting,
    program: &Program,
    bar: &BallBar,
    scenario: &Scenario,
) -> Result<SimulatedRun> {
    let bent = Bent::new(machine, mounting, scenario)?;
    let scenario = &bent.scenario;
    let trajectory = scenario.control.trajectory(
        program,
        &bent.machine,
        scenario.feed_override,
        scenario.seed,
    )?;
    let pauses_s = pauses_s(program, &trajectory, scenario)?;
    let clock = Clock::new(&trajectory, scenario.start_s, scenario.clock_ppm, pauses_s);
    let sample_rate_hz = scenario.sample_rate_hz.unwrap_or(bar.sample_rate_hz);
    let resolution_mm = scenario.resolution_mm.unwrap_or(bar.resolution_mm);
    let range_mm = scenario.range_mm.unwrap_or(bar.range_mm);
    let mut instrument =
        Instrument::new(scenario, Reads { range_mm, resolution_mm }, sample_rate_hz.recip());

    let followed_s = clock.end_s();
    if scenario.control.following_s.iter().any(|s| *s > 0.0) && followed_s > LONGEST_FOLLOWED_S {
        return Err(Error::input(format!(
            "slides that follow with a lag are followed for {LONGEST_FOLLOWED_S} s at the most, and this run takes {followed_s:.0} s"
        ))
        .hint("shorter pauses, a larger `feed_mm_min` or fewer arcs make it shorter; or leave `following_ms` out"));
    }
    let drive = Drive::new(trajectory, clock, &scenario.control.following_s);
    let last_s = drive.clock.end_log_s() + scenario.after_s;
    let samples = (last_s * sample_rate_hz).floor().max(0.0);
    if samples > MOST_SAMPLES {
        return Err(Error::input(format!(
            "a log of {samples:.0} readings, {:.1} h at {sample_rate_hz} a second, and {MOST_SAMPLES:.0} are the most",
            last_s / 3600.0
        ))
        .hint("a larger `feed_mm_min`, fewer arcs, a smaller `sample_rate_hz` or shorter pauses make it shorter"));
    }
    let samples = samples as usize + 1;
    let mut readings = Vec::with_capacity(samples);
    let mut truth = Vec::with_capacity(samples);
    for k in 0..samples {
        let log_s = k as f64 / sample_rate_hz;
        let (moment, state, condition) = bent.at(&drive, log_s);
        let exact_mm = bent.length_mm(&condition) - bar.length_mm;
        if let Outcome::Row(deviation_mm) = instrument.sample(exact_mm) {
            let written_s = (log_s * TIME_STEPS_PER_S).round() / TIME_STEPS_PER_S;
            readings.push((written_s, deviation_mm));
            truth.push(TruePoint { moment, state, exact_mm });
        }
    }
    let feeds = program.steps.iter().filter_map(|step| match step.action {
        Action::Move(motion) => Some(motion.feed_mm_s),
        _ => None,
    });
    Ok(SimulatedRun {
        readings,
        truth,
        clock: drive.clock,
        scenario: bent.scenario,
        sample_rate_hz,
        resolution_mm,
        feed_mm_s: feeds.fold(0.0, f64::max),
    })
}

/// How long every operator's pause of the program is, s.
fn pauses_s(program: &Program, trajectory: &Trajectory, scenario: &Scenario) -> Result<Vec<f64>> {
    if let Some(recorded_s) = trajectory.recorded_pauses_s() {
        return Ok(recorded_s.to_vec());
    }
    let stops = clock::stops_s(trajectory).len();
    match &scenario.pauses {
        Pauses::Between(limits_s) => {
            let mut stream = Stream::new(scenario.seed, Purpose::Pauses);
            Ok((0..stops).map(|_| stream.between(*limits_s)).collect())
        }
        Pauses::Fixed(lengths_s) if lengths_s.len() == stops => Ok(lengths_s.clone()),
        Pauses::Fixed(lengths_s) => Err(Error::input(format!(
            "the scenario gives the length of {} pause(s), the program has {stops} M00",
            lengths_s.len()
        ))
        .at(Place::file(&program.file))
        .hint("give `fixed_s` one length for each M00, or draw them with `between_s = [5, 40]`")),
    }
}
