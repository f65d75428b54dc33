//! The table of all causes.

use super::cause::{AMPLITUDE, Cause, Key, Kind, SeatKind};

const fn key(name: &'static str, si: f64, default: Option<f64>, limits: [f64; 2]) -> Key {
    Key { name, si, default, limits }
}

/// Its factor hangs on the seat; what stands here must spoil every result, and still equal itself.
const AMPLITUDE_KEY: Key = key(AMPLITUDE, f64::INFINITY, None, [-1e4, 1e4]);
const MINUTE_S: f64 = 60.0;

/// All causes, in the order in which equally good ones are named.
pub const CAUSES: &[Cause] = &[
    Cause {
        kind: Kind::Cyclic,
        id: "cyclic",
        title: "cyclic error of a screw or scale",
        seat: SeatKind::Function,
        keys: &[
            AMPLITUDE_KEY,
            key("period_mm", 1.0, None, [0.5, 500.0]),
            key("phase_rad", 1.0, Some(0.0), [-100.0, 100.0]),
        ],
        equation: "E(h) = A sin(2 pi h / period + phase)",
        source: "a ball screw that runs out or is mounted bent, its encoder out of centre; subdivision of a scale's signal",
        remedy: "check the screw's bearings, coupling and encoder mounting, or the scale's reading head; a periodic compensation table if the control has one",
        taken_for: "vibration, where the feed is the same all along; another harmonic of the same pitch",
        known: true,
    },
    Cause {
        kind: Kind::Servo,
        id: "servo",
        title: "servo mismatch: following error of a slide",
        seat: SeatKind::Slides,
        keys: &[key("delay_ms", 1e-3, None, [-1e3, 1e3])],
        equation: "E_HH = -delay v_H; what all slides have in common shows at the corners of chords only",
        source: "position loops with different gains, or feed-forward on some axes only",
        remedy: "set equal position gains (Fanuc 1825) and feed-forward on all axes, then repeat at two feeds",
        taken_for: "squareness at one feed and one direction, a wrong time of the log",
        known: true,
    },
    Cause {
        kind: Kind::ReversalSpike,
        id: "reversal-spike",
        title: "reversal spike of a slide",
        seat: SeatKind::Slide,
        keys: &[AMPLITUDE_KEY, key("decay_ms", 1e-3, None, [10.0, 1e5])],
        equation: "E_HH = A b exp(-(t - t_reversal) / decay); A > 0 overshoots, A < 0 lags",
        source: "friction turns its sign before the servo has built up the opposite torque",
        remedy: "tune the backlash acceleration (Fanuc 2048 and following), check the lubrication of the ways",
        taken_for: "pre-sliding, where all runs had one feed",
        known: true,
    },
    Cause {
        kind: Kind::GrowingBacklash,
        id: "growing-backlash",
        title: "backlash that grows along a slide",
        seat: SeatKind::Function,
        keys: &[key("slope_um_m", 1e-6, None, [-1e5, 1e5])],
        equation: "E(h) = slope b h",
        source: "a nut or a screw worn over part of its travel, a drive that winds up with the free length of its screw",
        remedy: "measure reversal at several places (ISO 230-2), then replace or preload the nut; compensate by table",
        taken_for: "a plain reversal error, a squareness that differs with the direction",
        known: true,
    },
    Cause {
        kind: Kind::PreSliding,
        id: "pre-sliding",
        title: "backlash that builds up over a distance",
        seat: SeatKind::Function,
        keys: &[AMPLITUDE_KEY, key("distance_mm", 1.0, None, [1e-3, 200.0])],
        equation: "E = A b (1 - 2 exp(-s / distance)), s = way since the reversal",
        source: "pre-sliding friction: seals, wipers and ways yield elastically before they slide",
        remedy: "lubrication and wipers; friction compensation by distance rather than by time",
        taken_for: "a reversal spike, where all runs had one feed",
        known: true,
    },
    Cause {
        kind: Kind::Drift,
        id: "drift",
        title: "thermal drift",
        seat: SeatKind::Body,
        keys: &[AMPLITUDE_KEY, key("time_constant_s", 1.0, None, [1.0, 1e7])],
        equation: "x = A (1 - exp(-t / time constant)); a long time constant is a straight line",
        source: "spindle, screw or bar warms or cools during the run",
        remedy: "let machine and bar come to rest, shorten the test, drive arcs in both orders; spindle growth compensation",
        taken_for: "a constant of the machine, where all arcs are driven once and in one order; a knock",
        known: true,
    },
    Cause {
        kind: Kind::Knock,
        id: "knock",
        title: "knock: a ball moved once",
        seat: SeatKind::Ball,
        keys: &[
            key("step_um", 1e-3, None, [-1e4, 1e4]),
            key("moment_s", 1.0, None, [0.0, 1e6]),
            key("run", 1.0, Some(1.0), [1.0, 1e4]),
        ],
        equation: "x = step for t > moment, in one run",
        source: "the magnetic cup or the stand was touched, a chip came between ball and cup",
        remedy: "clean and fasten cup and stand, repeat the run",
        taken_for: "drift, a reading that was lost",
        known: true,
    },
    Cause {
        kind: Kind::BarLength,
        id: "bar-length",
        title: "calibrated length of the bar",
        seat: SeatKind::None,
        keys: &[AMPLITUDE_KEY],
        equation: "length = A longer than stated",
        source: "a bar that was not calibrated, or at another temperature",
        remedy: "calibrate the bar at the temperature of the test; measure with two lengths",
        taken_for: "the scales of all three slides at once (exactly, with one length)",
        known: true,
    },
    Cause {
        kind: Kind::Roundness,
        id: "roundness",
        title: "roundness of a ball or its seat",
        seat: SeatKind::None,
        keys: &[
            AMPLITUDE_KEY,
            key("degree", 1.0, None, [2.0, 8.0]),
            key("order", 1.0, Some(0.0), [-8.0, 8.0]),
        ],
        equation: "length = A Y(degree, order; direction of the bar), Y of rms 1 over the sphere",
        source: "a ball out of round, a worn or dirty magnetic cup",
        remedy: "turn the ball in its holder and repeat; clean or replace ball and cup",
        taken_for: "higher degrees of error functions",
        known: true,
    },
    Cause {
        kind: Kind::Degree,
        id: "degree",
        title: "higher degree of an error function",
        seat: SeatKind::Function,
        keys: &[AMPLITUDE_KEY, key("degree", 1.0, None, [4.0, 6.0])],
        equation: "E(h) = A (h / 100 mm)^degree",
        source: "guideways bent by their mounting, a screw that sags",
        remedy: "level and align the ways; compensate by table",
        taken_for: "roundness of the balls, a local fault of the way",
        known: true,
    },
    Cause {
        kind: Kind::Vibration,
        id: "vibration",
        title: "vibration at a fixed frequency",
        seat: SeatKind::Reading,
        keys: &[
            AMPLITUDE_KEY,
            key("frequency_hz", 1.0, None, [1e-3, 1e5]),
            key("phase_rad", 1.0, Some(0.0), [-100.0, 100.0]),
        ],
        equation: "x = A sin(2 pi frequency t + phase), another phase in every run",
        source: "a pump, a fan, a machine beside this one, mains hum of the instrument; seen aliased above half the sample rate",
        remedy: "switch auxiliaries off one by one; sample faster to tell a frequency from its aliases",
        taken_for: "a cyclic error, where the feed is the same all along",
        known: true,
    },
    Cause {
        kind: Kind::StickSlip,
        id: "stick-slip",
        title: "stick-slip: friction near standstill of a slide",
        seat: SeatKind::Slide,
        keys: &[AMPLITUDE_KEY, key("speed_mm_min", 1.0 / MINUTE_S, None, [0.1, 1e5])],
        equation: "E_HH = -A sign(v) exp(-|v| / speed): the slide lags where it is slow (Stribeck)",
        source: "friction of the ways rises towards standstill",
        remedy: "lubrication, another way oil; friction compensation",
        taken_for: "a reversal spike, pre-sliding",
        known: true,
    },
    Cause {
        kind: Kind::FeedOverride,
        id: "feed-override",
        title: "feed override other than stated",
        seat: SeatKind::None,
        keys: &[key("percent", 1e-2, None, [1.0, 200.0])],
        equation: "every time at feed is longer by 100 / percent",
        source: "the knob, or a limit of the control",
        remedy: "state `feed_override_percent` of the run, or set the knob to 100",
        taken_for: "a clock that runs wrong",
        known: true,
    },
    Cause {
        kind: Kind::Clock,
        id: "clock",
        title: "clock of the instrument",
        seat: SeatKind::None,
        keys: &[key("ppm", 1e-6, None, [-1e4, 1e4])],
        equation: "program time = (1 + ppm 1e-6) log time - start",
        source: "a host that stamps the samples",
        remedy: "state `clock_ppm` of the bar as it is",
        taken_for: "a feed override",
        known: true,
    },
    Cause {
        kind: Kind::BallPlace,
        id: "ball-place",
        title: "place of the balls other than in the test file",
        seat: SeatKind::Ball,
        keys: &[
            key("offset_mm", 1.0, None, [-1e3, 1e3]),
            key("mounting", 1.0, Some(0.0), [0.0, 1e3]),
        ],
        equation: "of the tool ball (EXt ..): the tool is longer; of the workpiece ball (EXw ..): both balls meet elsewhere in the travel; mounting counts from 1, 0 is all",
        source: "a work offset or a tool length of another set-up",
        remedy: "read `coincidence_mm` and `tool_ball_mm` of the mounting from the control again",
        taken_for: "coefficients of the machine",
        known: true,
    },
    Cause {
        kind: Kind::Pivot,
        id: "pivot",
        title: "pivot other than in the machine file",
        seat: SeatKind::Slide,
        keys: &[],
        equation: "angular errors turn about the other of carriage and base",
        source: "the machine's construction",
        remedy: "correct `pivot` in the machine file",
        taken_for: "higher degrees of straightness",
        known: true,
    },
    Cause {
        kind: Kind::Coefficient,
        id: "coefficient",
        title: "coefficient that the chosen terms leave out",
        seat: SeatKind::Coefficient,
        keys: &[key("value", 1.0, None, [-1.0, 1.0])],
        equation: "one of the paper's 90",
        source: "terms chosen for another test",
        remedy: "add it to `terms`, or let `complete` choose",
        taken_for: "whatever is like it",
        known: true,
    },
    Cause {
        kind: Kind::Bump,
        id: "bump",
        title: "local fault of a guideway",
        seat: SeatKind::Function,
        keys: &[
            AMPLITUDE_KEY,
            key("at_mm", 1.0, None, [-1e4, 1e4]),
            key("width_mm", 1.0, None, [0.1, 1e4]),
        ],
        equation: "E(h) = A exp(-(h - at)^2 / (2 width^2))",
        source: "a dent, a joint, a worn stretch",
        remedy: "",
        taken_for: "",
        known: false,
    },
    Cause {
        kind: Kind::Joint,
        id: "joint",
        title: "step where a guideway is joined",
        seat: SeatKind::Function,
        keys: &[
            AMPLITUDE_KEY,
            key("at_mm", 1.0, None, [-1e4, 1e4]),
            key("width_mm", 1.0, None, [0.1, 1e4]),
        ],
        equation: "E(h) = A tanh((h - at) / width)",
        source: "ways made of pieces",
        remedy: "",
        taken_for: "",
        known: false,
    },
    Cause {
        kind: Kind::FrictionTilt,
        id: "friction-tilt",
        title: "tilt of a slide by friction that rises with speed",
        seat: SeatKind::Angle,
        keys: &[AMPLITUDE_KEY],
        equation: "E(v) = A sign(v) sqrt(|v| / 1000 mm/min)",
        source: "a drive beside the centre of friction",
        remedy: "",
        taken_for: "",
        known: false,
    },
];

impl Kind {
    /// The cause of this kind.
    pub fn cause(self) -> &'static Cause {
        // The table is in the order of the kinds.
        &CAUSES[self as usize]
    }
}

impl Cause {
    /// The cause of a name.
    pub fn named(id: &str) -> Option<&'static Self> {
        CAUSES.iter().find(|cause| cause.id == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_kinds() {
        for (index, cause) in CAUSES.iter().enumerate() {
            assert_eq!(cause.kind as usize, index);
            assert_eq!(cause.kind.cause().id, cause.id);
        }
    }
}
