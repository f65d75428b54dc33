//! Machine files, and how long a program takes on what they describe.

use ballbar::machine::Machine;
use ballbar::motion::Trajectory;

use super::{Target, accepted};
use crate::seeds::{self, RIGS};

pub const TARGET: Target = Target {
    name: "machine",
    seeds: || {
        let mut seeds = seeds::all_of_project("machines", ".toml");
        seeds.extend(seeds::all_of_project("tests/data", "machine.toml"));
        seeds.extend(
            [seeds::FULL_MACHINE, seeds::OTHER_MACHINE].map(|text| text.as_bytes().to_vec()),
        );
        seeds
    },
    words: WORDS,
    made: &[],
    read,
};

pub const WORDS: &[&str] = &[
    "name",
    "topology",
    "axes",
    "X",
    "Y",
    "Z",
    "travel_mm",
    "rapid_mm_min",
    "acceleration_mm_s2",
    "max_feed_mm_min",
    "feed_acceleration_mm_s2",
    "pivot",
    "carriage",
    "base",
    "screw_pitch_mm",
    "location_mm",
    "retract_mm",
    "controller",
    "dialect",
    "fanuc",
    "linuxcnc",
    "decimals",
    "sequence_step",
    "comment_characters",
    "look_ahead_on",
    "look_ahead_off",
    "path_acceleration_mm_s2",
    "corner_stop_deg",
    "corner_speed_step_mm_min",
    "corner_tolerance_um",
    "acceleration_change_ms",
    "block_time_ms",
    "memory_kb",
    "clearance",
    "tool",
    "spindle_nose",
    "support",
    "diameter_mm",
    "length_mm",
    "direction",
    "-Z",
    "plausible",
    "slope_um_m",
    "way_um",
    "reversal_um",
    "turn_urad",
    "bend_urad",
    "tip_urad",
    "set_up_um",
    "wXYFZSt",
    "wCBXFZYSt",
    "wFXYZt",
    "wXYZFt",
    "M03 S20000",
    "G05 P10000",
    "G08 P1",
    "true",
    "[[",
    "nan",
    "inf",
];

fn read(input: &[u8]) -> bool {
    let machine = Machine::parse(&seeds::as_text(input), "machine.toml".as_ref());
    if let Ok(machine) = &machine {
        let planned = &RIGS[0].programs[0];
        let trajectory = Trajectory::new(&planned.program, machine, 1.0);
        let time = trajectory.duration();
        assert!(
            time.known_s().is_finite() && time.known_s() >= 0.0,
            "a program takes a time: {time:?}"
        );
        let end = trajectory.at(0.5 * trajectory.end_s());
        assert!(
            end.position_mm.iter().all(|mm| mm.is_finite()),
            "the machine is somewhere: {end:?}"
        );
        planned.path.least_clearance(machine);
    }
    accepted(&machine)
}
