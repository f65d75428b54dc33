//! The table of all causes.

use super::cause::{Cause, Runs};
use super::harmonics::MOST_DEGREE;
use super::key::{AMPLITUDE, DEGREE, Key, MOUNTING, Measure, ORDER, PHASE, RUN};
use super::law::{Inner, Law, Over, Scale, Start};
use super::seat::SeatKind;
use super::unit::Unit;
use super::variable::Variable;
use crate::machine::Axis;

const fn key(name: &'static str, unit: Unit, limits: [f64; 2]) -> Key {
    Key { name, measure: Measure::Fixed(unit), default: None, limits }
}

/// A key that need not be given.
const fn or(key: Key, default: f64) -> Key {
    Key { default: Some(default), ..key }
}

const AMPLITUDE_KEY: Key =
    Key { name: AMPLITUDE, measure: Measure::OfSeat, default: None, limits: [-1e4, 1e4] };
const PHASE_KEY: Key = or(key(PHASE, Unit::RAD, [-100.0, 100.0]), 0.0);
const RUN_KEY: Key = or(key(RUN, Unit::NONE, [1.0, 1e4]), 1.0);

/// The same in either sense of the axis.
const fn over(variable: fn(Axis) -> Variable) -> Over {
    Over { variable, with_sense: false }
}

/// Turning with the sense of the axis.
const fn turning(variable: fn(Axis) -> Variable) -> Over {
    Over { variable, with_sense: true }
}

const ELAPSED: Over = over(|_| Variable::Elapsed);
const PROGRAM: Over = over(|_| Variable::Program);

/// From a moment on.
const STEP: fn(f64, f64) -> f64 = |t, moment| if t > moment { 1.0 } else { 0.0 };

/// An inner number that nothing bounds but the limits of its key.
const fn inner(key: &'static str, scale: Option<Scale>, start: Start) -> Inner {
    Inner { key, scale, start, part_of_way: f64::INFINITY, part_of_fastest: f64::INFINITY }
}

/// Waves longer than this are smooth: of such, several make any curve. By trial; screws have pitches up to 20 mm.
const SMOOTH_MM: f64 = 25.0;

/// What most entries have in common.
const CAUSE: Cause = Cause {
    id: "",
    title: "",
    seat: SeatKind::None,
    keys: &[],
    law: Law::Constant,
    law_of_all: None,
    runs: Runs::Alike,
    makes_any_curve: |_| false,
    equation: "",
    source: "",
    remedy: "",
    taken_for: "",
    unseen: "",
};

/// A place of a ball other than in the test file.
pub const BALL_PLACE: Cause = Cause {
    id: "ball-place",
    title: "place of the balls other than in the test file",
    seat: SeatKind::Ball,
    keys: &[key("offset", Unit::MM, [-1e3, 1e3]), or(key(MOUNTING, Unit::NONE, [0.0, 1e3]), 0.0)],
    law: Law::Setting,
    equation: "of the tool ball: it is so far from where the test file has it; of the workpiece ball: both balls and the whole path lie so far elsewhere in the travel; in that mounting of the test file, counted from 1, or with 0 in all",
    source: "the work offset or the tool length of another set-up",
    remedy: "read `coincidence_mm` and `tool_ball_mm` of the mounting from the control again",
    taken_for: "coefficients of the machine",
    ..CAUSE
};

/// A pivot other than in the machine file.
pub const PIVOT: Cause = Cause {
    id: "pivot",
    title: "pivot other than in the machine file",
    seat: SeatKind::Slide,
    keys: &[],
    law: Law::Setting,
    equation: "the axis turns about the other one of `carriage` and `base`; seen only where it has angular errors",
    source: "the construction of the machine",
    remedy: "correct `pivot` in the machine file",
    taken_for: "higher degrees of straightness",
    ..CAUSE
};

/// All causes, in the order in which equally good ones are named.
pub const CAUSES: &[Cause] = &[
    Cause {
        id: "cyclic",
        title: "cyclic error of a screw or scale",
        seat: SeatKind::Function,
        keys: &[AMPLITUDE_KEY, key("period", Unit::MM, [0.5, 500.0]), PHASE_KEY],
        law: Law::Wave(
            over(Variable::Position),
            |h, period| h / period,
            // What is not seen twice is not seen to repeat: it may be any bump.
            Inner { part_of_way: 0.5, ..inner("period", Some(Scale::Inverse), Start::Waves) },
        ),
        makes_any_curve: |period| period > SMOOTH_MM,
        equation: "E = A sin(2 pi h / period + phase)",
        source: "a ball screw that runs out or is mounted bent, its encoder out of centre; subdivision of a scale's signal",
        remedy: "check the screw's bearings, coupling and encoder mounting, or the scale's reading head; a periodic compensation table if the control has one",
        taken_for: "vibration, where the feed is the same throughout; another harmonic of the same pitch",
        ..CAUSE
    },
    Cause {
        id: "servo",
        title: "servo mismatch: following error of an axis",
        seat: SeatKind::Slides,
        keys: &[key("delay", Unit::MS, [-1e3, 1e3])],
        law: Law::Curve(over(Variable::Velocity), |v, _| -v, None),
        law_of_all: Some(Law::Corner(inner("delay", None, Start::Grid([1e-3, 40e-3], 24)))),
        equation: "the axis stands where it was commanded to be a delay ago: E = -delay v; of a delay that all axes share only the corners of the path remain",
        source: "position loops with different gains, or feed-forward on some axes only",
        remedy: "set equal position gains (Fanuc 1825) and feed-forward on all axes, then repeat at two feeds",
        taken_for: "squareness, where one feed and one direction were measured; a wrong time of the log",
        ..CAUSE
    },
    Cause {
        id: "reversal-spike",
        title: "reversal spike of an axis",
        seat: SeatKind::Slide,
        keys: &[AMPLITUDE_KEY, key("decay", Unit::MS, [10.0, 1e5])],
        law: Law::Curve(
            turning(Variable::SinceReversal),
            |t, decay| (-t / decay).exp(),
            Some(inner("decay", Some(Scale::Logarithm), Start::Grid([0.05, 20.0], 14))),
        ),
        equation: "E = A b exp(-(time since the reversal) / decay); A above 0 overshoots, below 0 lags; 0 where the axis has never reversed",
        source: "friction changes sign before the servo has built up the opposite torque",
        remedy: "tune the backlash acceleration (Fanuc 2048 and following); check the lubrication of the guideways",
        taken_for: "backlash that builds up over a distance, where all runs had one feed",
        ..CAUSE
    },
    Cause {
        id: "growing-backlash",
        title: "backlash that grows along the travel",
        seat: SeatKind::Function,
        keys: &[
            Key {
                name: "slope",
                measure: Measure::OfSeatPerLength,
                default: None,
                limits: [-1e5, 1e5],
            },
            or(key("from", Unit::MM, [-1e5, 1e5]), 0.0),
        ],
        // From the middle of what was driven the reversal there stays what it is.
        law: Law::Curve(
            turning(Variable::Position),
            |h, from| h - from,
            Some(inner("from", None, Start::Middle)),
        ),
        equation: "E = slope b (h - from)",
        source: "a nut or a screw worn over part of the travel; a screw that winds up with its free length",
        remedy: "measure the reversal at several places (ISO 230-2), then preload or replace the nut; compensate by table",
        taken_for: "a constant reversal error; a squareness that differs with the direction",
        unseen: "Backlash that grows along the travel leaves nothing in the residuals for {}.",
        ..CAUSE
    },
    Cause {
        id: "pre-sliding",
        title: "backlash that builds up over a distance",
        seat: SeatKind::Function,
        keys: &[AMPLITUDE_KEY, key("distance", Unit::MM, [1e-3, 200.0])],
        law: Law::Curve(
            turning(Variable::WaySinceReversal),
            |s, distance| 1.0 - 2.0 * (-s / distance).exp(),
            // It ends within the way.
            Some(Inner {
                part_of_way: 1.0,
                ..inner("distance", Some(Scale::Logarithm), Start::Grid([0.02, 60.0], 16))
            }),
        ),
        equation: "E = A b (1 - 2 exp(-s / distance)), s the way since the reversal; A b where the axis has never reversed",
        source: "pre-sliding friction: seals, wipers and guideways yield elastically before they slide",
        remedy: "check lubrication and wipers; use friction compensation by distance rather than by time",
        taken_for: "a reversal spike, where all runs had one feed",
        ..CAUSE
    },
    Cause {
        id: "drift",
        title: "thermal drift",
        seat: SeatKind::Body,
        keys: &[AMPLITUDE_KEY, key("time_constant", Unit::S, [1.0, 1e7])],
        law: Law::Curve(
            ELAPSED,
            |t, constant| -(-t.max(0.0) / constant).exp_m1(),
            Some(inner(
                "time_constant",
                Some(Scale::Logarithm),
                Start::TimeConstants([0.03, 20.0], 14),
            )),
        ),
        equation: "x = A (1 - exp(-t / time constant)), of `bar` its reading; a long time constant is a straight line",
        source: "the spindle, a screw or the bar warms or cools during the run",
        remedy: "let machine and bar settle, shorten the test, drive the arcs in both orders; use spindle growth compensation",
        taken_for: "a constant error of the machine, where all arcs are driven once and in one order; a knock",
        ..CAUSE
    },
    Cause {
        id: "knock",
        title: "knock: a ball moved once",
        seat: SeatKind::Ball,
        keys: &[key("step", Unit::UM, [-1e4, 1e4]), key("moment", Unit::S, [0.0, 1e6]), RUN_KEY],
        law: Law::Curve(ELAPSED, STEP, Some(inner("moment", None, Start::Moments))),
        runs: Runs::One,
        equation: "x = step for t > moment, in that run",
        source: "the magnetic cup or the stand was touched; a chip came between ball and cup",
        remedy: "clean and fasten cup and stand, repeat the run",
        taken_for: "drift, a reading that was lost",
        ..CAUSE
    },
    Cause {
        id: "repeated-step",
        title: "step of a ball at the same moment of every run",
        seat: SeatKind::Ball,
        keys: &[key("step", Unit::UM, [-1e4, 1e4]), key("moment", Unit::S, [0.0, 1e6])],
        law: Law::Curve(PROGRAM, STEP, Some(inner("moment", None, Start::Moments))),
        equation: "x = step from this moment of the program on, without the operator's pauses, in every run",
        source: "something that the program does there: a hose or cable that snags, a clamp, a valve, a spindle that lets go",
        remedy: "watch the machine at that moment of the program; tie hoses and cables, hold the spindle",
        taken_for: "drift; a local fault of a guideway",
        ..CAUSE
    },
    Cause {
        id: "bar-length",
        title: "calibrated length of the bar",
        seat: SeatKind::None,
        keys: &[AMPLITUDE_KEY],
        law: Law::Constant,
        equation: "the bar reads A more",
        source: "a bar that was not calibrated, or was calibrated at another temperature",
        remedy: "calibrate the bar at the temperature of the test; measure with two lengths",
        taken_for: "the scales of all three axes at once (exactly, with one length)",
        unseen: "A wrong length of the bar is the same as a scale of all axes: a second bar length would tell them apart.",
        ..CAUSE
    },
    Cause {
        id: "roundness",
        title: "roundness of a ball or its seat",
        seat: SeatKind::None,
        keys: &[
            AMPLITUDE_KEY,
            key(DEGREE, Unit::NONE, [2.0, MOST_DEGREE as f64]),
            or(key(ORDER, Unit::NONE, [-8.0, 8.0]), 0.0),
        ],
        law: Law::Harmonics(inner(DEGREE, None, Start::Whole)),
        makes_any_curve: |_| true,
        equation: "the bar reads A Y more, Y the real spherical harmonic of rms 1 in the direction from the workpiece ball to the tool ball; orders above 0 go with the cosine of the azimuth, below 0 with the sine",
        source: "a ball out of round; a worn or dirty magnetic cup",
        remedy: "turn the ball in its holder and repeat; clean or replace ball and cup",
        taken_for: "higher degrees of error functions",
        ..CAUSE
    },
    Cause {
        id: "degree",
        title: "higher degree of an error function",
        seat: SeatKind::Function,
        keys: &[AMPLITUDE_KEY, key(DEGREE, Unit::NONE, [4.0, 6.0])],
        law: Law::Curve(
            over(Variable::Position),
            |h, degree| (h / 100.0).powi(degree as i32),
            Some(inner(DEGREE, None, Start::Whole)),
        ),
        makes_any_curve: |_| true,
        equation: "E = A (h / 100 mm)^degree",
        source: "guideways bent by their mounting; a screw that sags",
        remedy: "level and align the guideways; compensate by table",
        taken_for: "roundness of the balls; a local fault of the guideway",
        ..CAUSE
    },
    Cause {
        id: "vibration",
        title: "vibration at a fixed frequency",
        seat: SeatKind::Reading,
        keys: &[AMPLITUDE_KEY, key("frequency", Unit::HZ, [1e-3, 1e5]), PHASE_KEY],
        law: Law::Wave(
            ELAPSED,
            |t, frequency| t * frequency,
            inner("frequency", Some(Scale::Plain), Start::Lines),
        ),
        runs: Runs::Each,
        equation: "x = A sin(2 pi frequency t + phase), with another phase in every run",
        source: "a pump, a fan, a machine nearby, mains hum of the instrument; above half the sample rate it appears at another frequency",
        remedy: "switch auxiliaries off one by one; sample faster to know the true frequency",
        taken_for: "a cyclic error, where the feed is the same throughout",
        ..CAUSE
    },
    Cause {
        id: "stick-slip",
        title: "stick-slip: friction of an axis near standstill",
        seat: SeatKind::Slide,
        keys: &[AMPLITUDE_KEY, key("speed", Unit::MM_MIN, [0.1, 1e5])],
        law: Law::Curve(
            turning(Variable::Velocity),
            |v, speed| -(-v.abs() / speed).exp(),
            // Of a larger one exp(-abs(v) / speed) is a straight line up to the highest speed driven, within a tenth of its amplitude:
            // with b a reversal and a servo mismatch, which are known by their names.
            Some(Inner {
                part_of_fastest: 0.5,
                ..inner("speed", Some(Scale::Logarithm), Start::Grid([0.05, 20.0], 12))
            }),
        ),
        makes_any_curve: |_| true,
        equation: "E = -A b exp(-abs(v) / speed), also at rest: the axis lags where it is slow (Stribeck)",
        source: "friction of the guideways rises towards standstill",
        remedy: "check the lubrication, try another way oil; use friction compensation",
        taken_for: "a reversal spike; backlash that builds up over a distance",
        ..CAUSE
    },
    Cause {
        id: "feed-override",
        title: "feed override other than stated",
        seat: SeatKind::None,
        keys: &[key("percent", Unit::PERCENT, [1.0, 200.0])],
        law: Law::Setting,
        equation: "where the knob really stands: every time at feed is longer by 100 / percent",
        source: "the knob or a limit of the control",
        remedy: "state `feed_override_percent` of the run, or set the knob to 100",
        taken_for: "a clock that runs wrong",
        ..CAUSE
    },
    Cause {
        id: "clock",
        title: "clock of the instrument",
        seat: SeatKind::None,
        keys: &[key("ppm", Unit::PPM, [-1e4, 1e4])],
        law: Law::Setting,
        equation: "program time = (1 + ppm 1e-6) log time - start, in place of the scenario's",
        source: "a computer that stamps the samples",
        remedy: "state `clock_ppm` of the bar as it is",
        taken_for: "a feed override",
        ..CAUSE
    },
    BALL_PLACE,
    PIVOT,
    Cause {
        id: "coefficient",
        title: "coefficient that the chosen terms leave out",
        seat: SeatKind::Coefficient,
        keys: &[key("value", Unit::NONE, [-1.0, 1.0])],
        law: Law::Constant,
        equation: "adds to that coefficient",
        source: "terms that were chosen for another test",
        remedy: "add it to `terms`, or let `complete` choose",
        taken_for: "whatever behaves like it in this test",
        unseen: "{}: not among the chosen terms, and not to be told from them in these runs; further mountings would help (`ballbar plan`).",
        ..CAUSE
    },
    Cause {
        id: "bump",
        title: "local fault of a guideway",
        seat: SeatKind::Function,
        keys: &[
            AMPLITUDE_KEY,
            key("at", Unit::MM, [-1e4, 1e4]),
            key("width", Unit::MM, [0.1, 1e4]),
        ],
        law: Law::Unknown(over(Variable::Position)),
        equation: "E = A exp(-(h - at)^2 / (2 width^2))",
        source: "a dent, a joint, a worn stretch",
        ..CAUSE
    },
    Cause {
        id: "joint",
        title: "step where a guideway is joined",
        seat: SeatKind::Function,
        keys: &[
            AMPLITUDE_KEY,
            key("at", Unit::MM, [-1e4, 1e4]),
            key("width", Unit::MM, [0.1, 1e4]),
        ],
        law: Law::Unknown(over(Variable::Position)),
        equation: "E = A tanh((h - at) / width)",
        source: "a guideway made of pieces",
        ..CAUSE
    },
    Cause {
        id: "friction-tilt",
        title: "tilt of an axis by friction that rises with speed",
        seat: SeatKind::Angle,
        keys: &[AMPLITUDE_KEY],
        law: Law::Unknown(over(Variable::Velocity)),
        equation: "E = A b sqrt(abs(v) / (1000 mm/min))",
        source: "a drive beside the centre of friction",
        ..CAUSE
    },
];

impl Cause {
    /// The cause of a name.
    pub fn named(id: &str) -> Option<&'static Self> {
        CAUSES.iter().find(|cause| cause.id == id)
    }

    /// Its place in the order in which equally good ones are named.
    pub fn rank(&self) -> usize {
        CAUSES.iter().position(|cause| cause == self).unwrap_or(CAUSES.len())
    }
}
